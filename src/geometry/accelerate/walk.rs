//! The walk of a ray through the tree.
//!
//! Written once and compiled twice, for any processor and for one with wider registers; both
//! do the same arithmetic in the same order and give the same bits. Everything is inlined into
//! the two callers, since only what is inlined is compiled for the registers of its caller.

use super::super::{PreciseRay, Ray};
use super::block::{Block, BlockRay};
use super::node::{BoxRay, Child, Node, Target, WIDTH};
use super::tree::Tree;
use std::ops::ControlFlow;

/// What is done with the primitives on a ray's way.
pub(super) trait Visitor {
    /// Whether they are wanted about in the order in which the ray meets them.
    const SORTED: bool;

    /// Meets a primitive exactly; returns the distance beyond which others do not count. A
    /// method rather than a closure, so that it can be told to be inlined.
    fn visit(&mut self, candidate: Candidate) -> ControlFlow<(), f32>;
}

/// A primitive that a ray may meet.
pub(super) enum Candidate {
    /// A triangle, its vertices at hand, and its slot.
    Triangle([[f32; 3]; 3], u32),
    /// Any primitive, by its slot.
    Primitive(u32),
}

/// Shows `visitor` the primitives that `ray` may meet nearer than the limit that the last visit
/// returned; one of two pieces perhaps twice.
#[inline(always)]
pub(super) fn walk<V: Visitor>(tree: &Tree, ray: &Ray, precise: &PreciseRay, reach: f32, visitor: &mut V) {
    if tree.nodes.is_empty() {
        return;
    }
    let (boxes, triangles) = (BoxRay::new(ray), BlockRay::new(precise, reach));
    let mut limit = ray.t_max;
    let mut stack = Stack::new();
    let mut next = Some(Child::ROOT);
    while let Some(child) = next {
        let visited = match child.target() {
            Target::Node(number) => {
                next = enter::<V>(&tree.nodes[number], &boxes, limit, &mut stack);
                if next.is_some() {
                    continue;
                }
                ControlFlow::Continue(limit)
            }
            Target::Block(number) => visit_block(&tree.blocks[number], &triangles, limit, visitor),
            Target::Slot(slot) => visitor.visit(Candidate::Primitive(slot)),
        };
        match visited {
            ControlFlow::Continue(nearer) => limit = nearer,
            ControlFlow::Break(()) => return,
        }
        next = stack.pop(if V::SORTED { limit } else { f32::INFINITY });
    }
}

#[inline(always)]
fn visit_block<V: Visitor>(
    block: &Block,
    ray: &BlockRay,
    mut limit: f32,
    visitor: &mut V,
) -> ControlFlow<(), f32> {
    let mut left = block.may_meet(ray, limit);
    while left != 0 {
        limit = visitor.visit(block.candidate(left.trailing_zeros() as usize))?;
        left &= left - 1;
    }
    ControlFlow::Continue(limit)
}

/// The child of a node to go on with; the others that are met go to the stack, the farthest
/// first where order is wanted.
#[inline(always)]
fn enter<V: Visitor>(node: &Node, ray: &BoxRay, limit: f32, stack: &mut Stack) -> Option<Child> {
    let (mut met, enters) = node.meet(ray, limit);
    if met == 0 {
        return None;
    }
    let first = met.trailing_zeros() as usize;
    met &= met - 1;
    if met == 0 {
        return Some(node.child(first));
    }
    let mut nearest = node.child(first).at(enters[first % WIDTH]);
    let bottom = stack.used;
    while met != 0 {
        let place = met.trailing_zeros() as usize;
        met &= met - 1;
        let key = node.child(place).at(enters[place % WIDTH]);
        if V::SORTED {
            stack.insert(bottom, nearest.max(key));
            nearest = nearest.min(key);
        } else {
            stack.insert(stack.used, key);
        }
    }
    Some(Child::from_key(nearest).0)
}

/// Children still to visit, by [`Child::at`].
struct Stack {
    keys: [u64; Self::SIZE],
    used: usize,
    /// What did not fit: depth is not bounded by anything but the number of primitives.
    spilled: Vec<u64>,
}

impl Stack {
    const SIZE: usize = 48;

    #[inline(always)]
    const fn new() -> Self {
        Self { keys: [0; Self::SIZE], used: 0, spilled: Vec::new() }
    }

    /// Puts a key where it belongs among those from `bottom` on, which fall towards the top.
    #[inline(always)]
    fn insert(&mut self, bottom: usize, key: u64) {
        if self.used >= Self::SIZE {
            // Any order is right, and this one is rare.
            self.spilled.push(key);
            return;
        }
        let mut place = self.used;
        while place > bottom && self.keys[place - 1] < key {
            self.keys[place] = self.keys[place - 1];
            place -= 1;
        }
        self.keys[place] = key;
        self.used += 1;
    }

    /// The next child that the ray enters no farther than `limit`.
    #[inline(always)]
    fn pop(&mut self, limit: f32) -> Option<Child> {
        loop {
            let key = match self.spilled.pop() {
                Some(key) => key,
                None => {
                    self.used = self.used.checked_sub(1)?;
                    self.keys[self.used]
                }
            };
            let (child, enter) = Child::from_key(key);
            if enter <= limit {
                return Some(child);
            }
        }
    }
}
