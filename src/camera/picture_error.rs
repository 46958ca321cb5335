//! What a picture knows of its own error: relMSE, how sure it is, and whether to believe it.
//!
//! relMSE is the mean over pixels of (L - truth)^2 / (truth^2 + e), L the luminance and e the
//! square of 1 % of its mean. Its expectation is the mean of variance / (truth^2 + e), which is
//! estimated with the unbiased variance of each pixel and with L in place of the truth.
//!
//! The interval is for the relMSE of this very picture, which scatters around its expectation,
//! and not for the expectation alone, which it holds the more surely. Both are sums of squares of
//! nearly normal numbers, D of the errors of the picture and V of the scatter of its batches. Of G
//! batches, batch b adds the term T_b to V, so that the terms' own scatter gives
//! var(V) = G^3 / ((G - 1) (G - 2)) s^2(T), whatever pixels share; and as sums of squares of
//! vectors of one covariance, var(D) = (G - 1) var(V). By Satterthwaite's approximation both are
//! multiples of chi-squared numbers of 2 mean^2 / variance degrees of freedom, and D / V follows
//! Fisher's law. That s^2(T) itself is known from G terms only widens both, as Student's law
//! widens the normal one.

use super::witnesses::{Scatter, Witnesses};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, FisherSnedecor, StudentsT};

/// Share of the mean luminance whose square keeps dark pixels from counting too much.
pub const FLOOR_SHARE: f64 = 0.01;
/// Share of the pixels that is trimmed off.
pub const TRIMMED_SHARE: f64 = 0.001;
/// Share of the error that so few pixels, or a single batch, carry at least where the tail is heavy.
const HEAVY_SHARE: f64 = 0.5;
/// Batches from which the share of one of them says something.
const ENOUGH_BATCHES: usize = 4;
/// Batches from which their terms have a variance.
const FEWEST_BATCHES: usize = 3;
/// Probability with which the interval is to hold the relMSE of the picture.
const CONFIDENCE: f64 = 0.95;
/// The normal law's quantile for it.
const NORMAL_QUANTILE: f64 = 1.959_963_985;

/// Estimated error of a luminance picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PictureError {
    /// Estimated relMSE.
    pub relmse: f64,
    /// Interval that holds the relMSE of this picture against the truth with 95 %; `None` from
    /// fewer than three batches.
    pub relmse_ci95: Option<[f64; 2]>,
    /// The estimate without the 0.1 % of the pixels that add most to it, one at least.
    pub relmse_trimmed: f64,
    /// Independent blocks that it is from: one more than the degrees of freedom of a variance.
    pub blocks: u32,
    /// Whether pixels share random numbers: one path lights several, or chains were mutated.
    pub correlated: bool,
    /// Whether 0.1 % of the pixels, or one of four batches or more, carry more than half of it: then
    /// rare samples decide, those that were not met are missing, and neither the estimate nor its
    /// interval is to be trusted.
    pub heavy_tail: bool,
}

/// What the error of a picture is computed from.
pub(super) struct Known<'a> {
    /// Luminance of each pixel.
    pub luminance: &'a [f64],
    /// Standard error of each.
    pub standard_errors: &'a [f64],
    /// Independent causes of error.
    pub scatters: &'a [Scatter],
    pub blocks: u32,
    pub correlated: bool,
}

/// Estimates the error; `None` where it cannot be known.
pub(super) fn estimate(known: &Known<'_>) -> Option<PictureError> {
    let weights = weights(known.luminance)?;
    let mut terms: Vec<f64> =
        known.standard_errors.iter().zip(&weights).map(|(error, weight)| error * error * weight).collect();
    let pixels = terms.len();
    let relmse = terms.iter().sum::<f64>() / pixels as f64;
    if !relmse.is_finite() {
        return None;
    }
    let cut = ((TRIMMED_SHARE * pixels as f64).ceil() as usize).max(1);
    terms.sort_unstable_by(|a, b| b.total_cmp(a));
    let (largest, rest) = terms.split_at(cut);
    let in_largest = largest.iter().sum::<f64>() / pixels as f64;
    let relmse_trimmed = if rest.is_empty() { 0.0 } else { rest.iter().sum::<f64>() / rest.len() as f64 };
    let spread = Spread::of(known, &weights);
    Some(PictureError {
        relmse,
        relmse_ci95: spread.ratio_interval().map(|ratio| ratio.map(|bound| bound * relmse)),
        relmse_trimmed,
        blocks: known.blocks,
        correlated: known.correlated,
        heavy_tail: in_largest > HEAVY_SHARE * relmse || spread.largest_batch > HEAVY_SHARE,
    })
}

