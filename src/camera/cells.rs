//! Errors of mean luminance over squares of pixels, from a coarse grid up to the whole picture.
//!
//! Where one path lights several pixels, or a chain stays near where it was, the errors of
//! neighbours are not independent, and that of their mean does not follow from theirs. So the sums
//! of a block are also added up over squares: the scatter of these holds whatever pixels share.
//! The grid is coarse, so that it costs next to nothing.

use super::film::BlockStatistics;
use serde::{Deserialize, Serialize};

/// Squares of the finest level at most.
const MOST_CELLS: u64 = 1024;
/// Side of the smallest squares in pixels: pixels have their errors already.
const SMALLEST_PX: u32 = 2;

/// One level: squares of one size from the top left corner, cut off at the right and at the bottom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellLevel {
    /// Side of a square in pixels, a power of two.
    pub cell_px: u32,
    /// Squares in a row.
    pub columns: u32,
    /// Rows of squares.
    pub rows: u32,
}

/// Every level of a picture, the finest first; the last one is a single square.
#[derive(Clone, Debug)]
pub struct CellGrid {
    resolution: [u32; 2],
    levels: Vec<CellLevel>,
}

impl CellGrid {
    /// That of a picture of this width and height in pixels.
    pub fn of(resolution: [u32; 2]) -> Self {
        let level = |power: u32| {
            let [columns, rows] = resolution.map(|side| (u64::from(side).div_ceil(1 << power)).max(1) as u32);
            CellLevel { cell_px: 1 << power, columns, rows }
        };
        let count = |level: &CellLevel| u64::from(level.columns) * u64::from(level.rows);
        let mut levels: Vec<CellLevel> = (SMALLEST_PX.trailing_zeros()..u32::BITS)
            .map(level)
            .skip_while(|level| count(level) > MOST_CELLS)
            .collect();
        let whole = levels.iter().position(|level| count(level) == 1).map_or(levels.len(), |at| at + 1);
        levels.truncate(whole);
        Self { resolution, levels }
    }

    /// Squares of all levels.
    pub fn count(&self) -> usize {
        self.levels.iter().map(|level| level.columns as usize * level.rows as usize).sum()
    }

    /// Squares of the finest level.
    fn finest(&self) -> usize {
        self.levels.first().map_or(0, |level| level.columns as usize * level.rows as usize)
    }

    /// Adds the values of a row of pixels to sums over the finest squares.
    fn add_row(&self, finest: &mut [f64], row: usize, values: impl Iterator<Item = f64>) {
        let Some(level) = self.levels.first() else { return };
        let first = row / level.cell_px as usize * level.columns as usize;
        for (column, value) in values.enumerate() {
            finest[first + column / level.cell_px as usize] += value;
        }
    }

    /// Sums over the squares of all levels, level by level and row by row, from those of the finest.
    fn climb(&self, finest: &[f64]) -> Vec<f64> {
        let mut sums = finest.to_vec();
        let mut first = 0;
        for pair in self.levels.windows(2) {
            let (below, above) = (pair[0], pair[1]);
            let start = sums.len();
            sums.resize(start + above.columns as usize * above.rows as usize, 0.0);
            for row in 0..below.rows as usize {
                for column in 0..below.columns as usize {
                    let value = sums[first + row * below.columns as usize + column];
                    sums[start + row / 2 * above.columns as usize + column / 2] += value;
                }
            }
            first = start;
        }
        sums
    }

    /// Sums over the squares of all levels of a value that every pixel has.
    pub fn sums(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let [width, height] = self.resolution.map(|side| side as usize);
        let mut finest = vec![0.0; self.finest()];
        for row in 0..height {
            self.add_row(&mut finest, row, (0..width).map(|column| value(row * width + column)));
        }
        self.climb(&finest)
    }

    /// What is known of the squares of all levels, from standard errors of the sums over them.
    pub fn errors(&self, of_sums: &[f64]) -> CellErrors {
        let areas = self.sums(|_| 1.0);
        let mut stderr = of_sums.iter().zip(&areas).map(|(error, area)| error / area);
        let level = |level: &CellLevel| LevelErrors {
            cell_px: level.cell_px,
            columns: level.columns,
            rows: level.rows,
            stderr: stderr.by_ref().take(level.columns as usize * level.rows as usize).collect(),
        };
        CellErrors { levels: self.levels.iter().map(level).collect() }
    }
}

/// Standard errors of mean luminance over squares of pixels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CellErrors {
    /// The finest squares first; last the whole picture.
    pub levels: Vec<LevelErrors>,
}

/// Those of one level.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LevelErrors {
    /// Side of a square in pixels; at the right and at the bottom squares are cut off.
    pub cell_px: u32,
    /// Squares in a row.
    pub columns: u32,
    /// Rows of squares.
    pub rows: u32,
    /// Standard errors of the mean over the pixels of a square, row by row, in the film's unit.
    pub stderr: Vec<f64>,
}

