//! Bodies whose index is that of their surroundings.

use crate::common::hemisphere::Random;
use crate::common::{luminance, metered, read_seeded};
use crate::record::Record;
use etalon::integrator::{Integrator, Reading};
use etalon::material::fresnel::dielectric;
use etalon::material::{Bsdf, Interface, Quantity};
use etalon::spectrum::Spectrum;
use serde_json::{Value, json};

/// A luminance behind where a ball of a material is, or is not.
fn behind(ball: Option<Value>, samples: u64, seed: u64) -> Reading {
    let mut materials = json!({ "shell": { "lambertian": { "reflectance": 0 } } });
    let mut objects =
        vec![json!({ "shape": { "sphere": { "center": [0, 0, 0], "radius": 3 } }, "material": "shell",
        "emission": { "spectrum": "d65", "level": { "luminance_cd_m2": 100 }, "two_sided": true } })];
    if let Some(material) = ball {
        materials["ball"] = material;
        objects
            .push(json!({ "shape": { "sphere": { "center": [0, 0, 0], "radius": 1 } }, "material": "ball" }));
    }
    let meter = luminance([0.2, 0.55, -2.0], [0.0, 0.0, 1.0]);
    read_seeded(&metered(materials, json!(objects), json!([]), meter), Integrator::Path, samples, seed)
}

// Case 23.
pub fn a_body_of_index_one_is_not_there(record: &mut Record) {
    let samples = record.samples(1 << 14);
    let without = behind(None, samples, record.seed());
    let same = json!({ "dielectric": { "index": 1.33, "outside_index": 1.33 } });
    for (name, ball) in [("of index 1", json!({ "dielectric": { "index": 1 } })), ("of water in water", same)]
    {
        let with = behind(Some(ball), samples, record.seed());
        record.relative(
            format!("luminance through a ball {name}"),
            with.photometric.mean,
            without.photometric.mean,
            1e-6,
        );
    }
    for cosine in [1.0, 0.3, 1e-10, 0.0] {
        record.exactly(format!("R at cos {cosine}"), dielectric(cosine, 0.0).reflected, 0.0);
    }
}

/// Draws of the 24th case by day.
const DRAWS: u64 = 10_000_000;

// Case 24.
pub fn a_rough_body_of_index_one_is_not_there(record: &mut Record) {
    for alpha in [1e-4, 0.3, 1.0] {
        let nothing = Bsdf::dielectric(Interface::new(Spectrum::ONE), alpha);
        let mut random = Random(record.seed() ^ 24);
        let (mut others, mut not_finite, mut weights) = (0_u64, 0_u64, 0.0);
        let draws = DRAWS / 3;
        for _ in 0..draws {
            let wo = random.on_sphere();
            let Some(s) = nothing.sample(wo, random.uniform(), random.pair(), Quantity::Radiance) else {
                continue;
            };
            let weight = s.value / s.pdf;
            weights += f64::from(weight.hero());
            not_finite += u64::from(!weight.is_finite() || !s.wi.is_finite());
            others += u64::from(s.wi != -wo || !s.is_delta || !s.is_transmission);
        }
        record.exactly(format!("alpha {alpha}: draws that are no numbers, of {draws}"), not_finite, 0);
        record.exactly(format!("alpha {alpha}: draws other than straight through"), others, 0);
        record.absolute(format!("alpha {alpha}: mean weight"), weights / draws as f64, 1.0, 1e-4);
    }
    let ball = json!({ "dielectric": { "index": 1, "roughness_alpha": 0.3 } });
    let reading = behind(Some(ball), record.samples(1 << 16), record.seed());
    record.relative("furnace behind a rough ball of index 1, cd/m2", reading.photometric.mean, 100.0, 1e-4);
}
