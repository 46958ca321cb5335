//! Whether two estimates of one picture agree.
//!
//! Each estimate is given as independent batches. At every scale, from pixels to the whole
//! picture, Welch's test asks of every cell whether the two means differ, with Holm's
//! correction for their number. Two further tests look at the pixels together: the sum of
//! squared deviates (chi-squared), and the distribution of p-values (Kolmogorov-Smirnov); both
//! count correlated pixels for as many independent ones as they are worth. All tests share
//! [`ALPHA`] equally: two estimates of the same picture are called different once in a
//! thousand times. They are called equal only where the ratio of the whole pictures is one
//! within a margin (two one-sided tests, at 95 %), which needs samples enough to tell.
//!
//! Welch's test needs means that are near normal; the rule by which cells are judged or left to
//! coarser levels stands in `cells`.

use super::cells::{Cell, Cells, LevelTest, TAME};
use super::pyramid::Level;
use super::ratio::RatioInterval;
use super::together::{PValuesTest, together};
use std::fmt;

/// Chance that two estimates of the same picture are called different.
pub const ALPHA: f64 = 1e-3;
/// Fewest batches of either picture.
const FEWEST_BATCHES: usize = 8;
/// Tests beside those of the levels.
const TESTS_TOGETHER: usize = 2;

/// What is to be said of two estimates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// Nothing differs, and the whole pictures are equal within the margin.
    Equal,
    /// A test that the same picture fails once in a thousand times has failed.
    Different,
    /// Nothing differs, but that may be for lack of samples.
    Undecided {
        /// How many times as many samples let equal pictures pass nine times of ten.
        samples_factor: f64,
    },
}

/// Two estimates of a picture, compared.
#[derive(Clone, Debug)]
pub struct Agreement {
    /// What follows from all tests.
    pub verdict: Verdict,
    /// Test by size of cell, from pixels to the whole picture.
    pub levels: Vec<LevelTest>,
    /// All pixels together; `None` where too few are judged, or their batches are skewed.
    pub together: Option<PValuesTest>,
    /// Ratio of the whole pictures.
    pub ratio: RatioInterval,
    /// Pixels to look at, in rows: about one in twenty of them is there by chance (Benjamini
    /// and Hochberg).
    pub suspicious: Vec<bool>,
}

impl Agreement {
    /// Compares two pictures of one channel, each given as eight or more independent batches
    /// of pixels in rows. `margin` is the relative difference of the whole pictures that
    /// counts as none ([`super::MARGIN`]).
    pub fn of(a: &[Vec<f64>], b: &[Vec<f64>], width: usize, height: usize, margin: f64) -> Self {
        assert!(a.len().min(b.len()) >= FEWEST_BATCHES, "{FEWEST_BATCHES} batches of either picture");
        assert!(a.iter().chain(b).all(|batch| batch.len() == width * height), "pictures of one size");
        let levels = compare_levels(a, b, width, height);
        let alpha = ALPHA / (levels.len() + TESTS_TOGETHER) as f64;
        let (pixels, whole) = (&levels[0], &levels[levels.len() - 1]);
        let together = together(pixels, a, b, alpha);
        let whole_cell = &whole.cells[0];
        let ratio = RatioInterval::of(&whole_cell.a, &whole_cell.b, margin);
        let tests: Vec<LevelTest> = levels.iter().map(|level| level.test(alpha)).collect();
        let differs = tests.iter().any(|t| t.rejected > 0) || together.is_some_and(|t| t.fails());
        let verdict = match () {
            () if differs => Verdict::Different,
            () if whole_cell.judged && ratio.is_one() => Verdict::Equal,
            () => Verdict::Undecided { samples_factor: samples_factor(whole_cell, &ratio) },
        };
        let suspicious = pixels.suspicious();
        Self { verdict, levels: tests, together, ratio, suspicious }
    }
}

/// How many times as many samples let equal pictures be called so.
fn samples_factor(whole: &Cell, ratio: &RatioInterval) -> f64 {
    let to_be_tame = whole.a.relative_variance().max(whole.b.relative_variance()) / TAME;
    ratio.samples_factor().max(to_be_tame)
}

fn compare_levels(a: &[Vec<f64>], b: &[Vec<f64>], width: usize, height: usize) -> Vec<Cells> {
    let finest = Level::finest(a, b, width, height);
    std::iter::successors(Some(finest), Level::coarser).map(|level| Cells::of(&level)).collect()
}

impl fmt::Display for Agreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for level in &self.levels {
            writeln!(f, "{level}")?;
        }
        if let Some(together) = &self.together {
            writeln!(f, "{together}")?;
        }
        writeln!(f, "{}", self.ratio)?;
        write!(f, "{}", self.verdict)
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Equal => write!(f, "equal"),
            Self::Different => write!(f, "different"),
            Self::Undecided { samples_factor } => {
                write!(f, "undecided; {samples_factor:.1} times as many samples would tell")
            }
        }
    }
}
