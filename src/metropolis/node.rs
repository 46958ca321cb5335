//! A vertex of a chain's path: what is there, and nothing about the walk that found it.

use crate::geometry::SurfacePoint;
use crate::path::{Kind, Surface};

/// A vertex of a complete path.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// Where it is.
    pub point: SurfacePoint,
    /// What is there; the first vertex of a path is always a light, the last always the eye.
    pub kind: Kind,
    /// Whether the path goes on from here by a Dirac delta.
    pub is_delta: bool,
}

impl Node {
    /// A point of the eye.
    pub const fn eye(point: SurfacePoint, has_area: bool) -> Self {
        Self { point, kind: Kind::Eye { has_area }, is_delta: false }
    }

    /// A point of a light.
    pub const fn light(point: SurfacePoint, light: u32, primitive: Option<u32>) -> Self {
        Self { point, kind: Kind::Light { light, primitive }, is_delta: false }
    }

    /// The surface, unless the vertex is an end.
    pub const fn surface(&self) -> Option<&Surface> {
        match &self.kind {
            Kind::Surface(surface) => Some(surface),
            Kind::Eye { .. } | Kind::Light { .. } => None,
        }
    }

    /// Whether nothing can be joined to the vertex.
    pub fn is_mirror(&self) -> bool {
        self.surface().is_some_and(|surface| surface.bsdf.is_delta())
    }

    /// Whether fresh paths count the vertex: not a mirror, unless it shines by itself.
    pub fn counts(&self) -> bool {
        !self.is_mirror() || self.surface().is_some_and(|surface| surface.light.is_some())
    }

    /// The vertex as the end of a path that has met a light; `None` where nothing shines.
    pub fn as_light(&self) -> Option<Self> {
        let surface = self.surface()?;
        Some(Self::light(self.point, surface.light?, Some(surface.primitive)))
    }
}
