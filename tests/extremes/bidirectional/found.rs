//! Paths that no strategy makes, and the lamp's size that makes them.

use crate::common::program::{folder, render};
use crate::common::{luminance, read_with, scene};
use crate::record::Record;
use etalon::integrator::Integrator;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Reflectance of the mirror and of the floor.
const MIRROR: f64 = 0.9;
const FLOOR: f64 = 0.5;

/// A matte floor at y = 0 beside a mirror wall at x = 4 mm.
fn corner() -> (Value, Value) {
    let materials = json!({
        "mirror": { "mirror": { "reflectance": MIRROR } },
        "floor": { "lambertian": { "reflectance": FLOOR } },
        "black": { "lambertian": { "reflectance": 0 } },
    });
    let objects = json!([
        { "shape": { "quad": { "vertices": [[-100, 0, -100], [-100, 0, 100], [4, 0, 100], [4, 0, -100]] } }, "material": "floor" },
        { "shape": { "quad": { "vertices": [[4, 0, -100], [4, 0, 100], [4, 100, 100], [4, 100, -100]] } }, "material": "mirror" },
    ]);
    (materials, objects)
}

// Case 57.
pub fn light_that_no_strategy_finds_is_named_and_refused(record: &mut Record) {
    let (materials, objects) = corner();
    let scene = json!({
        "name": "mirror box", "length_unit": "mm", "materials": materials, "objects": objects,
        "lights": [{ "point": { "position": [2, 4, 0], "emission": { "spectrum": "d65", "level": { "flux_lm": 1 } } } }],
        "camera": { "position": [2, 3, 5], "look_at": [8, 0, 0], "up": [0, 1, 0], "focal_length_mm": 30,
            "sensor_mm": [24, 24], "resolution": [8, 8], "f_stop": 2, "shutter_s": 0.01, "iso": 100 },
    });
    let folder = folder("extremes-unreachable");
    for integrator in ["path", "light", "bdpt", "mlt"] {
        let strict = render(&scene, &folder, &format!("--spp 1 --integrator {integrator} --strict"));
        record.exactly(format!("{integrator}: exit code under --strict"), strict.code, 3);
        record.says(format!("{integrator}: the class"), &strict.err, "(L S+ (D S+)+ E)");
        record.holds(format!("{integrator}: no picture is written"), !folder.join("out.exr").exists());
    }
}

// Case 57.
pub fn a_lamp_of_one_millimetre_in_a_mirror_lights_as_its_image_does(record: &mut Record) {
    const LUMINANCE: f64 = 1000.0;
    let (materials, mut objects) = corner();
    objects.as_array_mut().expect("a list").push(json!({
        "shape": { "sphere": { "center": [2, 4, 0], "radius": 1 } }, "material": "black",
        "emission": { "spectrum": "d65", "level": { "luminance_cd_m2": LUMINANCE } } }));
    // By way of the mirror the meter sees the floor's origin, which lamp and image light.
    let scene =
        scene(&json!({ "name": "test", "length_unit": "mm", "materials": materials, "objects": objects,
        "meters": luminance([2.0, 3.0, 5.0], [6.0, -3.0, -5.0]) }));
    // A sphere above the horizon lights by pi L r^2 cos / d^2 = pi L r^2 h / d^3.
    let lit_from = |x: f64, y: f64| PI * LUMINANCE * y / (x * x + y * y).powf(1.5);
    let seen = |illuminance: f64| MIRROR * FLOOR / PI * illuminance;
    let (direct, image) = (seen(lit_from(2.0, 4.0)), seen(MIRROR * lit_from(6.0, 4.0)));
    for integrator in [Integrator::Path, Integrator::Bdpt] {
        let reading = read_with(&scene, integrator, record.samples(1 << 22)).photometric;
        let by_image = reading.mean - direct;
        let what = format!("{}: light by way of the image, cd/m2", integrator.name());
        record.mean(format!("{what} and direct"), reading.mean, reading.standard_error, direct + image, 2e-3);
        record.relative(what, by_image, image, 1e-2);
    }
}
