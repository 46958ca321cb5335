//! Cells of one size of two pictures: which of them can be judged, and whether their means differ.
//!
//! A cell is *judged* only where its mean has, in either picture, a skewness of at most
//! [`LARGEST_SKEWNESS`], after the part that its picture has in the noise of the difference; where
//! both pictures know of light, or both of none; and where a quarter of the level's lit cells are
//! so. What is left of skewness is taken out of t at its worst: the picture that is darker is taken
//! to have missed light. Below the whole picture, cells are judged only where both pictures have
//! [`FEWEST_BLOCKS`].

use super::estimate::Grid;
use super::side::{Known, Side};
use crate::statistics::cells::{FALSE_DISCOVERIES, FEWEST_TAME, WorstCell};
use crate::statistics::multiple::{benjamini_hochberg, holm};
use crate::statistics::welch::{ROUNDING, Welch, unskewed};
use std::fmt;

/// Skewness of a mean up to which a correction of first order is near enough.
pub const LARGEST_SKEWNESS: f64 = 0.3;
/// Blocks behind standard errors from which cells below the whole picture are judged: variances
/// of fewer say too little of their own scatter to bound the skewness with.
pub const FEWEST_BLOCKS: f64 = 4.0;

/// The test of all cells of one size.
#[derive(Clone, Debug)]
pub struct LevelResult {
    /// Side of a cell in pixels.
    pub cell_px: usize,
    /// Cells of this size.
    pub cells: usize,
    /// Cells that can be judged.
    pub judged: usize,
    /// Cells whose means differ after Holm's correction.
    pub rejected: usize,
    /// Cells to look at: about one in twenty of them is there by chance (Benjamini, Hochberg).
    pub suspicious: usize,
    /// Chance of one or more wrongly rejected cells.
    pub alpha: f64,
    /// The judged cell with the smallest p-value.
    pub worst: Option<WorstCell>,
}

/// The comparison of one cell.
#[derive(Clone, Copy, Debug)]
pub struct Compared {
    /// What the first picture says.
    pub a: Known,
    /// What the second says.
    pub b: Known,
    /// Difference in standard errors, with what skewness may have made of it taken out.
    pub welch: Welch,
    /// Probability of as clear a difference by chance.
    pub p_value: f64,
    /// Largest skewness of either mean, after its part in the noise of the difference.
    pub skewness: f64,
    /// Whether all that means anything.
    pub judged: bool,
}

impl Compared {
    /// Compares two means; `is_whole`: of whole pictures, which are taken at their word where they
    /// are black.
    pub fn of(a: Known, b: Known, is_whole: bool) -> Self {
        let variance = a.variance + b.variance;
        let difference = a.mean - b.mean;
        let counted = (difference.abs() - ROUNDING * a.mean.abs().max(b.mean.abs())).max(0.0);
        let steady = a.steady + b.steady;
        let part = |side: &Known| if steady > 0.0 { side.steady / steady } else { 0.5 };
        let skewness = |side: &Known| side.kurtosis.sqrt() * part(side).powf(1.5);
        let missing = if difference < 0.0 { skewness(&a) } else { skewness(&b) };
        let size = match counted {
            0.0 => 0.0,
            _ if variance == 0.0 => f64::INFINITY,
            // A mean that has missed light has a t below zero; one above has the other to blame.
            _ => -unskewed_from_below(-counted / variance.sqrt(), missing),
        };
        let freedom = 1.0 / (part(&a).powi(2) / a.freedom + part(&b).powi(2) / b.freedom);
        let welch = Welch { t: size.copysign(difference), freedom };
        let is_dark = |side: &Known| side.mean == 0.0 && side.variance == 0.0;
        let skewness = skewness(&a).max(skewness(&b));
        let judged = skewness <= LARGEST_SKEWNESS && (is_whole || is_dark(&a) == is_dark(&b));
        Self { a, b, welch, p_value: welch.p_value(), skewness, judged }
    }

    fn is_lit(&self) -> bool {
        [self.a, self.b].iter().any(|side| side.mean != 0.0 || side.variance != 0.0)
    }
}

/// A t below zero of means with a tail upwards; never on the other side of zero.
fn unskewed_from_below(t: f64, skewness: f64) -> f64 {
    if skewness > 0.0 { unskewed(t, skewness).clamp(t, 0.0) } else { t }
}

/// All cells of one size, compared; `None` where one picture says nothing. `blocks`: behind the
/// standard errors of the picture that has fewer.
pub fn compare(a: &Side, b: &Side, blocks: f64) -> Vec<Option<Compared>> {
    let is_whole = a.len() == 1;
    let both = |(a, b): (&Option<Known>, &Option<Known>)| Some(Compared::of((*a)?, (*b)?, is_whole));
    let mut cells: Vec<Option<Compared>> = a.iter().zip(b).map(both).collect();
    let lit = cells.iter().flatten().filter(|cell| cell.is_lit()).count();
    let judged = cells.iter().flatten().filter(|cell| cell.judged && cell.is_lit()).count();
    if (judged as f64) < FEWEST_TAME * lit as f64 || !is_whole && blocks < FEWEST_BLOCKS {
        cells.iter_mut().flatten().for_each(|cell| cell.judged = false);
    }
    cells
}

/// The judged cells with their places.
pub fn judged(cells: &[Option<Compared>]) -> impl Iterator<Item = (usize, &Compared)> {
    cells
        .iter()
        .enumerate()
        .filter_map(|(index, cell)| Some((index, cell.as_ref().filter(|cell| cell.judged)?)))
}

impl LevelResult {
    /// Tests a level so that one or more of its cells are wrongly rejected with chance `alpha`.
    pub fn of(cells: &[Option<Compared>], grid: &Grid, alpha: f64) -> Self {
        let p_values: Vec<f64> = judged(cells).map(|(_, cell)| cell.p_value).collect();
        let worst = judged(cells).min_by(|x, y| x.1.p_value.total_cmp(&y.1.p_value)).map(|(index, cell)| {
            let pixel = [index % grid.cells[0], index / grid.cells[0]].map(|i| i * grid.cell_px);
            WorstCell { pixel, ratio: cell.a.mean / cell.b.mean, t: cell.welch.t, p_value: cell.p_value }
        });
        let limit = benjamini_hochberg(&p_values, FALSE_DISCOVERIES);
        Self {
            cell_px: grid.cell_px,
            cells: cells.len(),
            judged: p_values.len(),
            rejected: holm(&p_values, alpha),
            suspicious: limit.map_or(0, |limit| p_values.iter().filter(|p| **p <= limit).count()),
            alpha,
            worst,
        }
    }
}

impl fmt::Display for LevelResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { cell_px, cells, judged, rejected, suspicious, .. } = self;
        write!(f, "{cell_px:>7} {cells:>9} {judged:>9} {rejected:>9} {suspicious:>11}")?;
        match self.worst {
            Some(WorstCell { pixel: [x, y], ratio, t, p_value }) => {
                write!(f, "   ({x}, {y}): ratio {ratio:.4}, t {t:+.1}, p {p_value:.1e}")
            }
            None => Ok(()),
        }
    }
}
