//! Named examples of every model, over which the tests loop.

use super::{Bsdf, Ggx, Interface, Lambertian, Mirror, RoughConductor, SmoothConductor};
use crate::spectrum::Spectrum;

/// Every model in its ordinary and in its awkward forms.
pub fn specimens() -> Vec<(&'static str, Bsdf)> {
    let flat = |eta: f32| Interface::new(Spectrum::splat(eta));
    // Dense flint, exaggerated: hero in the middle of the visible range.
    let flint = Interface::new(Spectrum([1.62, 1.66, 1.64, 1.61, 1.60, 1.59, 1.65, 1.63]));
    // Two media whose indices cross, and meet at the hero.
    let crossing = Interface::from_excess(Spectrum([0.0, -0.02, -0.01, -1e-7, 1e-7, 0.01, 0.02, 0.03]));
    let ramp = Spectrum([0.5, 0.1, 0.9, 0.3, 0.7, 0.0, 1.0, 0.2]);
    let gold = Spectrum([0.25, 1.4, 0.9, 0.35, 0.2, 0.18, 1.3, 0.5]);
    let gold_k = Spectrum([2.8, 1.9, 1.8, 2.5, 3.1, 3.6, 1.85, 2.2]);
    let metal = SmoothConductor { n: gold, k: gold_k, two_sided: false };
    let brushed = RoughConductor { metal, facets: Ggx::anisotropic(0.1, 0.4) };
    vec![
        ("paint", Bsdf::Lambertian(Lambertian { reflectance: ramp, two_sided: false })),
        ("paper", Bsdf::Lambertian(Lambertian { reflectance: ramp, two_sided: true })),
        ("mirror", Bsdf::Mirror(Mirror { reflectance: ramp, two_sided: true })),
        ("glass", Bsdf::dielectric(flat(1.5), 0.0)),
        ("flint", Bsdf::dielectric(flint, 0.0)),
        ("bubble", Bsdf::dielectric(flat(1.0 / 1.33), 0.0)),
        ("nothing", Bsdf::dielectric(flat(1.0), 0.0)),
        ("ground nothing", Bsdf::dielectric(flat(1.0), 0.3)),
        ("nearly polished glass", Bsdf::dielectric(flat(1.5), 0.01)),
        ("satin glass", Bsdf::dielectric(flat(1.5), 0.1)),
        ("ground glass", Bsdf::dielectric(flat(1.5), 0.5)),
        ("roughest glass", Bsdf::dielectric(flat(1.5), 1.0)),
        ("ground bubble", Bsdf::dielectric(flat(1.0 / 1.33), 0.3)),
        ("ground flint", Bsdf::dielectric(flint, 0.3)),
        ("nearly matched", Bsdf::dielectric(flat(1.01), 0.3)),
        ("matched at the hero", Bsdf::dielectric(crossing, 0.5)),
        ("gold", Bsdf::conductor(gold, gold_k, 0.0, false)),
        ("nearly polished gold", Bsdf::conductor(gold, gold_k, 0.01, false)),
        ("satin gold", Bsdf::conductor(gold, gold_k, 0.2, true)),
        ("roughest gold", Bsdf::conductor(gold, gold_k, 1.0, false)),
        ("brushed gold", Bsdf::RoughConductor(brushed)),
    ]
}
