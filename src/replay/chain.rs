//! A path of a chain, kept by its vertices, judged again: what it is worth follows from these
//! alone, whatever the chain did before.

use super::name::{ChainPath, ChainVertex, Place};
use crate::error::{Error, Result};
use crate::geometry::{Frame, SurfacePoint};
use crate::metropolis::{Node, Path, World};
use crate::path::{Kind, Surface};
use crate::scene::Scene;
use crate::spectrum::Wavelengths;
use glam::Vec3A;

/// A path of a chain, judged again.
#[derive(Clone, Debug)]
pub struct ReplayedPath {
    /// The path; target, densities and channels are those that the chain saw.
    pub path: Path,
    /// Whether a chain may be at it.
    pub is_valid: bool,
}

/// The vertices of a chain's path by their bits.
pub fn name_vertices(nodes: &[Node]) -> Vec<ChainVertex> {
    nodes.iter().map(name_vertex).collect()
}

fn name_vertex(node: &Node) -> ChainVertex {
    let mut vectors = vec![node.point.position, node.point.error, node.point.normal];
    let at = match node.kind {
        Kind::Eye { has_area } => Place::Eye { has_area },
        Kind::Light { light, primitive } => Place::Light { light, primitive },
        Kind::Surface(Surface { shading, object, primitive, .. }) => {
            vectors.extend([shading.tangent, shading.bitangent, shading.normal]);
            Place::Surface { object, primitive }
        }
    };
    let bits = vectors.iter().flat_map(|v| v.to_array().map(f32::to_bits)).collect();
    ChainVertex { at, is_delta: node.is_delta, bits }
}

/// Judges a path again in the world that it was made in.
///
/// # Errors
///
/// Names what does not fit the scene.
pub fn replay_path(world: &World<'_>, kept: &ChainPath) -> Result<ReplayedPath> {
    let u_wavelength = f32::from_bits(kept.wavelength_bits);
    let wavelengths = world.plan.wavelengths.sample(u_wavelength);
    let mut path = Path::empty(wavelengths);
    path.u_wavelength = u_wavelength;
    for vertex in &kept.vertices {
        path.nodes.push(node(world.scene, vertex, &wavelengths).ok_or_else(|| {
            Error::new("a vertex of the path is of nothing in the scene")
                .hint("give the scene that was rendered")
        })?);
    }
    let is_valid = path.judge(world);
    Ok(ReplayedPath { path, is_valid })
}

fn node(scene: &Scene, vertex: &ChainVertex, wavelengths: &Wavelengths) -> Option<Node> {
    let numbers: Vec<f32> = vertex.bits.iter().map(|bits| f32::from_bits(*bits)).collect();
    let vector = |index: usize| Some(Vec3A::from_slice(numbers.get(3 * index..3 * index + 3)?));
    let point = SurfacePoint { position: vector(0)?, error: vector(1)?, normal: vector(2)? };
    let kind = match vertex.at {
        Place::Eye { has_area } => Kind::Eye { has_area },
        Place::Light { light, primitive } => {
            (light < scene.lights.len() as u32).then_some(Kind::Light { light, primitive })?
        }
        Place::Surface { object, primitive } => {
            let described = scene.objects.get(object as usize)?;
            let shading = Frame { tangent: vector(3)?, bitangent: vector(4)?, normal: vector(5)? };
            let bsdf = scene.materials[described.material as usize].at(wavelengths);
            Kind::Surface(Surface { shading, bsdf, object, primitive, light: described.light })
        }
    };
    Some(Node { point, kind, is_delta: vertex.is_delta })
}
