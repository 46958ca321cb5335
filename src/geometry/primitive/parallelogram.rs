//! The parallelogram, watertight against its neighbours.

use super::super::{Bounds, Meeting, PreciseRay, SurfacePoint};
use super::coefficients;
use super::triangle::meet_sheared;
use crate::sampler::inverse::unit;
use glam::{DVec3, Vec3, Vec3A};

/// A parallelogram that keeps all four corners.
///
/// A fourth corner computed from the other three would differ by a rounding from the corner
/// a neighbour has there, and rays would slip through. With four corners it is in truth two
/// triangles along the diagonal, bent by that rounding; the bend enters the error bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parallelogram {
    /// In the order corner, corner + first edge, corner + both, corner + second edge.
    corners: [[f32; 3]; 4],
}

impl Parallelogram {
    /// A parallelogram from its corners, counter-clockwise seen from the side of its normal;
    /// `None` when it has no area. That opposite edges agree to rounding is the caller's care.
    pub fn new(corners: [Vec3; 4]) -> Option<Self> {
        let parallelogram = Self { corners: corners.map(|v| v.to_array()) };
        let area = parallelogram.area();
        (area > 0.0 && area.is_finite()).then_some(parallelogram)
    }

    /// A parallelogram from one corner and the two edges that leave it.
    pub fn from_edges(corner: Vec3, edge_u: Vec3, edge_v: Vec3) -> Option<Self> {
        Self::new([corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v])
    }

    /// The corners, counter-clockwise seen from the side of the normal.
    pub fn corners(&self) -> [Vec3; 4] {
        self.corners.map(Vec3::from)
    }

    /// A box around the parallelogram.
    pub fn bounds(&self) -> Bounds {
        let [a, b, c, d] = self.corners.map(Vec3A::from);
        Bounds { min: a.min(b).min(c.min(d)), max: a.max(b).max(c.max(d)) }
    }

    /// The place where `ray` meets the parallelogram, edges and corners included.
    #[inline(always)]
    pub fn intersect(&self, ray: &PreciseRay) -> Option<Meeting> {
        let [a, b, c, d] = &self.corners;
        let [a, b, c, d] = [ray.sheared(a), ray.sheared(b), ray.sheared(c), ray.sheared(d)];
        let first =
            meet_sheared([a, b, c]).map(|(t, [_, to_b, to_c])| Meeting { t, u: to_b + to_c, v: to_c });
        let meeting = first.or_else(|| {
            meet_sheared([a, c, d]).map(|(t, [_, to_c, to_d])| Meeting { t, u: to_c, v: to_c + to_d })
        })?;
        ray.reaches(meeting.t).then_some(meeting)
    }

    /// The point of a meeting.
    #[inline]
    pub fn point(&self, _ray: &PreciseRay, meeting: &Meeting) -> SurfacePoint {
        self.at(meeting.u, meeting.v)
    }

    /// Surface area.
    pub fn area(&self) -> f32 {
        self.cross().length() as f32
    }

    /// A point uniform over the area.
    #[inline]
    pub fn sample_area(&self, u: [f32; 2]) -> SurfacePoint {
        self.at(f64::from(u[0]), f64::from(u[1]))
    }

    /// The numbers with which `sample_area` draws a position.
    #[inline]
    pub fn invert_area(&self, position: Vec3A) -> [f32; 2] {
        self.shares_of(position).map(unit)
    }

    /// The shares of both edges at which a position lies, beyond 0 to 1 by its own rounding.
    #[inline]
    pub fn shares_of(&self, position: Vec3A) -> [f64; 2] {
        let [a, b, c, d] = self.doubles();
        let offset = position.as_dvec3() - a;
        let [u, v] = coefficients(offset, b - a, c - b);
        if u >= v { [u, v] } else { coefficients(offset, c - d, d - a) }
    }

    /// The point at shares of both edges.
    #[inline]
    pub fn at(&self, u: f64, v: f64) -> SurfacePoint {
        let [a, b, c, d] = self.doubles();
        let position =
            if u >= v { a * (1.0 - u) + b * (u - v) + c * v } else { a * (1.0 - v) + d * (v - u) + c * u };
        let sizes = self.corners.map(|v| Vec3A::from(v).abs());
        let reach = sizes[0].max(sizes[1]).max(sizes[2].max(sizes[3])).max_element();
        let bend = (a - b + c - d).abs();
        SurfacePoint::rounded(position, f64::from(reach), bend, self.cross())
    }

    #[inline]
    fn cross(&self) -> DVec3 {
        let [a, b, c, d] = self.doubles();
        // Half the cross product of the diagonals: the area vector of any quadrilateral.
        0.5 * (c - a).cross(d - b)
    }

    #[inline]
    fn doubles(&self) -> [DVec3; 4] {
        self.corners.map(|v| Vec3::from(v).as_dvec3())
    }
}
