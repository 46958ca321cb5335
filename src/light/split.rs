//! Where to cut a set of lights in two.

use super::cluster::Cluster;

/// A light's index and what the hierarchy knows of it.
pub(super) type Member = (u32, Cluster);

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
    fn slice_of(&self, (_, cluster): &Member) -> usize {
        (((cluster.bounds.center()[self.axis] - self.low) * self.scale) as usize).min(SLICES - 1)
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
    let centers = members.iter().map(|(_, cluster)| cluster.bounds.center());
    let (low, high) = centers
        .fold((glam::Vec3A::INFINITY, glam::Vec3A::NEG_INFINITY), |(low, high), c| (low.min(c), high.max(c)));
    let extent = high - low;
    let mut best: Option<(f64, Cut)> = None;
    for axis in 0..3 {
        let scale = SLICES as f32 / extent[axis];
        if !(extent[axis] > 0.0 && scale.is_finite()) {
            continue;
        }
        // Thin pieces are costly: Conty Estevez and Kulla 2018, section 4.4, factor k_r.
        let thinness = f64::from(extent.max_element() / extent[axis]);
        for (cost, slices) in costs(members, Cut { axis, slices: 0, low: low[axis], scale }) {
            if best.is_none_or(|(least, _)| cost * thinness < least) {
                best = Some((cost * thinness, Cut { axis, slices, low: low[axis], scale }));
            }
        }
    }
    best.map(|(_, cut)| cut)
}

/// Cost of each cut along an axis that leaves something on both sides, with the number of
/// slices before it.
fn costs(members: &[Member], along: Cut) -> Vec<(f64, usize)> {
    let mut slices = [None; SLICES];
    for member in members {
        let slice = &mut slices[along.slice_of(member)];
        *slice = join(*slice, Some(member.1));
    }
    let mut after = slices;
    for index in (0..SLICES - 1).rev() {
        after[index] = join(after[index + 1], slices[index]);
    }
    let mut costs = Vec::with_capacity(SLICES);
    let mut before = None;
    for index in 1..SLICES {
        let Some(added) = slices[index - 1] else { continue };
        before = join(before, Some(added));
        if let (Some(before), Some(after)) = (before, after[index]) {
            costs.push((before.cost() + after.cost(), index));
        }
    }
    costs
}

fn join(a: Option<Cluster>, b: Option<Cluster>) -> Option<Cluster> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.union(&b)),
        (one, other) => one.or(other),
    }
}
