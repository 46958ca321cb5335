//! Spectra: carried by paths as lanes, described by curves, tabulated in `spectra/`.
//!
//! A [`Curve`], [`LampSpectrum`] or [`RefractiveIndex`] is what a user or a table says, in f64.
//! Transport sees only [`Dense`] curves on the 1 nm grid, and the lines of an [`Emission`] that
//! have no width, read at the [`Wavelengths`] of a path.

mod blackbody;
pub mod colour;
mod csv;
mod curve;
mod dense;
mod emission;
mod index;
mod lamp;
mod lanes;
pub mod library;
mod wavelengths;

pub use blackbody::{ln_planck, planck_w_m2_sr_m};
pub use csv::CsvTable;
pub use curve::{Curve, Outside, Table};
pub use dense::Dense;
pub use emission::Emission;
pub use index::{C_NM, D_NM, F_NM, RefractiveIndex};
pub use lamp::{LampSpectrum, Line};
pub use lanes::{LANES, Spectrum};
pub use wavelengths::{
    FIRST_NM, GRID_POINTS, LAST_NM, WavelengthSampler, Wavelengths, between_grid_points, grid_nm,
};
