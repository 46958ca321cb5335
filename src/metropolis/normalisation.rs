//! The level of the picture: the mean of what fresh paths estimate, and how sure it is.

use serde::{Deserialize, Serialize};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// What independent fresh paths have estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimates {
    /// Fresh paths, void ones included.
    pub paths: u64,
    /// Those that found something.
    pub found: u64,
    sum: f64,
    squares: f64,
    largest: f64,
}

/// Probability with which the interval is to hold the truth.
const CONFIDENCE: f64 = 0.95;

impl Estimates {
    /// Adds a fresh path; `None` for one that carries nothing.
    pub fn add(&mut self, estimate: Option<f64>) {
        self.paths += 1;
        if let Some(estimate) = estimate {
            self.found += 1;
            self.sum += estimate;
            self.squares += estimate * estimate;
            self.largest = self.largest.max(estimate);
        }
    }

    /// Adds what another chain has found.
    pub fn merge(&mut self, other: &Self) {
        self.paths += other.paths;
        self.found += other.found;
        self.sum += other.sum;
        self.squares += other.squares;
        self.largest = self.largest.max(other.largest);
    }

    /// The normalisation b: mean over all fresh paths of target over density.
    pub fn mean(&self) -> f64 {
        self.sum / self.paths as f64
    }

    /// Standard error of the mean.
    pub fn standard_error(&self) -> f64 {
        let n = self.paths as f64;
        let variance = (self.squares - self.sum * self.sum / n).max(0.0) / (n - 1.0);
        (variance / n).sqrt()
    }

    /// Interval that holds the true mean with 95 %.
    ///
    /// Few of the paths find anything, so the sum is one of weighted Poisson counts, for which
    /// Fay and Feuer 1997 ("Confidence intervals for directly standardized rates", Statistics in
    /// Medicine 16) give gamma quantiles; with one weight it is the exact interval of a Poisson
    /// mean, with many finds the normal one.
    pub fn interval(&self) -> [f64; 2] {
        let n = self.paths as f64;
        let quantile = |sum: f64, squares: f64, p: f64| {
            let scale = squares / sum;
            let degrees = 2.0 * sum / scale;
            ChiSquared::new(degrees).map_or(sum, |law| 0.5 * scale * law.inverse_cdf(p)) / n
        };
        if self.sum <= 0.0 {
            return [0.0, f64::INFINITY];
        }
        let outside = 0.5 * (1.0 - CONFIDENCE);
        let low = quantile(self.sum, self.squares, outside);
        let largest = self.largest;
        let high = quantile(self.sum + largest, self.squares + largest * largest, 1.0 - outside);
        [low, high]
    }
}
