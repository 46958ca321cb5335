//! From described shapes to a [`Geometry`].

use super::accelerate::MOST_PRIMITIVES;
use super::blueprint::Blueprint;
use super::{Geometry, MetreBounds, Primitive, Shape, ShapeError, Transform, unit_scale};
use glam::Vec3A;
use std::ops::Range;

/// Collects shapes; `build` turns them into the structure that rays are traced through.
#[derive(Clone, Debug, Default)]
pub struct GeometryBuilder {
    blueprints: Vec<Blueprint>,
    /// Where each object ends in `blueprints`.
    ends: Vec<usize>,
}

/// What `build` hands to the acceleration structure.
pub(crate) struct Parts {
    /// All primitives, object by object.
    pub primitives: Vec<Primitive>,
    /// Vertex normals of the triangles that have them.
    pub normals: Vec<[Vec3A; 3]>,
    /// Primitives of each object.
    pub objects: Vec<Range<u32>>,
    /// Triangles left out because they have no area.
    pub degenerate: usize,
    /// The unit of the scene.
    pub metres_per_unit: f64,
}

impl GeometryBuilder {
    /// A builder without objects.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds one object made of `shape`, placed by `to_world`, and returns its number; the
    /// first object is number 0. A shape with an error adds nothing.
    pub fn add_object(&mut self, shape: &Shape, to_world: &Transform) -> Result<u32, ShapeError> {
        let object = u32::try_from(self.ends.len()).map_err(|_| ShapeError::TooMany)?;
        let before = self.blueprints.len();
        let placed = shape.place(to_world, &mut self.blueprints).and_then(|()| {
            let finite = self.blueprints[before..].iter().all(|b| {
                let mut bounds = MetreBounds::EMPTY;
                b.add_to(&mut bounds);
                bounds.min.is_finite() && bounds.max.is_finite()
            });
            if finite { Ok(()) } else { Err(ShapeError::NotFinite { what: "the placed shape" }) }
        });
        if let Err(error) = placed {
            self.blueprints.truncate(before);
            return Err(error);
        }
        self.ends.push(self.blueprints.len());
        Ok(object)
    }

    /// A box around everything added so far; disks and cylinders count with their radius in
    /// every direction.
    pub fn bounds(&self) -> MetreBounds {
        let mut bounds = MetreBounds::EMPTY;
        for blueprint in &self.blueprints {
            blueprint.add_to(&mut bounds);
        }
        bounds
    }

    /// Builds in the unit that suits the shapes' own bounds.
    pub fn build(self) -> Result<Geometry, ShapeError> {
        let metres_per_unit = unit_scale(&self.bounds());
        self.build_at(metres_per_unit)
    }

    /// Builds in a given unit, a power of two of metres, as [`unit_scale`] gives for bounds
    /// that include whatever else must fit.
    pub fn build_at(self, metres_per_unit: f64) -> Result<Geometry, ShapeError> {
        if self.blueprints.len() > MOST_PRIMITIVES as usize {
            return Err(ShapeError::TooMany);
        }
        let mut parts = Parts {
            primitives: Vec::with_capacity(self.blueprints.len()),
            normals: Vec::new(),
            objects: Vec::with_capacity(self.ends.len()),
            degenerate: 0,
            metres_per_unit,
        };
        let mut start = 0;
        for &end in &self.ends {
            parts.add_object(&self.blueprints[start..end])?;
            start = end;
        }
        // Before the tree is built, which takes as much memory again.
        drop(self);
        Ok(Geometry::from_parts(parts))
    }
}

impl Parts {
    fn add_object(&mut self, blueprints: &[Blueprint]) -> Result<(), ShapeError> {
        let vanishes = ShapeError::Vanishes { object: self.objects.len() as u32 };
        let first = self.primitives.len() as u32;
        for blueprint in blueprints {
            match blueprint.build(self.metres_per_unit, &mut self.normals) {
                Some(primitive) => self.primitives.push(primitive),
                None if blueprint.may_vanish() => self.degenerate += 1,
                None => return Err(vanishes),
            }
        }
        let last = self.primitives.len() as u32;
        if first == last {
            return Err(vanishes);
        }
        self.objects.push(first..last);
        Ok(())
    }
}
