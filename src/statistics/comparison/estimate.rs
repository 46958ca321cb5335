//! Two pictures as files hold them: means, and what is stated of their errors.
//!
//! A file has no batches, only what was made of them: a standard error for every pixel, and
//! sometimes for cells of pixels. Means over cells of independent pixels have errors that follow
//! from those of the pixels; where light is splatted or chained, pixels depend on one another, and
//! only stated errors of cells are believed.

/// Share of a cell's pixels that may be left out for its stated error to be believed.
const LARGEST_LEFT_OUT: f64 = 0.01;

/// A picture of one channel and its error.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// Values in rows; all of the same unit.
    pub mean: Vec<f64>,
    /// What is known of their error; `None`: nothing.
    pub noise: Option<Noise>,
}

/// The stated error of a picture.
#[derive(Clone, Debug)]
pub struct Noise {
    /// Standard error of every pixel.
    pub standard_error: Vec<f64>,
    /// Independent blocks behind each of them, at least two.
    pub blocks: f64,
    /// Whether the errors of different pixels are independent.
    pub independent: bool,
    /// Standard errors of means over cells, from fine to coarse; may be empty.
    pub cells: Vec<CellErrors>,
}

/// Standard errors of the means over square cells of one size.
#[derive(Clone, Debug)]
pub struct CellErrors {
    /// Cells in a row and in a column; those at the right and lower edge may be cut off.
    pub grid: [usize; 2],
    /// Side of a cell in pixels.
    pub cell_px: usize,
    /// In rows.
    pub standard_error: Vec<f64>,
}

/// The square cells of one size that a picture is divided into.
#[derive(Clone, Debug)]
pub struct Grid {
    /// Side of a cell in pixels.
    pub cell_px: usize,
    /// Cells in a row and in a column.
    pub cells: [usize; 2],
    /// Pixels of each cell that count.
    pub pixels: Vec<f64>,
    /// Pixels of each cell.
    pub area: Vec<f64>,
    /// Whether all of a cell's pixels count.
    pub complete: Vec<bool>,
}

impl Grid {
    /// Single pixels.
    pub fn finest(size: [usize; 2], counted: &[bool]) -> Self {
        let pixels = counted.iter().map(|counted| f64::from(u8::from(*counted))).collect();
        Self { cell_px: 1, cells: size, pixels, area: vec![1.0; counted.len()], complete: counted.to_vec() }
    }

    /// Cells of twice the side; `None` beyond the whole picture.
    pub fn coarser(&self) -> Option<Self> {
        if self.cells == [1, 1] {
            return None;
        }
        let cells = self.cells.map(|side| side.div_ceil(2));
        let zeros = vec![0.0; cells[0] * cells[1]];
        let (mut pixels, mut area, mut complete) = (zeros.clone(), zeros, vec![true; cells[0] * cells[1]]);
        for cell in 0..self.pixels.len() {
            let parent = self.parent(cell);
            pixels[parent] += self.pixels[cell];
            area[parent] += self.area[cell];
            complete[parent] &= self.complete[cell];
        }
        Some(Self { cell_px: 2 * self.cell_px, cells, pixels, area, complete })
    }

    /// What the stated error of a cell is multiplied with where pixels are left out: of what counts,
    /// the noise of the sum is taken to be that of all. `None` where too many are.
    pub fn stretch(&self, cell: usize) -> Option<f64> {
        let (counted, all) = (self.pixels[cell], self.area[cell]);
        (all - counted <= LARGEST_LEFT_OUT * all).then(|| all / counted)
    }

    /// The cell of [`Self::coarser`] that a cell is a part of.
    pub fn parent(&self, cell: usize) -> usize {
        let (x, y) = (cell % self.cells[0], cell / self.cells[0]);
        y / 2 * self.cells[0].div_ceil(2) + x / 2
    }
}
