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
    pub(super) fn evaluate(&self, wo: Vec3A, wi: Vec3A) -> BsdfValue {
        let Some(upright) = Upright::of_opaque(wo, self.two_sided) else {
            return BsdfValue::ZERO;
        };
        let pdf = upright.turn(wi).z.max(0.0) * FRAC_1_PI;
        BsdfValue { value: self.reflectance * pdf, pdf: Spectrum::splat(pdf) }
    }

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

/// A direction of the upper hemisphere with density cos / pi.
///
/// Concentric map of the square to the disc (Shirley and Chiu 1997), lifted to the sphere.
fn cosine_distributed(u: [f32; 2]) -> Vec3A {
    let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    let (radius, phi) = if a.abs() > b.abs() {
        (a, FRAC_PI_4 * (b / a))
    } else if b != 0.0 {
        (b, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (a / b))
    } else {
        (0.0, 0.0)
    };
    let z = ((1.0 - radius) * (1.0 + radius)).max(0.0).sqrt();
    Vec3A::new(radius * phi.cos(), radius * phi.sin(), z)
}
