//! Rays, and where they meet something.

use super::Frame;
use glam::Vec3A;

/// A half line, or a stretch of one.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Start, in scene units.
    pub origin: Vec3A,
    /// Unit direction.
    pub direction: Vec3A,
    /// Hits at or beyond this distance do not count; infinite for a half line.
    pub t_max: f32,
}

impl Ray {
    /// A half line from `origin` along the unit vector `direction`.
    #[inline]
    pub const fn new(origin: Vec3A, direction: Vec3A) -> Self {
        Self { origin, direction, t_max: f32::INFINITY }
    }
}

/// A point on a surface together with the bound of its rounding error.
///
/// Rays that leave a surface start outside the error box around the computed point, so
/// that they never meet the surface they left; no fixed epsilon is involved
/// (Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., section 6.8).
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Position in scene units.
    pub position: Vec3A,
    /// The true point lies within this distance of `position`, axis by axis.
    pub error: Vec3A,
    /// Unit normal of the surface itself; outward for closed analytic shapes, by
    /// counter-clockwise vertex order for triangles and quads.
    pub normal: Vec3A,
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Distance along the ray, in scene units.
    pub t: f32,
    /// The point met, with its error bound and geometric normal.
    pub point: SurfacePoint,
    /// Shading frame: its normal is the interpolated one where a mesh carries normals,
    /// the geometric one elsewhere; on the same side as the geometric normal.
    pub shading: Frame,
    /// Index of the primitive in [`super::Geometry`].
    pub primitive: u32,
    /// Index of the object that the primitive belongs to.
    pub object: u32,
}

impl SurfacePoint {
    /// A ray from this point along the unit vector `direction`, starting just outside the
    /// error box on the side that the direction points to.
    #[inline]
    pub fn ray_along(&self, direction: Vec3A) -> Ray {
        Ray::new(self.offset_towards(direction), direction)
    }

    /// A ray from this point to another, ending short of the other's error box; `None`
    /// when the two coincide.
    #[inline]
    pub fn ray_to(&self, other: &Self) -> Option<Ray> {
        let start = self.offset_towards(other.position - self.position);
        let end = other.offset_towards(start - other.position);
        segment(start, end)
    }

    /// A ray from this point to an exact position such as a point light.
    #[inline]
    pub fn ray_to_position(&self, target: Vec3A) -> Option<Ray> {
        segment(self.offset_towards(target - self.position), target)
    }

    /// The position moved along the normal, to the side of `direction`, out of the error box.
    #[inline]
    fn offset_towards(&self, direction: Vec3A) -> Vec3A {
        let distance = self.normal.abs().dot(self.error);
        let offset = self.normal * distance.copysign(self.normal.dot(direction));
        let moved = self.position + offset;
        // Round each coordinate away from the surface: the sum above may have rounded back.
        Vec3A::new(away(moved.x, offset.x), away(moved.y, offset.y), away(moved.z, offset.z))
    }
}

#[inline]
fn segment(start: Vec3A, end: Vec3A) -> Option<Ray> {
    let span = end - start;
    let length = span.length();
    (length > 0.0).then(|| Ray {
        origin: start,
        direction: span / length,
        // The end is outside its own error box already; this covers the rounding of the
        // division and the square root.
        t_max: length * (1.0 - 4.0 * f32::EPSILON),
    })
}

#[inline]
fn away(coordinate: f32, offset: f32) -> f32 {
    if offset > 0.0 {
        coordinate.next_up()
    } else if offset < 0.0 {
        coordinate.next_down()
    } else {
        coordinate
    }
}
