//! Small scenes for what the common ones have not: lamps of few wavelengths, a chart in a plane,
//! mirrors alone, a lens before glass.

use crate::common::scenes;
use serde_json::{Value, json};

/// A matte room under a lamp that shines from 500 to 600 nm.
pub fn band() -> Value {
    relit("band", json!({ "table": { "wavelengths_nm": [500, 550, 600], "values": [0, 1, 0] } }))
}

/// The same under a lamp of three spectral lines.
pub fn lines() -> Value {
    let line = |nm: f64, power: f64| json!({ "wavelength_nm": nm, "power": power });
    relit("lines", json!({ "lines": { "lines": [line(435.8, 1.0), line(546.1, 2.0), line(611.0, 2.0)] } }))
}

fn relit(name: &str, spectrum: Value) -> Value {
    let mut scene = scenes::diffuse();
    scene["name"] = json!(name);
    for object in scene["objects"].as_array_mut().expect("objects") {
        if object["emission"].is_object() {
            object["emission"]["spectrum"] = spectrum.clone();
        }
    }
    scene
}

/// Two patches in a plane under a lamp: all light on them is direct.
pub fn chart() -> Value {
    let patch = |x: f64, material: &str| {
        let corners = [[x, 0.0, 0.0], [x, 0.0, 1.0], [x + 0.5, 0.0, 1.0], [x + 0.5, 0.0, 0.0]];
        json!({ "shape": { "quad": { "vertices": corners } }, "material": material })
    };
    with_objects(scenes::diffuse(), "chart", vec![patch(-0.5, "orange"), patch(0.0, "blue")])
}

/// A lamp and two mirrors.
pub fn mirrors() -> Value {
    let mirror = |x: f64| {
        let corners = [[x, 0.0, -1.0], [x, 2.0, -1.0], [x, 2.0, 1.0], [x, 0.0, 1.0]];
        json!({ "shape": { "quad": { "vertices": corners } }, "material": "mirror" })
    };
    let mut scene = with_objects(scenes::metal(), "mirrors", vec![mirror(-0.3), mirror(0.3)]);
    scene["camera"]["look_at"] = json!([0.0, 1.5, 0.0]);
    scene
}

/// A room's lamps and other things in the place of its own.
fn with_objects(mut scene: Value, name: &str, things: Vec<Value>) -> Value {
    scene["name"] = json!(name);
    let objects = scene["objects"].as_array_mut().expect("objects");
    objects.retain(|object| object["emission"].is_object());
    objects.extend(things);
    scene
}

/// A point light within a glass ball before a wide lens: light that nothing but meeting the lens
/// finds.
pub fn point_in_glass() -> Value {
    let mut scene = scenes::light_in_glass();
    scene["name"] = json!("point-in-glass");
    let objects = scene["objects"].as_array_mut().expect("objects");
    objects.retain(|object| !object["emission"].is_object());
    scene["lights"] = point_at([0.1, 1.0, 0.4]);
    scene["camera"]["focal_length_mm"] = json!(40);
    scene["camera"]["sensor_mm"] = json!([50, 50]);
    scene["camera"]["focus_distance"] = json!(0.6);
    scene["camera"]["f_stop"] = json!(0.2);
    scene
}

/// The room of the point light with the light in view.
pub fn point_in_view() -> Value {
    let mut scene = scenes::point_light();
    scene["name"] = json!("point-in-view");
    scene["lights"] = point_at([0.1, 1.0, 0.3]);
    scene
}

fn point_at(position: [f64; 3]) -> Value {
    let emission = json!({ "spectrum": "d65", "level": { "flux_lm": 400 } });
    json!([{ "point": { "position": position, "emission": emission } }])
}
