//! Rooms that lose nothing, and rooms that lose a little.

use crate::common::program::{Ran, etalon, folder, json_file, scene_file};
use crate::common::scene;
use crate::record::Record;
use etalon::integrator::{Bounded, Integrator};
use etalon::path::Eye;
use etalon::scene::{Plan, closure};
use serde_json::{Value, json};
use std::path::Path;

fn camera(position: [f64; 3], look_at: [f64; 3]) -> Value {
    json!({ "position": position, "look_at": look_at, "up": [0.1, 1, 0], "focal_length_mm": 50,
        "sensor_mm": [36, 36], "resolution": [16, 16], "iso": 100, "shutter_s": 0.01, "f_stop": 1 })
}

fn point_lamp(position: [f64; 3]) -> Value {
    json!([{ "point": { "position": position, "emission": { "spectrum": 1, "level": { "flux_lm": 1700 } } } }])
}

fn ball(radius: f64, material: &str) -> Value {
    json!({ "shape": { "sphere": { "center": [0, 0, 0], "radius": radius } }, "material": material })
}

fn file(objects: Value, lights: Value, camera: Value) -> Value {
    json!({
        "name": "closed", "length_unit": "m",
        "materials": {
            "white": { "lambertian": { "reflectance": 1 } },
            "paint": { "lambertian": { "reflectance": 0.999 } },
            "black": { "lambertian": { "reflectance": 0 } },
            "mirror": { "mirror": { "reflectance": 1 } },
            "crown": { "dielectric": { "index": 1.5 } },
            "flint": { "dielectric": { "index": "n-sf11" } },
        },
        "objects": objects, "lights": lights, "camera": camera,
    })
}

fn inside() -> Value {
    camera([0.1, 0.2, -0.6], [0.3, 0.5, 0.5])
}

/// A white ball that shines inside and outside.
fn shining() -> Value {
    let mut ball = ball(1.0, "white");
    ball["emission"] =
        json!({ "spectrum": 1, "level": { "spectral_radiance_factor": 1 }, "two_sided": true });
    ball
}

fn render(scene: &Path, integrator: &str, strict: bool) -> (Ran, Value) {
    let folder = scene.parent().expect("in a folder");
    let [exr, report] = ["out.exr", "report.json"].map(|name| folder.join(name));
    let _ = std::fs::remove_file(&exr);
    let mut words = vec!["render".into(), scene.into(), "-o".into(), exr.clone()];
    words.extend(["--spp", "4", "--integrator", integrator, "--report"].map(Into::into));
    words.push(report.clone());
    if strict {
        words.push("--strict".into());
    }
    let ran = etalon(words);
    assert!(exr.is_file(), "{integrator}: the picture is written: {}", ran.err);
    let facts = json_file(&report);
    (ran, facts)
}

/// Seconds within which a render of 1024 samples without a value must end.
const PATIENCE_S: f64 = 60.0;

// Case 40.
pub fn light_between_lossless_walls_is_cut_off_and_said(record: &mut Record) {
    let centre = || point_lamp([0.0; 3]);
    let scenes: [(&str, Value, &[&str]); 4] = [
        ("shining wall", file(json!([shining()]), json!([]), inside()), &["path", "light", "bdpt", "mlt"]),
        (
            "point lamp",
            file(json!([ball(1.0, "white")]), centre(), inside()),
            &["path", "light", "bdpt", "mlt"],
        ),
        ("flint in it", file(json!([shining(), ball(0.2, "flint")]), json!([]), inside()), &["path", "bdpt"]),
        // No light is asked for through the glass: only joints of both walks find any.
        (
            "lamp in glass",
            file(json!([ball(1.0, "white"), ball(0.2, "crown")]), centre(), inside()),
            &["bdpt"],
        ),
    ];
    for (index, (name, text, integrators)) in scenes.iter().enumerate() {
        let folder = folder(&format!("extremes-closed-{index}"));
        let scene = scene_file(&folder, text);
        for integrator in *integrators {
            // Where classes of paths are missing --strict does not render at all.
            let strict = index < 2;
            let (ran, facts) = render(&scene, integrator, strict);
            let what = format!("{name}, {integrator}");
            record.at_most(format!("{what}: seconds"), ran.seconds, PATIENCE_S);
            let code = if strict { 3 } else { 0 };
            record.exactly(format!("{what}: exit code, strict {strict}"), ran.code, code);
            record.says(format!("{what}: message"), &ran.err, "energy truncated >= ");
            let share = &facts["truncation"]["energy_truncated_at_least"];
            let share = share.as_f64().unwrap_or(f64::NAN);
            // Half of what the wall shines with leaves on its outside: of 1024 walks from it half
            // are cut off, with a standard error of 1/64, and the bound is 1.6 of these below.
            let least = if what == "shining wall, light" { 0.39 } else { 0.99 };
            record.at_least(format!("{what}: share truncated"), share, least);
        }
    }
}

