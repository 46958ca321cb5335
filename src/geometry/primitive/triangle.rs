//! The triangle, watertight against its neighbours.

use super::super::{Bounds, Meeting, PreciseRay, SurfacePoint};
use super::coefficients;
use crate::sampler::inverse::{ANY, unit};
use glam::{DVec3, Vec3, Vec3A};

/// A flat triangle that carries its own vertices, so that meeting it touches one cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    vertices: [[f32; 3]; 3],
    normals: u32,
}

/// Stands for the absence of vertex normals.
const NO_NORMALS: u32 = u32::MAX;

impl Triangle {
    /// A triangle from its vertices, counter-clockwise seen from the side of its normal;
    /// `None` when it has no area.
    pub fn new(vertices: [Vec3; 3]) -> Option<Self> {
        let triangle = Self { vertices: vertices.map(|v| v.to_array()), normals: NO_NORMALS };
        let area = triangle.area();
        (area > 0.0 && area.is_finite()).then_some(triangle)
    }

    /// The same triangle with its vertex normals at `index` of the geometry's list.
    pub(crate) const fn with_normals(self, index: u32) -> Self {
        Self { normals: index, ..self }
    }

    /// Where the geometry keeps the vertex normals, if the mesh had any.
    #[inline]
    pub(crate) fn normals(&self) -> Option<u32> {
        (self.normals != NO_NORMALS).then_some(self.normals)
    }

    /// Vertex positions.
    pub fn vertices(&self) -> [Vec3; 3] {
        self.vertices.map(Vec3::from)
    }

    /// A box around the triangle.
    pub fn bounds(&self) -> Bounds {
        let [a, b, c] = self.vertices.map(Vec3A::from);
        Bounds { min: a.min(b).min(c), max: a.max(b).max(c) }
    }

    /// The place where `ray` meets the triangle, edges and vertices included.
    #[inline(always)]
    pub fn intersect(&self, ray: &PreciseRay) -> Option<Meeting> {
        Self::meet(&self.vertices, ray)
    }

    /// The place where `ray` meets the triangle of these vertices.
    #[inline(always)]
    pub(crate) fn meet([a, b, c]: &[[f32; 3]; 3], ray: &PreciseRay) -> Option<Meeting> {
        let (t, [_, u, v]) = meet_sheared([ray.sheared(a), ray.sheared(b), ray.sheared(c)])?;
        ray.reaches(t).then_some(Meeting { t, u, v })
    }

    /// The point of a meeting.
    #[inline]
    pub fn point(&self, _ray: &PreciseRay, meeting: &Meeting) -> SurfacePoint {
        self.at(meeting.u, meeting.v)
    }

    /// Surface area.
    pub fn area(&self) -> f32 {
        (0.5 * self.cross().length()) as f32
    }

    /// A point uniform over the area.
    #[inline]
    pub fn sample_area(&self, u: [f32; 2]) -> SurfacePoint {
        // Osada et al. 2002, "Shape distributions", equation 1.
        let root = f64::from(u[0]).sqrt();
        self.at(root * (1.0 - f64::from(u[1])), root * f64::from(u[1]))
    }

    /// The numbers with which `sample_area` draws a position.
    #[inline]
    pub fn invert_area(&self, position: Vec3A) -> [f32; 2] {
        let [a, b, c] = self.doubles();
        let [to_b, to_c] = coefficients(position.as_dvec3() - a, b - a, c - a);
        let root = (to_b + to_c).clamp(0.0, 1.0);
        [unit(root * root), if root > 0.0 { unit(to_c / root) } else { ANY }]
    }

    #[inline]
    fn at(&self, u: f64, v: f64) -> SurfacePoint {
        let [a, b, c] = self.doubles();
        let terms = [a * (1.0 - u - v), b * u, c * v];
        let position = terms[0] + terms[1] + terms[2];
        let [first, second, third] = self.vertices.map(|v| Vec3A::from(v).abs());
        let reach = first.max(second).max(third).max_element();
        SurfacePoint::rounded(position, f64::from(reach), DVec3::ZERO, self.cross())
    }

    #[inline]
    fn cross(&self) -> DVec3 {
        let [a, b, c] = self.doubles();
        (b - a).cross(c - a)
    }

    #[inline]
    fn doubles(&self) -> [DVec3; 3] {
        self.vertices.map(|v| Vec3::from(v).as_dvec3())
    }
}

/// Distance and vertex weights where the z axis meets a triangle given in sheared
/// coordinates; edges count as inside.
///
/// Each edge function of two triangles that share the edge is the other's negative exactly,
/// so no ray passes between them (Woop et al. 2013, section 3).
#[inline(always)]
pub(super) fn meet_sheared([a, b, c]: [DVec3; 3]) -> Option<(f64, [f64; 3])> {
    let across_a = c.x * b.y - c.y * b.x;
    let across_b = a.x * c.y - a.y * c.x;
    let across_c = b.x * a.y - b.y * a.x;
    let low = across_a.min(across_b).min(across_c);
    let high = across_a.max(across_b).max(across_c);
    if low < 0.0 && high > 0.0 {
        return None;
    }
    let determinant = across_a + across_b + across_c;
    if determinant == 0.0 {
        return None;
    }
    let inverse = 1.0 / determinant;
    let weights = [across_a * inverse, across_b * inverse, across_c * inverse];
    Some((weights[0] * a.z + weights[1] * b.z + weights[2] * c.z, weights))
}
