//! Etalon.
#![warn(missing_docs)]
pub mod geometry;
pub mod material;
pub mod spectrum;
