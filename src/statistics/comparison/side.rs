//! One picture at one size of cell: means, their variances, and how far both can be trusted.
//!
//! A mean of few bright samples is skewed, and the estimate of its variance is low just where the
//! mean is low. The skewness g itself is not in the file. But noise that comes from few bright
//! events scatters in its own estimate: the variances of cells alike have a relative variance of
//! 2/f + K, f the degrees of freedom and K the excess kurtosis of the mean, and events that only
//! add light (a compound Poisson sum) have g^2 <= K by Schwarz's inequality. So K is taken from
//! the relative variances of 5x5 cells, and its root bounds the skewness. Cells that are not alike
//! make K too large, which costs power and no false alarms. Events that are too rare to have been
//! met among 25 cells are not seen; of those nothing can be known from the file.

use super::estimate::{CellErrors, Grid, Noise};
use crate::statistics::cells::{FEWEST_FOR_CORRECTION, NEIGHBOURHOOD};
use crate::statistics::pyramid::around;

/// Excess kurtosis where too few cells are near to tell: that of a mean whose noise is one event.
const KURTOSIS_OF_ONE_EVENT: f64 = 1.0;
/// Parts of a cell.
const PARTS: f64 = 4.0;
/// Share of a cell's pixels that are in parts whose errors are known, at least.
const MOST_PARTS: f64 = 0.5;

/// What a picture says of one cell.
#[derive(Clone, Copy, Debug)]
pub struct Known {
    /// Mean over the pixels that count.
    pub mean: f64,
    /// Variance of that mean.
    pub variance: f64,
    /// The same as its surroundings have it: independent enough of the mean to weigh with.
    pub steady: f64,
    /// Excess kurtosis of the mean, or more.
    pub kurtosis: f64,
    /// Degrees of freedom of the variance, the kurtosis considered.
    pub freedom: f64,
}

/// One picture at one size of cell, in rows; `None` where nothing is known.
pub type Side = Vec<Option<Known>>;

/// Single pixels. A pixel that is not lit here counts as lit for its neighbours where `lit` says so:
/// the other picture has light there.
pub fn pixels(mean: &[f64], noise: &Noise, grid: &Grid, lit: &[bool]) -> Side {
    let variance: Vec<f64> = noise.standard_error.iter().map(|error| error * error).collect();
    known_by_neighbours(mean, &variance, noise.blocks, grid, lit, &grid.complete)
}

fn known_by_neighbours(
    mean: &[f64],
    variance: &[f64],
    blocks: f64,
    grid: &Grid,
    lit: &[bool],
    usable: &[bool],
) -> Side {
    let freedom = blocks - 1.0;
    let known = |cell: usize| {
        let near: Vec<usize> =
            around(grid.cells, cell, NEIGHBOURHOOD).filter(|&other| usable[other] && lit[other]).collect();
        let Surroundings { steady, kurtosis } = Surroundings::of(mean, variance, freedom, &near);
        let freedom = 2.0 / (2.0 / freedom + kurtosis);
        Known { mean: mean[cell], variance: variance[cell], steady, kurtosis, freedom }
    };
    (0..mean.len()).map(|cell| usable[cell].then(|| known(cell))).collect()
}

/// What cells that lie together say of the noise of each.
pub struct Surroundings {
    /// Variance of a mean.
    pub steady: f64,
    /// Excess kurtosis of a mean, or more.
    pub kurtosis: f64,
}

impl Surroundings {
    /// Relative variances are compared, so that brightness matters less.
    pub fn of(mean: &[f64], variance: &[f64], freedom: f64, near: &[usize]) -> Self {
        let count = near.len() as f64;
        if near.is_empty() {
            return Self { steady: 0.0, kurtosis: 0.0 };
        }
        // Where no block has met light that is there, one block would have made all of it.
        let relative = |&cell: &usize| match mean[cell] {
            0.0 => 1.0,
            level => variance[cell] / (level * level),
        };
        let level = near.iter().map(|&cell| mean[cell]).sum::<f64>() / count;
        let average = near.iter().map(relative).sum::<f64>() / count;
        let steady = level * level * average;
        if average == 0.0 {
            return Self { steady, kurtosis: 0.0 };
        }
        if near.len() < FEWEST_FOR_CORRECTION {
            return Self { steady, kurtosis: KURTOSIS_OF_ONE_EVENT };
        }
        let scatter = near.iter().map(|cell| (relative(cell) / average - 1.0).powi(2)).sum::<f64>();
        Self { steady, kurtosis: (scatter / (count - 1.0) - 2.0 / freedom).max(0.0) }
    }
}

