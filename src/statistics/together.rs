//! What all pixels say together, however they depend on one another.

use super::cells::{Cell, Cells};
use super::welch::deviate;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::fmt;

/// Fewest judged pixels for tests of them together.
const FEWEST_TOGETHER: usize = 32;

/// What the p-values of all judged pixels say together.
#[derive(Clone, Copy, Debug)]
pub struct PValuesTest {
    /// Mean square of the normal deviates; one is expected.
    pub reduced_chi_squared: f64,
    /// Probability of a mean square as large.
    pub chi_squared_p: f64,
    /// By how much the share of p-values below some value exceeds that value, at most.
    pub distance: f64,
    /// Probability of a distance as large (Kolmogorov-Smirnov, one-sided).
    pub distance_p: f64,
    /// Independent pixels that the judged ones are worth.
    pub independent: f64,
    /// Level at which either fails.
    pub alpha: f64,
}

/// Tests of all judged pixels at once; pixels that do not scatter have no deviate.
pub fn together(pixels: &Cells, a: &[Vec<f64>], b: &[Vec<f64>], alpha: f64) -> Option<PValuesTest> {
    let scattering: Vec<usize> =
        pixels.judged().filter(|(_, cell)| cell.a.variance + cell.b.variance > 0.0).map(|(i, _)| i).collect();
    if pixels.skewed || scattering.len() < FEWEST_TOGETHER {
        return None;
    }
    let count = scattering.len() as f64;
    let mut p_values: Vec<f64> = scattering.iter().map(|&i| pixels.cells[i].p_value).collect();
    p_values.sort_by(f64::total_cmp);
    let reduced_chi_squared = p_values.iter().map(|p| deviate(*p).powi(2)).sum::<f64>() / count;
    let excess = |(i, p): (usize, &f64)| (i + 1) as f64 / count - p;
    let distance = p_values.iter().enumerate().map(excess).fold(0.0, f64::max);
    let independent = independent_pixels(pixels, &scattering, a, b);
    let chi_squared = ChiSquared::new(independent).expect("at least one pixel");
    Some(PValuesTest {
        reduced_chi_squared,
        chi_squared_p: chi_squared.sf(independent * reduced_chi_squared),
        distance,
        distance_p: (-2.0 * independent * distance * distance).exp(),
        independent,
        alpha,
    })
}

impl PValuesTest {
    /// Whether either test fails.
    pub fn fails(&self) -> bool {
        self.chi_squared_p.min(self.distance_p) <= self.alpha
    }
}

/// N^2 over the sum of all squared correlations between pixels: as many independent deviates
/// have a mean square, and a share below any value, that scatters as much.
///
/// The sum is the trace of the squared correlation matrix, which has the same value as that of
/// the far smaller matrix of products between batches; the part that mere noise adds to it is
/// taken out (Srivastava 2005, "Some tests concerning the covariance matrix in high
/// dimensional data", J. Japan Statist. Soc. 35(2), equation 1.13).
fn independent_pixels(pixels: &Cells, chosen: &[usize], a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let rows: Vec<Vec<f64>> = a
        .iter()
        .map(|batch| residuals(pixels, chosen, batch, a.len(), |cell| cell.a.mean))
        .chain(b.iter().map(|batch| residuals(pixels, chosen, batch, b.len(), |cell| cell.b.mean)))
        .collect();
    let product = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let noisy: f64 = rows.iter().flat_map(|x| rows.iter().map(move |y| product(x, y).powi(2))).sum();
    let count = chosen.len() as f64;
    let n = chosen.iter().map(|&i| pixels.cells[i].welch.freedom).sum::<f64>() / count;
    let squares = n * n / ((n - 1.0) * (n + 2.0)) * (noisy - count * count / n);
    (count * count / squares.max(count)).max(1.0)
}

/// A batch's deviations from the mean, scaled so that the products of all batches of both
/// pictures add up to the correlations of the difference of means.
fn residuals(
    pixels: &Cells,
    chosen: &[usize],
    batch: &[f64],
    batches: usize,
    mean: impl Fn(&Cell) -> f64,
) -> Vec<f64> {
    let count = batches as f64;
    let residual = |&i: &usize| {
        let cell = &pixels.cells[i];
        (batch[i] - mean(cell)) / (count * (count - 1.0) * (cell.a.variance + cell.b.variance)).sqrt()
    };
    chosen.iter().map(residual).collect()
}

impl fmt::Display for PValuesTest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "pixels together, worth {:.0}: chi-squared {:.3} (p {:.1e}), p-values off uniform by {:.3} (p {:.1e})",
            self.independent, self.reduced_chi_squared, self.chi_squared_p, self.distance, self.distance_p
        )
    }
}
