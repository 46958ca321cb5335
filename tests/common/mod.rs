//! What the tests share: scenes from text, readings, and the judgement of a statistical one.
#![allow(dead_code, reason = "each test program uses its own part")]

pub mod alone;
pub mod chi_squared;
pub mod contributions;
pub mod facets;
pub mod hemisphere;
pub mod program;
pub mod refusals;
pub mod rooms;
pub mod runs;
pub mod scaling;
pub mod scenes;

use etalon::camera::Sensor;
use etalon::geometry::SurfacePoint;
use etalon::integrator::{Draw, Integrator, Reading, Tracer, read_meters};
use etalon::path::{Eye, Strategies, Subpaths};
use etalon::sampler::{Sampler, Stream};
use etalon::scene::{Plan, Scene};
use etalon::spectrum::{Spectrum, Wavelengths};
use serde_json::{Value, json};
use std::path::Path;

/// Largest |z| of a passing statistical test: a false alarm once in 1.7 million.
pub const SIGMAS: f64 = 5.0;

/// A scene from its JSON; paths in it are relative to the project's root.
pub fn scene(json: &Value) -> Scene {
    Scene::from_text(&json.to_string(), Path::new(env!("CARGO_MANIFEST_DIR")))
        .unwrap_or_else(|error| panic!("{error}\n{json:#}"))
}

/// A scene without camera: materials, objects, lights and meters.
pub fn metered(materials: Value, objects: Value, lights: Value, meters: Value) -> Scene {
    scene(&json!({
        "name": "test", "length_unit": "m", "materials": materials, "objects": objects, "lights": lights,
        "meters": meters,
    }))
}

/// The reading of a scene's only meter, by path tracing.
pub fn read_one(scene: &Scene, samples: u64) -> Reading {
    read_with(scene, Integrator::Path, samples)
}

/// The reading of a scene's only meter.
pub fn read_with(scene: &Scene, integrator: Integrator, samples: u64) -> Reading {
    read_seeded(scene, integrator, samples, 1)
}

/// The reading of a scene's only meter, with the seed of its random numbers.
pub fn read_seeded(scene: &Scene, integrator: Integrator, samples: u64, seed: u64) -> Reading {
    let mut readings = read_meters(scene, integrator, samples, seed);
    assert_eq!(readings.len(), 1);
    readings.remove(0)
}

/// Asserts that a reading holds the truth within [`SIGMAS`], and that it is precise enough
/// for that to mean something: its standard error is below `relative` of the truth.
pub fn assert_reads(what: &str, reading: &Reading, truth: f64, relative: f64) {
    let (mean, error) = (reading.photometric.mean, reading.photometric.standard_error);
    assert!(error <= relative * truth.abs(), "{what}: too noisy to judge: {mean} +- {error}, truth {truth}");
    // Deterministic estimates have no scatter; what remains is rounding.
    let allowed = SIGMAS * error + 2e-5 * truth.abs();
    assert!(
        (mean - truth).abs() <= allowed,
        "{what}: {mean} +- {error}, truth {truth} (off by {:.3} %)",
        100.0 * (mean / truth - 1.0)
    );
    assert_eq!(reading.faults.count, 0, "{what}");
}

/// The plan of path tracing for instruments.
pub fn instrument_plan(scene: &Scene, sensor: &Sensor) -> Plan {
    let mut plan = Plan::of(scene, sensor, Strategies::PATH);
    plan.strategies = plan.strategies.for_instruments();
    plan
}

/// One sample of irradiance at a point, in W m^-2 nm^-1.
pub fn irradiance(
    scene: &Scene,
    plan: &Plan,
    point: SurfacePoint,
    wavelengths: &Wavelengths,
    sampler: &Sampler,
) -> Spectrum {
    let position = sampler.pair(Stream::Pixel, 0).map(f64::from);
    let draw = Draw { position, wavelengths, sampler };
    Tracer::new(scene, plan, Eye::Irradiance(point)).gather(&draw, &mut Subpaths::default())
}

/// A meter for illuminance.
pub fn illuminance(position: [f64; 3], normal: [f64; 3]) -> Value {
    json!([{ "illuminance": { "name": "meter", "position": position, "normal": normal } }])
}

/// A meter for luminance.
pub fn luminance(position: [f64; 3], direction: [f64; 3]) -> Value {
    json!([{ "luminance": { "name": "meter", "position": position, "direction": direction } }])
}
