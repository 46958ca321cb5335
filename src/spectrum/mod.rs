//! Spectra: carried by paths as lanes, described by curves, tabulated in `spectra/`.

mod lanes;

pub use lanes::{LANES, Spectrum};
