//! Where tables end, and what is drawn.

use crate::common::{illuminance, metered, refusals};
use crate::record::Record;
use etalon::camera::Sensor;
use etalon::integrator::Integrator;
use etalon::material::Material;
use etalon::scene::{Plan, Scene};
use etalon::spectrum::colour::CIE_1931;
use etalon::spectrum::{Dense, FIRST_NM, GRID_POINTS, WavelengthSampler, between_grid_points, grid_nm};
use etalon::statistics::{BATCHES, BatchMean};
use serde_json::{Value, json};

/// Index of the grid point at a wavelength.
const fn point(nm: usize) -> usize {
    nm - 360
}

// Case 13.
pub fn gaps_of_a_table_are_told_with_what_fills_them(record: &mut Record) {
    record.note(
        "The share is that of the channel of the scene's sensor that loses most: of X, Y and Z, and \
         of the sensor's own channels.",
    );
    let table = json!({ "table": { "wavelengths_nm": [400, 700], "values": [0.25, 0.75] } });
    let materials = json!({ "paint": { "lambertian": { "reflectance": table } } });
    let scene = metered(materials, json!([]), lamp(&table), json!([]));
    let Material::Lambertian { reflectance, .. } = &scene.materials[0] else { panic!("matte") };
    record.exactly("reflectance at 360 nm, held from 400 nm", reflectance.at_grid_point(0), 0.25);
    record.exactly(
        "reflectance at 830 nm, held from 700 nm",
        reflectance.at_grid_point(GRID_POINTS - 1),
        0.75,
    );
    let shines = |nm: usize| continuum(&scene)[point(nm)] > 0.0;
    let edges = [399, 400, 700, 701].map(shines);
    record.exactly(
        "lamp shines at 399, 400, 700, 701 nm",
        format!("{edges:?}"),
        "[false, true, true, false]".into(),
    );
    let share = |(nm, value): (f64, &f64)| if (400.0..=700.0).contains(&nm) { 0.0 } else { *value };
    let uncovered = CIE_1931
        .matching
        .each_ref()
        .map(|m| 100.0 * grid_nm().zip(m).map(share).sum::<f64>() / m.iter().sum::<f64>());
    let most = uncovered.into_iter().fold(0.0, f64::max);
    for rule in ["its end values are held", "it counts as zero"] {
        let expected =
            format!("known from 400 to 700 nm; outside, with up to {most:.4} % of a channel's response (");
        let remark = scene.notes.iter().find(|note| note.ends_with(rule)).cloned().unwrap_or_default();
        record.says(format!("warning: {rule}"), &remark, &expected);
    }
    let index = "{\n\"name\": \"glass\", \"length_unit\": \"m\",\n\"materials\": {\"glass\": {\"dielectric\": {\n\
        \"index\": {\"table\": {\"wavelengths_nm\": [400, 700], \"n\": [1.52, 1.51]}}}}}\n}\n";
    let (code, _, error) = refusals::check("index-400-700", index);
    record.exactly("exit code for an index known from 400 to 700 nm", code.unwrap_or(-1), 2);
    record.says("what is said", &error, "the refractive index is known from 400 to 700 nm, not at 360 nm");
    record.says("where", &error, &refusals::place("index-400-700", index, "\"index\""));
}

fn lamp(spectrum: &Value) -> Value {
    json!([{ "point": { "position": [0, 0, 0], "emission": { "spectrum": spectrum, "level": { "flux_lm": 1 } } } }])
}

fn continuum(scene: &Scene) -> Vec<f64> {
    match scene.lights.get(0) {
        etalon::light::Light::Point(light) => light.intensity.at_grid_points().collect(),
        etalon::light::Light::Area(light) => light.radiance().at_grid_points().collect(),
    }
}

