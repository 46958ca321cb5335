//! Double precision where rays meet surfaces.
//!
//! Every surface is defined exactly by its `f32` parameters; meeting it with a ray is
//! computed in `f64`. The error of a meeting is then eight decimal digits below the spacing
//! of the `f32` positions that rays start from, so a start one spacing off a surface is
//! certainly off it, and neither a fixed epsilon nor a least distance is needed.

use super::{Ray, SurfacePoint};
use glam::{DVec3, Vec3A};

/// Bound on the error of a meeting relative to the largest coordinate of the primitive, 2^-27.
///
/// A start on a plane is told from the plane's other side with an error of about 12 units in
/// the last place of `f64` times the aspect ratio of the triangle, whichever way its plane
/// lies; this covers ratios to a million and is an eighth of the spacing of `f32`.
const MEETING_ERROR: f64 = 1.0 / (1u64 << 27) as f64;

/// A ray in double precision, with the shear of the triangle test prepared.
///
/// Woop, Benthin, Wald, "Watertight ray/triangle intersection", JCGT 2013: the shear makes
/// the ray the z axis.
#[derive(Clone, Copy, Debug)]
pub struct PreciseRay {
    /// Start, in scene units.
    pub origin: DVec3,
    /// Direction, of unit length to the rounding of `f32`.
    pub direction: DVec3,
    /// Hits at or beyond this distance do not count.
    pub t_max: f64,
    start: [f64; 3],
    axes: [usize; 3],
    shear: [f64; 3],
}

/// Where along a ray, and where on a primitive, the two meet.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    /// Distance along the ray, in units of its direction's length.
    pub t: f64,
    /// First surface coordinate: of the parallelogram along its first edge, of the triangle
    /// the weight of its second vertex; unused by curved primitives.
    pub u: f64,
    /// Second surface coordinate, as above: second edge, third vertex.
    pub v: f64,
}

impl PreciseRay {
    /// Prepares `ray`.
    #[inline]
    pub fn new(ray: &Ray) -> Self {
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let size = direction.abs();
        let z = if size.x > size.y {
            if size.x > size.z { 0 } else { 2 }
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let along = direction.to_array();
        let inverse = 1.0 / along[z];
        Self {
            origin,
            direction,
            t_max: f64::from(ray.t_max),
            start: origin.to_array(),
            axes,
            shear: [along[axes[0]] * inverse, along[axes[1]] * inverse, inverse],
        }
    }

    /// The point at distance `t`.
    #[inline]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }

    /// Whether a meeting at distance `t` counts.
    #[inline(always)]
    pub fn reaches(&self, t: f64) -> bool {
        t > 0.0 && t < self.t_max
    }

    /// The axes as the shear orders them, its own last, and the shear: of the first two, and
    /// the distance along the ray per unit of its own axis.
    #[inline]
    pub(crate) const fn shear(&self) -> ([usize; 3], [f64; 3]) {
        (self.axes, self.shear)
    }

    /// A vertex in the sheared coordinates in which this ray is the z axis.
    ///
    /// The result depends on nothing but ray and vertex, which is what makes triangles that
    /// share a vertex meet without a gap.
    #[inline(always)]
    pub(crate) fn sheared(&self, vertex: &[f32; 3]) -> DVec3 {
        let component = |axis: usize| f64::from(vertex[axis]) - self.start[axis];
        let z = component(self.axes[2]);
        DVec3::new(
            component(self.axes[0]) - self.shear[0] * z,
            component(self.axes[1]) - self.shear[1] * z,
            self.shear[2] * z,
        )
    }

    /// The nearer of two distances that counts, if any does.
    #[inline(always)]
    pub(crate) fn first_of(&self, roots: (f64, f64), counts: impl Fn(f64) -> bool) -> Option<Meeting> {
        let meeting = |t| Meeting { t, u: 0.0, v: 0.0 };
        if self.reaches(roots.0) && counts(roots.0) {
            Some(meeting(roots.0))
        } else if self.reaches(roots.1) && counts(roots.1) {
            Some(meeting(roots.1))
        } else {
            None
        }
    }
}

/// Distances at which the line through `offset` (from the centre) along `direction` is at
/// distance `radius` from the centre, nearer first.
///
/// The discriminant is radius^2 minus the squared distance of the line from the centre,
/// which loses nothing for small and far spheres (Haines et al., Ray Tracing Gems,
/// chapter 7).
#[inline(always)]
pub(crate) fn round_roots(offset: DVec3, direction: DVec3, radius: f64) -> Option<(f64, f64)> {
    let a = direction.length_squared();
    let b = -offset.dot(direction);
    let nearest = offset + direction * (b / a);
    let discriminant = radius * radius - nearest.length_squared();
    // NaN is what a direction without extent gives.
    if discriminant < 0.0 || discriminant.is_nan() {
        return None;
    }
    let c = offset.length_squared() - radius * radius;
    let q = b + (a * discriminant).sqrt().copysign(b);
    let (first, second) = (c / q, q / a);
    Some(if first < second { (first, second) } else { (second, first) })
}

impl SurfacePoint {
    /// Rounds a position computed in `f64` on a primitive whose coordinates reach to `reach`,
    /// and whose surface is itself only known to within `thickness`.
    #[inline]
    pub(crate) fn rounded(exact: DVec3, reach: f64, thickness: DVec3, normal: DVec3) -> Self {
        let position = exact.as_vec3a();
        let slop = DVec3::splat(reach * MEETING_ERROR);
        let error = (exact - position.as_dvec3()).abs() + slop + thickness;
        Self {
            position,
            error: Vec3A::new(round_up(error.x), round_up(error.y), round_up(error.z)),
            normal: normal.normalize_or_zero().as_vec3a(),
        }
    }
}

/// The least `f32` not below `x`.
#[inline(always)]
pub(crate) fn round_up(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) < x { rounded.next_up() } else { rounded }
}
