//! Dispersion that is nothing, and next to nothing.

use crate::common::{instrument_plan, luminance, metered, read_seeded, refusals};
use crate::record::Record;
use etalon::camera::Sensor;
use etalon::geometry::Ray;
use etalon::integrator::{Draw, Integrator, Tracer};
use etalon::path::{Eye, Subpaths};
use etalon::sampler::{BlockSampler, Stream};
use etalon::scene::{MeterKind, Scene};
use serde_json::{Value, json};

/// Index at the d line of all glasses here.
const ND: f64 = 1.5168;

/// A white lamp seen aslant through a plate of glass.
fn plate(index: &Value) -> Scene {
    let materials = json!({ "glass": { "dielectric": { "index": index } }, "black": { "lambertian": { "reflectance": 0 } } });
    let objects = json!([
        { "shape": { "box": { "min": [-9, -9, 0], "max": [9, 9, 0.2] } }, "material": "glass" },
        { "shape": { "disk": { "center": [0, 0, 2], "normal": [0, 0, -1], "radius": 6 } }, "material": "black",
          "emission": { "spectrum": "cie-e", "level": { "luminance_cd_m2": 1000 } } }
    ]);
    metered(materials, objects, json!([]), luminance([0., 0., -1.], [0.5, 0.2, 1.]))
}

fn read(scene: &Scene, record: &Record) -> [f64; 3] {
    read_seeded(scene, Integrator::Path, record.samples(1 << 17), record.seed()).xyz
}

/// Luminance of each of many paths.
fn luminances(scene: &Scene, record: &Record) -> Vec<f64> {
    let sensor = Sensor::cie();
    let plan = instrument_plan(scene, &sensor);
    let MeterKind::Luminance { position, direction } = scene.meters[0].kind else {
        panic!("a luminance meter")
    };
    let tracer = Tracer::new(scene, &plan, Eye::Radiance(Ray::new(position, direction)));
    let size = record.samples(1 << 15) as u32;
    let numbers = BlockSampler::new(record.seed(), 16, 0, size);
    let mut paths = Subpaths::default();
    let mut one = |index| {
        let sampler = numbers.sample(index);
        let wavelengths = plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
        let draw = Draw { position: [0.5; 2], wavelengths: &wavelengths, sampler: &sampler };
        let mut luminous = 0.0;
        let put = |channel, value| luminous += if channel == 1 { value } else { 0.0 };
        sensor.record(tracer.gather(&draw, &mut paths), &wavelengths, put);
        luminous
    };
    (0..size).map(&mut one).collect()
}

fn variance(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64
}

// Case 16.
pub fn glass_without_dispersion_keeps_all_wavelengths(record: &mut Record) {
    let constant = plate(&json!(ND));
    let (xyz, scatter) = (read(&constant, record), variance(&luminances(&constant, record)));
    let table = json!({ "table": { "wavelengths_nm": [300, 900], "n": [ND, ND] } });
    for (name, index) in [
        ("Abbe number 1e12", json!({ "abbe": { "nd": ND, "vd": 1e12 } })),
        ("Cauchy with b = 0", json!({ "cauchy": { "a": ND, "b_um2": 0 } })),
        ("a flat table", table),
    ] {
        let scene = plate(&index);
        for (channel, (value, truth)) in
            ["X", "Y", "Z"].into_iter().zip(read(&scene, record).into_iter().zip(xyz))
        {
            record.relative(
                format!("{name}: {channel} over that of a constant index"),
                value / truth,
                1.0,
                1e-3,
            );
        }
        let ratio = variance(&luminances(&scene, record)) / scatter;
        record.at_most(format!("{name}: variance over that of a constant index"), ratio, 1.05);
    }
    record.note("No Abbe number stands for “none”: 0 is refused, and JSON has no infinity.");
    for (name, vd, says) in
        [("zero", "0", "the Abbe number 0 is not positive"), ("infinite", "1e999", "too large")]
    {
        let scene = format!(
            "{{\n\"name\": \"glass\", \"length_unit\": \"m\",\n\"materials\": {{\"glass\": {{\"dielectric\": {{\n\"index\": {{\"abbe\": {{\"nd\": 1.5, \"vd\": {vd}}}}}}}}}}}\n}}\n"
        );
        let (code, _, error) = refusals::check(&format!("abbe-{name}"), &scene);
        record.exactly(format!("exit code for an Abbe number of {vd}"), code.unwrap_or(-1), 2);
        record.says(format!("Abbe number {vd}"), &error, says);
    }
}

// Case 17. Shares of Fresnel differ by 1e-5 between the ends of the spectrum: nothing beside the noise.
pub fn a_trace_of_dispersion_changes_no_mean(record: &mut Record) {
    let (none, trace) = (plate(&json!(ND)), plate(&json!({ "abbe": { "nd": ND, "vd": 1e4 } })));
    let [a, b] = [&trace, &none].map(|scene| {
        let samples = record.samples(1 << 20);
        read_seeded(scene, Integrator::Path, samples, record.seed())
    });
    let [one, other] = [&a, &b].map(|reading| [reading.photometric.mean, reading.photometric.standard_error]);
    record.same_mean("luminance with Abbe number 1e4, and without dispersion", one, other, 1e-3);
    let [one, other] = [&a, &b].map(|reading| [reading.radiant.mean, reading.radiant.standard_error]);
    record.same_mean("radiance with Abbe number 1e4, and without dispersion", one, other, 1e-3);
    let [with, without] = [&trace, &none].map(|scene| variance(&luminances(scene, record)));
    record.note(format!(
        "The hero goes on alone where indices differ at all: the variance of a path through the plate is \
         {:.2} times that of all {} wavelengths together, which share their stratification.",
        with / without,
        etalon::spectrum::LANES
    ));
    record.holds("the hero goes on alone", with > 1.05 * without);
}
