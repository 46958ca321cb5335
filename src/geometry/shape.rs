//! Shapes as a user describes them: in metres, and possibly wrong.

use super::blueprint::Blueprint;
use super::{Mesh, ShapeError, Transform};
use glam::DVec3;

/// A surface described in metres.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A sphere; its normal points outward.
    Sphere {
        /// Centre.
        center: DVec3,
        /// Radius.
        radius: f64,
    },
    /// A right circular cylinder; its normal points outward.
    Cylinder {
        /// Centre of one end.
        from: DVec3,
        /// Centre of the other end.
        to: DVec3,
        /// Radius.
        radius: f64,
        /// Whether disks close the ends.
        capped: bool,
    },
    /// A flat disk.
    Disk {
        /// Centre.
        center: DVec3,
        /// Direction of its normal; any length.
        normal: DVec3,
        /// Radius.
        radius: f64,
    },
    /// A quadrilateral, convex or not; its normal faces the side from which the vertices
    /// run counter-clockwise.
    Quad {
        /// Corners in order around it.
        vertices: [DVec3; 4],
    },
    /// A box along the coordinate axes (before its transform); its normals point outward.
    Box {
        /// Lowest corner.
        min: DVec3,
        /// Highest corner.
        max: DVec3,
    },
    /// A triangle mesh.
    Mesh(Mesh),
}

/// How far the fourth corner of a parallelogram may be off, relative to its largest
/// coordinate, by the rounding of the numbers it was written in.
const PARALLELOGRAM_SLACK: f64 = 1.0 / (1u64 << 40) as f64;

impl Shape {
    /// Checks the shape and appends its pieces, placed by `to_world`.
    pub(crate) fn place(&self, to_world: &Transform, out: &mut Vec<Blueprint>) -> Result<(), ShapeError> {
        match self {
            Self::Sphere { center, radius } => sphere(*center, *radius, to_world, out),
            Self::Cylinder { from, to, radius, capped } => {
                cylinder([*from, *to], *radius, *capped, to_world, out)
            }
            Self::Disk { center, normal, radius } => disk(*center, *normal, *radius, to_world, out),
            Self::Quad { vertices } => quad(vertices, to_world, out),
            Self::Box { min, max } => cuboid(*min, *max, to_world, out),
            Self::Mesh(mesh) => triangles(mesh, to_world, out),
        }
    }
}

fn sphere(
    center: DVec3,
    radius: f64,
    to_world: &Transform,
    out: &mut Vec<Blueprint>,
) -> Result<(), ShapeError> {
    finite("the centre of the sphere", center)?;
    positive("the radius of the sphere", radius)?;
    let scale = similarity("sphere", to_world)?;
    out.push(Blueprint::Sphere { center: to_world.point(center), radius: radius * scale });
    Ok(())
}

fn cylinder(
    [from, to]: [DVec3; 2],
    radius: f64,
    capped: bool,
    to_world: &Transform,
    out: &mut Vec<Blueprint>,
) -> Result<(), ShapeError> {
    finite("the ends of the cylinder", from + to)?;
    positive("the radius of the cylinder", radius)?;
    let scale = similarity("cylinder", to_world)?;
    let [from, to] = [to_world.point(from), to_world.point(to)];
    let radius = radius * scale;
    if from == to {
        return Err(ShapeError::NoExtent { what: "the axis of the cylinder" });
    }
    out.push(Blueprint::Cylinder { from, to, radius });
    if capped {
        out.push(Blueprint::Cap { center: from, opposite: to, radius });
        out.push(Blueprint::Cap { center: to, opposite: from, radius });
    }
    Ok(())
}

fn disk(
    center: DVec3,
    normal: DVec3,
    radius: f64,
    to_world: &Transform,
    out: &mut Vec<Blueprint>,
) -> Result<(), ShapeError> {
    finite("the centre of the disk", center)?;
    finite("the normal of the disk", normal)?;
    positive("the radius of the disk", radius)?;
    let scale = similarity("disk", to_world)?;
    if normal == DVec3::ZERO {
        return Err(ShapeError::NoExtent { what: "the normal of the disk" });
    }
    let normal = to_world.normal(normal / normal.abs().max_element());
    out.push(Blueprint::Disk { center: to_world.point(center), normal, radius: radius * scale });
    Ok(())
}

