//! Lamps that are tiny, far, without area, mirrored, or known in closed form.

use crate::common::{illuminance, metered, read_with};
use crate::record::Record;
use etalon::integrator::Integrator;
use etalon::scene::Scene;
use serde_json::{Value, json};
use std::f64::consts::PI;

fn materials() -> Value {
    json!({ "black": { "lambertian": { "reflectance": 0 } } })
}

fn lamp(shape: Value, luminance_cd_m2: f64) -> Value {
    json!({ "shape": shape, "material": "black",
        "emission": { "spectrum": "d65", "level": { "luminance_cd_m2": luminance_cd_m2 } } })
}

fn lit_by(object: Value, position: [f64; 3], normal: [f64; 3]) -> Scene {
    metered(materials(), json!([object]), json!([]), illuminance(position, normal))
}

/// Both ways of reading a meter.
const INTEGRATORS: [Integrator; 2] = [Integrator::Path, Integrator::Bdpt];

// Case 47.
pub fn a_tiny_lamp_far_away_lights_by_the_solid_angle_it_fills(record: &mut Record) {
    for (radius_m, distance_m, luminance) in
        [(1e-6_f64, 1e6_f64, 1e24), (1e-3, 1.0, 1e6), (1e-3, 1e3, 1e12), (0.9, 1.0, 1.0)]
    {
        let sphere = json!({ "sphere": { "center": [0, 0, distance_m], "radius": radius_m } });
        let scene = lit_by(lamp(sphere, luminance), [0.0; 3], [0.0, 0.0, 1.0]);
        // A sphere above the horizon: E = pi L sin^2.
        let truth = PI * luminance * (radius_m / distance_m).powi(2);
        for integrator in INTEGRATORS {
            let reading = read_with(&scene, integrator, record.samples(1 << 16));
            let what = format!(
                "{}, r = {radius_m:e} m at {distance_m:e} m, L = {luminance:e} cd/m2, lx",
                integrator.name()
            );
            record.relative(what, reading.photometric.mean, truth, 1e-3);
        }
    }
}

// Case 51.
pub fn emissive_triangles_without_area_are_dropped_and_counted(record: &mut Record) {
    let mesh = |degenerate: &[[u32; 3]]| {
        let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
        triangles.extend_from_slice(degenerate);
        lamp(
            json!({ "mesh": { "vertices": [[-0.5, -0.5, 1], [-0.5, 0.5, 1], [0.5, 0.5, 1], [0.5, -0.5, 1], [0, 0, 1]],
                "triangles": triangles } }),
            1000.0,
        )
    };
    let read = |degenerate: &[[u32; 3]], integrator| {
        let scene = lit_by(mesh(degenerate), [0.0; 3], [0.0, 0.0, 1.0]);
        let reading = read_with(&scene, integrator, 1 << 12);
        (reading.photometric.mean, reading.faults.count, scene)
    };
    for integrator in INTEGRATORS {
        let (truth, _, sound) = read(&[], integrator);
        let (mean, faults, scene) = read(&[[0, 0, 1], [0, 4, 2], [3, 3, 3]], integrator);
        let name = integrator.name();
        record.exactly(format!("{name}: dropped"), scene.geometry.degenerate_triangles(), 3);
        record.says(
            format!("{name}: the remark"),
            &scene.notes.join("; "),
            "3 triangles without area were left out",
        );
        record.exactly(format!("{name}: samples that are no number"), faults, 0);
        record.exactly(
            format!("{name}: flux, lm"),
            scene.emitters[0].luminous_flux.0,
            sound.emitters[0].luminous_flux.0,
        );
        record.exactly(format!("{name}: illuminance, lx"), mean, truth);
    }
}

// Case 54.
pub fn a_mirrored_lamp_shines_from_the_same_side(record: &mut Record) {
    let square = json!([[0.2, 0.0, 1.0], [0.2, 0.4, 1.0], [0.6, 0.4, 1.0], [0.6, 0.0, 1.0]]);
    let shapes = [
        ("quad", json!({ "quad": { "vertices": square } })),
        ("mesh", json!({ "mesh": { "vertices": square, "triangles": [[0, 1, 2], [0, 2, 3]] } })),
        ("disk", json!({ "disk": { "center": [0.4, 0.2, 1.0], "normal": [0, 0, -1], "radius": 0.2 } })),
        ("sphere", json!({ "sphere": { "center": [0.4, 0.2, 1.0], "radius": 0.2 } })),
    ];
    for (name, shape) in shapes {
        for (mirror, x, z) in
            [([-1.0, 1.0, 1.0], -1.0, 1.0), ([1.0, 1.0, -1.0], 1.0, -1.0), ([-1.0, -1.0, -1.0], -1.0, -1.0)]
        {
            let mut mirrored = lamp(shape.clone(), 1000.0);
            mirrored["transform"] = json!([{ "scale": mirror }]);
            // A meter on either side of the lamp's plane, where the image of the plain one is.
            let read = |object: Value, flip: [f64; 2], from: f64, up: f64| {
                let y = if flip[0] < 0.0 && mirror[1] < 0.0 { -0.2 } else { 0.2 };
                let scene = lit_by(object, [0.4 * flip[0], y, from * flip[1]], [0.0, 0.0, up * flip[1]]);
                read_with(&scene, Integrator::Path, 1 << 14).photometric.mean
            };
            let plain = read(lamp(shape.clone(), 1000.0), [1.0, 1.0], 0.0, 1.0);
            let seen = read(mirrored.clone(), [x, z], 0.0, 1.0);
            record.relative(format!("{name}, scale {mirror:?}: before it, lx"), seen, plain, 5e-3);
            if name != "sphere" {
                let behind = read(mirrored, [x, z], 2.0, -1.0);
                record.exactly(format!("{name}, scale {mirror:?}: behind it, lx"), behind, 0.0);
            }
        }
    }
}

// Case 56.
pub fn a_square_lamp_lights_by_its_form_factor(record: &mut Record) {
    let square =
        json!({ "quad": { "vertices": [[-0.5, -0.5, 1], [-0.5, 0.5, 1], [0.5, 0.5, 1], [0.5, -0.5, 1]] } });
    let scene = lit_by(lamp(square, 1000.0), [0.0; 3], [0.0, 0.0, 1.0]);
    // Four corners' rectangles a by b at height c: L/2 (a/p atan(b/p) + b/q atan(a/q)).
    let half: f64 = 0.5;
    let slant = half.hypot(1.0);
    let truth = 4.0 * 1000.0 * (half / slant) * (half / slant).atan();
    record.relative("closed form, lx", truth, 752.275, 1e-6);
    for integrator in INTEGRATORS {
        let reading = read_with(&scene, integrator, record.samples(1 << 17));
        let what = format!("{}: illuminance, lx", integrator.name());
        record.relative(what, reading.photometric.mean, truth, 1e-3);
    }
}