/// A room of 2 m with a square opening of 0.2 m in its wall at z = 1.
fn room_with_a_window() -> Value {
    let wall =
        |corners: [[f64; 3]; 4]| json!({ "shape": { "quad": { "vertices": corners } }, "material": "white" });
    let strip = |x: [f64; 2], y: [f64; 2]| {
        wall([[x[0], y[0], 1.0], [x[1], y[0], 1.0], [x[1], y[1], 1.0], [x[0], y[1], 1.0]])
    };
    let side = |axis: usize, at: f64| {
        let corner = |a: f64, b: f64| {
            let mut corner = [a, b, 0.0];
            corner.rotate_right(axis + 1);
            corner[axis] = at;
            corner
        };
        let mut wall = wall([corner(-1., -1.), corner(1., -1.), corner(1., 1.), corner(-1., 1.)]);
        wall["material"] = json!("paint");
        wall
    };
    let mut walls = vec![side(0, -1.0), side(0, 1.0), side(1, -1.0), side(1, 1.0), side(2, -1.0)];
    for wall in &mut walls {
        wall["material"] = json!("both");
    }
    walls.extend([
        strip([-1.0, 1.0], [-1.0, -0.1]),
        strip([-1.0, 1.0], [0.1, 1.0]),
        strip([-1.0, -0.1], [-0.1, 0.1]),
        strip([0.1, 1.0], [-0.1, 0.1]),
    ]);
    for wall in &mut walls {
        wall["material"] = json!("both");
    }
    json!(walls)
}

// Case 40.
pub fn a_little_loss_is_no_divergence(record: &mut Record) {
    let black_core = json!([ball(1.0, "white"), ball(0.05, "black")]);
    let cube = json!([{ "shape": { "box": { "min": [-0.5, -0.5, -0.5], "max": [0.5, 0.5, 0.5] } },
        "material": "crown" }, ball(2.0, "black")]);
    let mut window = file(room_with_a_window(), point_lamp([0.2, 0.1, 0.3]), inside());
    window["materials"]["both"] = json!({ "lambertian": { "reflectance": 1, "two_sided": true } });
    let scenes = [
        ("walls of 0.999", file(json!([ball(1.0, "paint")]), point_lamp([0.0; 3]), inside())),
        ("a window of 1/600 of the walls", window),
        ("a black core of 1/400 of the walls", file(black_core, point_lamp([0.3; 3]), inside())),
        (
            "lamp and camera in clear glass",
            file(cube.clone(), point_lamp([0.1; 3]), camera([0.1, 0.2, -0.3], [0.3, 0.5, 0.5])),
        ),
        ("lamp in clear glass", file(cube, point_lamp([0.1; 3]), camera([1.5, 0.2, 0.1], [0.0; 3]))),
        // White, closed and lit, but the camera is outside.
        (
            "a white ball seen from outside",
            file(json!([ball(1.0, "white")]), point_lamp([0.0; 3]), camera([3.0, 0.0, 0.0], [0.0; 3])),
        ),
    ];
    for (name, text) in scenes {
        let scene = scene(&text);
        let view = scene.view().expect("a camera");
        for integrator in [Integrator::Path, Integrator::Light, Integrator::Bdpt] {
            let plan = Plan::of(&scene, &view.sensor, integrator.strategies());
            let bounded = Bounded::of(&scene, &plan, Eye::Camera(&view.camera));
            let what = format!("{name}, {}: no limit on bounces", integrator.name());
            record.holds(what, bounded.plan.most_bounces.is_none());
        }
    }
    let lossless = closure(&scene(&file(json!([ball(1.0, "white")]), point_lamp([0.0; 3]), inside())));
    record.exactly("walks that left the white ball", lossless.left, 0);
    record.holds("hardly any ended there", lossless.is_lossless());
    let paint = closure(&scene(&file(json!([ball(1.0, "paint")]), point_lamp([0.0; 3]), inside())));
    record.holds("the painted one is closed", paint.is_closed());
    record.holds("and loses light", !paint.is_lossless());
    record.relative("its largest albedo", paint.largest_albedo, 0.999, 1e-6);
}
