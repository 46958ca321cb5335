//! Levels of lamps: the same lumens whatever their shape.

use crate::common::{illuminance, metered, read_seeded};
use crate::record::Record;
use etalon::integrator::Integrator;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// All of them shine as a black body of 6500 K.
fn lamp(level: Value) -> Value {
    json!({ "spectrum": { "blackbody": { "temperature_k": 6500 } }, "level": level })
}

/// The lamp of a household: 27 W at 62.963 lm/W.
fn household() -> Value {
    lamp(json!({ "electrical_power": { "power_w": 27, "efficacy_lm_per_w": 62.963 } }))
}

// Case 10. Flat lamps of 2 cm are seen from 1 m: what their extent takes away is below 1.4e-4.
pub fn lamps_of_every_shape_agree_on_their_lumens(record: &mut Record) {
    let hundred = lamp(json!({ "flux_lm": 100 }));
    for (name, emission, round, flat) in
        [("27 W", household(), 135.28, 541.13), ("100 lm", hundred, 7.958, 31.831)]
    {
        for (shape, object) in shapes() {
            let mut object = object.clone();
            object["emission"] = emission.clone();
            let truth = if shape == "sphere" { round } else { flat };
            compare(record, &format!("{name}, {shape}"), json!([object]), json!([]), truth);
        }
        for (distribution, described, truth) in distributions(round, flat) {
            let mut point = json!({ "point": { "position": [0, 0, 0], "emission": emission } });
            if let Some(described) = described {
                point["point"]["distribution"] = described;
            }
            compare(record, &format!("{name}, point, {distribution}"), json!([]), json!([point]), truth);
        }
    }
    let scene = metered(
        json!({}),
        json!([]),
        json!([{ "point": { "position": [0, 0, 0], "emission": household() } }]),
        json!([]),
    );
    record.relative("lumens of 27 W at 62.963 lm/W", scene.emitters[0].luminous_flux.0, 1700.0, 1e-5);
}

/// Illuminance 1 m away along the axis, lx, to the 0.1 % that shapes may differ by.
fn compare(record: &mut Record, what: &str, objects: Value, lights: Value, truth: f64) {
    let materials = json!({ "black": { "lambertian": { "reflectance": 0 } } });
    let scene = metered(materials, objects, lights, illuminance([0., 1., 0.], [0., -1., 0.]));
    let reading = read_seeded(&scene, Integrator::Path, record.samples(1 << 16), record.seed());
    record.relative(format!("{what}, lx"), reading.photometric.mean, truth, 1e-3);
    record.exactly(format!("{what}: samples that are no numbers"), reading.faults.count, 0);
}

/// Shapes of a centimetre or two that look along +y.
fn shapes() -> Vec<(&'static str, Value)> {
    let quad = json!([[-0.01, 0, -0.01], [-0.01, 0, 0.01], [0.01, 0, 0.01], [0.01, 0, -0.01]]);
    let of = |shape: Value| json!({ "shape": shape, "material": "black" });
    vec![
        ("sphere", of(json!({ "sphere": { "center": [0, 0, 0], "radius": 0.01 } }))),
        ("disk", of(json!({ "disk": { "center": [0, 0, 0], "normal": [0, 1, 0], "radius": 0.01 } }))),
        ("quad", of(json!({ "quad": { "vertices": quad } }))),
        ("mesh", of(json!({ "mesh": { "vertices": quad, "triangles": [[0, 1, 2], [0, 2, 3]] } }))),
    ]
}

/// Intensity distributions of a point; the measured one is a cosine at every degree.
fn distributions(round: f64, flat: f64) -> Vec<(&'static str, Option<Value>, f64)> {
    let angles: Vec<f64> = (0..=90).map(f64::from).collect();
    let cosines: Vec<f64> = angles.iter().map(|angle| (angle / 180.0 * PI).cos().max(0.0)).collect();
    let profile =
        json!({ "profile": { "axis": [0, 1, 0], "angles_deg": angles, "relative_intensity": cosines } });
    vec![
        ("isotropic", None, round),
        ("cosine", Some(json!({ "cosine": { "axis": [0, 1, 0] } })), flat),
        ("measured profile", Some(profile), flat),
    ]
}
