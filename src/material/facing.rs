//! Which side of an opaque surface is looked at, and the flip that brings it up.
//!
//! Models are written for `wo` above the surface. The flip mirrors z alone, so that the
//! tangents stay and samples vary continuously with the direction.

use glam::Vec3A;

/// The mirroring of z that brings `wo` above the surface; its own inverse.
#[derive(Clone, Copy)]
pub(super) struct Upright(Vec3A);

impl Upright {
    /// `None` for a direction in the plane of the surface.
    #[inline]
    pub(super) fn of(wo: Vec3A) -> Option<Self> {
        (wo.z != 0.0 && wo.is_finite()).then(|| Self(Vec3A::new(1.0, 1.0, wo.z.signum())))
    }

    /// `None` also for the back of a surface that is black there.
    #[inline]
    pub(super) fn of_opaque(wo: Vec3A, two_sided: bool) -> Option<Self> {
        Self::of(wo).filter(|_| wo.z > 0.0 || two_sided)
    }

    /// The direction as seen by the model, or back again.
    #[inline]
    pub(super) fn turn(self, direction: Vec3A) -> Vec3A {
        direction * self.0
    }
}

/// Reflection at the macroscopic surface.
#[inline]
pub(super) fn mirrored(wo: Vec3A) -> Vec3A {
    Vec3A::new(-wo.x, -wo.y, wo.z)
}
