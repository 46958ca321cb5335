//! Spectra: carried by paths as lanes, described by curves, tabulated in `spectra/`.
//!
//! A [`Curve`] or [`RefractiveIndex`] is what a user or a table says, in f64. Transport
//! sees only [`Dense`] curves on the 1 nm grid, read at the [`Wavelengths`] of a path.

mod blackbody;
pub mod colour;
mod csv;
mod curve;
mod dense;
mod index;
mod lanes;
pub mod library;
mod wavelengths;

pub use blackbody::{ln_planck, planck_w_m2_sr_m};
pub use csv::CsvTable;
pub use curve::{Curve, Outside, Table};
pub use dense::Dense;
pub use index::{C_NM, D_NM, F_NM, RefractiveIndex};
pub use lanes::{LANES, Spectrum};
pub use wavelengths::{FIRST_NM, GRID_POINTS, LAST_NM, WavelengthSampler, Wavelengths, grid_nm};
