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

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution::{ChiSquared, ContinuousCDF};

    /// Smallest probability of a passing chi-squared test: a false alarm once in a thousand.
    const LEAST_P: f64 = 1e-3;

    fn p_value(chi2: f64, degrees: usize) -> f64 {
        1.0 - ChiSquared::new(degrees as f64).expect("some degrees").cdf(chi2)
    }

    const STEPS: Steps = Steps { smallest: 1e-3, largest: 0.3 };

    /// A chain of steps alone reproduces known densities on the circle: even, with a jump at
    /// the end of the interval, and with a peak across it. Of 16 million turns every 400th is
    /// looked at, farther apart than the chain remembers. Steps that are clamped at the
    /// ends instead of going round fail all three.
    #[test]
    fn known_densities_are_reproduced() {
        const CELLS: usize = 32;
        const LOOKS: usize = 40_000;
        const APART: usize = 400;
        let even = |_: f64| 1.0;
        let ramp = |u: f64| u + 0.02;
        let peak = |u: f64| (-40.0 * u.min(1.0 - u)).exp() + 0.01;
        let densities: [(&str, &dyn Fn(f64) -> f64); 3] = [("even", &even), ("ramp", &ramp), ("peak", &peak)];
        for (name, density) in densities {
            let mut numbers = Numbers::of(&[11]);
            let mut at = 0.5_f32;
            let mut counts = [0.0; CELLS];
            for _ in 0..LOOKS {
                for _ in 0..APART {
                    let to = STEPS.along_unit(at, &mut numbers);
                    let ratio = density(f64::from(to)) / density(f64::from(at));
                    if numbers.fine() < ratio {
                        at = to;
                    }
                }
                counts[(at * CELLS as f32) as usize] += 1.0;
            }
            let mass = |cell: usize| -> f64 {
                (0..1000).map(|i| density((cell as f64 + (f64::from(i) + 0.5) / 1000.0) / CELLS as f64)).sum()
            };
            let all: f64 = (0..CELLS).map(mass).sum();
            let term = |(cell, count): (usize, &f64)| {
                let expected = LOOKS as f64 * mass(cell) / all;
                (count - expected).powi(2) / expected
            };
            let p = p_value(counts.iter().enumerate().map(term).sum(), CELLS - 1);
            assert!(p > LEAST_P, "{name}: p = {p}");
        }
    }

    /// As many steps lead from one cell to another as back, from evenly spread starts: on the
    /// circle, in the plane and on the sphere.
    #[test]
    fn steps_are_symmetric() {
        fn judge<T: Copy>(
            name: &str,
            start: impl Fn(&mut Numbers) -> T,
            step: impl Fn(T, &mut Numbers) -> T,
            cell: impl Fn(T) -> usize,
        ) {
            let mut numbers = Numbers::of(&[12]);
            let mut pairs = std::collections::BTreeMap::new();
            for _ in 0..400_000 {
                let from = start(&mut numbers);
                let to = step(from, &mut numbers);
                *pairs.entry((cell(from), cell(to))).or_insert(0.0) += 1.0;
            }
            let (mut chi2, mut degrees) = (0.0, 0);
            for (&(a, b), &there) in pairs.iter().filter(|((a, b), _)| a < b) {
                let back: f64 = pairs.get(&(b, a)).copied().unwrap_or(0.0);
                if there + back >= 20.0 {
                    chi2 += (there - back).powi(2) / (there + back);
                    degrees += 1;
                }
            }
            let p = p_value(chi2, degrees);
            assert!(degrees > 5 && p > LEAST_P, "{name}: p = {p} over {degrees} pairs");
        }
        judge("circle", |n| n.single(), |u, n| STEPS.along_unit(u, n), |u| (u * 16.0) as usize);
        let plane =
            |[x, y]: [f64; 2]| ((x * 4.0).rem_euclid(4.0) as usize) * 4 + (y * 4.0).rem_euclid(4.0) as usize;
        judge("plane", |n| [n.fine(), n.fine()], |p, n| STEPS.in_plane(p, n), plane);
        let uniform = |n: &mut Numbers| {
            let z = 2.0 * n.fine() - 1.0;
            let (sin, cos) = (TAU * n.fine()).sin_cos();
            let across = (1.0 - z * z).sqrt();
            glam::DVec3::new(across * cos, across * sin, z).as_vec3a()
        };
        let octant = |w: Vec3A| {
            let third = |v: f32| ((v + 1.0) * 1.499) as usize;
            third(w.x) * 9 + third(w.y) * 3 + third(w.z)
        };
        judge("sphere", uniform, |w, n| STEPS.on_sphere(w, n), octant);
    }
}
