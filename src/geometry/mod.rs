//! Rays, frames, shapes, and the one structure that finds what a ray meets.
//!
//! Positions are in scene units: metres divided by a power of two that the scene builder
//! picks so that everything fits a box of about unit size. The scale of a scene therefore
//! changes no bit of a result.

mod frame;
mod ray;

pub use frame::Frame;
pub use ray::{Hit, Ray, SurfacePoint};
