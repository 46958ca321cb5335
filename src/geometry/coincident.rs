//! Faces in the place of other faces: of those a ray meets one, that of the lowest number, and
//! the others are never seen. They are counted, so that a user can be told.

use super::{Geometry, Primitive, Ray};
use rayon::prelude::*;

/// Least cosine between the normals of faces that count as being in one plane.
const PARALLEL: f32 = 0.999;

impl Geometry {
    /// Flat faces whose middle lies on another flat face, to the rounding of positions: each
    /// with the number of another one, the lowest.
    pub fn coincident_faces(&self) -> Vec<(u32, u32)> {
        (0..self.primitive_count()).into_par_iter().filter_map(|id| Some((id, self.beneath(id)?))).collect()
    }

    /// The lowest other face on which the middle of a flat face lies.
    fn beneath(&self, id: u32) -> Option<u32> {
        let face = self.primitive(id);
        let normal = face.flat_normal()?;
        // Numbers that draw the middle: the square root of 4/9 is two thirds.
        let u = match face {
            Primitive::Triangle(_) => [4.0 / 9.0, 0.5],
            Primitive::Disk(_) => [0.0, 0.0],
            _ => [0.5, 0.5],
        };
        let middle = face.sample_area(u);
        let distance = face.bounds().radius();
        let ray = Ray { t_max: 2.0 * distance, ..Ray::new(middle.position + normal * distance, -normal) };
        let mut lowest = None;
        self.meet_all(&ray, |other, point| {
            let is_level = other != id
                && self.primitive(other).flat_normal().is_some_and(|n| n.dot(normal).abs() > PARALLEL);
            let gap = (point.position - middle.position).dot(normal).abs();
            let rounding = normal.abs().dot(point.error + middle.error);
            if is_level && gap <= 2.0 * rounding && lowest.is_none_or(|lowest| other < lowest) {
                lowest = Some(other);
            }
        });
        lowest
    }
}
