//! What surfaces do with light.
//!
//! [`Material`] is a surface's description, resolved once when the scene is built;
//! [`Bsdf`] is that description at the wavelengths of one path. The contract of every
//! model, in the local frame whose z axis is the shading normal:
//!
//! * `wo` is where the path came from, `wi` where it goes on; both point away from the
//!   surface, both have unit length.
//! * `eval` gives f(wo, wi) |cos(wi)| per lane, `pdf` the density of `wi` per solid angle
//!   *per lane* (each lane's own density, were it the hero), `sample` draws `wi` with the
//!   hero's density and gives the same two things side by side.
//! * Where a model is a Dirac delta, `eval` and `pdf` are zero; `sample` gives the deltas'
//!   coefficients.
//! * Radiance is scaled by the squared ratio of refractive indices when it crosses an
//!   interface, importance is not ([`Quantity`]).
//! * `sample` may draw nothing; then the integral of `pdf` falls short of one by exactly
//!   the probability of that.
//! * A direction in the plane of the surface carries nothing.
//!
//! Lobes of microfacets are scattered once: light that meets a second facet is lost. The
//! table in [`ggx`] says how much.

mod bsdf;
mod facing;
pub mod fresnel;
pub mod ggx;
mod interface;
mod lambertian;
mod mirror;
mod rough_conductor;
mod rough_dielectric;
mod smooth_conductor;
mod smooth_dielectric;
mod specimens;
mod surface;

pub use bsdf::{Bsdf, BsdfSample, BsdfValue, Quantity};
pub use ggx::Ggx;
pub use interface::Interface;
pub use lambertian::Lambertian;
pub use mirror::Mirror;
pub use rough_conductor::RoughConductor;
pub use rough_dielectric::RoughDielectric;
pub use smooth_conductor::SmoothConductor;
pub use smooth_dielectric::SmoothDielectric;
pub use specimens::specimens;
pub use surface::Material;
