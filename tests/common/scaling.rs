//! The same scene in other lengths, or under other light: every number of its description that
//! has the dimension, multiplied.

use serde_json::{Value, json};

/// Keys of a shape that hold lengths or lists of positions.
const LENGTHS: [&str; 8] = ["center", "radius", "from", "to", "min", "max", "vertices", "position"];

/// A scene with all lengths times `factor`. Radiance stays, so flux and intensity go with the
/// square of it and absorption with its inverse; a lens grows with the scene, a pinhole need not.
pub fn with_lengths(scene: &Value, factor: f64) -> Value {
    let mut scene = with_coordinates(scene, factor);
    for object in each(&mut scene["objects"]) {
        scale_power(&mut object["emission"]["level"], factor * factor);
        drop_nulls(&mut object["emission"]);
        drop_nulls(object);
    }
    for light in each(&mut scene["lights"]) {
        scale_power(&mut light["point"]["emission"]["level"], factor * factor);
    }
    if let Some(materials) = scene["materials"].as_object_mut() {
        for material in materials.values_mut() {
            let absorption = &mut material["dielectric"]["absorption_per_m"];
            multiply(absorption, 1.0 / factor);
            if let Some(values) = absorption.pointer_mut("/table/values") {
                multiply(values, 1.0 / factor);
            }
            drop_nulls(&mut material["dielectric"]);
            drop_nulls(material);
        }
    }
    if !scene["camera"]["focus_distance"].is_null() {
        ["focal_length_mm", "sensor_mm"].iter().for_each(|key| multiply(&mut scene["camera"][key], factor));
    }
    drop_nulls(&mut scene["camera"]);
    drop_nulls(&mut scene);
    scene
}

/// A scene with every number in its unit of length times `factor`: the same scene where the unit
/// is smaller by as much.
pub fn with_coordinates(scene: &Value, factor: f64) -> Value {
    let mut scene = scene.clone();
    for object in each(&mut scene["objects"]) {
        let is_file = scale_shape(&mut object["shape"], factor);
        let mut steps = object["transform"].as_array().cloned().unwrap_or_default();
        for step in &mut steps {
            multiply(&mut step["translate"], factor);
            for row in each(&mut step["matrix"]) {
                multiply(&mut row[3], factor);
            }
            drop_nulls(step);
        }
        if is_file {
            steps.insert(0, json!({ "scale": [factor, factor, factor] }));
        }
        object["transform"] = json!(steps);
    }
    for light in each(&mut scene["lights"]) {
        multiply(&mut light["point"]["position"], factor);
    }
    for meter in each(&mut scene["meters"]) {
        for kind in ["illuminance", "luminance"] {
            multiply(&mut meter[kind]["position"], factor);
        }
        drop_nulls(meter);
    }
    for key in ["position", "look_at", "focus_distance"] {
        multiply(&mut scene["camera"][key], factor);
    }
    for key in ["lights", "meters", "camera"] {
        drop_nulls(&mut scene[key]);
    }
    drop_nulls(&mut scene);
    scene
}

/// A scene with the light of all its lamps times `factor`.
pub fn with_light(scene: &Value, factor: f64) -> Value {
    let mut scene = scene.clone();
    for object in each(&mut scene["objects"]) {
        scale_all(&mut object["emission"]["level"], factor);
        drop_nulls(&mut object["emission"]);
        drop_nulls(object);
    }
    for light in each(&mut scene["lights"]) {
        scale_all(&mut light["point"]["emission"]["level"], factor);
    }
    drop_nulls(&mut scene);
    scene
}

fn each(list: &mut Value) -> impl Iterator<Item = &mut Value> {
    list.as_array_mut().into_iter().flatten()
}

/// Multiplies a number, or all numbers of a list.
fn multiply(value: &mut Value, factor: f64) {
    match value {
        Value::Number(number) => *value = json!(number.as_f64().expect("a number") * factor),
        Value::Array(list) => list.iter_mut().for_each(|item| multiply(item, factor)),
        _ => {}
    }
}

/// Looking up keys that are not there leaves nulls.
fn drop_nulls(value: &mut Value) {
    if let Some(map) = value.as_object_mut() {
        map.retain(|_, v| !v.is_null() && v.as_object().is_none_or(|inner| !inner.is_empty()));
    }
}

/// Whether the shape's coordinates are in a file.
fn scale_shape(shape: &mut Value, factor: f64) -> bool {
    let map = shape.as_object_mut().expect("a shape");
    let (kind, described) = map.iter_mut().next().expect("a kind of shape");
    let is_file = kind == "obj" || kind == "ply";
    for (key, value) in described.as_object_mut().expect("a description") {
        if LENGTHS.contains(&key.as_str()) {
            multiply(value, factor);
        }
    }
    is_file
}

fn scale_power(level: &mut Value, factor: f64) {
    for key in ["flux_lm", "intensity_cd"] {
        multiply(&mut level[key], factor);
    }
    drop_nulls(level);
}

fn scale_all(level: &mut Value, factor: f64) {
    for key in ["flux_lm", "intensity_cd", "luminance_cd_m2", "spectral_radiance_factor"] {
        multiply(&mut level[key], factor);
    }
    drop_nulls(level);
}
