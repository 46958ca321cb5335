//! Curves as transport reads them: one value per nanometre, or one value in all.

use super::lanes::{LANES, Spectrum};
use super::wavelengths::{GRID_POINTS, Wavelengths, grid_nm};

/// Cells that a table has room for: a power of two, so that a masked index needs no check.
const CELLS: usize = GRID_POINTS.next_power_of_two();

/// A curve resampled onto the 1 nm grid; a flat curve is a single number.
#[derive(Clone, Debug, PartialEq)]
pub enum Dense {
    /// The same value at every wavelength.
    Flat(f32),
    /// Values at 360, 361, … 830 nm; linear between.
    Grid(Box<GridTable>),
}

/// Values at the grid points, and zeros behind them.
#[derive(Clone, Debug, PartialEq)]
pub struct GridTable([f32; CELLS + 1]);

impl GridTable {
    fn new(values: &[f32; GRID_POINTS]) -> Self {
        let mut table = Self([0.0; CELLS + 1]);
        table.0[..GRID_POINTS].copy_from_slice(values);
        table
    }

    fn values(&self) -> &[f32] {
        &self.0[..GRID_POINTS]
    }

    #[inline]
    fn at(&self, wavelengths: &Wavelengths) -> Spectrum {
        let ends = |lane: usize| {
            let cell = wavelengths.cell[lane] as usize & (CELLS - 1);
            [self.0[cell], self.0[cell + 1]]
        };
        let ends: [[f32; 2]; LANES] = std::array::from_fn(ends);
        Spectrum::from_fn(|lane| {
            let [a, b] = ends[lane];
            a + (b - a) * wavelengths.fraction[lane]
        })
    }
}

impl Dense {
    /// Samples a function of wavelength in nm at every grid point.
    pub fn from_fn(value_at_nm: impl Fn(f64) -> f64) -> Self {
        let values: Vec<f32> = grid_nm().map(|nm| value_at_nm(nm) as f32).collect();
        Self::from_values(&values)
    }

    /// From values at the grid points.
    ///
    /// # Panics
    /// If there are not [`GRID_POINTS`] of them.
    pub fn from_values(values: &[f32]) -> Self {
        if values.iter().all(|v| v.to_bits() == values[0].to_bits()) {
            return Self::Flat(values[0]);
        }
        Self::Grid(Box::new(GridTable::new(values.try_into().expect("one value per grid point"))))
    }

    /// The curve at the wavelengths of a path.
    #[inline]
    pub fn at(&self, wavelengths: &Wavelengths) -> Spectrum {
        match self {
            Self::Flat(value) => Spectrum::splat(*value),
            Self::Grid(table) => table.at(wavelengths),
        }
    }

    /// Value at a grid point given by its index.
    pub fn at_grid_point(&self, index: usize) -> f32 {
        match self {
            Self::Flat(value) => *value,
            Self::Grid(table) => table.values()[index],
        }
    }

    /// Whether the curve is the same everywhere.
    pub const fn is_flat(&self) -> bool {
        matches!(self, Self::Flat(_))
    }

    /// Whether the curve is zero everywhere.
    pub fn is_zero(&self) -> bool {
        *self == Self::Flat(0.0)
    }

    /// The curve times another, grid point by grid point.
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        let values: Vec<f32> =
            (0..GRID_POINTS).map(|i| self.at_grid_point(i) * other.at_grid_point(i)).collect();
        Self::from_values(&values)
    }

    /// The value at each grid point.
    pub fn values(&self) -> Vec<f32> {
        (0..GRID_POINTS).map(|i| self.at_grid_point(i)).collect()
    }

    /// The curve times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let times = |v: f32| (f64::from(v) * factor) as f32;
        match self {
            Self::Flat(value) => Self::Flat(times(*value)),
            Self::Grid(table) => {
                let values: Vec<f32> = table.values().iter().copied().map(times).collect();
                Self::from_values(&values)
            }
        }
    }
}
