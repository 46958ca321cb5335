//! An orthonormal frame around a normal: local `z` is the normal.

use glam::Vec3A;

/// Three unit vectors at right angles; materials work in the coordinates of this frame.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Local x axis in world coordinates.
    pub tangent: Vec3A,
    /// Local y axis in world coordinates.
    pub bitangent: Vec3A,
    /// Local z axis in world coordinates.
    pub normal: Vec3A,
}

impl Frame {
    /// A frame whose third axis is `normal` (unit length).
    ///
    /// Branch-free construction after Duff et al., "Building an orthonormal basis,
    /// revisited", JCGT 2017.
    #[inline]
    pub fn around(normal: Vec3A) -> Self {
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        Self { tangent, bitangent, normal }
    }

    /// World coordinates to local ones.
    #[inline]
    pub fn to_local(&self, world: Vec3A) -> Vec3A {
        Vec3A::new(world.dot(self.tangent), world.dot(self.bitangent), world.dot(self.normal))
    }

    /// Local coordinates to world ones.
    #[inline]
    pub fn to_world(&self, local: Vec3A) -> Vec3A {
        self.tangent * local.x + self.bitangent * local.y + self.normal * local.z
    }
}
