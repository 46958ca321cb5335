//! Pieces of shapes in metres, checked and placed, before the unit of the scene is known.

use super::primitive::{Cylinder, Disk, Parallelogram, Primitive, Sphere, Triangle};
use super::{MetreBounds, Transform};
use glam::{DVec3, Vec3, Vec3A};

/// A primitive in metres.
#[derive(Clone, Debug)]
pub(crate) enum Blueprint {
    /// Corners, and vertex normals of unit length where a mesh gave them.
    Triangle([DVec3; 3], Option<[Vec3A; 3]>),
    Parallelogram([DVec3; 4]),
    Sphere {
        center: DVec3,
        radius: f64,
    },
    Cylinder {
        from: DVec3,
        to: DVec3,
        radius: f64,
    },
    /// An end of a cylinder, facing away from the other end.
    Cap {
        center: DVec3,
        opposite: DVec3,
        radius: f64,
    },
    Disk {
        center: DVec3,
        normal: DVec3,
        radius: f64,
    },
}

impl Blueprint {
    /// A transformed triangle; a mirror swaps two corners, so that it keeps its side.
    pub fn triangle(mut corners: [DVec3; 3], normals: Option<[DVec3; 3]>, to_world: &Transform) -> Self {
        let mut normals = normals;
        if to_world.mirrors() {
            corners.swap(1, 2);
            if let Some(normals) = &mut normals {
                normals.swap(1, 2);
            }
        }
        let unit = |n: DVec3| to_world.normal(squarable(n)).normalize_or_zero().as_vec3a();
        Self::Triangle(corners.map(|p| to_world.point(p)), normals.map(|n| n.map(unit)))
    }

    /// A transformed parallelogram; a mirror swaps its edges, so that it keeps its side.
    pub fn parallelogram(mut corners: [DVec3; 4], to_world: &Transform) -> Self {
        if to_world.mirrors() {
            corners.swap(1, 3);
        }
        Self::Parallelogram(corners.map(|p| to_world.point(p)))
    }

    /// Grows `bounds` to hold this piece.
    pub fn add_to(&self, bounds: &mut MetreBounds) {
        let mut ball = |center: DVec3, radius: f64| {
            bounds.include(center - DVec3::splat(radius));
            bounds.include(center + DVec3::splat(radius));
        };
        match *self {
            Self::Triangle(corners, _) => corners.map(|p| bounds.include(p)).into_iter().collect(),
            Self::Parallelogram(corners) => corners.map(|p| bounds.include(p)).into_iter().collect(),
            Self::Sphere { center, radius }
            | Self::Cap { center, radius, .. }
            | Self::Disk { center, radius, .. } => ball(center, radius),
            Self::Cylinder { from, to, radius } => {
                ball(from, radius);
                ball(to, radius);
            }
        }
    }

    /// The primitive in scene units; `None` when nothing is left of it in `f32`.
    pub fn build(&self, metres_per_unit: f64, normals: &mut Vec<[Vec3A; 3]>) -> Option<Primitive> {
        let round = |p: DVec3| -> Vec3 { (p / metres_per_unit).as_vec3() };
        let size = |radius: f64| (radius / metres_per_unit) as f32;
        Some(match *self {
            Self::Triangle(corners, shading) => {
                let triangle = Triangle::new(corners.map(round))?;
                Primitive::Triangle(match shading {
                    None => triangle,
                    Some(shading) => {
                        normals.push(shading);
                        triangle.with_normals(u32::try_from(normals.len() - 1).ok()?)
                    }
                })
            }
            Self::Parallelogram(corners) => Primitive::Parallelogram(Parallelogram::new(corners.map(round))?),
            Self::Sphere { center, radius } => Primitive::Sphere(Sphere::new(round(center), size(radius))?),
            Self::Cylinder { from, to, radius } => {
                Primitive::Cylinder(Cylinder::new(round(from), round(to), size(radius))?)
            }
            Self::Cap { center, opposite, radius } => {
                // The same rounded ends as the lateral surface has, so that the rims agree.
                let normal = round(center).as_dvec3() - round(opposite).as_dvec3();
                Primitive::Disk(Disk::new(round(center), normal, size(radius))?)
            }
            Self::Disk { center, normal, radius } => {
                Primitive::Disk(Disk::new(round(center), normal, size(radius))?)
            }
        })
    }

    /// Whether losing the piece to rounding loses no area: true of triangles.
    pub fn may_vanish(&self) -> bool {
        matches!(self, Self::Triangle(..))
    }
}

/// The vector itself, or one along it where its square would leave the range of `f64`.
fn squarable(vector: DVec3) -> DVec3 {
    let largest = vector.abs().max_element();
    if largest == 0.0 || (1e-100..1e100).contains(&largest) { vector } else { vector / largest }
}
