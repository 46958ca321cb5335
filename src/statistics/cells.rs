//! Cells of one size: which of them can be judged, and whether their means differ.
//!
//! Welch's test needs means that are near normal. A cell is *judged* only where, in the 5x5
//! cells around it, no batch of either picture is zero, batches scatter by less than half of
//! their mean (root mean square), and their skewness is below one; the whole picture has no
//! neighbours, and its skewness does not matter. Cells that are black in both pictures do not
//! count. Where less than a quarter of a level's cells pass, none is judged; and pixels are
//! looked at together only where batches all over the picture are as little skewed. The rule
//! looks at each picture by itself, never at their difference; what few bright paths reach is
//! left by it to coarser levels. The neighbours matter because a path that is too rare to have
//! been met in one cell has been met in one of twenty-five; of light that none of them has met
//! nothing can be known. The skewness that is left is corrected for.

use super::multiple::{benjamini_hochberg, holm};
use super::pyramid::Level;
use super::welch::{Moments, Welch};
use std::fmt;

/// Share of the suspicious pixels that are so by chance.
pub const FALSE_DISCOVERIES: f64 = 0.05;
/// Side of the square of cells around a cell that say how its batches scatter.
pub const NEIGHBOURHOOD: usize = 5;
/// Fewest cells that tell a skewness well enough to correct for it.
pub const FEWEST_FOR_CORRECTION: usize = 9;
/// Scatter of batches over their mean, squared, up to which their mean is near normal.
pub const TAME: f64 = 0.25;
/// Share of a level's cells that must pass the rule: where fewer do, it is by chance.
pub const FEWEST_TAME: f64 = 0.25;
/// Skewness of batches up to which Welch's test can be corrected for it: at 1, half of the
/// batches can be bright and half dark, and a cell is still sure to meet both kinds.
const LARGEST_SKEWNESS: f64 = 1.0;

/// Welch's test in all cells of one size.
#[derive(Clone, Debug)]
pub struct LevelTest {
    /// Side of a cell in pixels.
    pub cell_px: usize,
    /// Cells of this size.
    pub cells: usize,
    /// Cells whose batches are tame enough to be judged.
    pub judged: usize,
    /// Cells whose means differ after Holm's correction.
    pub rejected: usize,
    /// Chance of one or more wrongly rejected cells.
    pub alpha: f64,
    /// The judged cell with the smallest p-value.
    pub worst: Option<WorstCell>,
}

/// The cell of a level in which the means differ most clearly.
#[derive(Clone, Copy, Debug)]
pub struct WorstCell {
    /// Column and row of its upper left pixel.
    pub pixel: [usize; 2],
    /// Mean of the first picture over that of the second.
    pub ratio: f64,
    /// Difference in standard errors.
    pub t: f64,
    /// Probability of a difference as clear by chance, in this cell alone.
    pub p_value: f64,
}

/// One cell of both pictures.
pub struct Cell {
    /// The first picture's.
    pub a: Moments,
    /// The second picture's.
    pub b: Moments,
    /// Their comparison.
    pub welch: Welch,
    /// Its p-value.
    pub p_value: f64,
    /// Whether it means anything.
    pub judged: bool,
}

/// All cells of one size.
pub struct Cells {
    cell_px: usize,
    columns: usize,
    /// In rows.
    pub cells: Vec<Cell>,
    /// Whether the batches of either picture, all over it, are skewed.
    pub skewed: bool,
}

impl Cells {
    /// All cells of a level, compared and judged.
    pub fn of(level: &Level) -> Self {
        let count = level.columns * level.rows;
        let moments = |batches: &[Vec<f64>]| -> Vec<Moments> {
            (0..count).map(|cell| Moments::of(batches.iter().map(|batch| batch[cell]))).collect()
        };
        let (a, b) = (moments(&level.a), moments(&level.b));
        let cell = |cell: usize| {
            let lit = |other: &usize| count == 1 || a[*other].is_lit() || b[*other].is_lit();
            let around: Vec<usize> = level.around(cell, NEIGHBOURHOOD).filter(lit).collect();
            let welch = Welch::of(&a[cell], &b[cell], skewness_of_difference(&a, &b, &around));
            let judged = is_tame(&a, &around) && is_tame(&b, &around);
            Cell { a: a[cell], b: b[cell], welch, p_value: welch.p_value(), judged }
        };
        let mut cells: Vec<Cell> = (0..count).map(cell).collect();
        let lit: Vec<usize> = (0..count).filter(|&cell| a[cell].is_lit() || b[cell].is_lit()).collect();
        let judged = cells.iter().filter(|cell| cell.judged).count();
        if (judged as f64) < FEWEST_TAME * lit.len() as f64 {
            cells.iter_mut().for_each(|cell| cell.judged = false);
        }
        let skewed = [&a, &b].iter().any(|cells| skewness(cells, &lit).abs() > LARGEST_SKEWNESS);
        Self { cell_px: level.cell_px, columns: level.columns, cells, skewed }
    }

