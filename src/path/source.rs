//! The light's end of a path, where its neighbour asked for it or met it.

use super::contribution::End;
use super::vertex::Vertex;
use crate::geometry::SurfacePoint;
use crate::light::Light;
use crate::measure::AreaPdf;

/// A light's point that was asked for, or met.
pub(super) struct Source<'l> {
    pub light: &'l Light,
    pub index: u32,
    pub primitive: Option<u32>,
    pub point: SurfacePoint,
    /// Density of the point for a subpath from the light.
    pub started: f64,
    /// Density of the point for a vertex that asks.
    pub asked: f64,
    /// Solid angle at the vertex that asks over area at the point; zero for a point light.
    pub per_area: f64,
}

impl Source<'_> {
    pub const fn end(&self) -> End {
        End { point: self.point, light: Some((self.index, self.primitive)) }
    }

    pub const fn starts(&self) -> AreaPdf {
        AreaPdf::of_all_lanes(self.started)
    }

    /// Density with which light from here reaches a vertex.
    pub fn reaches(&self, vertex: &Vertex) -> AreaPdf {
        let span = vertex.point.position - self.point.position;
        let density = self.light.pdf_emission(self.point.normal, span.normalize_or_zero());
        AreaPdf::of_all_lanes(density * vertex.solid_angle_per_area_from(self.point.position))
    }
}
