//! What a ray can meet: five kinds of surface in scene units.
//!
//! The contract of each kind, by the same names everywhere: `bounds` holds every point;
//! `intersect` finds the nearest meeting with 0 < t < t_max; `point` turns a meeting into a
//! position with its error bound; `area`; `sample_area` draws points with density 1/area,
//! and `invert_area` gives back the numbers that draw a point.

mod cylinder;
mod disk;
mod parallelogram;
mod sphere;
mod spherical_rectangle;
mod triangle;

pub use cylinder::Cylinder;
pub use disk::Disk;
pub use parallelogram::Parallelogram;
pub use sphere::Sphere;
pub use spherical_rectangle::SphericalRectangle;
pub use triangle::Triangle;

use super::{Bounds, Meeting, PreciseRay, SurfacePoint};
use crate::sampler::inverse::turn;
use glam::{DVec3, Vec3A};

/// A surface that is met as one piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Primitive {
    /// A flat triangle, its vertices counter-clockwise seen from the side of its normal.
    Triangle(Triangle),
    /// A parallelogram; its normal is first edge cross second edge.
    Parallelogram(Parallelogram),
    /// A whole sphere; its normal points outward.
    Sphere(Sphere),
    /// The lateral surface of a right circular cylinder; its normal points outward.
    Cylinder(Cylinder),
    /// A flat disk; its normal is its axis.
    Disk(Disk),
}

/// Calls the same method on whichever primitive it is.
macro_rules! each {
    ($primitive:expr, $inner:ident => $call:expr) => {
        match $primitive {
            Primitive::Triangle($inner) => $call,
            Primitive::Parallelogram($inner) => $call,
            Primitive::Sphere($inner) => $call,
            Primitive::Cylinder($inner) => $call,
            Primitive::Disk($inner) => $call,
        }
    };
}

impl Primitive {
    /// A box around the surface.
    pub fn bounds(&self) -> Bounds {
        each!(self, inner => inner.bounds())
    }

    /// The nearest place where `ray` meets the surface.
    #[inline(always)]
    pub fn intersect(&self, ray: &PreciseRay) -> Option<Meeting> {
        each!(self, inner => inner.intersect(ray))
    }

    /// The point of a meeting that `intersect` gave for the same ray.
    #[inline]
    pub fn point(&self, ray: &PreciseRay, meeting: &Meeting) -> SurfacePoint {
        each!(self, inner => inner.point(ray, meeting))
    }

    /// Surface area, in square scene units.
    pub fn area(&self) -> f32 {
        each!(self, inner => inner.area())
    }

    /// Unit normal of a flat surface; `None` for a curved one.
    pub fn flat_normal(&self) -> Option<Vec3A> {
        match self {
            Self::Triangle(_) | Self::Parallelogram(_) | Self::Disk(_) => {
                Some(self.sample_area([0.0; 2]).normal)
            }
            Self::Sphere(_) | Self::Cylinder(_) => None,
        }
    }

    /// A point on the surface, uniform over its area (density 1/area), from two numbers
    /// uniform in [0, 1).
    #[inline]
    pub fn sample_area(&self, u: [f32; 2]) -> SurfacePoint {
        each!(self, inner => inner.sample_area(u))
    }

    /// The numbers with which [`Self::sample_area`] draws a point of the surface, of which
    /// `position` may be off by a rounding.
    ///
    /// A number that decides nothing, as at a corner or a centre, is any.
    #[inline]
    pub fn invert_area(&self, position: Vec3A) -> [f32; 2] {
        each!(self, inner => inner.invert_area(position))
    }
}

/// Unit vector at angle `turn` (in whole turns) in the plane across the unit vector `axis`.
#[inline]
fn around(axis: DVec3, turn: f64) -> DVec3 {
    let (tangent, bitangent) = axis.any_orthonormal_pair();
    let (sin, cos) = (turn * std::f64::consts::TAU).sin_cos();
    tangent * cos + bitangent * sin
}

/// The angle, in whole turns, at which [`around`] points along the part of `offset` that is
/// across the axis.
#[inline]
fn turn_around(axis: DVec3, offset: DVec3) -> f64 {
    let (tangent, bitangent) = axis.any_orthonormal_pair();
    turn(offset.dot(tangent), offset.dot(bitangent))
}

/// The coefficients of two edges that add up to `offset`, or to its projection into their
/// plane.
#[inline]
fn coefficients(offset: DVec3, first: DVec3, second: DVec3) -> [f64; 2] {
    let cross = first.cross(second);
    let scale = 1.0 / cross.length_squared();
    [offset.cross(second).dot(cross) * scale, first.cross(offset).dot(cross) * scale]
}
