//! Etalon.
#![warn(missing_docs)]
pub mod error;
pub mod geometry;
pub mod material;
pub mod spectrum;
pub mod units;
