//! A rectangular lamp near the point that it lights: drawn from by the solid angle that it fills
//! times the cosine at the point, as far as its four corners tell that.
//!
//! From further away area sampling does as well and costs half. The cosine is that off the true
//! normal, on either side: what is lit may transmit.

use super::bilinear::Bilinear;
use crate::geometry::SurfacePoint;
use crate::geometry::primitive::{Parallelogram, SphericalRectangle};
use glam::DVec3;

/// A rectangle near a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearRectangle {
    rectangle: SphericalRectangle,
    cosines: Bilinear,
}

/// Least squared diagonal of a lamp that is near, over the squared distance of its centre.
const NEAR: f64 = 0.5;
/// Largest cosine between the edges of a rectangle: what rounding its corners makes of a right
/// angle.
const RIGHT: f64 = 1e-6;
/// Least cosine at a corner: between corners that the horizon passes through there is light too.
const LEAST_COSINE: f64 = 0.01;

impl NearRectangle {
    /// `None` for a lamp that is not near, or no rectangle, or seen too flatly for its arithmetic.
    #[inline]
    pub fn new(quad: &Parallelogram, from: &SurfacePoint) -> Option<Self> {
        let [a, b, c, d] = quad.corners().map(|corner| corner.as_dvec3() - from.position.as_dvec3());
        let center = 0.25 * (a + b + c + d);
        if (c - a).length_squared() < NEAR * center.length_squared() {
            return None;
        }
        let [first, second] = [b - a, d - a];
        let right = RIGHT * RIGHT * first.length_squared() * second.length_squared();
        if first.dot(second).powi(2) > right {
            return None;
        }
        let rectangle = SphericalRectangle::new(a, [first, second])?;
        let normal = from.normal.as_dvec3();
        let cosine = |corner: DVec3| (normal.dot(corner).abs() / corner.length()).max(LEAST_COSINE);
        Some(Self { rectangle, cosines: Bilinear([a, b, d, c].map(cosine)) })
    }

    /// Draws a point with its density in sr^-1.
    #[inline]
    pub fn sample(&self, quad: &Parallelogram, u: [f32; 2]) -> (SurfacePoint, f32) {
        let place = self.cosines.sample(u.map(f64::from));
        let [s, t] = self.rectangle.sample(place);
        (quad.at(s, t), self.density(place))
    }

    /// The density in sr^-1 with which a point is drawn.
    #[inline]
    pub fn pdf(&self, quad: &Parallelogram, point: &SurfacePoint) -> f32 {
        self.density(self.rectangle.invert(quad.shares_of(point.position)))
    }

    /// The numbers that draw a point.
    #[inline]
    pub fn invert(&self, quad: &Parallelogram, point: &SurfacePoint) -> [f64; 2] {
        self.cosines.invert(self.rectangle.invert(quad.shares_of(point.position)))
    }

    #[inline]
    fn density(&self, place: [f64; 2]) -> f32 {
        (self.cosines.density(place) / self.rectangle.solid_angle()) as f32
    }
}