// Case 14.
pub fn every_wavelength_that_counts_is_drawn(record: &mut Record) {
    for lamp_name in ["d65", "cie-a", "fl11", "hp1", "led-b3"] {
        let scene =
            metered(json!({}), json!([]), lamp(&json!(lamp_name)), illuminance([0., 0., 1.], [0., 0., -1.]));
        let sampler = Plan::of(&scene, &Sensor::cie(), Integrator::Path.strategies()).wavelengths;
        integrals(record, lamp_name, &sampler, &continuum(&scene));
    }
    // Every pair of a lamp and a sensor, however little either has left at an end.
    let tail: Vec<f64> = grid_nm().map(|nm| if nm < 500.0 { 1e-30 } else { 1.0 }).collect();
    let tail = json!({ "table": { "wavelengths_nm": grid_nm().collect::<Vec<_>>(), "values": tail } });
    let lamps = [json!("d65"), tail, json!({ "blackbody": { "temperature_k": 800 } }), json!("led-rgb1")];
    let mut sensors = vec![Sensor::cie()];
    let built_in = etalon::spectrum::library::entries().filter(|entry| entry.kind == "sensitivity");
    sensors.extend(built_in.map(|entry| Sensor::named(entry.name).expect("built in")));
    let mut missed = 0;
    for lamp_spectrum in &lamps {
        let scene = metered(json!({}), json!([]), lamp(lamp_spectrum), json!([]));
        for sensor in &sensors {
            let sampler = Plan::of(&scene, sensor, Integrator::Path.strategies()).wavelengths;
            missed += unsupported(&sampler, &continuum(&scene), sensor);
        }
    }
    record.exactly(
        format!(
            "cells of {} lamps before {} sensors that shine and are never drawn",
            lamps.len(),
            sensors.len()
        ),
        missed,
        0,
    );
}

/// Integral of each matching function times a lamp, from a million wavelengths; the truth by
/// Simpson's rule within each cell, where both factors are linear.
fn integrals(record: &mut Record, name: &str, sampler: &WavelengthSampler, lamp: &[f64]) {
    let size = record.samples(1_000_000 / BATCHES as u64);
    let lamp_values: Vec<f32> = lamp.iter().map(|value| *value as f32).collect();
    let lamp_dense = Dense::from_values(&lamp_values);
    for (channel, matching) in ["X", "Y", "Z"].into_iter().zip(&CIE_1931.matching) {
        let matching_values: Vec<f32> = matching.iter().map(|value| *value as f32).collect();
        let response = Dense::from_values(&matching_values);
        let batch = |batch: usize| {
            let mut random = crate::common::hemisphere::Random(record.seed() << 8 | batch as u64);
            let one = |_| {
                let drawn = sampler.sample(random.uniform());
                f64::from((response.at(&drawn) * lamp_dense.at(&drawn) / drawn.density).mean())
            };
            (0..size).map(one).sum::<f64>() / size as f64
        };
        let found = BatchMean::of(&std::array::from_fn(batch));
        let truth: f64 = (0..GRID_POINTS - 1)
            .map(|cell| {
                let at = |t: f64| {
                    let nm = FIRST_NM + cell as f64 + t;
                    between_grid_points(matching, nm) * between_grid_points(lamp, nm)
                };
                (at(0.0) + 4.0 * at(0.5) + at(1.0)) / 6.0
            })
            .sum();
        record.mean(
            format!("integral of {channel} under {name}"),
            found.mean / truth,
            found.standard_error / truth,
            1.0,
            2e-3,
        );
    }
}

/// Cells of the grid at whose ends a lamp shines and a channel responds, that are never drawn.
fn unsupported(sampler: &WavelengthSampler, lamp: &[f64], sensor: &Sensor) -> usize {
    let seen = |index: usize| {
        lamp[index] > 0.0 && sensor.channels.iter().any(|c| c.response.at_grid_point(index) > 0.0)
    };
    (0..GRID_POINTS - 1)
        .filter(|&cell| {
            (seen(cell) || seen(cell + 1)) && sampler.pdf_per_nm(FIRST_NM + cell as f64 + 0.5) <= 0.0
        })
        .count()
}
