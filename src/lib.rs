//! Etalon.
#![warn(missing_docs)]
pub mod camera;
pub mod error;
pub mod geometry;
pub mod image;
pub mod integrator;
pub mod light;
pub mod material;
pub mod python;
pub mod sampler;
pub mod scene;
pub mod spectrum;
pub mod statistics;
pub mod units;