/// What the squared error of each pixel is multiplied with; `None` of a black picture.
pub(super) fn weights(luminance: &[f64]) -> Option<Vec<f64>> {
    let mean = luminance.iter().sum::<f64>() / luminance.len() as f64;
    let floor = (FLOOR_SHARE * mean).powi(2);
    (floor > 0.0).then(|| luminance.iter().map(|value| 1.0 / (value * value + floor)).collect())
}

/// How far sums of squares scatter, all causes together, in units of the sum over witnesses.
#[derive(Debug, Default)]
struct Spread {
    /// Estimated sum.
    value: f64,
    /// Variance of the estimate.
    variance: f64,
    /// Variance of the sum over the errors of the picture itself.
    variance_of_errors: f64,
    /// Sum over causes of variance^2 / degrees of freedom.
    variance_squares: f64,
    /// Largest share that one batch has in its cause of error.
    largest_batch: f64,
    /// Whether a cause has too few batches.
    is_unknown: bool,
}

impl Spread {
    fn of(known: &Known<'_>, weights: &[f64]) -> Self {
        let witnesses = Witnesses::of(weights.len());
        let at: Vec<f64> = (0..witnesses.len()).map(|witness| weights[witnesses.pixel(witness)]).collect();
        // Pixels that share nothing are as many times surer as there are more of them.
        let more = if known.correlated { 1.0 } else { witnesses.stride() as f64 };
        let mut spread = Self::default();
        for scatter in known.scatters {
            spread.add(scatter, &at, more);
        }
        spread.is_unknown |= known.scatters.is_empty();
        spread
    }

    fn add(&mut self, scatter: &Scatter, weights: &[f64], more: f64) {
        let term = |residuals: &Vec<f64>| -> f64 {
            residuals.iter().zip(weights).map(|(residual, weight)| residual * residual * weight).sum()
        };
        let terms: Vec<f64> = scatter.residuals.iter().map(term).collect();
        let sum: f64 = terms.iter().sum();
        if scatter.is_known {
            self.value += sum;
            self.variance_of_errors += 2.0 * sum * sum;
            return;
        }
        let batches = terms.len() as f64;
        self.value += sum * batches / (batches - 1.0);
        if sum <= 0.0 {
            return; // a cause that is not there
        }
        if terms.len() < FEWEST_BATCHES {
            self.is_unknown = true;
            return;
        }
        let mean = sum / batches;
        let scattered = terms.iter().map(|term| (term - mean).powi(2)).sum::<f64>() / (batches - 1.0);
        let variance = batches.powi(3) / ((batches - 1.0) * (batches - 2.0)) * scattered / more;
        self.variance += variance;
        self.variance_of_errors += (batches - 1.0) * variance;
        self.variance_squares += variance * variance / (batches - 1.0);
        if terms.len() >= ENOUGH_BATCHES {
            self.largest_batch = self.largest_batch.max(terms.iter().copied().fold(0.0, f64::max) / sum);
        }
    }

    /// Interval of the relMSE of the picture over its estimate.
    fn ratio_interval(&self) -> Option<[f64; 2]> {
        /// Degrees of freedom that are as good as infinite.
        const MANY: f64 = 1e6;
        if self.is_unknown || self.value <= 0.0 {
            return None;
        }
        let wider = if self.variance > 0.0 {
            let freedom = self.variance * self.variance / self.variance_squares;
            StudentsT::new(0.0, 1.0, freedom).ok()?.inverse_cdf(0.5 + 0.5 * CONFIDENCE) / NORMAL_QUANTILE
        } else {
            1.0
        };
        let freedom = |variance: f64| {
            let relative = wider * wider * variance / (self.value * self.value);
            if relative > 2.0 / MANY { 2.0 / relative } else { MANY }
        };
        let law = FisherSnedecor::new(freedom(self.variance_of_errors), freedom(self.variance)).ok()?;
        Some([0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE].map(|p| law.inverse_cdf(p)))
    }
}
