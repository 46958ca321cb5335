//! The sphere.

use super::super::precise::round_roots;
use super::super::{Bounds, Meeting, PreciseRay, SurfacePoint};
use super::{around, turn_around};
use crate::sampler::inverse::unit;
use glam::{DVec3, Vec3, Vec3A};
use std::f64::consts::PI;

/// A whole sphere; its normal points outward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    center: Vec3,
    radius: f32,
}

impl Sphere {
    /// A sphere; `None` when the radius is not positive and finite.
    pub fn new(center: Vec3, radius: f32) -> Option<Self> {
        (radius > 0.0 && radius.is_finite() && center.is_finite()).then_some(Self { center, radius })
    }

    /// Centre.
    pub fn center(&self) -> Vec3 {
        self.center
    }

    /// Radius.
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// A box around the sphere.
    pub fn bounds(&self) -> Bounds {
        let reach = DVec3::splat(f64::from(self.radius));
        let center = self.center.as_dvec3();
        Bounds::around(center - reach, center + reach)
    }

    /// The nearest place where `ray` meets the sphere.
    #[inline(always)]
    pub fn intersect(&self, ray: &PreciseRay) -> Option<Meeting> {
        let offset = ray.origin - self.center.as_dvec3();
        let roots = round_roots(offset, ray.direction, f64::from(self.radius))?;
        ray.first_of(roots, |_| true)
    }

    /// The point of a meeting, brought back onto the sphere.
    #[inline]
    pub fn point(&self, ray: &PreciseRay, meeting: &Meeting) -> SurfacePoint {
        let outward = (ray.at(meeting.t) - self.center.as_dvec3()).normalize_or(DVec3::Z);
        self.towards(outward)
    }

    /// Surface area.
    pub fn area(&self) -> f32 {
        (4.0 * PI * f64::from(self.radius) * f64::from(self.radius)) as f32
    }

    /// A point uniform over the area.
    #[inline]
    pub fn sample_area(&self, u: [f32; 2]) -> SurfacePoint {
        let height = 1.0 - 2.0 * f64::from(u[0]);
        let across = (1.0 - height * height).max(0.0).sqrt();
        self.towards(around(DVec3::Z, f64::from(u[1])) * across + DVec3::Z * height)
    }

    /// The numbers with which `sample_area` draws a position.
    #[inline]
    pub fn invert_area(&self, position: Vec3A) -> [f32; 2] {
        self.invert_outward(position.as_dvec3() - self.center.as_dvec3())
    }

    #[inline]
    fn invert_outward(&self, outward: DVec3) -> [f32; 2] {
        let outward = outward.normalize_or(DVec3::Z);
        let height = outward.z;
        // One minus the height, without cancellation about the pole.
        let fall =
            if height > 0.0 { outward.truncate().length_squared() / (1.0 + height) } else { 1.0 - height };
        [unit(0.5 * fall), unit(turn_around(DVec3::Z, outward))]
    }

    /// A point seen from `from`, uniform over the solid angle that the sphere fills, and its
    /// density per steradian; from inside, a point uniform over the area with its density
    /// converted. `None` only when a point from inside coincides with `from`.
    #[inline]
    pub fn sample_solid_angle(&self, from: Vec3A, u: [f32; 2]) -> Option<(SurfacePoint, f32)> {
        let Some(cone) = self.cone(from) else {
            let point = self.sample_area(u);
            let pdf = self.pdf_from_inside(from, &point);
            return (pdf > 0.0 && pdf.is_finite()).then_some((point, pdf));
        };
        // One minus the cosine of the angle off the axis, then the angle at the centre
        // (Pharr, Jakob, Humphreys, 4th ed., section 6.2.4).
        let fall = f64::from(u[0]) * cone.one_minus_cos;
        let sin2 = fall * (2.0 - fall);
        let inside = (1.0 - sin2 / cone.sin2).max(0.0).sqrt();
        let cos_center = (sin2 / cone.sin2.sqrt() + (1.0 - fall) * inside).min(1.0);
        let sin_center = (1.0 - cos_center * cos_center).max(0.0).sqrt();
        let outward = cone.axis * cos_center + around(cone.axis, f64::from(u[1])) * sin_center;
        Some((self.towards(outward), cone.pdf()))
    }

