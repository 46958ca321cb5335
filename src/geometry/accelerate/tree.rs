//! The tree that rays walk: eight children a node, collapsed from a binary tree.
//!
//! A subtree whose triangles fit a block becomes one, which costs a ray no more than a node
//! would; it is split again where its node has places left and the parts' boxes are together
//! smaller. Curved primitives are leaves of their own.

use super::super::{Bounds, Primitive};
use super::binary::{Bvh2, binary_tree};
use super::block::Block;
use super::node::{Child, Node, WIDTH};

/// Nodes and blocks, the root first, and the primitives in the order of the slots.
pub(super) struct Tree {
    pub nodes: Vec<Node>,
    pub blocks: Vec<Block>,
    pub order: Vec<u32>,
}

impl Tree {
    /// A tree over primitives; without any it has no node.
    pub fn new(primitives: &[Primitive], bounds: &Bounds) -> Self {
        let mut tree = Self { nodes: Vec::new(), blocks: Vec::new(), order: Vec::new() };
        if !primitives.is_empty() {
            let binary = binary_tree(primitives, bounds);
            let mut sizes = vec![0; binary.nodes.len()];
            measure(&binary, primitives, 0, &mut sizes);
            tree.order.reserve_exact(primitives.len());
            tree.nodes.push(Node::EMPTY);
            Collapse { binary: &binary, primitives, sizes: &sizes, tree: &mut tree }.fill(0, 0);
            tree.nodes.shrink_to_fit();
            tree.blocks.shrink_to_fit();
        }
        tree
    }
}

/// More triangles than a block holds; a curved primitive counts as so many.
const TOO_MANY: u8 = WIDTH as u8 + 1;

/// Finds the number of triangles below each node.
fn measure(binary: &Bvh2, primitives: &[Primitive], index: usize, sizes: &mut [u8]) -> u8 {
    let node = &binary.nodes[index];
    let first = node.first_index as usize;
    sizes[index] = if node.is_leaf() {
        match primitives[binary.primitive_indices[first] as usize] {
            Primitive::Triangle(_) => 1,
            Primitive::Parallelogram(_) => 2,
            _ => TOO_MANY,
        }
    } else {
        let size = |child, sizes: &mut [u8]| measure(binary, primitives, child, sizes);
        (size(first, sizes) + size(first + 1, sizes)).min(TOO_MANY)
    };
    sizes[index]
}

struct Collapse<'a> {
    binary: &'a Bvh2,
    primitives: &'a [Primitive],
    sizes: &'a [u8],
    tree: &'a mut Tree,
}

impl Collapse<'_> {
    /// Fills the empty node `number` with what is below node `index` of the binary tree.
    fn fill(&mut self, number: usize, index: usize) {
        let mut members = vec![index];
        while members.len() < WIDTH {
            let Some(opened) = self.to_open(&members) else { break };
            let first = self.binary.nodes[members[opened]].first_index as usize;
            members[opened] = first;
            members.push(first + 1);
        }
        for (place, &member) in members.iter().enumerate() {
            let around = self.binary.nodes[member].aabb();
            let bounds = Bounds { min: around.min, max: around.max };
            let child = self.child(member);
            self.tree.nodes[number].set(place, &bounds, child);
        }
    }

    /// Which member to replace by its two children: the largest that is no leaf; then the block
    /// whose parts' boxes are smallest compared with its own.
    fn to_open(&self, members: &[usize]) -> Option<usize> {
        let area = |member: usize| self.binary.nodes[member].aabb().half_area();
        let gain = |member: usize| {
            let first = self.binary.nodes[member].first_index as usize;
            area(member) - area(first) - area(first + 1)
        };
        let inner = (0..members.len()).filter(|&i| !self.binary.nodes[members[i]].is_leaf());
        let (large, blocks): (Vec<_>, Vec<_>) = inner.partition(|&i| self.sizes[members[i]] == TOO_MANY);
        let by =
            |key: &dyn Fn(usize) -> f32, a: &usize, b: &usize| key(members[*a]).total_cmp(&key(members[*b]));
        large
            .into_iter()
            .max_by(|a, b| by(&area, a, b))
            .or_else(|| blocks.into_iter().filter(|&i| gain(members[i]) > 0.0).max_by(|a, b| by(&gain, a, b)))
    }

    /// Adds what is below node `index` of the binary tree.
    fn child(&mut self, index: usize) -> Child {
        if self.sizes[index] < TOO_MANY {
            let mut block = Block::EMPTY;
            self.fill_block(&mut block, 0, index);
            self.tree.blocks.push(block);
            return Child::block(self.tree.blocks.len() - 1);
        }
        let node = &self.binary.nodes[index];
        if node.is_leaf() {
            self.tree.order.push(self.binary.primitive_indices[node.first_index as usize]);
            return Child::slot(self.tree.order.len() - 1);
        }
        self.tree.nodes.push(Node::EMPTY);
        let number = self.tree.nodes.len() - 1;
        self.fill(number, index);
        Child::node(number)
    }

    /// Puts the faces below node `index` of the binary tree into a block from `place` on;
    /// returns the place after them.
    fn fill_block(&mut self, block: &mut Block, place: usize, index: usize) -> usize {
        let node = &self.binary.nodes[index];
        let first = node.first_index as usize;
        if !node.is_leaf() {
            let place = self.fill_block(block, place, first);
            return self.fill_block(block, place, first + 1);
        }
        let id = self.binary.primitive_indices[first];
        let slot = self.tree.order.len() as u32;
        self.tree.order.push(id);
        match &self.primitives[id as usize] {
            Primitive::Triangle(triangle) => {
                block.set(place, &triangle.vertices().map(|v| v.to_array()), slot, false);
                place + 1
            }
            Primitive::Parallelogram(parallelogram) => {
                let [a, b, c, d] = parallelogram.corners().map(|v| v.to_array());
                block.set(place, &[a, b, c], slot, true);
                block.set(place + 1, &[a, c, d], slot, true);
                place + 2
            }
            _ => place,
        }
    }
}
