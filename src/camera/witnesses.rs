//! What tells how sure the estimated error of a picture is: batches of its blocks at some pixels.
//!
//! The error of a picture is a sum over pixels; how far it may be off depends on what pixels share
//! and on how evenly blocks contribute, and no sum over blocks at single pixels knows that. So
//! luminance is kept batch by batch, at every pixel of a small picture and at one pixel of every
//! run of some in a large one, which bounds the memory. Blocks that lie beside one another are put
//! together when there are too many.

use crate::sampler::mix;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Pixels at most that are kept batch by batch: 8 MiB with [`MOST_BATCHES`].
const MOST_PIXELS: usize = 1 << 15;
/// Batches at most.
const MOST_BATCHES: usize = 32;

/// Numbers at most that are kept of a picture of so many pixels, the block being taken among them.
pub const fn batch_numbers(pixels: u64) -> u64 {
    let kept = if pixels < MOST_PIXELS as u64 { pixels } else { MOST_PIXELS as u64 };
    kept * (MOST_BATCHES as u64 + 1)
}

/// The pixels of a picture that are kept: one at random in each run of equal length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Witnesses {
    pixels: usize,
}

impl Witnesses {
    /// Those of a picture of so many pixels.
    pub const fn of(pixels: usize) -> Self {
        Self { pixels }
    }

    /// Pixels that each stands for.
    pub const fn stride(self) -> usize {
        let stride = self.pixels.div_ceil(MOST_PIXELS);
        if stride > 0 { stride } else { 1 }
    }

    /// How many there are.
    pub const fn len(self) -> usize {
        self.pixels.div_ceil(self.stride())
    }

    /// The pixel of one, pixels counted in rows from the top left.
    pub fn pixel(self, witness: usize) -> usize {
        let stride = self.stride();
        let within = (mix(witness as u64) % stride as u64) as usize;
        (witness * stride + within).min(self.pixels.saturating_sub(1))
    }

    /// Those among a range of pixels, with their pixels.
    fn among(self, pixels: Range<usize>) -> impl Iterator<Item = (usize, usize)> {
        let stride = self.stride();
        let witnesses = pixels.start / stride..pixels.end.div_ceil(stride).min(self.len());
        witnesses.map(move |witness| (witness, self.pixel(witness))).filter(move |(_, p)| pixels.contains(p))
    }
}

/// Sums of blocks at the witnesses, put together in batches.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Batches {
    witnesses: Witnesses,
    /// What each batch weighs: its samples, or what its chains weigh.
    sizes: Vec<f64>,
    sums: Vec<Vec<f64>>,
    /// The block being taken.
    block: Vec<f64>,
}

impl Batches {
    /// Nothing gathered yet, of a picture of so many pixels.
    pub fn new(pixels: usize) -> Self {
        let witnesses = Witnesses::of(pixels);
        Self { witnesses, sizes: Vec::new(), sums: Vec::new(), block: vec![0.0; witnesses.len()] }
    }

    /// Whether they are of a picture of so many pixels: those from a file may be anything.
    pub fn fits(&self, pixels: usize) -> bool {
        let witnesses = Witnesses::of(pixels);
        self.witnesses == witnesses
            && self.sizes.len() == self.sums.len()
            && self.sums.len() <= MOST_BATCHES
            && self.sums.iter().chain([&self.block]).all(|sums| sums.len() == witnesses.len())
    }

    /// Adds what a range of pixels has received of the block being taken.
    pub fn add(&mut self, pixels: Range<usize>, value: impl Fn(usize) -> f64) {
        for (witness, pixel) in self.witnesses.among(pixels) {
            self.block[witness] += value(pixel);
        }
    }

    /// Ends a block of a size.
    pub fn finish_block(&mut self, size: f64) {
        let empty = vec![0.0; self.block.len()];
        self.sizes.push(size);
        self.sums.push(std::mem::replace(&mut self.block, empty));
        if self.sums.len() > MOST_BATCHES
            && let Some((at, _)) = self.smallest_pair()
        {
            self.merge(at);
        }
    }

