//! How far two pictures are apart, and how much of it their noise explains.
//!
//! The expectation of (A - B)^2 is bias^2 + var A + var B; with unbiased variances that are stated
//! per pixel the noise can be taken out, whatever its distribution. What is left scatters around
//! the squared bias and may be below zero.

use super::estimate::{Estimate, Grid, Noise};
use super::side::Surroundings;
use crate::statistics::cells::{FEWEST_FOR_CORRECTION, NEIGHBOURHOOD};
use crate::statistics::error_measures::{FLOOR_SHARE, RelativeMse, relative_mse};
use crate::statistics::pyramid::around;
use statrs::distribution::{ContinuousCDF, Normal};
use std::fmt;

/// 97.5 % quantile of the standard normal distribution.
const NORMAL_975: f64 = 1.959_963_984_540_054;
/// Fewest pixels for a test of all of them together.
const FEWEST_TOGETHER: usize = 32;

/// Distances over all pixels that count.
#[derive(Clone, Copy, Debug)]
pub struct Measures {
    /// Mean of (A - B)^2, in the square of the pictures' unit.
    pub mse: f64,
    /// Mean of (A - B)^2 / (B^2 + e), e the square of 1 % of B's mean, and the same without the
    /// largest 0.1 % of the terms.
    pub relative: RelativeMse,
    /// Mean of |A - B| / (|A| + |B|); pixels that are black in both count as zero.
    pub smape: f64,
    /// Without what noise of both adds; `None` where it is not known.
    pub corrected: Option<Corrected>,
}

/// Mean squared differences without noise.
#[derive(Clone, Copy, Debug)]
pub struct Corrected {
    /// Mean of (A - B)^2 less both variances.
    pub mse: f64,
    /// The same, relative as in [`Measures::relative`].
    pub relative_mse: f64,
    /// 95 % intervals of both; `None` where pixels depend on one another.
    pub intervals: Option<[[f64; 2]; 2]>,
}

impl Measures {
    /// Of the pixels that `counted` names, at least one.
    pub fn of(a: &Estimate, b: &Estimate, counted: &[bool]) -> Self {
        let kept = |values: &[f64]| -> Vec<f64> {
            values.iter().zip(counted).filter(|(_, counted)| **counted).map(|(value, _)| *value).collect()
        };
        let [image, reference] = [a, b].map(|picture| kept(&picture.mean));
        let pairs = || image.iter().zip(&reference);
        let apart = |(i, r): (&f64, &f64)| if i == r { 0.0 } else { (i - r).abs() / (i.abs() + r.abs()) };
        let count = image.len() as f64;
        let level = reference.iter().sum::<f64>() / count;
        let corrected = a.noise.as_ref().zip(b.noise.as_ref()).map(|(na, nb)| {
            let errors = [na, nb].map(|noise| kept(&noise.standard_error));
            let excess: Vec<f64> = (0..image.len())
                .map(|p| (image[p] - reference[p]).powi(2) - errors[0][p].powi(2) - errors[1][p].powi(2))
                .collect();
            let relative: Vec<f64> = excess
                .iter()
                .zip(&reference)
                .map(|(excess, r)| excess / (r * r + (FLOOR_SHARE * level).powi(2)))
                .collect();
            let intervals =
                (na.independent && nb.independent).then(|| [interval(&excess), interval(&relative)]);
            Corrected { mse: mean(&excess), relative_mse: mean(&relative), intervals }
        });
        Self {
            mse: pairs().map(|(i, r)| (i - r).powi(2)).sum::<f64>() / count,
            relative: relative_mse(&image, &reference, FLOOR_SHARE),
            smape: pairs().map(apart).sum::<f64>() / count,
            corrected,
        }
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Standard error of the mean of independent values.
fn standard_error(values: &[f64]) -> f64 {
    let (mean, count) = (mean(values), values.len() as f64);
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0) / count).sqrt()
}

fn interval(values: &[f64]) -> [f64; 2] {
    let half_width = NORMAL_975 * standard_error(values);
    [mean(values) - half_width, mean(values) + half_width]
}

/// All pixels together: whether they differ by more than their noise.
///
/// (A - B)^2 less both variances has the expectation zero where the pictures are the same, however
/// skewed the noise; it is divided by the variances of the pixels around, which are independent of
/// it. Its mean over independent pixels is held against its own scatter.
#[derive(Clone, Copy, Debug)]
pub struct Excess {
    /// Mean square of the difference in standard errors; one is expected. The reduced chi-squared.
    pub reduced_chi_squared: f64,
    /// By how many of its standard errors it is above one.
    pub z: f64,
    /// Probability of that, or more, by chance.
    pub p_value: f64,
    /// Pixels in it.
    pub pixels: usize,
    /// Level at which it fails.
    pub alpha: f64,
}

impl Excess {
    /// `None` of pixels that depend on one another, and of too few.
    pub fn of(
        [a, b]: [&Estimate; 2],
        [na, nb]: [&Noise; 2],
        grid: &Grid,
        lit: &[bool],
        alpha: f64,
    ) -> Option<Self> {
        if !(na.independent && nb.independent) {
            return None;
        }
        let squares = |noise: &Noise| -> Vec<f64> { noise.standard_error.iter().map(|e| e * e).collect() };
        let [va, vb] = [na, nb].map(squares);
        let term = |pixel: usize| {
            let near: Vec<usize> = around(grid.cells, pixel, NEIGHBOURHOOD)
                .filter(|&other| other != pixel && grid.complete[other] && lit[other])
                .collect();
            if near.len() < FEWEST_FOR_CORRECTION {
                return None;
            }
            let expected = Surroundings::of(&a.mean, &va, na.blocks - 1.0, &near).steady
                + Surroundings::of(&b.mean, &vb, nb.blocks - 1.0, &near).steady;
            let excess = (a.mean[pixel] - b.mean[pixel]).powi(2) - va[pixel] - vb[pixel];
            (expected > 0.0).then(|| excess / expected)
        };
        let terms: Vec<f64> =
            (0..lit.len()).filter(|&pixel| grid.complete[pixel] && lit[pixel]).filter_map(term).collect();
        let error = standard_error(&terms);
        if terms.len() < FEWEST_TOGETHER || error == 0.0 {
            return None;
        }
        let z = mean(&terms) / error;
        Some(Self {
            reduced_chi_squared: 1.0 + mean(&terms),
            z,
            p_value: Normal::standard().sf(z),
            pixels: terms.len(),
            alpha,
        })
    }

    /// Whether the pixels differ by more than noise.
    pub fn fails(&self) -> bool {
        self.p_value <= self.alpha
    }
}

impl fmt::Display for Excess {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { reduced_chi_squared, z, p_value, pixels, .. } = self;
        write!(f, "chi-squared of {pixels} pixels {reduced_chi_squared:.4} (z {z:+.1}, p {p_value:.1e})")
    }
}
