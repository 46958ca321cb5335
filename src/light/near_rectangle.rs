//! A rectangular lamp near the point that it lights: drawn from by the solid angle that it fills.
//!
//! Near a lamp, the density that area sampling has over directions varies by orders of magnitude;
//! from further away both are alike, and the solid angle costs more. The cosine at the point is
//! left out: a product with it takes another 3 % off the variance and costs as much.

use crate::geometry::SurfacePoint;
use crate::geometry::primitive::{Parallelogram, SphericalRectangle};
use crate::sampler::inverse::unit;

/// A rectangle near a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearRectangle<'p> {
    quad: &'p Parallelogram,
    seen: SphericalRectangle,
}

/// Least squared diagonal of a lamp that is near, over the squared distance of its centre.
const NEAR: f64 = 0.5;
/// How far a corner of a rectangle may be off, relative to the largest coordinate: by its rounding
/// and those of two neighbours.
const CORNER_ROUNDING: f64 = 2.0 * f32::EPSILON as f64;

impl<'p> NearRectangle<'p> {
    /// `None` for a lamp that is not near, or no rectangle, or seen too flatly for its arithmetic.
    #[inline]
    pub fn new(quad: &'p Parallelogram, from: &SurfacePoint) -> Option<Self> {
        let [a, b, c, d] = quad.corners().map(|corner| corner.as_dvec3() - from.position.as_dvec3());
        let center = 0.25 * (a + b + c + d);
        if (c - a).length_squared() < NEAR * center.length_squared() {
            return None;
        }
        let [first, second] = [b - a, d - a];
        let reach = quad.corners().map(|corner| f64::from(corner.abs().max_element()));
        let off = CORNER_ROUNDING * reach.into_iter().fold(0.0, f64::max);
        if first.dot(second).abs() > off * (first.length() + second.length()) {
            return None;
        }
        Some(Self { quad, seen: SphericalRectangle::new(a, [first, second])? })
    }

    /// The point that two numbers name.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> SurfacePoint {
        let [s, t] = self.seen.sample(u.map(f64::from));
        self.quad.at(s, t)
    }

    /// Density of every point in sr^-1.
    #[inline]
    pub fn pdf(&self) -> f32 {
        (1.0 / self.seen.solid_angle()) as f32
    }

    /// The numbers that name a point.
    #[inline]
    pub fn invert(&self, point: &SurfacePoint) -> [f32; 2] {
        self.seen.invert(self.quad.shares_of(point.position)).map(unit)
    }
}
