//! Rays, frames, shapes, and the one structure that finds what a ray meets.
//!
//! A [`Shape`] is what a user describes, in metres; a [`GeometryBuilder`] checks, places and
//! rounds shapes to [`Primitive`]s; the [`Geometry`] it builds answers rays.
//!
//! Positions are in scene units: metres divided by a power of two that the builder picks so
//! that everything fits a box of about unit size. The scale of a scene therefore changes no
//! bit of a result.

mod accelerate;
mod blueprint;
mod bounds;
mod builder;
mod coincident;
mod error;
mod frame;
mod mesh;
#[cfg(feature = "meshes")]
mod obj;
#[cfg(feature = "meshes")]
mod ply;
mod precise;
pub mod primitive;
mod ray;
mod shape;
mod specimens;
mod transform;
#[cfg(feature = "meshes")]
mod words;

pub use accelerate::Geometry;
pub use bounds::{Bounds, MetreBounds, unit_scale};
pub use builder::GeometryBuilder;
pub use error::{MeshFault, MeshFileError, ShapeError};
pub use frame::Frame;
pub use mesh::Mesh;
#[cfg(feature = "meshes")]
pub use obj::parse_obj;
#[cfg(feature = "meshes")]
pub use ply::parse_ply;
pub use precise::{Meeting, PreciseRay};
pub use primitive::Primitive;
pub use ray::{Hit, Ray, SurfacePoint};
pub use shape::Shape;
pub use specimens::{icosphere, specimens};
pub use transform::Transform;
