//! What a picture knows of its own error: relMSE, how sure it is, and whether to believe it.
//!
//! relMSE is the mean over pixels of (L - truth)^2 / (truth^2 + e), L the luminance and e the
//! square of 1 % of its mean. Its expectation is the mean of variance / (truth^2 + e), which is
//! estimated with the unbiased variance of each pixel and with L in place of the truth.
//!
//! That bends it: bright samples raise the variance and L together, which makes the estimate too
//! small, and 1 / L^2 is convex, which makes it too large. Both are of the order of relMSE itself,
//! and so a few per cent of the estimate below an error of 10 %; above, it may be off by a fifth.
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
/// Batches from which the share of one of them says something. Where one cause moves all pixels, a
/// term is the square of one normal number, and the largest is more than half of all with a chance
/// of 73 % of 4 batches, of 24 % of 8 and of 2 % of 16.
const ENOUGH_BATCHES: usize = 16;
/// Blocks from which one that weighs more than all others together says something.
const ENOUGH_BLOCKS: usize = 4;
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
    /// fewer than three blocks, or batches of them that weigh about alike.
    pub relmse_ci95: Option<[f64; 2]>,
    /// The estimate without the 0.1 % of the pixels that add most to it, one at least.
    pub relmse_trimmed: f64,
    /// Independent blocks that it is from: one more than the degrees of freedom of a variance.
    pub blocks: u32,
    /// Whether pixels share random numbers: one path lights several, or chains were mutated.
    pub correlated: bool,
    /// Whether 0.1 % of the pixels, or one of 16 batches or more, carry more than half of it, or one
    /// block of chains weighs more than half of four or more, or so much that fewer than three
    /// batches alike are left of them: then rare samples decide, those that
    /// were not met are missing, and neither the estimate nor its interval is to be trusted.
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
    let terms: Vec<f64> =
        known.standard_errors.iter().zip(&weights).map(|(error, weight)| error * error * weight).collect();
    let spread = Spread::of(known, &weights);
    let plain = Terms::of(terms);
    let relmse = plain.mean();
    if !relmse.is_finite() {
        return None;
    }
    Some(PictureError {
        relmse,
        relmse_ci95: spread.ratio_interval().map(|ratio| ratio.map(|bound| bound * relmse)),
        relmse_trimmed: plain.trimmed_mean(),
        blocks: known.blocks,
        correlated: known.correlated,
        heavy_tail: plain.share_of_largest().max(spread.largest_share) > HEAVY_SHARE,
    })
}

/// What pixels add to a sum, the largest first.
struct Terms(Vec<f64>);

impl Terms {
    fn of(mut terms: Vec<f64>) -> Self {
        terms.sort_unstable_by(|a, b| b.total_cmp(a));
        Self(terms)
    }

    /// How many are trimmed off.
    fn cut(&self) -> usize {
        ((TRIMMED_SHARE * self.0.len() as f64).ceil() as usize).clamp(1, self.0.len())
    }

    fn mean(&self) -> f64 {
        self.0.iter().sum::<f64>() / self.0.len() as f64
    }

    /// Mean of those that are not trimmed off; zero where none are left.
    fn trimmed_mean(&self) -> f64 {
        let rest = &self.0[self.cut()..];
        if rest.is_empty() { 0.0 } else { rest.iter().sum::<f64>() / rest.len() as f64 }
    }

    /// Share that the largest have in the sum of more than a few.
    fn share_of_largest(&self) -> f64 {
        let largest: f64 = self.0[..self.cut()].iter().sum();
        if self.0.len() > 2 * self.cut() { largest / self.0.iter().sum::<f64>() } else { 0.0 }
    }
}

/// What the squared error of each pixel is multiplied with; `None` of a black picture.
pub(super) fn weights(luminance: &[f64]) -> Option<Vec<f64>> {
    let mean = luminance.iter().sum::<f64>() / luminance.len() as f64;
    let floor = (FLOOR_SHARE * mean).powi(2);
    (floor > 0.0).then(|| luminance.iter().map(|value| 1.0 / (value * value + floor)).collect())
}