    /// The numbers with which [`Self::sample_solid_angle`] draws `point`, a point of this
    /// sphere; `None` where the sphere hides it from `from`.
    ///
    /// The normal decides which point it is: on a small sphere it tells more than the position.
    #[inline]
    pub fn invert_solid_angle(&self, from: Vec3A, point: &SurfacePoint) -> Option<[f32; 2]> {
        let outward = point.normal.as_dvec3().normalize_or(DVec3::Z);
        let Some(cone) = self.cone(from) else { return Some(self.invert_outward(outward)) };
        let (center, radius) = (self.center.as_dvec3(), f64::from(self.radius));
        let distance = from.as_dvec3().distance(center);
        let cos_center = outward.dot(cone.axis);
        let reach = center.abs().max_element() + radius + distance;
        if cos_center < radius / distance - HORIZON_SLACK * reach / distance {
            return None;
        }
        let across = (outward - cone.axis * cos_center) * radius;
        let along = distance - radius * cos_center;
        let sin2 = across.length_squared() / (across.length_squared() + along * along);
        let fall = sin2 / (1.0 + (1.0 - sin2).max(0.0).sqrt());
        Some([unit(fall / cone.one_minus_cos), unit(turn_around(cone.axis, across))])
    }

    /// The density per steradian with which [`Self::sample_solid_angle`] draws `point`, which
    /// must be a point of this sphere that `from` sees.
    #[inline]
    pub fn pdf_solid_angle(&self, from: Vec3A, point: &SurfacePoint) -> f32 {
        match self.cone(from) {
            Some(cone) => cone.pdf(),
            None => self.pdf_from_inside(from, point),
        }
    }

    #[inline]
    fn pdf_from_inside(&self, from: Vec3A, point: &SurfacePoint) -> f32 {
        let span = from.as_dvec3() - point.position.as_dvec3();
        // Distance squared over cosine.
        let foreshortening = span.length_squared() * span.length() / span.dot(point.normal.as_dvec3()).abs();
        (foreshortening / f64::from(self.area())) as f32
    }

    /// The cone of directions that meet the sphere; `None` from inside or on it, which
    /// includes points of the sphere itself that rounding has put outside.
    #[inline]
    fn cone(&self, from: Vec3A) -> Option<Cone> {
        let center = self.center.as_dvec3();
        let span = from.as_dvec3() - center;
        let (distance2, radius2) = (span.length_squared(), f64::from(self.radius).powi(2));
        // Positions are rounded to f32 in the coordinates of the scene, not of the sphere.
        let rounding = 2.0 * f64::from(f32::EPSILON) * (center.abs().max_element() + f64::from(self.radius));
        if distance2 <= (f64::from(self.radius) + rounding).powi(2) {
            return None;
        }
        let sin2 = radius2 / distance2;
        let cos = ((distance2 - radius2) / distance2).sqrt();
        // 1 - cos itself would cancel for a small or far sphere.
        let one_minus_cos = sin2 / (1.0 + cos);
        Some(Cone { axis: span / distance2.sqrt(), sin2, one_minus_cos })
    }

    #[inline]
    fn towards(&self, outward: DVec3) -> SurfacePoint {
        let (center, radius) = (self.center.as_dvec3(), f64::from(self.radius));
        let reach = center.abs().max_element() + radius;
        SurfacePoint::rounded(center + outward * radius, reach, DVec3::ZERO, outward)
    }
}

/// How far beyond the horizon a point still counts as seen, relative to the largest
/// coordinate: both the point and the place it was met from are rounded to `f32`.
const HORIZON_SLACK: f64 = 16.0 * f32::EPSILON as f64;

/// The directions from a point to a sphere.
struct Cone {
    /// Unit vector from the sphere's centre to the point.
    axis: DVec3,
    /// Squared sine of the half angle.
    sin2: f64,
    /// One minus the cosine of the half angle.
    one_minus_cos: f64,
}

impl Cone {
    #[inline]
    fn pdf(&self) -> f32 {
        (0.5 / (PI * self.one_minus_cos)) as f32
    }
}
