//! What became of walks: what they still carried where they were counted as trapped or cut off.
//!
//! A walk ends when nothing is left of it, it leaves the scene, or roulette ends it; none of
//! that loses light on average. A limit on bounces does, and by how much is seen only where the
//! walk is cut: it is counted there.

use serde::{Deserialize, Serialize};

/// What became of the walks from one end. What a walk carries is relative to what it set out
/// with, and counted with the inverse of the probability with which roulette has let it live, so
/// that sums over walks have the right mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Fates {
    /// Walks.
    pub walks: u64,
    /// Those that have lost nothing in [`super::TRAPPED_BOUNCES`] bounces.
    pub trapped: u64,
    /// What these carried then.
    pub trapped_carried: f64,
    /// Walks that roulette ended though they had lost nothing but what rounding takes.
    pub ended_by_rounding: u64,
    /// Walks that were ended by the limit on bounces, and what they carried then.
    pub cut: u64,
    /// See `cut`.
    pub cut_carried: f64,
    /// Sum of the squares of that.
    pub cut_carried_squared: f64,
}

impl Fates {
    /// Adds those of other walks.
    pub fn merge(&mut self, other: &Self) {
        self.walks += other.walks;
        self.trapped += other.trapped;
        self.trapped_carried += other.trapped_carried;
        self.ended_by_rounding += other.ended_by_rounding;
        self.cut += other.cut;
        self.cut_carried += other.cut_carried;
        self.cut_carried_squared += other.cut_carried_squared;
    }

    /// Share of what all walks set out with that was trapped.
    pub fn trapped_share(&self) -> f64 {
        self.trapped_carried / self.walks.max(1) as f64
    }

    /// Share of what all walks set out with that the limit has cut off.
    pub fn cut_share(&self) -> f64 {
        self.cut_carried / self.walks.max(1) as f64
    }

    /// Standard error of [`Self::cut_share`], as if walks were independent.
    pub fn cut_share_error(&self) -> f64 {
        let n = self.walks.max(2) as f64;
        let mean = self.cut_share();
        ((self.cut_carried_squared / n - mean * mean).max(0.0) / (n - 1.0)).sqrt()
    }

    /// What the cut share is at least, with 95 % confidence where it is of many walks.
    pub fn cut_share_at_least(&self) -> f64 {
        /// Standard normal quantile at 0.95.
        const ONE_SIDED: f64 = 1.644_853_6;
        (self.cut_share() - ONE_SIDED * self.cut_share_error()).clamp(0.0, 1.0)
    }

    /// Notes what has become of a walk.
    pub(crate) fn note(&mut self, fate: Fate) {
        self.walks += 1;
        self.ended_by_rounding += u64::from(fate.ended_by_rounding);
        if let Some(carried) = fate.trapped {
            self.trapped += 1;
            self.trapped_carried += f64::from(carried);
        }
        if let Some(carried) = fate.cut {
            let carried = f64::from(carried);
            self.cut += 1;
            self.cut_carried += carried;
            self.cut_carried_squared += carried * carried;
        }
    }
}

/// What has become of one walk so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Fate {
    /// What it carried when it had lost nothing for very long.
    pub trapped: Option<f32>,
    /// What it carried when it was cut.
    pub cut: Option<f32>,
    /// Whether roulette has ended it though it had lost nothing but what rounding takes.
    pub ended_by_rounding: bool,
}

/// What became of the walks of both kinds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BothFates {
    /// Walks from the eye, which gather light.
    pub from_eye: Fates,
    /// Walks from lights, which carry power.
    pub from_lights: Fates,
}

impl BothFates {
    /// Adds those of other walks.
    pub fn merge(&mut self, other: &Self) {
        self.from_eye.merge(&other.from_eye);
        self.from_lights.merge(&other.from_lights);
    }

    /// The walks that tell of the picture: those from the eye where there are any.
    pub const fn of_the_picture(&self) -> &Fates {
        if self.from_eye.walks > 0 { &self.from_eye } else { &self.from_lights }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_and_errors_are_those_of_the_textbook() {
        // Walks carry 1, 0.5, 0, 0 when they are cut: mean 0.375, sum of squares 1.25,
        // variance of the mean (1.25 / 4 - 0.375^2) / 3.
        let mut fates = Fates::default();
        for cut in [Some(1.0), Some(0.5), None, None] {
            fates.note(Fate { cut, ..Fate::default() });
        }
        assert_eq!((fates.walks, fates.cut, fates.cut_share()), (4, 2, 0.375));
        let error = ((1.25 / 4.0 - 0.375_f64.powi(2)) / 3.0_f64).sqrt();
        assert!((fates.cut_share_error() - error).abs() < 1e-15);
        let mut twice = fates;
        twice.merge(&fates);
        assert_eq!((twice.walks, twice.cut_share()), (8, 0.375));
    }
}
