//! Extreme conditions: each is found where it is, and only there, and does to the error what it
//! says. Statistical comparisons have fixed seeds, and each states what it allows and why.

#[path = "../common/mod.rs"]
mod common;
mod predictions;
mod table;

use common::scene;
use etalon::scene::Scene;
use etalon::scene::conditions::{Condition, conditions};
use serde_json::{Value, json};

/// The conditions of a scene as its own camera sees it.
pub fn found(scene: &Scene) -> Vec<Condition> {
    conditions(scene, scene.view.as_ref())
}

/// Their names, each once, in alphabetical order.
pub fn names(scene: &Scene) -> Vec<&'static str> {
    let mut names: Vec<&str> = found(scene).iter().map(|condition| condition.name).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// A figure of the only condition of a name.
pub fn figure(scene: &Scene, name: &str, key: &str) -> f64 {
    let conditions = found(scene);
    let [condition] = &conditions.iter().filter(|c| c.name == name).collect::<Vec<_>>()[..] else {
        panic!("not one {name}: {conditions:#?}");
    };
    condition.value(key).unwrap_or_else(|| panic!("no figure {key}: {condition:#?}"))
}

/// A floor of 4 m under a lamp of 30 cm radius at 2 m, and a meter on the floor.
pub fn plain() -> Value {
    json!({
        "name": "plain", "length_unit": "m",
        "materials": {
            "grey": { "lambertian": { "reflectance": 0.5 } },
            "black": { "lambertian": { "reflectance": 0 } },
        },
        "objects": [
            { "name": "floor", "material": "grey", "shape": { "quad": { "vertices": [[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]] } } },
            { "name": "lamp", "material": "black", "shape": { "sphere": { "center": [0, 0, 2], "radius": 0.3 } },
                "emission": { "spectrum": "d65", "level": { "luminance_cd_m2": 100 } } },
        ],
        "meters": [{ "illuminance": { "name": "meter", "position": [0.1, 0, 0], "normal": [0, 0, 1] } }],
    })
}

/// The same with a camera in place of the meter, exposed for the floor.
pub fn pictured() -> Value {
    let mut scene = plain();
    scene["meters"] = json!([]);
    scene["camera"] = json!({
        "position": [0, -3, 1.5], "look_at": [0, 0, 0], "up": [0, 0, 1], "focal_length_mm": 35, "sensor_mm": [36, 24],
        "resolution": [24, 16], "iso": 800, "shutter_s": 0.25, "f_stop": 2.8,
    });
    scene
}

/// A scene after a change.
pub fn with(mut json: Value, change: impl FnOnce(&mut Value)) -> Scene {
    change(&mut json);
    scene(&json)
}

/// Adds an object of a material.
pub fn add(scene: &mut Value, shape: Value, material: Value) {
    let object = json!({ "name": "thing", "shape": shape, "material": "thing" });
    scene["objects"].as_array_mut().expect("a list").push(object);
    scene["materials"]["thing"] = material;
}