    /// Where the two neighbours begin that are smallest together, and what they come to.
    fn smallest_pair(&self) -> Option<(usize, f64)> {
        let pairs = self.sizes.windows(2).map(|pair| pair[0] + pair[1]).enumerate();
        pairs.min_by(|(_, a), (_, b)| a.total_cmp(b))
    }

    /// Puts a batch and the next one together.
    fn merge(&mut self, at: usize) {
        let (size, sums) = (self.sizes.remove(at + 1), self.sums.remove(at + 1));
        self.sizes[at] += size;
        self.sums[at].iter_mut().zip(sums).for_each(|(sum, more)| *sum += more);
    }

    /// The same in batches of which none has less than half the size of the largest: a few samples
    /// scatter less evenly than many.
    fn balanced(&self) -> Self {
        let mut batches = self.clone();
        while let Some(smallest) = batches.too_small() {
            let size = |at: Option<usize>| at.and_then(|at| batches.sizes.get(at)).copied();
            let before = size(smallest.checked_sub(1)).unwrap_or(f64::INFINITY);
            let after = size(Some(smallest + 1)).unwrap_or(f64::INFINITY);
            batches.merge(if before < after { smallest - 1 } else { smallest });
        }
        batches
    }

    /// The smallest batch, where it has less than half the size of the largest.
    fn too_small(&self) -> Option<usize> {
        let largest = self.sizes.iter().copied().fold(0.0, f64::max);
        let smallest = (0..self.sizes.len()).min_by(|a, b| self.sizes[*a].total_cmp(&self.sizes[*b]));
        smallest.filter(|at| self.sizes[*at] < 0.5 * largest)
    }

    /// How the batches scatter around the mean of all; `None` before the first.
    ///
    /// The residual of one of G batches is (mean of the batch - mean of all) / G, times the root of
    /// its size over the mean size. The variance of the mean of all is then estimated by
    /// G / (G - 1) times the sum of their squares, to which every batch contributes alike. Of the
    /// unbalanced ones it is what they move the mean of all by.
    pub fn scatter(&self, scale: f64) -> Option<Scatter> {
        let Self { sizes, sums, .. } = self.balanced();
        let all: f64 = sizes.iter().sum();
        if sums.is_empty() || all <= 0.0 {
            return None;
        }
        let mean = |witness: usize| sums.iter().map(|sums| sums[witness]).sum::<f64>() / all;
        let means: Vec<f64> = (0..self.block.len()).map(mean).collect();
        let residual = |sums: &Vec<f64>, size: f64, scale: f64| -> Vec<f64> {
            sums.iter().zip(&means).map(|(sum, mean)| scale * (sum - mean * size)).collect()
        };
        let even = |size: f64| scale / (size * all * sizes.len() as f64).sqrt();
        let is_merged = sizes.len() < self.sizes.len();
        let blocks = self.sums.iter().zip(&self.sizes).filter(|_| is_merged);
        Some(Scatter {
            residuals: sums
                .iter()
                .zip(&sizes)
                .map(|(sums, size)| residual(sums, *size, even(*size)))
                .collect(),
            unbalanced: blocks.map(|(sums, size)| residual(sums, *size, scale / all)).collect(),
            blocks: self.sizes.len(),
            largest_weight: self.sizes.iter().copied().fold(0.0, f64::max) / all,
            is_known: false,
        })
    }
}

impl Batches {
    /// A random level of this standard deviation, in units of the sum of all blocks.
    pub fn level(&self, deviation: f64) -> Scatter {
        let sum = |witness: usize| self.sums.iter().map(|sums| sums[witness]).sum::<f64>();
        let residual = (0..self.block.len()).map(|witness| deviation * sum(witness)).collect();
        Scatter {
            residuals: vec![residual],
            unbalanced: vec![],
            blocks: 0,
            largest_weight: 0.0,
            is_known: true,
        }
    }
}