    /// The judged cells with their places.
    pub fn judged(&self) -> impl Iterator<Item = (usize, &Cell)> {
        self.cells.iter().enumerate().filter(|(_, cell)| cell.judged)
    }

    fn p_values(&self) -> Vec<f64> {
        self.judged().map(|(_, cell)| cell.p_value).collect()
    }

    /// Holm's test of all judged cells.
    pub fn test(&self, alpha: f64) -> LevelTest {
        let p_values = self.p_values();
        let worst = self.judged().min_by(|x, y| x.1.p_value.total_cmp(&y.1.p_value)).map(|(index, cell)| {
            let pixel = [index % self.columns, index / self.columns].map(|i| i * self.cell_px);
            WorstCell { pixel, ratio: cell.a.mean / cell.b.mean, t: cell.welch.t, p_value: cell.p_value }
        });
        LevelTest {
            cell_px: self.cell_px,
            cells: self.cells.len(),
            judged: p_values.len(),
            rejected: holm(&p_values, alpha),
            alpha,
            worst,
        }
    }

    /// Cells to look at.
    pub fn suspicious(&self) -> Vec<bool> {
        let limit = benjamini_hochberg(&self.p_values(), FALSE_DISCOVERIES);
        self.cells
            .iter()
            .map(|cell| cell.judged && limit.is_some_and(|limit| cell.p_value <= limit))
            .collect()
    }
}

/// Whether the batches of one picture in these cells are such that their means are near
/// normal. A whole picture that is black in every batch is taken at its word.
fn is_tame(cells: &[Moments], around: &[usize]) -> bool {
    let black = cells.len() == 1 && !cells[0].is_lit();
    let scatter: f64 = around.iter().map(|&cell| cells[cell].relative_variance()).sum();
    let steady = scatter <= TAME * around.len() as f64
        && around.iter().all(|&cell| cells[cell].zeros == 0)
        && (cells.len() == 1 || skewness(cells, around).abs() <= LARGEST_SKEWNESS);
    black || steady
}

/// Skewness of the batches of one picture.
fn skewness(cells: &[Moments], around: &[usize]) -> f64 {
    // Relative to the cell's mean, so that a bright cell counts no more than a dark one.
    let cumulants = |&cell: &usize| {
        let Moments { mean, variance, third, count, .. } = cells[cell];
        (third * count * count / mean.powi(3), (variance * count / (mean * mean)).powf(1.5))
    };
    skewness_of(around, cumulants)
}

/// Skewness of the difference of the means, to be corrected for; zero where cells are too few
/// to tell.
fn skewness_of_difference(a: &[Moments], b: &[Moments], around: &[usize]) -> f64 {
    if around.len() < FEWEST_FOR_CORRECTION {
        return 0.0;
    }
    let cumulants =
        |&cell: &usize| (a[cell].third - b[cell].third, (a[cell].variance + b[cell].variance).powf(1.5));
    skewness_of(around, cumulants)
}

/// Third cumulant over the variance to the power of 3/2, each added up over cells.
fn skewness_of(cells: &[usize], cumulants: impl Fn(&usize) -> (f64, f64)) -> f64 {
    let (third, scale) = cells.iter().map(cumulants).fold((0.0, 0.0), |sum, c| (sum.0 + c.0, sum.1 + c.1));
    if scale > 0.0 { third / scale } else { 0.0 }
}

impl fmt::Display for LevelTest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { cell_px, cells, judged, rejected, alpha, .. } = self;
        write!(
            f,
            "cells of {cell_px} px: {rejected} of {judged} differ ({cells} in all, alpha {alpha:.1e})"
        )?;
        let Some(WorstCell { pixel: [x, y], ratio, t, p_value }) = self.worst else { return Ok(()) };
        write!(f, "; worst at ({x}, {y}): ratio {ratio:.4}, t {t:.2}, p {p_value:.1e}")
    }
}
