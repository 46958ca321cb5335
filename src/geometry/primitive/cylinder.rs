//! The lateral surface of a cylinder.

use super::super::precise::round_roots;
use super::super::{Bounds, Meeting, PreciseRay, SurfacePoint};
use super::{around, turn_around};
use crate::sampler::inverse::unit;
use glam::{DVec3, Vec3, Vec3A};
use std::f64::consts::TAU;

/// Relative slack at the rims, a few hundred units in the last place of `f64`: it closes the
/// gap that rounding would leave between the lateral surface and a cap.
pub(super) const RIM_SLACK: f64 = 512.0 * f64::EPSILON;

/// The lateral surface of a right circular cylinder, open at both ends; its normal points
/// away from the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    from: Vec3,
    radius: f32,
    axis: DVec3,
    length: f64,
}

impl Cylinder {
    /// A cylinder around the segment between two points; `None` when length or radius is not
    /// positive and finite.
    pub fn new(from: Vec3, to: Vec3, radius: f32) -> Option<Self> {
        let span = to.as_dvec3() - from.as_dvec3();
        let length = span.length();
        let valid = length > 0.0 && length.is_finite() && radius > 0.0 && radius.is_finite();
        valid.then(|| Self { from, radius, axis: span / length, length })
    }

    /// Unit vector from the first end to the second.
    pub fn axis(&self) -> DVec3 {
        self.axis
    }

    /// Radius.
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// A box around the cylinder.
    pub fn bounds(&self) -> Bounds {
        let reach = disk_reach(self.axis, self.radius);
        let from = self.from.as_dvec3();
        let to = from + self.axis * self.length;
        Bounds::around(from.min(to) - reach, from.max(to) + reach)
    }

    /// The nearest place where `ray` meets the lateral surface.
    #[inline(always)]
    pub fn intersect(&self, ray: &PreciseRay) -> Option<Meeting> {
        let offset = ray.origin - self.from.as_dvec3();
        let (height, climb) = (offset.dot(self.axis), ray.direction.dot(self.axis));
        let across = offset - self.axis * height;
        let sideways = ray.direction - self.axis * climb;
        let roots = round_roots(across, sideways, f64::from(self.radius))?;
        let slack = RIM_SLACK * (self.length + height.abs());
        ray.first_of(roots, |t| {
            let height = height + t * climb;
            height >= -slack && height <= self.length + slack
        })
    }

    /// The point of a meeting, brought back onto the surface.
    #[inline]
    pub fn point(&self, ray: &PreciseRay, meeting: &Meeting) -> SurfacePoint {
        let offset = ray.at(meeting.t) - self.from.as_dvec3();
        let height = offset.dot(self.axis);
        let outward = (offset - self.axis * height).normalize_or(around(self.axis, 0.0));
        self.at(height, outward)
    }

    /// Surface area, without caps.
    pub fn area(&self) -> f32 {
        (TAU * f64::from(self.radius) * self.length) as f32
    }

    /// A point uniform over the area.
    #[inline]
    pub fn sample_area(&self, u: [f32; 2]) -> SurfacePoint {
        self.at(f64::from(u[0]) * self.length, around(self.axis, f64::from(u[1])))
    }

    /// The numbers with which `sample_area` draws a position.
    #[inline]
    pub fn invert_area(&self, position: Vec3A) -> [f32; 2] {
        let offset = position.as_dvec3() - self.from.as_dvec3();
        [unit(offset.dot(self.axis) / self.length), unit(turn_around(self.axis, offset))]
    }

    #[inline]
    fn at(&self, height: f64, outward: DVec3) -> SurfacePoint {
        let (from, radius) = (self.from.as_dvec3(), f64::from(self.radius));
        let position = from + self.axis * height + outward * radius;
        let reach = from.abs().max_element() + radius + self.length;
        SurfacePoint::rounded(position, reach, DVec3::ZERO, outward)
    }
}

/// How far a disk reaches from its centre along each coordinate axis, rounded up.
pub(super) fn disk_reach(normal: DVec3, radius: f32) -> DVec3 {
    let across = (DVec3::ONE - normal * normal).max(DVec3::ZERO);
    // The slack covers an axis whose squared length is not exactly one.
    let sine = (across + DVec3::splat(RIM_SLACK)).map(f64::sqrt);
    sine * (f64::from(radius) * (1.0 + RIM_SLACK))
}