/// Share of the largest of many terms; zero of few.
fn largest_share(terms: &[f64]) -> f64 {
    let (largest, sum) = terms.iter().fold((0.0_f64, 0.0), |(most, sum), term| (most.max(*term), sum + term));
    if terms.len() >= ENOUGH_BATCHES && sum > 0.0 { largest / sum } else { 0.0 }
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
    /// Largest share that one batch or block has in its cause of error, or in its weight.
    largest_share: f64,
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
        let of = |residuals: &[Vec<f64>]| -> Vec<f64> { residuals.iter().map(term).collect() };
        let terms = of(&scatter.residuals);
        let sum: f64 = terms.iter().sum();
        if scatter.is_known {
            self.value += sum;
            self.variance_of_errors += 2.0 * sum * sum;
            return;
        }
        let unbalanced = of(&scatter.unbalanced);
        if sum + unbalanced.iter().sum::<f64>() <= 0.0 {
            return; // a cause that is not there
        }
        let weight = if scatter.blocks >= ENOUGH_BLOCKS { scatter.largest_weight } else { 0.0 };
        let shares = [largest_share(&terms), largest_share(&unbalanced), weight];
        self.largest_share = shares.into_iter().fold(self.largest_share, f64::max);
        if terms.len() < FEWEST_BATCHES {
            self.is_unknown = true;
            // Then one of many blocks has a third of the weight or more.
            if scatter.blocks >= ENOUGH_BLOCKS {
                self.largest_share = 1.0;
            }
            return;
        }
        let batches = terms.len() as f64;
        self.value += sum * batches / (batches - 1.0);
        let mean = sum / batches;
        let scattered = terms.iter().map(|term| (term - mean).powi(2)).sum::<f64>() / (batches - 1.0);
        let variance = batches.powi(3) / ((batches - 1.0) * (batches - 2.0)) * scattered / more;
        self.variance += variance;
        self.variance_of_errors += (batches - 1.0) * variance;
        self.variance_squares += variance * variance / (batches - 1.0);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Film;
    use crate::camera::witnesses::Batches;
    use crate::sampler::mix;
    use statrs::distribution::{Binomial, DiscreteCDF};
    use std::f64::consts::TAU;

    const SIDE: u32 = 16;
    const PIXELS: usize = (SIDE * SIDE) as usize;
    const BLOCKS: u64 = 16;
    const FILMS: u64 = 1000;

    fn normal(names: [u64; 3]) -> f64 {
        let key = names.iter().fold(0, |key, name| mix(key ^ *name));
        let [a, b] = [key, !key].map(|key| ((mix(key) >> 11) as f64 + 0.5) / (1_u64 << 53) as f64);
        (-2.0 * a.ln()).sqrt() * (TAU * b).cos()
    }

    fn truth(pixel: usize) -> f64 {
        1.0 + (pixel % 7) as f64
    }

    /// A film of normal noise of 3 % of each pixel: of its own, and as much again that rows share.
    fn film(number: u64, shared: f64) -> Film {
        let mut film = Film::new([SIDE, SIDE], 1, shared > 0.0);
        for block in 0..BLOCKS {
            for row in 0..SIDE as usize {
                let of_row = shared * normal([number, block, (PIXELS + row) as u64]);
                let value = |column: usize| {
                    let pixel = row * SIDE as usize + column;
                    let noise = normal([number, block, pixel as u64]) + of_row;
                    truth(pixel) * (1.0 + 0.03 * (BLOCKS as f64).sqrt() * noise)
                };
                film.add_row(row, &(0..SIDE as usize).map(value).collect::<Vec<_>>(), 1);
            }
            film.finish_block(1);
        }
        film
    }

    /// Of 1000 films, as many hold their own relMSE in the interval as 95 % are to, at 1 in 1000
    /// for a false alarm on either side; whether pixels share noise or not.
    #[test]
    fn the_interval_holds_the_error_of_the_film() {
        let floor = (0.01 * (0..PIXELS).map(truth).sum::<f64>() / PIXELS as f64).powi(2);
        for shared in [0.0, 1.0, 4.0] {
            let held = (0..FILMS).filter(|number| {
                let film = film(*number, shared);
                let term = |pixel: usize| {
                    (film.mean(pixel, 0) - truth(pixel)).powi(2) / (truth(pixel).powi(2) + floor)
                };
                let relmse = (0..PIXELS).map(term).sum::<f64>() / PIXELS as f64;
                let error = film.error().expect("blocks");
                assert!(!error.heavy_tail);
                let [low, high] = error.relmse_ci95.expect("blocks");
                (low..=high).contains(&relmse)
            });
            let held = held.count() as u64;
            // Satterthwaite's law and Student's quantile are approximations: 2 % to either side.
            let quantile = |share: f64, p: f64| Binomial::new(share, FILMS).expect("a law").inverse_cdf(p);
            let allowed = quantile(0.93, 1e-3)..=quantile(0.97, 1.0 - 1e-3);
            assert!(allowed.contains(&held), "{held} of {FILMS} at {shared}, allowed {allowed:?}");
        }
    }

    /// One bright sample in all carries the error: it is told, and the rest apart.
    #[test]
    fn a_firefly_is_a_heavy_tail() {
        let mut one = film(0, 0.0);
        let calm = one.error().expect("blocks");
        assert!(!calm.heavy_tail && calm.relmse_trimmed < calm.relmse);
        let mut sums: Vec<f64> = (0..SIDE as usize).map(truth).collect();
        sums[3] += 1e3;
        one.add_row(0, &sums, 1);
        (1..SIDE as usize).for_each(|row| {
            let first = row * SIDE as usize;
            one.add_row(row, &(first..first + SIDE as usize).map(truth).collect::<Vec<_>>(), 1);
        });
        one.finish_block(1);
        let error = one.error().expect("blocks");
        assert!(error.heavy_tail && error.relmse > 2.0 * error.relmse_trimmed, "{error:?}");
        assert!(error.relmse_trimmed < 2.0 * calm.relmse, "{error:?}");
    }

    /// Sixteen blocks, of which the first weighs so much.
    fn of_blocks(weight: f64) -> PictureError {
        let mut batches = Batches::new(PIXELS);
        for block in 0..BLOCKS {
            let weight = if block == 0 { weight } else { 1.0 };
            let noise = |pixel: usize| 1.0 + 0.1 * normal([1, block, pixel as u64]);
            batches.add(0..PIXELS, |pixel| weight * truth(pixel) * noise(pixel));
            batches.finish_block(weight);
        }
        let luminance: Vec<f64> = (0..PIXELS).map(truth).collect();
        let standard_errors: Vec<f64> = luminance.iter().map(|value| 0.03 * value).collect();
        let scatters: Vec<_> = batches.scatter(1.0).into_iter().collect();
        let known = Known {
            luminance: &luminance,
            standard_errors: &standard_errors,
            scatters: &scatters,
            blocks: BLOCKS as u32,
            correlated: true,
        };
        estimate(&known).expect("light")
    }

    /// Beside one that weighs 15.5, 50 or 1000, fifteen blocks of weight one make two batches or one:
    /// the tail is heavy, and there is no interval. One that weighs 3 has a third of the error.
    #[test]
    fn a_block_that_weighs_more_than_all_others_is_a_heavy_tail() {
        let even = of_blocks(1.0);
        assert!(!even.heavy_tail && even.relmse_ci95.is_some(), "{even:?}");
        for (weight, has_interval) in [(15.5, false), (50.0, false), (1e3, false), (3.0, true)] {
            let error = of_blocks(weight);
            assert_eq!(error.heavy_tail, !has_interval, "{weight}: {error:?}");
            assert_eq!(error.relmse_ci95.is_some(), has_interval, "{weight}: {error:?}");
        }
    }

    /// Of four batches with one cause the largest is more than half of all more often than not.
    #[test]
    fn few_batches_say_nothing_of_the_tail() {
        let heavy = |number: u64| {
            let mut film = Film::new([SIDE, SIDE], 1, true);
            for block in 0..4 {
                let level = 1.0 + 0.1 * normal([2, number, block]);
                for row in 0..SIDE as usize {
                    let of_pixel = |column: usize| level * truth(row * SIDE as usize + column);
                    film.add_row(row, &(0..SIDE as usize).map(of_pixel).collect::<Vec<_>>(), 1);
                }
                film.finish_block(1);
            }
            film.error().expect("blocks").heavy_tail
        };
        assert!(!(0..20).any(heavy));
    }

    #[test]
    fn what_is_not_known_is_not_told() {
        let mut film = Film::new([2, 1], 1, false);
        film.add_row(0, &[1.0, 2.0], 1);
        film.finish_block(1);
        assert_eq!(film.error(), None, "a single block");
        film.add_row(0, &[2.0, 2.0], 1);
        film.finish_block(1);
        assert_eq!(film.error().expect("two blocks").relmse_ci95, None);
        let mut dark = Film::new([2, 1], 1, false);
        (0..4).for_each(|_| dark.finish_block(1));
        assert_eq!(dark.error(), None, "no light");
    }
}