/// What parts of a cell add up to.
#[derive(Clone, Copy, Default)]
struct Sum {
    pixels: f64,
    mean: f64,
    variance: f64,
    steady: f64,
    fourth: f64,
    /// Variance of the variance, over two.
    spread: f64,
    unknown: bool,
}

fn sums(finer: &Side, from: &Grid, to: &Grid) -> Vec<Sum> {
    let mut sums = vec![Sum::default(); to.pixels.len()];
    for (cell, known) in finer.iter().enumerate().filter(|(cell, _)| from.pixels[*cell] > 0.0) {
        let sum = &mut sums[from.parent(cell)];
        let Some(known) = known else {
            sum.unknown = true;
            continue;
        };
        let weight = from.pixels[cell];
        let (variance, steady) = (weight * weight * known.variance, weight * weight * known.steady);
        sum.pixels += weight;
        sum.mean += weight * known.mean;
        sum.variance += variance;
        sum.steady += steady;
        sum.fourth += known.kurtosis * steady * steady;
        sum.spread += steady * steady / known.freedom;
    }
    sums
}

/// Cells of twice the side, of pixels that are independent: variances, fourth cumulants and
/// variances of variances add up.
pub fn coarser_of_independent(finer: &Side, from: &Grid, to: &Grid) -> Side {
    let known = |sum: Sum| {
        let area = sum.pixels * sum.pixels;
        let over = |value: f64, none: f64| {
            if sum.steady > 0.0 { value / (sum.steady * sum.steady) } else { none }
        };
        Known {
            mean: sum.mean / sum.pixels,
            variance: sum.variance / area,
            steady: sum.steady / area,
            kurtosis: over(sum.fourth, 0.0),
            // Without any scatter there is none of its estimate.
            freedom: 1.0 / over(sum.spread, 1.0),
        }
    };
    sums(finer, from, to)
        .into_iter()
        .map(|sum| (sum.pixels > 0.0 && !sum.unknown).then(|| known(sum)))
        .collect()
}

/// Variance of the mean over the pixels of a cell that count; NaN where it is not known.
fn stated_variance(stated: &CellErrors, grid: &Grid, cell: usize) -> f64 {
    grid.stretch(cell).map_or(f64::NAN, |stretch| (stretch * stated.standard_error[cell]).powi(2))
}

/// Cells with stated errors, at the finest size that has them: told by their neighbours.
pub fn stated(mean: &[f64], stated: &CellErrors, blocks: f64, grid: &Grid) -> Side {
    let variance: Vec<f64> = (0..mean.len()).map(|cell| stated_variance(stated, grid, cell)).collect();
    let lit: Vec<bool> = mean.iter().zip(&variance).map(|(mean, v)| *mean != 0.0 || *v != 0.0).collect();
    let usable: Vec<bool> = variance.iter().map(|variance| variance.is_finite()).collect();
    known_by_neighbours(mean, &variance, blocks, grid, &lit, &usable)
}

/// Cells with stated errors that have parts with stated errors. Of four independent parts the
/// kurtosis falls to a quarter, of four that go together it stays; how far they do is told by the
/// variance of the cell against those of its parts. Parts that are not known are taken to be like
/// the others, which are most.
pub fn coarser_of_stated(
    mean: &[f64],
    stated: &CellErrors,
    blocks: f64,
    finer: &Side,
    from: &Grid,
    to: &Grid,
) -> Side {
    let parts = sums(finer, from, to);
    let known = |cell: usize| {
        let (sum, variance) = (parts[cell], stated_variance(stated, to, cell));
        if !variance.is_finite() || sum.pixels < MOST_PARTS * to.pixels[cell] {
            return None;
        }
        // Sums over all parts are so many times those over the known ones.
        let times = to.pixels[cell] / sum.pixels;
        let together = (variance * to.pixels[cell].powi(2) / (times * sum.variance)).clamp(1.0, PARTS);
        let kurtosis =
            if sum.variance > 0.0 { together * sum.fourth / (times * sum.steady * sum.steady) } else { 0.0 };
        let freedom = 2.0 / (2.0 / (blocks - 1.0) + kurtosis);
        Some(Known { mean: mean[cell], variance, steady: variance, kurtosis, freedom })
    };
    (0..parts.len()).map(known).collect()
}
