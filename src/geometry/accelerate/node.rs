//! A node of the tree: eight boxes, tested together.
//!
//! The boxes are kept as they are, in `f32`: unpacking compressed ones costs more than the
//! memory they save, also at a million triangles. The test rounds in the ray's favour, so that
//! no box is missed whose contents are met.

use super::super::{Bounds, Ray};
use glam::Vec3A;

/// Children of a node, and primitives of a block.
pub(super) const WIDTH: usize = 8;

/// What a node leads to: the two highest bits say of which kind, the rest is its number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Child(u32);

/// A [`Child`] taken apart.
pub(super) enum Target {
    /// A node, by its number.
    Node(usize),
    /// A block of flat faces, by its number.
    Block(usize),
    /// A single primitive, by its slot.
    Slot(u32),
}

/// Nodes, blocks and slots that a tree can hold.
pub(super) const CHILD_LIMIT: u32 = 1 << 30;
const BLOCK: u32 = 1 << 31;
const SLOT: u32 = 1 << 30;

impl Child {
    pub const ROOT: Self = Self(0);

    pub const fn node(number: usize) -> Self {
        Self(number as u32)
    }

    pub const fn block(number: usize) -> Self {
        Self(number as u32 | BLOCK)
    }

    pub const fn slot(number: usize) -> Self {
        Self(number as u32 | SLOT)
    }

    #[inline(always)]
    pub const fn target(self) -> Target {
        let number = self.0 & (CHILD_LIMIT - 1);
        if self.0 & BLOCK != 0 {
            Target::Block(number as usize)
        } else if self.0 & SLOT != 0 {
            Target::Slot(number)
        } else {
            Target::Node(number as usize)
        }
    }

    /// A child and where the ray enters it as a number that sorts by the distance, which must
    /// not be negative.
    #[inline(always)]
    pub fn at(self, enter: f32) -> u64 {
        u64::from(enter.to_bits()) << 32 | u64::from(self.0)
    }

    /// Back from [`Self::at`].
    #[inline(always)]
    pub fn from_key(key: u64) -> (Self, f32) {
        (Self(key as u32), f32::from_bits((key >> 32) as u32))
    }
}

/// Up to eight boxes and what they hold: four cache lines.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Low and high sides along x, y, z.
    sides: [[[f32; WIDTH]; 2]; 3],
    children: [Child; WIDTH],
    /// A bit for each child that there is.
    present: u32,
}

/// A ray as the box test wants it.
pub(super) struct BoxRay {
    origin: [f32; 3],
    inverse: [f32; 3],
    /// Whether the ray meets the high side first.
    falls: [bool; 3],
}

/// Direction components below this count as this: far below the padding of boxes at any
/// distance a scene holds, and the inverse stays finite through the box test.
const LEAST_COMPONENT: f32 = 1e-20;
/// Bound on the relative rounding of a distance to a side: three roundings, and one of its own.
const BOX_ROUNDING: f32 = 2.0 * f32::EPSILON;

impl BoxRay {
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let size = ray.direction.abs().max(Vec3A::splat(LEAST_COMPONENT));
        let inverse = size.copysign(ray.direction).recip().to_array();
        Self { origin: ray.origin.to_array(), inverse, falls: inverse.map(|i| i < 0.0) }
    }
}

impl Node {
    /// A node without children.
    pub const EMPTY: Self = Self {
        sides: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3],
        children: [Child::ROOT; WIDTH],
        present: 0,
    };

    /// Puts a child into a place.
    pub fn set(&mut self, place: usize, bounds: &Bounds, child: Child) {
        for axis in 0..3 {
            self.sides[axis][0][place] = bounds.min[axis];
            self.sides[axis][1][place] = bounds.max[axis];
        }
        self.children[place] = child;
        self.present |= 1 << place;
    }

    #[inline(always)]
    pub fn child(&self, place: usize) -> Child {
        self.children[place % WIDTH]
    }

    /// Which children the ray meets before `limit`, a bit each, and where at the earliest it
    /// enters them.
    #[inline(always)]
    pub fn meet(&self, ray: &BoxRay, limit: f32) -> (u32, [f32; WIDTH]) {
        let near = [0, 1, 2].map(|axis| &self.sides[axis][usize::from(ray.falls[axis])]);
        let far = [0, 1, 2].map(|axis| &self.sides[axis][usize::from(!ray.falls[axis])]);
        let (mut enters, mut met) = ([0.0; WIDTH], [0; WIDTH]);
        for place in 0..WIDTH {
            let (mut enter, mut leave) = (0.0, limit);
            for axis in 0..3 {
                let nearest = (near[axis][place] - ray.origin[axis]) * ray.inverse[axis];
                let farthest = (far[axis][place] - ray.origin[axis]) * ray.inverse[axis];
                // Comparisons, not `max` and `min`: these are one instruction, and what is not
                // a number counts as met.
                enter = if nearest > enter { nearest } else { enter };
                leave = if farthest < leave { farthest } else { leave };
            }
            enter *= 1.0 - BOX_ROUNDING;
            enters[place] = enter;
            let missed = enter > leave * (1.0 + BOX_ROUNDING);
            met[place] = if missed { 0 } else { 1 << place };
        }
        (gather(met) & self.present, enters)
    }
}

/// All bits together.
#[inline(always)]
pub(super) fn gather(bits: [u32; WIDTH]) -> u32 {
    bits.into_iter().fold(0, |all, bit| all | bit)
}
