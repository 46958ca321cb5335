//! Noise: whole electrons that arrive at random, and amplifiers that add a little.
//!
//! The numbers of a pixel depend on seed, pixel and channel alone, so that noise is the same
//! on any number of threads and in any order. Drawing is done here because the library that
//! gives the distributions draws through generators that are used up in order.

use crate::sampler::mix;
use statrs::distribution::{ContinuousCDF as _, Normal};
use statrs::function::gamma::ln_gamma;

/// Uniform numbers that belong to one value of one pixel.
#[derive(Clone, Debug)]
pub struct Numbers {
    key: u64,
    drawn: u64,
}

impl Numbers {
    /// The numbers of a channel in a pixel, under a seed.
    pub const fn new(seed: u64, pixel: u64, channel: u64) -> Self {
        Self { key: mix(mix(mix(seed) ^ pixel) ^ channel), drawn: 0 }
    }

    /// The next number, between 0 and 1 and never either.
    fn uniform(&mut self) -> f64 {
        let bits = mix(self.key ^ self.drawn) >> 11;
        self.drawn += 1;
        (bits as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// A number of mean 0 and standard deviation 1, normally distributed.
    pub fn normal(&mut self) -> f64 {
        Normal::standard().inverse_cdf(self.uniform())
    }

    /// A count of independent events of which `mean` are expected; 0 for a mean not above 0.
    pub fn poisson(&mut self, mean: f64) -> f64 {
        /// From here on counts are drawn by rejection, which below is slower or undefined.
        const MANY: f64 = 10.0;
        /// Beyond, the distribution is normal but for a skewness of 1e-4, and the logarithms
        /// that rejection compares have no digits left.
        const COUNTLESS: f64 = 1e8;
        if mean > COUNTLESS {
            (mean + mean.sqrt() * self.normal()).round()
        } else if mean >= MANY {
            self.poisson_by_rejection(mean)
        } else {
            self.poisson_by_inversion(mean)
        }
    }

    fn poisson_by_inversion(&mut self, mean: f64) -> f64 {
        let u = self.uniform();
        let (mut count, mut term) = (0.0, (-mean).exp());
        let mut sum = term;
        while u > sum && term > 0.0 {
            count += 1.0;
            term *= mean / count;
            sum += term;
        }
        count
    }

    /// Transformed rejection, algorithm PTRS of W. Hoermann, "The transformed rejection method
    /// for generating Poisson random variables", Insurance: Mathematics and Economics 12
    /// (1993) 39-45.
    fn poisson_by_rejection(&mut self, mean: f64) -> f64 {
        let b = 0.931 + 2.53 * mean.sqrt();
        let a = -0.059 + 0.024_83 * b;
        let inverse_alpha = 1.1239 + 1.1328 / (b - 3.4);
        let squeeze = 0.9277 - 3.6224 / (b - 2.0);
        loop {
            let (u, v) = (self.uniform() - 0.5, self.uniform());
            let us = 0.5 - u.abs();
            let count = ((2.0 * a / us + b) * u + mean + 0.43).floor();
            if us >= 0.07 && v <= squeeze {
                return count;
            }
            if count < 0.0 || (us < 0.013 && v > us) {
                continue;
            }
            let left = (v * inverse_alpha / (a / (us * us) + b)).ln();
            if left <= count * mean.ln() - mean - ln_gamma(count + 1.0) {
                return count;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution::{ChiSquared, Discrete as _, DiscreteCDF as _, Poisson};

    const DRAWS: u64 = 40_000;

    /// Counts in cells of at least 20 expected draws follow the distribution: chi-squared,
    /// false alarm once in 1e5 for each of six means.
    #[test]
    fn counts_follow_the_poisson_distribution() {
        for (case, mean) in [0.3, 4.0, 9.9, 10.1, 47.0, 80_085.0].into_iter().enumerate() {
            let truth = Poisson::new(mean).expect("a mean");
            // Cells of equal width around the mean, two tails.
            let width = (0.25 * mean.sqrt()).ceil();
            let first = (mean - 3.0 * mean.sqrt()).max(0.0).floor();
            let cells = (6.0 * mean.sqrt() / width).ceil().max(3.0) as usize;
            let edge = |cell: usize| first + width * cell as f64;
            let mut counted = vec![0.0; cells + 2];
            for pixel in 0..DRAWS {
                let count = Numbers::new(5, pixel, case as u64).poisson(mean);
                let cell = ((count - first) / width).floor() + 1.0;
                counted[(cell.max(0.0) as usize).min(cells + 1)] += 1.0;
            }
            let below = |x: f64| if x <= 0.0 { 0.0 } else { truth.cdf(x as u64 - 1) };
            let (mut chi2, mut used) = (0.0, 0);
            for (cell, counted) in counted.iter().enumerate() {
                let from = if cell == 0 { 0.0 } else { below(edge(cell - 1)) };
                let to = if cell == cells + 1 { 1.0 } else { below(edge(cell)) };
                let expected = (to - from) * DRAWS as f64;
                if expected >= 20.0 {
                    chi2 += (counted - expected).powi(2) / expected;
                    used += 1;
                }
            }
            let limit = ChiSquared::new(f64::from(used - 1)).expect("cells").inverse_cdf(1.0 - 1e-5);
            assert!(used > 1 && chi2 < limit, "mean {mean}: chi2 {chi2} over {used} cells");
            assert!(truth.pmf(mean as u64) > 0.0);
        }
    }

    /// Variance over mean of counts is 1 within 5 standard errors, sqrt(2 / draws): false
    /// alarm once in 1.7 million for each mean.
    #[test]
    fn the_variance_of_shot_noise_is_its_mean() {
        for mean in [2.0, 30.0, 5000.0, 3e9] {
            let counts: Vec<f64> = (0..DRAWS).map(|p| Numbers::new(1, p, 0).poisson(mean)).collect();
            let average = counts.iter().sum::<f64>() / DRAWS as f64;
            let variance = counts.iter().map(|c| (c - average).powi(2)).sum::<f64>() / (DRAWS - 1) as f64;
            let error = (mean / DRAWS as f64).sqrt();
            assert!((average - mean).abs() < 5.0 * error, "{average} for {mean}");
            // Kurtosis of few counts widens it: var(s^2) = (2 + 1 / mean) mean^2 / n.
            let spread = ((2.0 + 1.0 / mean) / DRAWS as f64).sqrt();
            assert!((variance / mean - 1.0).abs() < 5.0 * spread, "{variance} for {mean}");
        }
    }

    #[test]
    fn nothing_expected_is_nothing_counted() {
        assert_eq!(Numbers::new(1, 2, 3).poisson(0.0), 0.0);
        assert_eq!(Numbers::new(1, 2, 3).poisson(-4.0), 0.0);
    }
}
