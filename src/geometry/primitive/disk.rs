//! The flat disk.

use super::super::{Bounds, Meeting, PreciseRay, SurfacePoint};
use super::cylinder::{RIM_SLACK, disk_reach};
use super::{around, turn_around};
use crate::sampler::inverse::unit;
use glam::{DVec3, Vec3, Vec3A};
use std::f64::consts::PI;

/// A flat disk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    center: Vec3,
    radius: f32,
    normal: DVec3,
}

impl Disk {
    /// A disk across `normal` (any length); `None` when radius or normal has no size.
    pub fn new(center: Vec3, normal: DVec3, radius: f32) -> Option<Self> {
        let normal = normal.try_normalize()?;
        (radius > 0.0 && radius.is_finite() && center.is_finite()).then_some(Self { center, radius, normal })
    }

    /// Centre.
    pub fn center(&self) -> Vec3 {
        self.center
    }

    /// Radius.
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// Unit normal.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// A box around the disk.
    pub fn bounds(&self) -> Bounds {
        let reach = disk_reach(self.normal, self.radius);
        let center = self.center.as_dvec3();
        Bounds::around(center - reach, center + reach)
    }

    /// The place where `ray` meets the disk, rim included.
    #[inline(always)]
    pub fn intersect(&self, ray: &PreciseRay) -> Option<Meeting> {
        let span = self.center.as_dvec3() - ray.origin;
        let t = span.dot(self.normal) / ray.direction.dot(self.normal);
        // False for NaN and infinity too: a ray along the plane does not meet it.
        if !ray.reaches(t) {
            return None;
        }
        let radius2 = f64::from(self.radius).powi(2) * (1.0 + 2.0 * RIM_SLACK);
        let inside = (ray.direction * t - span).length_squared() <= radius2;
        inside.then_some(Meeting { t, u: 0.0, v: 0.0 })
    }

    /// The point of a meeting, brought back onto the plane.
    #[inline]
    pub fn point(&self, ray: &PreciseRay, meeting: &Meeting) -> SurfacePoint {
        let offset = ray.at(meeting.t) - self.center.as_dvec3();
        self.at(offset - self.normal * offset.dot(self.normal))
    }

    /// Surface area of the side that the normal points to.
    pub fn area(&self) -> f32 {
        (PI * f64::from(self.radius) * f64::from(self.radius)) as f32
    }

    /// A point uniform over the area.
    #[inline]
    pub fn sample_area(&self, u: [f32; 2]) -> SurfacePoint {
        let distance = f64::from(self.radius) * f64::from(u[0]).sqrt();
        self.at(around(self.normal, f64::from(u[1])) * distance)
    }

    /// The numbers with which `sample_area` draws a position.
    #[inline]
    pub fn invert_area(&self, position: Vec3A) -> [f32; 2] {
        let offset = position.as_dvec3() - self.center.as_dvec3();
        let across = offset - self.normal * offset.dot(self.normal);
        let share = across.length_squared() / f64::from(self.radius).powi(2);
        [unit(share), unit(turn_around(self.normal, across))]
    }

    #[inline]
    fn at(&self, offset: DVec3) -> SurfacePoint {
        let center = self.center.as_dvec3();
        let reach = center.abs().max_element() + f64::from(self.radius);
        SurfacePoint::rounded(center + offset, reach, DVec3::ZERO, self.normal)
    }
}
