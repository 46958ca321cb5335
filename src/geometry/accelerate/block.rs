//! Blocks of up to eight triangles, tested together in `f32` before any is met in `f64`.
//!
//! The test never turns away what the exact one accepts: each of its quantities has a bound on
//! its rounding, and only what is outside by more than the bound is turned away. What passes is
//! met exactly, so blocks decide nothing but the time taken. A parallelogram stands as its two
//! halves.

use super::super::PreciseRay;
use super::node::{WIDTH, gather};
use super::walk::Candidate;

/// Triangles of flat primitives: five cache lines.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Block {
    /// By axis, then by vertex.
    vertices: [[[f32; WIDTH]; 3]; 3],
    /// Slots of the primitives, with [`IS_PART`].
    slots: [u32; WIDTH],
}

/// The slot of a triangle that is not there.
const NO_SLOT: u32 = u32::MAX;
/// Marks the slot of a primitive of which the triangle is but a part.
const IS_PART: u32 = 1 << 31;

/// A ray as the triangle test wants it: sheared onto the axis along which it is longest, as
/// [`PreciseRay`] is.
pub(super) struct BlockRay {
    axes: [usize; 3],
    start: [f32; 3],
    shear: [f32; 2],
    inverse: f32,
    /// The rounding of the largest distance along an axis: u R of [`EDGE_ROUNDINGS`].
    error: f32,
}

/// Half a unit in the last place of one.
const ROUNDING: f32 = 0.5 * f32::EPSILON;
/// How many roundings of (distance times extent) an edge function is off at most.
///
/// Let R bound the distances of vertices from the ray's start along each axis, P the sheared
/// coordinates, u the rounding. A sheared coordinate carries the roundings of two differences,
/// of the shear, of their product and of the last difference, of at most R, R, R, R and 2 R:
/// 6 u R. A product of two is off by 2 P (6 u R) + (6 u R)^2 + u P^2, their difference by
/// twice that and 2 u P^2; with P <= 2 R that is 32 u R P + 72 (u R)^2. Forty u R P is more,
/// where P counts for [`LEAST_EXTENT`] u R at least; it covers the rounding of this bound and
/// of the exact test too, 2^-29 of it.
const EDGE_ROUNDINGS: f32 = 40.0;
/// See [`EDGE_ROUNDINGS`].
const LEAST_EXTENT: f32 = 11.0;
/// Bound on what products below the range of `f32` lose.
const UNDERFLOW: f32 = 1e-36;
/// Bound on the relative rounding of a vertex's distance: three roundings, and one of its own.
const DISTANCE_ROUNDING: f32 = 2.0 * f32::EPSILON;

impl BlockRay {
    /// Prepares a ray for triangles whose coordinates reach to `reach`.
    #[inline(always)]
    pub fn new(ray: &PreciseRay, reach: f32) -> Self {
        let (axes, shear) = ray.shear();
        let start = ray.origin.as_vec3a();
        Self {
            axes,
            start: axes.map(|axis| start[axis]),
            shear: [shear[0] as f32, shear[1] as f32],
            inverse: (shear[2] as f32).clamp(f32::MIN, f32::MAX),
            error: (start.abs().max_element() + reach) * ROUNDING,
        }
    }
}

impl Block {
    /// A block without triangles.
    pub const EMPTY: Self = Self { vertices: [[[0.0; WIDTH]; 3]; 3], slots: [NO_SLOT; WIDTH] };

    /// Puts a triangle into a place: the primitive in `slot`, or a part of it.
    pub fn set(&mut self, place: usize, vertices: &[[f32; 3]; 3], slot: u32, is_part: bool) {
        for (axis, of_axis) in self.vertices.iter_mut().enumerate() {
            for (vertex, of_vertex) in of_axis.iter_mut().enumerate() {
                of_vertex[place] = vertices[vertex][axis];
            }
        }
        self.slots[place] = if is_part { slot | IS_PART } else { slot };
    }

    /// What stands in a place.
    #[inline(always)]
    pub fn candidate(&self, place: usize) -> Candidate {
        let place = place % WIDTH;
        let slot = self.slots[place];
        if slot & IS_PART != 0 {
            return Candidate::Primitive(slot & !IS_PART);
        }
        let vertex = |vertex: usize| [0, 1, 2].map(|axis: usize| self.vertices[axis][vertex][place]);
        Candidate::Triangle([vertex(0), vertex(1), vertex(2)], slot)
    }

    /// Which triangles the ray may meet before `limit`, a bit each.
    #[inline(always)]
    pub fn may_meet(&self, ray: &BlockRay, limit: f32) -> u32 {
        let [xs, ys, zs] = ray.axes.map(|axis| &self.vertices[axis]);
        let limit = limit * (1.0 + DISTANCE_ROUNDING) + f32::MIN_POSITIVE;
        let (scale, least_extent) = (EDGE_ROUNDINGS * ray.error, LEAST_EXTENT * ray.error);
        let mut may_meet = [0; WIDTH];
        for place in 0..WIDTH {
            let (mut x, mut y, mut t) = ([0.0; 3], [0.0; 3], [0.0; 3]);
            for vertex in 0..3 {
                let z = zs[vertex][place] - ray.start[2];
                x[vertex] = xs[vertex][place] - ray.start[0] - ray.shear[0] * z;
                y[vertex] = ys[vertex][place] - ray.start[1] - ray.shear[1] * z;
                t[vertex] = ray.inverse * z;
            }
            let across = [x[2] * y[1] - y[2] * x[1], x[0] * y[2] - y[0] * x[2], x[1] * y[0] - y[1] * x[0]];
            let extent = highest([highest(x.map(f32::abs)), highest(y.map(f32::abs)), least_extent]);
            let error = scale * extent + UNDERFLOW;
            let aside = (lowest(across) < -error) & (highest(across) > error);
            // The distance is a mean of the vertices'.
            let out_of_reach = (highest(t) < 0.0) | (lowest(t) > limit);
            let is_there = self.slots[place] != NO_SLOT;
            may_meet[place] = if is_there & !aside & !out_of_reach { 1 << place } else { 0 };
        }
        gather(may_meet)
    }
}

/// The greatest, by comparisons that are one instruction each.
#[inline(always)]
fn highest([a, b, c]: [f32; 3]) -> f32 {
    let high = if a > b { a } else { b };
    if high > c { high } else { c }
}

/// The least, likewise.
#[inline(always)]
fn lowest([a, b, c]: [f32; 3]) -> f32 {
    let low = if a < b { a } else { b };
    if low < c { low } else { c }
}
