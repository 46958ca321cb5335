//! Whether the ratio of two means is one, within a margin.

use super::welch::{Moments, two_sided_quantile};
use std::fmt;

/// Relative difference of whole pictures that is small enough to count as none.
pub const MARGIN: f64 = 0.002;

/// Chance that the interval misses the truth.
const OUTSIDE: f64 = 0.05;

/// Half widths of the interval that fit into the margin where equal pictures pass nine times of
/// ten: their ratio is off by less than 1.645 standard errors then, a half width is 1.960.
const PASSING_HALF_WIDTHS: f64 = 1.0 + 1.645 / 1.960;

/// The ratio of two means, its 95 % confidence interval, and the margin around one that the
/// interval is held against.
///
/// An interval within the margin is the pass of two one-sided tests, each at 2.5 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatioInterval {
    /// Ratio of the means; one where both are zero.
    pub ratio: f64,
    /// Lower and upper end of its 95 % confidence interval.
    pub interval: [f64; 2],
    /// Largest relative difference that counts as none.
    pub margin: f64,
}

impl RatioInterval {
    /// The ratio of the first mean to the second; its logarithm is taken to be near normal.
    pub fn of(a: &Moments, b: &Moments, margin: f64) -> Self {
        let ratio = if a.mean == b.mean { 1.0 } else { a.mean / b.mean };
        if a.mean == 0.0 || b.mean == 0.0 {
            return Self { ratio, interval: [ratio; 2], margin };
        }
        let relative = |m: &Moments| m.variance / (m.mean * m.mean);
        let variance = relative(a) + relative(b);
        if variance == 0.0 {
            return Self { ratio, interval: [ratio; 2], margin };
        }
        let share = |m: &Moments| (relative(m) / variance).powi(2) / (m.count - 1.0);
        let half_width = two_sided_quantile(1.0 / (share(a) + share(b)), OUTSIDE) * variance.sqrt();
        Self { ratio, interval: [ratio * (-half_width).exp(), ratio * half_width.exp()], margin }
    }

    /// Whether the whole interval lies within the margin.
    pub fn is_one(&self) -> bool {
        self.interval.iter().all(|end| (end - 1.0).abs() <= self.margin)
    }

    /// How many times as many samples, at least twice, make equal pictures pass nine times of
    /// ten. It does not look at the ratio, which is noise while nothing differs.
    pub fn samples_factor(&self) -> f64 {
        let half_width = 0.5 * (self.interval[1] - self.interval[0]);
        (PASSING_HALF_WIDTHS * half_width / self.margin).powi(2).max(2.0)
    }
}

impl fmt::Display for RatioInterval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |ratio: f64| 100.0 * (ratio - 1.0);
        let [low, high] = self.interval.map(percent);
        let (off, margin) = (percent(self.ratio), 100.0 * self.margin);
        write!(f, "whole picture off by {off:+.3} % [{low:+.3}, {high:+.3}], margin {margin:.3} %")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moments(mean: f64, standard_error: f64) -> Moments {
        Moments { mean, variance: standard_error.powi(2), third: 0.0, count: 32.0, zeros: 0 }
    }

    /// 0.03 % of error on one side and 0.04 % on the other: 0.05 % together, and a half width
    /// of 2.0 times that.
    #[test]
    fn the_interval_joins_both_errors() {
        let ratio = RatioInterval::of(&moments(10.0, 0.003), &moments(10.0, 0.004), MARGIN);
        let half_width = 0.5 * (ratio.interval[1] - ratio.interval[0]);
        assert!((half_width - 0.001).abs() < 2e-5, "{half_width}");
        assert!(ratio.is_one());
    }

    /// A half width of 2.0 * sqrt(2) * 0.3 % = 0.85 % is to become 0.2 % / 1.84.
    #[test]
    fn a_wide_interval_asks_for_more_samples() {
        let ratio = RatioInterval::of(&moments(10.0, 0.03), &moments(10.0, 0.03), MARGIN);
        assert!(!ratio.is_one());
        let factor = ratio.samples_factor();
        assert!((factor - 61.0).abs() < 1.0, "{factor}");
        let more = moments(10.0, 0.03 / factor.sqrt());
        assert!(RatioInterval::of(&more, &more, MARGIN).is_one());
    }

    #[test]
    fn two_black_pictures_are_equal() {
        assert!(RatioInterval::of(&moments(0.0, 0.0), &moments(0.0, 0.0), MARGIN).is_one());
    }
}
