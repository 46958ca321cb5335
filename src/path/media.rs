//! Which transparent bodies a path is inside of, where any of them absorbs.

use crate::geometry::Ray;
use crate::scene::Scene;
use crate::spectrum::Dense;
use glam::Vec3A;

/// Bodies that may lie within one another; what is nested deeper does not absorb.
const DEEPEST: usize = 8;
/// Surfaces that the search for a start's bodies crosses at most.
const MOST_CROSSINGS: u32 = 10_000;
/// Direction of that search: along no axis and no diagonal, where edges would be met.
const SEARCH: Vec3A = Vec3A::new(0.323_1, 0.871_7, 0.368_5);

/// The transparent bodies around a point, the innermost last; light travels through that one.
#[derive(Clone, Copy, Debug)]
pub struct Media {
    /// Objects in the scene.
    bodies: [u32; DEEPEST],
    depth: u32,
}

impl Media {
    /// Outside everything.
    pub const NONE: Self = Self { bodies: [0; DEEPEST], depth: 0 };

    /// Absorption coefficient here, per scene unit; `None` where nothing absorbs.
    #[inline]
    pub fn absorption<'s>(&self, scene: &'s Scene) -> Option<&'s Dense> {
        let body = self.bodies[self.depth.checked_sub(1)? as usize];
        scene.materials[scene.objects[body as usize].material as usize].absorption()
    }

    /// Crosses the surface of an object: into it, or out of it.
    pub fn cross(&mut self, object: u32, inwards: bool) {
        let depth = self.depth as usize;
        if inwards {
            if depth < DEEPEST {
                self.bodies[depth] = object;
                self.depth += 1;
            }
        } else if let Some(found) = self.bodies[..depth].iter().rposition(|body| *body == object) {
            self.bodies.copy_within(found + 1..depth, found);
            self.depth -= 1;
        }
    }

    /// The bodies around a position: those that a ray from there leaves without having
    /// entered, in the order in which it leaves them.
    pub fn around(scene: &Scene, position: Vec3A) -> Self {
        let mut entered: Vec<u32> = Vec::new();
        let mut left: Vec<u32> = Vec::new();
        let mut ray = Ray::new(position, SEARCH.normalize());
        for _ in 0..MOST_CROSSINGS {
            let Some(hit) = scene.geometry.intersect(&ray) else { break };
            ray = hit.point.ray_along(ray.direction);
            let material = &scene.materials[scene.objects[hit.object as usize].material as usize];
            if !material.is_transparent() {
                continue;
            }
            if hit.point.normal.dot(ray.direction) < 0.0 {
                entered.push(hit.object);
            } else if let Some(found) = entered.iter().rposition(|object| *object == hit.object) {
                entered.remove(found);
            } else {
                left.push(hit.object);
            }
        }
        let mut media = Self::NONE;
        left.iter().rev().for_each(|object| media.cross(*object, true));
        media
    }
}
