//! Batches of two pictures at every scale, from pixels to the whole.

/// Two pictures, batch by batch, with all pixels of a square cell added up.
///
/// Each batch is added up by itself, so that the scatter of a cell's batches holds whatever
/// correlation there is between its pixels.
pub struct Level {
    /// Side of a cell in pixels; cells at the right and lower edge may be cut off.
    pub cell_px: usize,
    /// Cells in a row.
    pub columns: usize,
    /// Cells in a column.
    pub rows: usize,
    /// Batches of one picture.
    pub a: Vec<Vec<f64>>,
    /// Batches of the other.
    pub b: Vec<Vec<f64>>,
}

impl Level {
    /// Single pixels.
    pub fn finest(a: &[Vec<f64>], b: &[Vec<f64>], width: usize, height: usize) -> Self {
        Self { cell_px: 1, columns: width, rows: height, a: a.to_vec(), b: b.to_vec() }
    }

    /// Cells of twice the side; `None` beyond the whole picture.
    pub fn coarser(&self) -> Option<Self> {
        if self.columns * self.rows == 1 {
            return None;
        }
        let halve = |batches: &[Vec<f64>]| batches.iter().map(|batch| self.halved(batch)).collect();
        Some(Self {
            cell_px: 2 * self.cell_px,
            columns: self.columns.div_ceil(2),
            rows: self.rows.div_ceil(2),
            a: halve(&self.a),
            b: halve(&self.b),
        })
    }

    fn halved(&self, batch: &[f64]) -> Vec<f64> {
        let columns = self.columns.div_ceil(2);
        let mut sums = vec![0.0; columns * self.rows.div_ceil(2)];
        for (y, row) in batch.chunks_exact(self.columns).enumerate() {
            for (x, value) in row.iter().enumerate() {
                sums[y / 2 * columns + x / 2] += value;
            }
        }
        sums
    }

    /// See [`around`].
    pub fn around(&self, cell: usize, side: usize) -> impl Iterator<Item = usize> + use<> {
        around([self.columns, self.rows], cell, side)
    }
}

/// The square of `side` cells, or as much of it as there is, that lies around a cell of a grid of
/// columns and rows, or has it near an edge where it is near the grid's.
pub fn around([columns, rows]: [usize; 2], cell: usize, side: usize) -> impl Iterator<Item = usize> + use<> {
    let (x, y) = (cell % columns, cell / columns);
    let span = |at: usize, end: usize| {
        let first = at.saturating_sub(side / 2).min(end.saturating_sub(side));
        first..(first + side).min(end)
    };
    let (xs, ys) = (span(x, columns), span(y, rows));
    ys.flat_map(move |row| xs.clone().map(move |column| row * columns + column))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_holds_the_whole_of_an_odd_picture() {
        let picture: Vec<f64> = (1..=15).map(f64::from).collect();
        let mut level = Level::finest(&[picture], &[], 5, 3);
        let mut sizes = vec![(level.columns, level.rows)];
        while let Some(coarser) = level.coarser() {
            level = coarser;
            sizes.push((level.columns, level.rows));
            assert_eq!(level.a[0].iter().sum::<f64>(), 120.0);
        }
        assert_eq!(sizes, [(5, 3), (3, 2), (2, 1), (1, 1)]);
    }

    #[test]
    fn neighbours_stay_within_the_picture() {
        let level = Level::finest(&[], &[], 4, 3);
        for corner in [0, 1, 4, 5] {
            assert_eq!(level.around(corner, 3).collect::<Vec<_>>(), [0, 1, 2, 4, 5, 6, 8, 9, 10]);
        }
        assert_eq!(level.around(7, 3).collect::<Vec<_>>(), [1, 2, 3, 5, 6, 7, 9, 10, 11]);
        assert_eq!(level.around(6, 5).count(), 12);
    }
}
