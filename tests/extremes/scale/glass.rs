//! Bodies of glass within one another, and ends of paths inside of them.

use crate::common::{luminance, metered, read_with};
use crate::record::Record;
use etalon::error::Error;
use etalon::integrator::Integrator;
use etalon::scene::Scene;
use serde_json::{Value, json};
use std::path::Path;

fn materials() -> Value {
    json!({
        "black": { "lambertian": { "reflectance": 0 } },
        "clear": { "dielectric": { "index": 1 } },
        "grey": { "dielectric": { "index": 1, "absorption_per_m": 0.5 } },
        "glass": { "dielectric": { "index": 1.5 } },
    })
}

fn ball(x: f64, radius: f64, material: &str) -> Value {
    json!({ "name": format!("{material} ball"), "material": material,
        "shape": { "sphere": { "center": [x, 0, 0], "radius": radius } } })
}

fn load(objects: Value) -> Result<Scene, Error> {
    let scene = json!({ "name": "test", "length_unit": "m", "materials": materials(), "objects": objects,
        "meters": luminance([0.0, 0.0, -5.0], [0.0, 0.0, 1.0]) });
    Scene::from_text(&scene.to_string(), Path::new("."))
}

// Case 55.
pub fn nested_glass_is_told_from_glass_that_overlaps(record: &mut Record) {
    let cuboid = |x: [f64; 2]| json!({ "material": "glass", "shape": { "box": { "min": [x[0], -1, -1], "max": [x[1], 1, 1] } } });
    let sound = [
        ("apart", json!([ball(0.0, 1.0, "glass"), ball(2.5, 1.0, "grey")])),
        ("within", json!([ball(0.0, 1.0, "glass"), ball(0.2, 0.5, "grey"), ball(0.3, 0.2, "clear")])),
        ("back to back", json!([cuboid([-1.0, 0.0]), cuboid([0.0, 1.0])])),
        ("opaque in glass", json!([ball(0.0, 1.0, "glass"), ball(0.9, 0.5, "black")])),
    ];
    for (what, objects) in sound {
        let fault = load(objects).err().map(|error| error.to_string());
        record.exactly(format!("{what}: what is said"), fault.unwrap_or_default(), String::new());
    }
    let overlapping = [
        ("half in", json!([ball(0.0, 1.0, "glass"), ball(1.0, 0.5, "grey")])),
        ("through", json!([cuboid([-2.0, 2.0]), ball(1.5, 0.8, "clear")])),
        ("of one kind", json!([ball(0.0, 1.0, "glass"), ball(0.5, 1.0, "glass")])),
    ];
    for (what, objects) in overlapping {
        let fault = load(objects).err().map_or_else(String::new, |error| error.to_string());
        record.says(format!("{what}: what is said"), &fault, "overlap at (");
        record.says(format!("{what}: where"), &fault, "/objects/1");
    }
    record.note("Bodies of glass have no priorities: one lies within another or beside it, each surface knows both its media (outside_index), and overlap is refused. What is hardly overlapping, less than 64 rays through a body tell, may pass; the innermost body entered last then absorbs.");
}

// Case 55.
pub fn a_lamp_and_a_camera_in_glass_know_what_they_are_in(record: &mut Record) {
    let lamp = |z: f64| {
        json!({ "shape": { "disk": { "center": [0, 0, z], "normal": [0, 0, -1], "radius": 0.5 } }, "material": "black",
        "emission": { "spectrum": "d65", "level": { "luminance_cd_m2": 1000 } } })
    };
    // Grey from -3 to 3, clear within from -1 to 1: where the meter is, where the lamp is, and
    // the metres of grey between.
    let places = [
        ("both outside", -5.0, 5.0, 4.0),
        ("meter in grey", -2.0, 5.0, 3.0),
        ("meter in clear", 0.0, 5.0, 2.0),
        ("lamp in grey", -5.0, 2.0, 3.0),
        ("lamp in clear", -5.0, 0.5, 2.0),
        ("both in clear", -0.5, 0.5, 0.0),
        ("meter and lamp in grey", -2.0, 2.0, 2.0),
    ];
    for (what, meter, at, grey_m) in places {
        let objects = json!([lamp(at), ball(0.0, 3.0, "grey"), ball(0.0, 1.0, "clear")]);
        let scene = metered(materials(), objects, json!([]), luminance([0.0, 0.0, meter], [0.0, 0.0, 1.0]));
        for integrator in [Integrator::Path, Integrator::Bdpt] {
            let reading = read_with(&scene, integrator, record.samples(1 << 13)).photometric;
            let truth = 1000.0 * f64::exp(-0.5 * grey_m);
            record.mean(
                format!("{what}, {}: cd/m2", integrator.name()),
                reading.mean,
                reading.standard_error,
                truth,
                5e-3,
            );
        }
    }
}
