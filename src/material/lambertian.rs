//! Perfectly matte: the same radiance into all directions of the side that is lit.

use std::f32::consts::{FRAC_1_PI, FRAC_PI_4};

use glam::Vec3A;

use super::facing::Upright;
use super::{BsdfSample, BsdfValue};
use crate::sampler::inverse::square_of_disk;
use crate::spectrum::Spectrum;

/// f = reflectance / pi on the side that `wo` is on.
#[derive(Clone, Copy, Debug)]
pub struct Lambertian {
    /// Share of the power that is reflected, in [0, 1].
    pub reflectance: Spectrum,
    /// Whether the back (z < 0) reflects too; otherwise it is black.
    pub two_sided: bool,
}

impl Lambertian {
    #[inline]
    pub(super) fn evaluate(&self, wo: Vec3A, wi: Vec3A) -> BsdfValue {
        let Some(upright) = Upright::of_opaque(wo, self.two_sided) else {
            return BsdfValue::ZERO;
        };
        let pdf = upright.turn(wi).z.max(0.0) * FRAC_1_PI;
        BsdfValue { value: self.reflectance * pdf, pdf: Spectrum::splat(pdf) }
    }

    #[inline]
    pub(super) fn pdf(&self, wo: Vec3A, wi: Vec3A) -> f32 {
        let upright = Upright::of_opaque(wo, self.two_sided);
        upright.map_or(0.0, |upright| upright.turn(wi).z.max(0.0) * FRAC_1_PI)
    }

    #[inline]
    pub(super) fn sample(&self, wo: Vec3A, u: [f32; 2]) -> Option<BsdfSample> {
        let upright = Upright::of_opaque(wo, self.two_sided)?;
        let wi = upright.turn(cosine_distributed(u));
        BsdfSample::of_lobe(wi, self.evaluate(wo, wi), false)
    }

    /// The numbers that draw `wi`, from whichever side.
    pub(super) fn invert(&self, wi: Vec3A) -> [f32; 2] {
        // Of exactly unit length the projection tells heights above the rim best.
        let wi = wi.as_dvec3().normalize();
        square_of_disk([wi.x, wi.y])
    }
}

/// A direction of the upper hemisphere with density cos / pi: the disc lifted to the sphere.
#[inline]
fn cosine_distributed(u: [f32; 2]) -> Vec3A {
    let (radius, [cos, sin]) = disk_of_square(u);
    let z = ((1.0 - radius) * (1.0 + radius)).max(0.0).sqrt();
    Vec3A::new(radius * cos, radius * sin, z)
}

/// The concentric map of the square to the unit disk (Shirley and Chiu 1997): the radius, which
/// may be negative, and cosine and sine of the angle.
#[inline]
fn disk_of_square(u: [f32; 2]) -> (f32, [f32; 2]) {
    let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    let (radius, across, is_first) = if a.abs() > b.abs() { (a, b, true) } else { (b, a, false) };
    // Off the axis by at most an eighth of a turn.
    let (cos, sin) = cos_sin(if radius == 0.0 { 0.0 } else { FRAC_PI_4 * (across / radius) });
    (radius, if is_first { [cos, sin] } else { [sin, cos] })
}

/// Cosine and sine of an angle of at most pi/4, by their Taylor series: off by less than 3e-8
/// before rounding, and the same on every machine.
#[inline]
fn cos_sin(x: f32) -> (f32, f32) {
    let s = x * x;
    let cos = 1.0 - s * (1.0 / 2.0 - s * (1.0 / 24.0 - s * (1.0 / 720.0 - s * (1.0 / 40_320.0))));
    let sin = x * (1.0 - s * (1.0 / 6.0 - s * (1.0 / 120.0 - s * (1.0 / 5_040.0 - s * (1.0 / 362_880.0)))));
    (cos, sin)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Within three units in the last place of 1.
    #[test]
    fn cosine_and_sine_are_those_of_the_angle() {
        for i in -10_000..=10_000 {
            let x = FRAC_PI_4 * (i as f32 / 10_000.0);
            let (cos, sin) = cos_sin(x);
            let (exact_sin, exact_cos) = f64::from(x).sin_cos();
            let error = (f64::from(cos) - exact_cos).abs().max((f64::from(sin) - exact_sin).abs());
            assert!(error < 1.5 * f64::from(f32::EPSILON), "{x}: off by {error}");
        }
    }
}