/// One independent cause of error, at the witnesses.
#[derive(Clone, Debug)]
pub struct Scatter {
    /// Of each batch, what it moves the picture by.
    pub residuals: Vec<Vec<f64>>,
    /// The same of what was gathered, where it had to be put together for batches to weigh alike;
    /// else empty.
    pub unbalanced: Vec<Vec<f64>>,
    /// How many were gathered, a few of neighbours that were put together counting as one.
    pub blocks: usize,
    /// Share that the heaviest of them has in the weight of all.
    pub largest_weight: f64,
    /// Whether it is one random number of known standard deviation, as a level that all pixels
    /// share; then there is one residual, and its square is the variance.
    pub is_known: bool,
}

impl Scatter {
    /// The same cause of error in a picture of which this one has a share.
    #[must_use]
    pub fn times(mut self, share: f64) -> Self {
        let all = self.residuals.iter_mut().chain(&mut self.unbalanced);
        all.flatten().for_each(|residual| *residual *= share);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_run_of_pixels_has_a_witness() {
        for pixels in [1, 7, MOST_PIXELS, MOST_PIXELS + 1, 5 * MOST_PIXELS + 3] {
            let witnesses = Witnesses::of(pixels);
            assert!(witnesses.len() <= MOST_PIXELS, "{pixels}");
            let all: Vec<usize> = (0..witnesses.len()).map(|witness| witnesses.pixel(witness)).collect();
            assert!(all.windows(2).all(|pair| pair[0] < pair[1]), "{pixels}");
            assert!(all.iter().enumerate().all(|(k, p)| p / witnesses.stride() == k && *p < pixels));
            // Row by row they are the same ones.
            let rows =
                (0..pixels).step_by(97).flat_map(|first| witnesses.among(first..(first + 97).min(pixels)));
            assert_eq!(rows.map(|(_, pixel)| pixel).collect::<Vec<_>>(), all);
        }
    }

    #[test]
    fn batches_stay_few_and_alike() {
        let mut batches = Batches::new(1);
        for block in 0..1000_u32 {
            batches.add(0..1, |_| f64::from(block));
            batches.finish_block(1.0);
        }
        assert_eq!(batches.sizes.iter().sum::<f64>(), 1000.0);
        assert_eq!(batches.sums.iter().map(|sums| sums[0]).sum::<f64>(), 499_500.0);
        let count = batches.sizes.len();
        assert!((MOST_BATCHES / 2..=MOST_BATCHES).contains(&count), "{count}");
        let largest = batches.sizes.iter().copied().fold(0.0, f64::max);
        assert!(largest <= 4.0 * 1000.0 / count as f64, "{:?}", batches.sizes);
    }

    #[test]
    fn the_small_blocks_of_a_beginning_are_one_batch() {
        let mut batches = Batches::new(1);
        for size in [1.0, 1.0, 2.0, 4.0, 8.0, 16.0, 16.0, 2.0] {
            batches.finish_block(size);
        }
        assert_eq!(batches.balanced().sizes, [16.0, 16.0, 18.0]);
        let mut even = Batches::new(1);
        (0..4).for_each(|_| even.finish_block(16.0));
        assert_eq!(even.balanced().sizes, [16.0; 4]);
    }

    #[test]
    fn residuals_are_those_of_a_mean() {
        let mut batches = Batches::new(1);
        for (value, size) in [(1.0, 2.0), (5.0, 2.0), (6.0, 2.0)] {
            batches.add(0..1, |_| value);
            batches.finish_block(size);
        }
        // Mean 2: (1 - 4) / 6, (5 - 4) / 6, (6 - 4) / 6.
        let residuals = batches.scatter(6.0).expect("three batches").residuals;
        for (residual, truth) in residuals.iter().flatten().zip([-3.0, 1.0, 2.0]) {
            assert!((residual - truth).abs() < 1e-12, "{residual}, truth {truth}");
        }
        assert!(Batches::new(1).scatter(1.0).is_none());
    }
}
