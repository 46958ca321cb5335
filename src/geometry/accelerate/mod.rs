//! The structure that finds what a ray meets.
//!
//! A tree with eight children a node, whose boxes are tested together, over blocks of eight
//! triangles, which are tested together as well. `obvhs` builds the binary tree beneath it;
//! its own wide trees and their walks are not used: they drop hits nearer than a fixed
//! distance, and pass between faces that share an edge.

mod answer;
mod binary;
mod block;
mod node;
#[cfg(test)]
mod tests;
mod tree;
mod walk;

use super::builder::Parts;
use super::{Bounds, Primitive};
use glam::{DVec3, Vec3A};
use rayon::prelude::*;
use std::ops::Range;
use tree::Tree;

/// Primitives that one geometry holds at most.
pub(super) const MOST_PRIMITIVES: u32 = node::CHILD_LIMIT;

/// All surfaces of a scene.
pub struct Geometry {
    tree: Tree,
    /// In the order of the tree's leaves.
    slots: Vec<Slot>,
    /// Slot of each primitive.
    slot_of: Vec<u32>,
    normals: Vec<[Vec3A; 3]>,
    objects: Vec<Range<u32>>,
    bounds: Bounds,
    /// The largest coordinate.
    reach: f32,
    degenerate: usize,
    metres_per_unit: f64,
}

/// A primitive where the tree wants it: one cache line.
#[derive(Clone, Copy)]
struct Slot {
    primitive: Primitive,
    id: u32,
    object: u32,
}

impl Geometry {
    pub(crate) fn from_parts(parts: Parts) -> Self {
        let bounds = parts.primitives.iter().fold(Bounds::EMPTY, |b, p| b.union(&p.bounds()));
        let mut tree = Tree::new(&parts.primitives, &bounds);
        let order = std::mem::take(&mut tree.order);
        let object_of = |id| parts.objects.partition_point(|range| range.end <= id) as u32;
        let slot = |&id: &u32| Slot { primitive: parts.primitives[id as usize], id, object: object_of(id) };
        let slots = order.par_iter().map(slot).collect();
        let mut slot_of = vec![0; order.len()];
        for (slot, &id) in order.iter().enumerate() {
            slot_of[id as usize] = slot as u32;
        }
        Self {
            tree,
            slots,
            slot_of,
            normals: parts.normals,
            objects: parts.objects,
            bounds,
            reach: bounds.min.abs().max(bounds.max.abs()).max_element(),
            degenerate: parts.degenerate,
            metres_per_unit: parts.metres_per_unit,
        }
    }

    /// Number of objects.
    pub fn object_count(&self) -> u32 {
        self.objects.len() as u32
    }

    /// Number of primitives.
    pub fn primitive_count(&self) -> u32 {
        self.slots.len() as u32
    }

    /// Numbers of the primitives of an object.
    ///
    /// # Panics
    /// When there is no such object.
    pub fn primitives_of(&self, object: u32) -> Range<u32> {
        self.objects[object as usize].clone()
    }

    /// Number of the object that a primitive belongs to.
    ///
    /// # Panics
    /// When there is no such primitive.
    pub fn object_of(&self, primitive: u32) -> u32 {
        self.slot(primitive).object
    }

    /// A primitive by its number.
    ///
    /// # Panics
    /// When there is no such primitive.
    #[inline]
    pub fn primitive(&self, primitive: u32) -> &Primitive {
        &self.slot(primitive).primitive
    }

    /// Area of a primitive in square scene units.
    ///
    /// # Panics
    /// When there is no such primitive.
    pub fn area_of(&self, primitive: u32) -> f32 {
        self.primitive(primitive).area()
    }

    /// A box around everything, in scene units; empty without primitives.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Length of a scene unit in metres: a power of two.
    pub fn metres_per_unit(&self) -> f64 {
        self.metres_per_unit
    }

    /// A position in metres as one in scene units.
    pub fn to_scene(&self, metres: DVec3) -> Vec3A {
        (metres / self.metres_per_unit).as_vec3a()
    }

    /// The coarsest spacing of positions in the scene, in metres: what a scene far from its
    /// origin loses.
    pub fn spacing_metres(&self) -> f64 {
        if self.bounds.is_empty() {
            return 0.0;
        }
        let reach = self.bounds.min.abs().max(self.bounds.max.abs()).max_element();
        f64::from(reach.next_up() - reach) * self.metres_per_unit
    }

    /// How many triangles were left out because they have no area.
    pub fn degenerate_triangles(&self) -> usize {
        self.degenerate
    }

    #[inline]
    fn slot(&self, primitive: u32) -> &Slot {
        &self.slots[self.slot_of[primitive as usize] as usize]
    }
}