impl CellErrors {
    /// Those of the sum of this picture and an independent one of the same size.
    pub fn with(mut self, other: &Self) -> Self {
        for (level, others) in self.levels.iter_mut().zip(&other.levels) {
            let pairs = level.stderr.iter_mut().zip(&others.stderr);
            pairs.for_each(|(error, another)| *error = error.hypot(*another));
        }
        self
    }

    /// Those of a picture of a share of this one's light.
    pub fn times(mut self, share: f64) -> Self {
        self.levels.iter_mut().flat_map(|level| &mut level.stderr).for_each(|error| *error *= share);
        self
    }

    /// That of the mean over the whole picture.
    pub fn of_whole(&self) -> Option<f64> {
        self.levels.last().and_then(|level| level.stderr.first().copied())
    }
}

/// Sums over squares and of their squares, block by block.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Cells {
    resolution: [u32; 2],
    statistics: Vec<BlockStatistics>,
    /// Sums over the finest squares of the block being taken.
    block: Vec<f64>,
}

impl Cells {
    /// Nothing gathered yet.
    pub fn new(resolution: [u32; 2]) -> Self {
        let grid = CellGrid::of(resolution);
        Self {
            resolution,
            statistics: vec![BlockStatistics::default(); grid.count()],
            block: vec![0.0; grid.finest()],
        }
    }

    /// Whether they are of a picture of this size: those from a file may be anything.
    pub fn fits(&self, resolution: [u32; 2]) -> bool {
        let grid = CellGrid::of(resolution);
        self.resolution == resolution
            && self.statistics.len() == grid.count()
            && self.block.len() == grid.finest()
    }

    /// Adds what the pixels of a row have received of the block being taken.
    pub fn add_row(&mut self, row: usize, values: impl Iterator<Item = f64>) {
        CellGrid::of(self.resolution).add_row(&mut self.block, row, values);
    }

    /// Ends a block of so many samples per pixel.
    pub fn finish_block(&mut self, count: u32) {
        let sums = CellGrid::of(self.resolution).climb(&self.block);
        self.statistics.iter_mut().zip(sums).for_each(|(statistic, sum)| statistic.add_block(sum, count));
        self.block.fill(0.0);
    }

    /// Standard errors after so many samples per pixel in so many blocks; `None` before two.
    pub fn errors(&self, samples: u64, blocks: u32) -> Option<CellErrors> {
        let of_sums: Option<Vec<f64>> =
            self.statistics.iter().map(|statistic| statistic.standard_error(samples, blocks)).collect();
        Some(CellGrid::of(self.resolution).errors(&of_sums?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_go_from_a_coarse_grid_to_the_whole() {
        let sides =
            |resolution| CellGrid::of(resolution).levels.iter().map(|l| l.cell_px).collect::<Vec<_>>();
        assert_eq!(sides([64, 48]), [2, 4, 8, 16, 32, 64]);
        assert_eq!(sides([1, 1]), [2]);
        assert_eq!(sides([640, 480]), [32, 64, 128, 256, 512, 1024]);
        assert_eq!(sides([1, 3000]), [4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096]);
        let odd = CellGrid::of([5, 3]);
        assert_eq!(odd.levels[0], CellLevel { cell_px: 2, columns: 3, rows: 2 });
    }

    #[test]
    fn sums_hold_the_pixels_under_them() {
        // 0  1  2  3  4
        // 5  6  7  8  9
        // 10 11 12 13 14
        let sums = CellGrid::of([5, 3]).sums(|pixel| pixel as f64);
        let by_hand = [12.0, 20.0, 13.0, 21.0, 25.0, 14.0, 78.0, 27.0, 105.0];
        assert_eq!(sums, by_hand);
    }

    /// Two blocks: a pixel that gains what its neighbour loses leaves their mean without scatter,
    /// one that gains with it doubles it.
    #[test]
    fn what_neighbours_share_is_in_the_error_of_their_mean() {
        let whole = |second: [f64; 2]| {
            let mut cells = Cells::new([2, 1]);
            for row in [[1.0, 1.0], second] {
                cells.add_row(0, row.into_iter());
                cells.finish_block(1);
            }
            cells.errors(2, 2).and_then(|errors| errors.of_whole()).expect("two blocks")
        };
        assert!(whole([2.0, 0.0]).abs() < 1e-15);
        // Means over the pixels 1 and 2: scatter 0.5, by hand, over two blocks.
        assert!((whole([2.0, 2.0]) - 0.5).abs() < 1e-15);
        assert_eq!(Cells::new([2, 1]).errors(1, 1), None);
    }
}
