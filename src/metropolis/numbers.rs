//! Random numbers of a chain, and the symmetric steps that mutations take with them.

use crate::sampler::mix;
use glam::Vec3A;
use std::f64::consts::TAU;

/// Independent numbers in the order in which they are asked for: SplitMix64 (Steele, Lea and
/// Flood 2014) from a key.
#[derive(Clone, Debug)]
pub struct Numbers {
    state: u64,
}

/// What a state of the generator advances by: the golden ratio in 64 bits.
const ADVANCE: u64 = 0x9e37_79b9_7f4a_7c15;

impl Numbers {
    /// The numbers that a list of names stands for.
    pub fn of(names: &[u64]) -> Self {
        Self { state: names.iter().fold(0, |key, name| mix(key ^ *name)) }
    }

    fn bits(&mut self) -> u64 {
        let drawn = mix(self.state);
        self.state = self.state.wrapping_add(ADVANCE);
        drawn
    }

    /// A number in [0, 1) with 24 bits.
    pub fn single(&mut self) -> f32 {
        (self.bits() >> 40) as f32 * (1.0 / 16_777_216.0)
    }

    /// Two numbers in [0, 1) with 24 bits.
    pub fn pair(&mut self) -> [f32; 2] {
        [self.single(), self.single()]
    }

    /// A number in [0, 1) with 53 bits.
    pub fn fine(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// An index below `count`, each alike.
    pub fn index(&mut self, count: usize) -> usize {
        ((self.fine() * count as f64) as usize).min(count.saturating_sub(1))
    }

    /// An index with probability in proportion to its weight; `None` where all are zero.
    pub fn choose(&mut self, weights: impl Iterator<Item = f64> + Clone) -> Option<usize> {
        let total: f64 = weights.clone().sum();
        let mut left = self.fine() * total;
        let mut chosen = None;
        for (index, weight) in weights.enumerate() {
            if weight > 0.0 {
                chosen = Some(index);
                left -= weight;
                if left < 0.0 {
                    break;
                }
            }
        }
        chosen
    }
}

/// A range of step sizes, all orders of magnitude in it alike.
///
/// The steps are symmetric: from either of two states the other one has the same density
/// (Kelemen et al. 2002, section 4; Veach 1997, section 11.4.3).
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    /// Smallest size.
    pub smallest: f64,
    /// Largest size.
    pub largest: f64,
}

impl Steps {
    /// A size.
    pub fn size(&self, numbers: &mut Numbers) -> f64 {
        self.largest * (self.smallest / self.largest).powf(numbers.fine())
    }

    /// A number of [0, 1) moved by a size to either side, around the end where it falls off.
    pub fn along_unit(&self, from: f32, numbers: &mut Numbers) -> f32 {
        let size = self.size(numbers);
        let side = if numbers.fine() < 0.5 { size } else { -size };
        let moved = (f64::from(from) + side).rem_euclid(1.0) as f32;
        // Rounding to f32 may reach the open end, which is the other end of the circle.
        if moved >= 1.0 { 0.0 } else { moved }
    }

    /// A position moved by a size in any direction of the plane.
    pub fn in_plane(&self, from: [f64; 2], numbers: &mut Numbers) -> [f64; 2] {
        let size = self.size(numbers);
        let (sin, cos) = (TAU * numbers.fine()).sin_cos();
        [from[0] + size * cos, from[1] + size * sin]
    }

    /// A unit direction turned by a size in radians towards any side.
    pub fn on_sphere(&self, from: Vec3A, numbers: &mut Numbers) -> Vec3A {
        let size = self.size(numbers);
        let axis = from.as_dvec3().normalize();
        let (tangent, bitangent) = axis.any_orthonormal_pair();
        let (sin, cos) = (TAU * numbers.fine()).sin_cos();
        let turned = axis * size.cos() + (tangent * cos + bitangent * sin) * size.sin();
        turned.normalize().as_vec3a()
    }
}
