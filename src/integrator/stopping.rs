//! When a run ends, and why that does not bend the picture.
//!
//! A run that ends when its own samples look good enough is biased: where bright samples are
//! rare, the picture is dark and looks sure of itself until the first one comes, so that the
//! runs that end early are the dark ones. The same holds for the clock, as bright paths are
//! often long ones. So a run that ends at an error or a time has two halves, of independent
//! random numbers, and each decides for the other: how many blocks of the first half enter the
//! picture follows from the samples and the seconds of the second half alone, and the other way
//! round. Given that number N, the first half's samples are distributed as if N had been chosen
//! beforehand; their mean, and the variance that their scatter gives, are unbiased for every N,
//! and so on average over N. The picture is the mean of both halves with weights of one half
//! each: weights that follow from the two N would depend on what they weigh.
//!
//! An error that is asked for is not promised: a half that has met none of the rare bright samples
//! says too early that the other one may end. The error that the picture then states is that of
//! its own samples, and right on average.
//!
//! What is lost is what the half that decides later takes beyond the other one's verdict:
//! those samples decide and are not in the picture.

use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Samples per pixel that a half has at least before its error is looked at.
pub const FEWEST_SAMPLES: u64 = 64;
/// Paths after which a half that waits for an error gives up, if it has found no light at all.
const MOST_DARK_PATHS: u64 = 1 << 22;
/// Blocks that a half has at least: one cannot give an error.
const FEWEST_BLOCKS: u32 = 2;

/// When a render ends, and what its random numbers start from.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Samples per pixel: reached exactly, unless an error or a time is given as well; then it
    /// is the most that are taken, rounded up to an even number.
    pub samples_per_pixel: u64,
    /// Time after which no further block is begun.
    pub time: Option<Duration>,
    /// Relative error of the luminance picture after which no further block is begun, as
    /// [`crate::camera::Film::relative_error`] estimates it.
    pub error: Option<f64>,
    /// Names the run.
    pub seed: u64,
}

/// What ended a half.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Reason {
    /// It has all its samples.
    Samples,
    /// The other half has reached the error.
    Error,
    /// The other half has used its time.
    Time,
    /// The other half has found no light in some four million paths.
    Dark,
}

/// How far a half has come.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace {
    pub samples_per_pixel: u64,
    pub pixels: u64,
    pub blocks: u32,
    /// Seconds that its blocks took.
    pub seconds: f64,
}

impl Budget {
    /// Whether it is the samples or the clock that decide when the run ends.
    pub const fn is_open(&self) -> bool {
        self.time.is_some() || self.error.is_some()
    }

    /// Parts of the run that share no random numbers.
    pub(crate) const fn halves(&self) -> usize {
        if self.is_open() { 2 } else { 1 }
    }

    /// Samples per pixel that each of them takes at most.
    pub(crate) const fn most_of_half(&self) -> u64 {
        if self.is_open() { self.samples_per_pixel.div_ceil(2) } else { self.samples_per_pixel }
    }

    /// What the random numbers of a half start from; without halves, those of the run.
    pub const fn seed_of(&self, half: usize) -> u64 {
        use crate::sampler::mix;
        /// Tells the seeds of halves from those of whole runs.
        const HALVES: u64 = 0x6861_6c76_6573;
        if self.is_open() { mix(self.seed ^ mix(HALVES + half as u64)) } else { self.seed }
    }

    /// What a half says about the other one: that it may end, or nothing yet. `error` is the
    /// relative error of the half's own picture; that of the mean of two such halves is smaller
    /// by the root of two. `before_s` are the seconds that both have spent before their first
    /// block.
    pub(crate) fn verdict(
        &self,
        pace: Pace,
        before_s: f64,
        error: impl FnOnce() -> Option<f64>,
    ) -> Option<Reason> {
        if pace.samples_per_pixel >= self.most_of_half() {
            return Some(Reason::Samples);
        }
        if pace.blocks < FEWEST_BLOCKS {
            return None;
        }
        if let Some(time) = self.time
            && pace.seconds >= 0.5 * (time.as_secs_f64() - before_s)
        {
            return Some(Reason::Time);
        }
        let target = self.error.filter(|_| pace.samples_per_pixel >= FEWEST_SAMPLES)?;
        let Some(error) = error() else {
            let paths = pace.samples_per_pixel.saturating_mul(pace.pixels);
            let goes_on_else = self.time.is_none() && self.samples_per_pixel == u64::MAX;
            return (goes_on_else && paths >= MOST_DARK_PATHS).then_some(Reason::Dark);
        };
        let whole = error * std::f64::consts::FRAC_1_SQRT_2;
        (whole <= target).then_some(Reason::Error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPEN: Budget =
        Budget { samples_per_pixel: 1001, time: Some(Duration::from_secs(10)), error: Some(0.01), seed: 1 };

    fn verdict(budget: &Budget, samples_per_pixel: u64, seconds: f64, error: f64) -> Option<Reason> {
        let pace = Pace { samples_per_pixel, pixels: 1, blocks: samples_per_pixel.min(8) as u32, seconds };
        budget.verdict(pace, 1.0, || Some(error))
    }

    #[test]
    fn each_rule_ends_a_half_at_its_share() {
        assert_eq!(verdict(&OPEN, 500, 4.4, 0.0142), None);
        assert_eq!(verdict(&OPEN, 501, 0.0, 1.0), Some(Reason::Samples));
        assert_eq!(verdict(&OPEN, 2, 4.5, 1.0), Some(Reason::Time));
        assert_eq!(verdict(&OPEN, 1, 100.0, 0.0), None, "one block gives no error");
        assert_eq!(verdict(&OPEN, 64, 0.0, 0.0141), Some(Reason::Error));
        assert_eq!(verdict(&OPEN, 63, 0.0, 0.0), None, "too few to judge by");
        let told = Budget { time: None, error: None, ..OPEN };
        assert_eq!(verdict(&told, 1000, 1e9, 0.0), None);
        assert_eq!(verdict(&told, 1001, 0.0, 1.0), Some(Reason::Samples));
    }

    #[test]
    fn a_black_picture_has_no_error_that_could_be_reached() {
        let endless = Budget { samples_per_pixel: u64::MAX, time: None, ..OPEN };
        let dark = |budget: &Budget, pixels: u64| {
            let pace = Pace { samples_per_pixel: 64, pixels, blocks: 8, seconds: 0.0 };
            budget.verdict(pace, 0.0, || None)
        };
        assert_eq!(dark(&endless, MOST_DARK_PATHS / 64 - 1), None);
        assert_eq!(dark(&endless, MOST_DARK_PATHS / 64), Some(Reason::Dark));
        assert_eq!(dark(&OPEN, MOST_DARK_PATHS), None, "its samples or its time end it");
    }

    #[test]
    fn halves_share_no_seed() {
        let told = Budget { time: None, error: None, ..OPEN };
        let seeds = [told.seed_of(0), OPEN.seed_of(0), OPEN.seed_of(1)];
        assert_eq!(seeds[0], 1);
        assert!(seeds[0] != seeds[1] && seeds[1] != seeds[2] && seeds[0] != seeds[2]);
    }
}
