//! Triangle meshes as read: positions, perhaps normals, and who belongs to which triangle.

use super::ShapeError;
use glam::DVec3;

/// A triangle mesh in metres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<DVec3>,
    /// One normal per vertex for shading, or none at all; any length, zero for "flat here".
    pub normals: Vec<DVec3>,
    /// Vertices of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Whether every number is finite and every index names a vertex.
    pub fn check(&self) -> Result<(), ShapeError> {
        let vertices = self.positions.len();
        if !self.positions.iter().all(|p| p.is_finite()) {
            return Err(ShapeError::NotFinite { what: "every vertex of the mesh" });
        }
        if !self.normals.iter().all(|n| n.is_finite()) {
            return Err(ShapeError::NotFinite { what: "every normal of the mesh" });
        }
        if !self.normals.is_empty() && self.normals.len() != vertices {
            return Err(ShapeError::NormalCount { vertices, normals: self.normals.len() });
        }
        for (triangle, corners) in self.triangles.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&index| index as usize >= vertices) {
                return Err(ShapeError::NoSuchVertex { triangle, index, vertices });
            }
        }
        Ok(())
    }

    /// Cuts a polygon into a fan of triangles around its first vertex; fewer than three
    /// vertices add nothing.
    #[cfg(feature = "meshes")]
    pub(crate) fn push_polygon(&mut self, corners: &[u32]) {
        for pair in corners.get(1..).unwrap_or_default().windows(2) {
            self.triangles.push([corners[0], pair[0], pair[1]]);
        }
    }
}
