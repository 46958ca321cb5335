//! Whether two pictures agree of which only means and standard errors are left.
//!
//! It asks what [`super::Agreement`] asks of batches: at every size of cell, from pixels to the
//! whole picture, whether the means differ, with Holm's correction; of all pixels together,
//! whether they differ by more than their noise; and whether the 95 % interval of the ratio of the
//! whole pictures lies within a margin. All tests share [`ALPHA`] equally. What stands in a file
//! says less than batches do: `side` says what is made of it.

mod estimate;
mod level;
mod measures;
mod side;

pub use estimate::{CellErrors, Estimate, Noise};
pub use level::LevelResult;
pub use measures::{Corrected, Excess, Measures};

use super::agreement::ALPHA;
use super::ratio::RatioInterval;
use super::welch::Moments;
use estimate::Grid;
use level::{Compared, FEWEST_BLOCKS, LARGEST_SKEWNESS};
use side::Side;

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// Values of one unit.
    Levels,
    /// Only how light is distributed over the picture: the first one is scaled to the mean of the
    /// second.
    Shape,
}

/// What follows from all tests.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// Nothing differs, and the means of the whole (of the shape: of its quarters) are equal
    /// within the margin.
    Equal,
    /// A test that the same picture fails once in a thousand times has failed.
    Different,
    /// Nothing differs, but that may be for lack of samples.
    Undecided {
        /// How many times as many samples of both let equal pictures pass nine times of ten;
        /// `None` where samples are not what is missing.
        samples_factor: Option<f64>,
        /// What is missing, in words.
        reason: &'static str,
    },
}

/// Mean of the first picture over that of the second.
#[derive(Clone, Copy, Debug)]
pub struct WholeRatio {
    /// The ratio.
    pub ratio: f64,
    /// With its 95 % interval, where errors of the means are known.
    pub interval: Option<RatioInterval>,
}

/// Two pictures, compared.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// How far they are apart.
    pub measures: Measures,
    /// Ratio of the whole; of a shape what it was before it was scaled, without an interval.
    pub whole: WholeRatio,
    /// Test by size of cell; empty where nothing is known of the noise.
    pub levels: Vec<LevelResult>,
    /// All pixels together.
    pub excess: Option<Excess>,
    /// What follows.
    pub outcome: Outcome,
    /// Difference in standard errors of every pixel, in rows; NaN where it means nothing.
    pub z: Vec<f64>,
}

impl Comparison {
    /// Compares two pictures of one size in rows of `size[0]`. Only pixels that `counted` names
    /// count, at least one; values and errors of them are finite. `margin` is the relative
    /// difference of means that counts as none.
    pub fn of(
        a: &Estimate,
        b: &Estimate,
        size: [usize; 2],
        counted: &[bool],
        margin: f64,
        subject: Subject,
    ) -> Self {
        let pixels = size[0] * size[1];
        assert!([a.mean.len(), b.mean.len(), counted.len()] == [pixels; 3], "pictures of one size");
        let means = [a, b].map(|picture| mean_of(&picture.mean, counted));
        let ratio = if means[0] == means[1] { 1.0 } else { means[0] / means[1] };
        let scaled = match subject {
            Subject::Levels => None,
            Subject::Shape => Some(scaled(a, 1.0 / ratio)),
        };
        let a = scaled.as_ref().unwrap_or(a);
        let measures = Measures::of(a, b, counted);
        let Some(noises) = a.noise.as_ref().zip(b.noise.as_ref()) else {
            let whole = WholeRatio { ratio, interval: None };
            let outcome = Outcome::Undecided { samples_factor: None, reason: NO_NOISE };
            return Self {
                measures,
                whole,
                levels: vec![],
                excess: None,
                outcome,
                z: vec![f64::NAN; pixels],
            };
        };
        let finest = Grid::finest(size, counted);
        let is_lit = |p: usize| {
            let lit = |mean: &[f64], noise: &Noise| mean[p] != 0.0 || noise.standard_error[p] != 0.0;
            lit(&a.mean, noises.0) || lit(&b.mean, noises.1)
        };
        let lit: Vec<bool> = (0..pixels).map(is_lit).collect();
        let grids: Vec<Grid> = std::iter::successors(Some(finest), Grid::coarser).collect();
        let sides =
            [(a, noises.0), (b, noises.1)].map(|(picture, noise)| pyramid(picture, noise, &grids, &lit));
        let blocks = noises.0.blocks.min(noises.1.blocks);
        let cells: Vec<Vec<Option<Compared>>> =
            sides[0].iter().zip(&sides[1]).map(|(a, b)| level::compare(a, b, blocks)).collect();
        let alpha = ALPHA / (cells.len() + 1) as f64;
        let excess = Excess::of([a, b], [noises.0, noises.1], &grids[0], &lit, alpha);
        let levels: Vec<LevelResult> =
            cells.iter().zip(&grids).map(|(cells, grid)| LevelResult::of(cells, grid, alpha)).collect();
        let differs = levels.iter().any(|level| level.rejected > 0) || excess.is_some_and(|e| e.fails());
        let interval = cells.last().and_then(|whole| whole[0].as_ref()).map(|cell| interval(cell, margin));
        let outcome = if differs {
            Outcome::Different
        } else {
            let of_whole = match subject {
                Subject::Levels => cells.len() - 1,
                Subject::Shape => cells.len().saturating_sub(2),
            };
            let is_left_out = grids[of_whole].complete.contains(&false);
            let is_stated = |noise: &Noise| noise.independent || !noise.cells.is_empty();
            let unknown = match is_left_out && is_stated(noises.0) && is_stated(noises.1) {
                true => LEFT_OUT,
                false => NOT_KNOWN,
            };
            equal_within(&cells[of_whole], margin, blocks, unknown)
        };
        let interval = interval.filter(|_| subject == Subject::Levels);
        let z =
            cells[0].iter().map(|cell| cell.as_ref().filter(|c| c.judged).map_or(f64::NAN, |c| c.welch.t));
        let whole = WholeRatio { ratio, interval };
        Self { measures, whole, levels, excess, outcome, z: z.collect() }
    }
}

