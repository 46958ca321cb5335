//! Materials turned and taken apart; directions, random numbers and quadrature are shared.

use etalon::material::{Bsdf, Interface, RoughDielectric, SmoothDielectric};
use etalon::spectrum::{LANES, Spectrum};
use glam::Vec3A;

pub use crate::common::hemisphere::*;

/// The interface of a dielectric.
pub fn interface_of(bsdf: &Bsdf) -> Option<Interface> {
    match bsdf {
        Bsdf::SmoothDielectric(model) => Some(model.interface),
        Bsdf::RoughDielectric(model) => Some(model.interface),
        _ => None,
    }
}

/// The same material with `lane` as the hero and the others moved round.
pub fn with_hero(bsdf: &Bsdf, lane: usize) -> Bsdf {
    let turn = |s: Spectrum| Spectrum::from_fn(|i| s[(i + lane) % LANES]);
    let mut turned = *bsdf;
    match &mut turned {
        Bsdf::Lambertian(model) => model.reflectance = turn(model.reflectance),
        Bsdf::Mirror(model) => model.reflectance = turn(model.reflectance),
        Bsdf::SmoothConductor(metal) => (metal.n, metal.k) = (turn(metal.n), turn(metal.k)),
        Bsdf::RoughConductor(model) => {
            let metal = &mut model.metal;
            (metal.n, metal.k) = (turn(metal.n), turn(metal.k));
        }
        Bsdf::SmoothDielectric(SmoothDielectric { interface })
        | Bsdf::RoughDielectric(RoughDielectric { interface, .. }) => {
            *interface = Interface::from_excess(turn(interface.excess()));
        }
    }
    turned
}

/// n(wo side) / n(wi side), squared, at the hero: the factor of radiance that crosses.
pub fn radiance_factor(bsdf: &Bsdf, wo: Vec3A, wi: Vec3A) -> f64 {
    let Some(interface) = interface_of(bsdf) else { return 1.0 };
    let eta = 1.0 + f64::from(interface.excess().hero());
    match (wo.z > 0.0, wi.z > 0.0) {
        (true, false) => 1.0 / (eta * eta),
        (false, true) => eta * eta,
        _ => 1.0,
    }
}
