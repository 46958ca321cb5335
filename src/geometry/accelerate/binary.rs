//! A binary tree of boxes; the only file that names `obvhs`.
//!
//! Clustering suits rays best; halving stands in where clustering makes a chain, as it does of
//! many faces in one place. Chains take quadratic time to make and overflow the call stack of
//! what follows.

use super::super::{Bounds, Primitive};
use obvhs::aabb::Aabb;
pub(super) use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;

/// Units in the last place of the scene's largest coordinate by which boxes are padded: it
/// covers the rounding of positions at which primitives are met.
const PADDING_ULPS: f32 = 4.0;
/// Share of nodes that each reinsertion pass of the tree optimiser looks at.
const REINSERTION_SHARE: f32 = 0.15;
/// Levels of a tree that is safe to walk by recursion.
const DEEPEST: u32 = 96;

/// A tree with one primitive in each leaf; there must be a primitive.
pub(super) fn binary_tree(primitives: &[Primitive], bounds: &Bounds) -> Bvh2 {
    let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
    // Along every axis the same: a face in a coordinate plane is met at coordinates about zero.
    let padding = glam::Vec3A::splat(reach * (PADDING_ULPS * f32::EPSILON));
    let padded = |primitive: &Primitive| {
        let Bounds { min, max } = primitive.bounds();
        Aabb::new(min - padding, max + padding)
    };
    let boxes: Vec<Aabb> = primitives.par_iter().map(padded).collect();
    if deepest_heap(&boxes) > DEEPEST as usize {
        return halved(&boxes);
    }
    let indices = (0..boxes.len() as u32).collect();
    let mut clustered = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Medium,
        &boxes,
        indices,
        SortPrecision::U64,
        0,
    );
    if !is_shallow(&clustered) {
        return halved(&boxes);
    }
    ReinsertionOptimizer::default().run(&mut clustered, REINSERTION_SHARE, None);
    if is_shallow(&clustered) { clustered } else { halved(&boxes) }
}

/// How many boxes at most are the same box.
fn deepest_heap(boxes: &[Aabb]) -> usize {
    let bits = |b: &Aabb| (b.min.to_array().map(f32::to_bits), b.max.to_array().map(f32::to_bits));
    let mut keys: Vec<_> = boxes.par_iter().map(bits).collect();
    keys.par_sort_unstable();
    keys.chunk_by(|a, b| a == b).map(<[_]>::len).max().unwrap_or(0)
}

fn is_shallow(tree: &Bvh2) -> bool {
    let mut pending = vec![(0, 0)];
    while let Some((index, depth)) = pending.pop() {
        if depth > DEEPEST {
            return false;
        }
        let node = &tree.nodes[index as usize];
        if !node.is_leaf() {
            pending.extend([(node.first_index, depth + 1), (node.first_index + 1, depth + 1)]);
        }
    }
    true
}

/// A tree that halves the number of boxes at each level, along the axis on which their
/// centres lie farthest apart.
fn halved(boxes: &[Aabb]) -> Bvh2 {
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut nodes = vec![Bvh2Node::default()];
    let mut pending = vec![(0, 0..boxes.len())];
    while let Some((node, range)) = pending.pop() {
        let members = &mut order[range.clone()];
        let (mut around, mut centers) = (Aabb::INVALID, Aabb::INVALID);
        for &member in members.iter() {
            around = around.union(&boxes[member as usize]);
            centers.extend(boxes[member as usize].center());
        }
        if members.len() == 1 {
            nodes[node] = Bvh2Node::new(around, 1, range.start as u32);
            continue;
        }
        let (axis, half) = (centers.largest_axis(), members.len() / 2);
        let center = |&member: &u32| boxes[member as usize].center_axis(axis);
        members.select_nth_unstable_by(half, |a, b| center(a).total_cmp(&center(b)));
        let children = nodes.len();
        nodes[node] = Bvh2Node::new(around, 0, children as u32);
        nodes.extend([Bvh2Node::default(); 2]);
        pending.push((children, range.start..range.start + half));
        pending.push((children + 1, range.start + half..range.end));
    }
    Bvh2 { nodes, primitive_indices: order, ..Bvh2::default() }
}