/// Why nothing can be tested.
const NO_NOISE: &str = "no noise figures: a picture has no standard errors, or only one block of samples";
const NOT_KNOWN: &str = "errors of means over the picture are not known, where pixels depend on one another";
const LEFT_OUT: &str = "too many pixels are left out for the stated errors of means over the picture";
const TOO_SKEWED: &str = "few bright samples make up the noise of the whole picture";
const TOO_FEW_BLOCKS: &str =
    "a picture has fewer than four blocks of samples, and parts of it are not judged";
const TOO_NOISY: &str = "the 95 % interval of the ratio of means does not lie within the margin";

/// Whether all cells are equal within the margin, where nothing differs; `unknown` says why one is
/// not known.
fn equal_within(cells: &[Option<Compared>], margin: f64, blocks: f64, unknown: &'static str) -> Outcome {
    let Some(cells) = cells.iter().copied().collect::<Option<Vec<Compared>>>() else {
        return Outcome::Undecided { samples_factor: None, reason: unknown };
    };
    let ratios: Vec<RatioInterval> = cells.iter().map(|cell| interval(cell, margin)).collect();
    let is_judged = cells.iter().all(|cell| cell.judged);
    if is_judged && ratios.iter().all(RatioInterval::is_one) {
        return Outcome::Equal;
    }
    // Skewness of a mean falls with the root of the number of samples.
    let tame = cells.iter().map(|cell| (cell.skewness / LARGEST_SKEWNESS).powi(2)).fold(0.0, f64::max);
    let narrow = ratios.iter().map(RatioInterval::samples_factor).fold(0.0, f64::max);
    let has_blocks = cells.len() == 1 || blocks >= FEWEST_BLOCKS;
    let more_blocks = if has_blocks { 1.0 } else { FEWEST_BLOCKS / blocks };
    let reason = match (is_judged, has_blocks) {
        (true, _) => TOO_NOISY,
        (false, true) => TOO_SKEWED,
        (false, false) => TOO_FEW_BLOCKS,
    };
    Outcome::Undecided { samples_factor: Some(tame.max(narrow).max(more_blocks)), reason }
}

fn interval(cell: &Compared, margin: f64) -> RatioInterval {
    let moments = |side: &side::Known| Moments {
        mean: side.mean,
        variance: side.variance,
        count: side.freedom + 1.0,
        ..Moments::default()
    };
    RatioInterval::of(&moments(&cell.a), &moments(&cell.b), margin)
}

/// One picture at every size of cell.
fn pyramid(picture: &Estimate, noise: &Noise, grids: &[Grid], lit: &[bool]) -> Vec<Side> {
    let mut sides = vec![side::pixels(&picture.mean, noise, &grids[0], lit)];
    let mut means = picture.mean.clone();
    // The last size with stated errors, where pixels depend on one another.
    let mut has_stated = false;
    for (from, to) in grids.iter().zip(&grids[1..]) {
        let finer = &sides[sides.len() - 1];
        let unknown = || vec![None; to.pixels.len()];
        let side = if noise.independent {
            side::coarser_of_independent(finer, from, to)
        } else {
            means = halved(&means, from, to);
            let stated = noise.cells.iter().find(|cells| cells.grid == to.cells);
            match stated {
                None => unknown(),
                Some(stated) if has_stated => {
                    side::coarser_of_stated(&means, stated, noise.blocks, finer, from, to)
                }
                Some(stated) => side::stated(&means, stated, noise.blocks, to),
            }
        };
        has_stated = !noise.independent && noise.cells.iter().any(|cells| cells.grid == to.cells);
        sides.push(side);
    }
    sides
}

/// Means over cells of twice the side.
fn halved(means: &[f64], from: &Grid, to: &Grid) -> Vec<f64> {
    let mut sums = vec![0.0; to.pixels.len()];
    for (cell, mean) in means.iter().enumerate().filter(|(cell, _)| from.pixels[*cell] > 0.0) {
        sums[from.parent(cell)] += from.pixels[cell] * mean;
    }
    sums.iter().zip(&to.pixels).map(|(sum, pixels)| if *pixels > 0.0 { sum / pixels } else { 0.0 }).collect()
}

fn mean_of(values: &[f64], counted: &[bool]) -> f64 {
    let kept = || values.iter().zip(counted).filter(|(_, counted)| **counted);
    kept().map(|(value, _)| value).sum::<f64>() / kept().count() as f64
}

fn scaled(picture: &Estimate, factor: f64) -> Estimate {
    let times = |values: &[f64]| values.iter().map(|value| value * factor).collect();
    let noise = picture.noise.as_ref().map(|noise| Noise {
        standard_error: times(&noise.standard_error),
        cells: noise
            .cells
            .iter()
            .map(|cells| CellErrors { standard_error: times(&cells.standard_error), ..cells.clone() })
            .collect(),
        ..*noise
    });
    Estimate { mean: times(&picture.mean), noise }
}
