//! Perturbations: a ray that moves a little, and follows the mirrors that it followed before.
//!
//! The step itself is symmetric, in the picture or on the sphere of directions; what remains of
//! the transition probabilities is how densely directions land on the area of the vertices
//! (Veach 1997, section 11.4.3).

use super::{Mutator, TURNS};
use crate::geometry::Ray;
use crate::material::Quantity;
use crate::metropolis::grow::lobe_number;
use crate::metropolis::node::Node;
use crate::metropolis::numbers::Numbers;
use crate::metropolis::path::{End, Path};
use crate::path::Kind;
use glam::Vec3A;

/// How far a perturbation moves the path.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Amount {
    /// By steps in the picture and turns of directions.
    Steps,
    /// Not at all: the same rays at other wavelengths.
    Nothing,
}

/// The first vertex from `from` towards the light that can be joined to the next one; `None`
/// where the mirrors only end at the light itself.
pub(super) fn joint_beyond(path: &Path, from: usize) -> Option<usize> {
    (1..=from).rev().find(|index| !path.is_delta(*index) && !path.is_delta(index - 1))
}

impl Mutator<'_, '_> {
    /// Lens and multi-chain mutation: which of them it is follows from the path.
    pub(super) fn lens(&mut self, x: &Path, y: &mut Path, numbers: &mut Numbers) -> Option<f64> {
        y.copy_nodes(x);
        self.moved_from_eye(x, y, Amount::Steps, numbers)
    }

    /// Moves the path from the eye on until it can be joined to what is left of it, or meets
    /// the light. `y` holds the vertices of `x`.
    pub(super) fn moved_from_eye(
        &self,
        x: &Path,
        y: &mut Path,
        amount: Amount,
        numbers: &mut Numbers,
    ) -> Option<f64> {
        let world = self.world;
        let last = x.count() - 1;
        let position = match amount {
            Amount::Steps => self.in_picture.in_plane(x.position, numbers),
            Amount::Nothing => x.position,
        };
        let inside = |axis: usize| (0.0..f64::from(world.resolution[axis])).contains(&position[axis]);
        if !inside(0) || !inside(1) {
            return None;
        }
        let mut ray = world.eye_ray(&y.nodes[last], position)?;
        let mut first = last;
        loop {
            first -= 1;
            let node = world.meet(&ray, &y.wavelengths)?;
            if first == 0 {
                y.nodes[0] = node.as_light()?;
                break;
            }
            y.nodes[first] = node;
            if let Some(followed) = self.follow(x, y, first, End::Light)? {
                ray = followed;
            } else if !x.is_delta(first - 1) {
                if !world.sees(&y.nodes[first - 1], &y.nodes[first]) {
                    return None;
                }
                break;
            } else {
                ray = turned(&y.nodes[first], x.direction(first, End::Light), amount, numbers);
            }
        }
        if !y.judge(world) {
            return None;
        }
        Some(y.ln_target - x.ln_target + x.ln_moved_from_eye(first) - y.ln_moved_from_eye(first))
    }

    pub(super) fn caustic(&mut self, x: &Path, y: &mut Path, numbers: &mut Numbers) -> Option<f64> {
        y.copy_nodes(x);
        self.moved_from_light(x, y, Amount::Steps, numbers)
    }

    /// Moves the ray that reaches, over mirrors, the vertex that the eye sees. `y` holds the
    /// vertices of `x`.
    pub(super) fn moved_from_light(
        &self,
        x: &Path,
        y: &mut Path,
        amount: Amount,
        numbers: &mut Numbers,
    ) -> Option<f64> {
        let world = self.world;
        let last = x.count() - 1;
        let given = (0..last - 1).rev().find(|index| !x.is_delta(*index))?;
        let mut ray = turned(&y.nodes[given], x.direction(given, End::Eye), amount, numbers);
        for index in given + 1..last {
            y.nodes[index] = world.meet(&ray, &y.wavelengths)?;
            match self.follow(x, y, index, End::Eye)? {
                Some(followed) => ray = followed,
                None if index + 1 == last => {}
                None => return None,
            }
        }
        if !world.sees(&y.nodes[last - 1], &y.nodes[last]) || !y.judge(world) {
            return None;
        }
        Some(y.ln_target - x.ln_target + x.ln_moved_from_light(given) - y.ln_moved_from_light(given))
    }

    /// Goes on from a vertex as the old path did, where that was by a delta. `None`: the path
    /// changes its kind; a ray, or none for a vertex that is no mirror.
    fn follow(&self, x: &Path, y: &mut Path, index: usize, towards: End) -> Option<Option<Ray>> {
        if !x.is_delta(index) {
            return (!y.nodes[index].is_mirror()).then_some(None);
        }
        let (from, quantity) = match towards {
            End::Light => (y.nodes[index + 1], Quantity::Radiance),
            End::Eye => (y.nodes[index - 1], Quantity::Importance),
        };
        let crosses = x.crosses(index);
        let node = &mut y.nodes[index];
        let ray = self.world.scattered_ray(node, &from, (lobe_number(crosses), [0.5; 2]), quantity)?;
        let normal = node.surface()?.shading.normal;
        let back = from.point.position - node.point.position;
        let crossed = normal.dot(back) * normal.dot(ray.direction) < 0.0;
        (node.is_delta && crossed == crosses).then_some(Some(ray))
    }
}

/// A ray from a vertex in a direction that is turned a little.
fn turned(node: &Node, direction: Vec3A, amount: Amount, numbers: &mut Numbers) -> Ray {
    let direction = match amount {
        Amount::Steps => TURNS.on_sphere(direction, numbers),
        Amount::Nothing => direction,
    };
    debug_assert!(!matches!(node.kind, Kind::Eye { .. }), "the eye's rays move in the picture");
    node.point.ray_along(direction)
}
