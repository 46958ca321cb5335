//! Where to cut a set of lights in two.

use super::cluster::Cluster;
use crate::geometry::Bounds;
use glam::{DVec3, Vec3A};
use std::f64::consts::PI;

/// A light on its way into the hierarchy.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member {
    /// Index of the light.
    pub light: u32,
    /// What the hierarchy knows of it.
    pub cluster: Cluster,
    /// Mean normal times intensity.
    facing: DVec3,
}

impl Member {
    /// A light by its index.
    pub fn new(light: u32, cluster: Cluster) -> Self {
        Self { light, cluster, facing: cluster.normals.mean() * cluster.intensity }
    }
}

/// Slices of a set along each axis, between which it may be cut.
const SLICES: usize = 12;

/// A cut across an axis of space.
#[derive(Clone, Copy)]
struct Cut {
    axis: usize,
    /// Slices before the cut.
    slices: usize,
    low: f32,
    /// Slices per length.
    scale: f32,
}

impl Cut {
    fn slice_of(&self, member: &Member) -> usize {
        (((member.cluster.bounds.center()[self.axis] - self.low) * self.scale) as usize).min(SLICES - 1)
    }
}

/// What the cost of a set follows from.
#[derive(Clone, Copy)]
struct Tally {
    bounds: Bounds,
    intensity: f64,
    facing: DVec3,
}

impl Tally {
    const EMPTY: Self = Self { bounds: Bounds::EMPTY, intensity: 0.0, facing: DVec3::ZERO };

    const fn of(member: &Member) -> Self {
        Self { bounds: member.cluster.bounds, intensity: member.cluster.intensity, facing: member.facing }
    }

    fn plus(&self, other: &Self) -> Self {
        Self {
            bounds: self.bounds.union(&other.bounds),
            intensity: self.intensity + other.intensity,
            facing: self.facing + other.facing,
        }
    }

    /// How little the whole says about its parts: intensity times squared extent times solid
    /// angle lit, after the surface area orientation heuristic (Conty Estevez and Kulla 2018,
    /// section 4.4). The squared extent stands for the surface of the box, which is zero for
    /// a row of lamps; and the solid angle goes from pi, where all normals agree, to 4 pi,
    /// where their mean vanishes.
    fn cost(&self) -> f64 {
        let extent = f64::from(self.bounds.radius());
        extent * extent * PI * (4.0 * self.intensity - 3.0 * self.facing.length())
    }
}

/// Reorders two or more lights into two sets and returns the size of the first; neither is
/// empty. Lights that are all in one place are halved in their order.
pub(super) fn split(members: &mut [Member]) -> usize {
    let Some(cut) = best_cut(members) else { return members.len() / 2 };
    // Stable, so that the hierarchy depends on nothing but the lights and their order.
    members.sort_by_key(|member| cut.slice_of(member) >= cut.slices);
    members.partition_point(|member| cut.slice_of(member) < cut.slices)
}

/// The cut of least cost; `None` where all centres coincide.
fn best_cut(members: &[Member]) -> Option<Cut> {
    let centers = members.iter().map(|member| member.cluster.bounds.center());
    let (low, high) = centers.fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), |(low, high), center| {
        (low.min(center), high.max(center))
    });
    let extent = high - low;
    let mut best: Option<(f64, Cut)> = None;
    for axis in 0..3 {
        let scale = SLICES as f32 / extent[axis];
        if !(extent[axis] > 0.0 && scale.is_finite()) {
            continue;
        }
        // Thin pieces are costly: Conty Estevez and Kulla 2018, section 4.4, factor k_r.
        let thinness = f64::from(extent.max_element() / extent[axis]);
        let along = Cut { axis, slices: 0, low: low[axis], scale };
        for (cost, slices) in costs(members, along) {
            if best.is_none_or(|(least, _)| cost * thinness < least) {
                best = Some((cost * thinness, Cut { slices, ..along }));
            }
        }
    }
    best.map(|(_, cut)| cut)
}

/// Cost of each cut along an axis that leaves something on both sides, with the number of
/// slices before it.
fn costs(members: &[Member], along: Cut) -> impl Iterator<Item = (f64, usize)> {
    let mut slices = [Tally::EMPTY; SLICES];
    for member in members {
        let slice = &mut slices[along.slice_of(member)];
        *slice = slice.plus(&Tally::of(member));
    }
    let mut after = slices;
    for index in (0..SLICES - 1).rev() {
        after[index] = after[index].plus(&after[index + 1]);
    }
    let mut before = Tally::EMPTY;
    (1..SLICES).filter_map(move |index| {
        before = before.plus(&slices[index - 1]);
        let divides = !before.bounds.is_empty() && !after[index].bounds.is_empty();
        divides.then(|| (before.cost() + after[index].cost(), index))
    })
}