fn quad(vertices: &[DVec3; 4], to_world: &Transform, out: &mut Vec<Blueprint>) -> Result<(), ShapeError> {
    for &vertex in vertices {
        finite("every vertex of the quad", vertex)?;
    }
    let [a, b, c, d] = *vertices;
    let reach = vertices.iter().fold(DVec3::ZERO, |reach, v| reach.max(v.abs())).max_element();
    let bend = (a - b + c - d).abs().max_element();
    if bend <= PARALLELOGRAM_SLACK * reach {
        if (b - a).cross(d - a) == DVec3::ZERO {
            return Err(ShapeError::NoExtent { what: "the quad" });
        }
        out.push(Blueprint::parallelogram(*vertices, to_world));
        return Ok(());
    }
    for half in halves(vertices)? {
        out.push(Blueprint::triangle(half, None, to_world));
    }
    Ok(())
}

/// The two triangles of a quadrilateral, cut along the diagonal that lies inside it.
fn halves(&[a, b, c, d]: &[DVec3; 4]) -> Result<[[DVec3; 3]; 2], ShapeError> {
    let area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
    let cuts = [[[a, b, c], [a, c, d]], [[b, c, d], [b, d, a]]];
    if cuts.iter().flatten().all(|&half| area(half) == DVec3::ZERO) {
        return Err(ShapeError::NoExtent { what: "the quad" });
    }
    cuts.into_iter()
        .find(|&[first, second]| area(first).dot(area(second)) > 0.0)
        .ok_or(ShapeError::CrossedQuad)
}

fn cuboid(min: DVec3, max: DVec3, to_world: &Transform, out: &mut Vec<Blueprint>) -> Result<(), ShapeError> {
    finite("the corners of the box", min + max)?;
    for (what, size) in [
        ("the size of the box along x", max.x - min.x),
        ("the size of the box along y", max.y - min.y),
        ("the size of the box along z", max.z - min.z),
    ] {
        positive(what, size)?;
    }
    // Bit 0, 1, 2 of a corner's number: high in x, y, z.
    let corner = |number: usize| {
        let high = |axis: usize| {
            if number >> axis & 1 == 1 { max[axis] } else { min[axis] }
        };
        DVec3::new(high(0), high(1), high(2))
    };
    for face in BOX_FACES {
        out.push(Blueprint::parallelogram(face.map(corner), to_world));
    }
    Ok(())
}

/// Corners of the faces of a box, counter-clockwise seen from outside: -x, +x, -y, +y, -z, +z.
const BOX_FACES: [[usize; 4]; 6] =
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

fn triangles(mesh: &Mesh, to_world: &Transform, out: &mut Vec<Blueprint>) -> Result<(), ShapeError> {
    mesh.check()?;
    if mesh.triangles.is_empty() {
        return Err(ShapeError::NoExtent { what: "the mesh" });
    }
    out.reserve(mesh.triangles.len());
    for corners in &mesh.triangles {
        let corners = corners.map(|index| index as usize);
        let normals = (!mesh.normals.is_empty()).then(|| corners.map(|i| mesh.normals[i]));
        out.push(Blueprint::triangle(corners.map(|i| mesh.positions[i]), normals, to_world));
    }
    Ok(())
}

fn finite(what: &'static str, value: DVec3) -> Result<(), ShapeError> {
    if value.is_finite() { Ok(()) } else { Err(ShapeError::NotFinite { what }) }
}

fn positive(what: &'static str, value: f64) -> Result<(), ShapeError> {
    if !value.is_finite() {
        Err(ShapeError::NotFinite { what })
    } else if value > 0.0 {
        Ok(())
    } else {
        Err(ShapeError::NotPositive { what, value })
    }
}

fn similarity(shape: &'static str, to_world: &Transform) -> Result<f64, ShapeError> {
    to_world.similarity().ok_or(ShapeError::NotASimilarity { shape })
}
