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
