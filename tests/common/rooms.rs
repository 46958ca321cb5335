//! Rooms of 2 m with hard things in them, on which paths are taken apart vertex by vertex.

use super::scene;
use etalon::scene::Scene;
use serde_json::{Value, json};

fn lamp(luminance_cd_m2: f64) -> Value {
    json!({ "spectrum": "d65", "level": { "luminance_cd_m2": luminance_cd_m2 } })
}

/// A room of 2 m with a camera in it, and what else is given.
fn room(objects: Value, lights: Value, camera: Value) -> Scene {
    let wall = |vertices: [[f64; 3]; 4], material: &str| json!({ "shape": { "quad": { "vertices": vertices } }, "material": material });
    let mut all = vec![
        wall([[0., 0., 0.], [0., 0., 2.], [2., 0., 2.], [2., 0., 0.]], "satin"),
        wall([[0., 2., 0.], [2., 2., 0.], [2., 2., 2.], [0., 2., 2.]], "grey"),
        wall([[0., 0., 2.], [0., 2., 2.], [2., 2., 2.], [2., 0., 2.]], "grey"),
        wall([[0., 0., 0.], [2., 0., 0.], [2., 2., 0.], [0., 2., 0.]], "grey"),
        wall([[0., 0., 0.], [0., 2., 0.], [0., 2., 2.], [0., 0., 2.]], "red"),
        wall([[2., 0., 0.], [2., 0., 2.], [2., 2., 2.], [2., 2., 0.]], "grey"),
    ];
    all.extend(objects.as_array().expect("a list").clone());
    scene(&json!({
        "name": "room", "length_unit": "m",
        "materials": {
            "grey": { "lambertian": { "reflectance": 0.6 } },
            "red": { "lambertian": { "reflectance": "cornell-red" } },
            "satin": { "conductor": { "metal": "gold", "roughness_alpha": 0.4 } },
            "black": { "lambertian": { "reflectance": 0 } },
            "mirror": { "mirror": { "reflectance": 0.9 } },
            "crown": { "dielectric": { "index": 1.5 } },
            "flint": { "dielectric": { "index": "n-sf11" } },
            "fickle": { "dielectric": { "roughness_alpha": 0.2,
                "index": { "table": { "wavelengths_nm": [360, 559, 561, 830], "n": [1, 1, 1.4, 1.4] } } } },
            "ground flint": { "dielectric": { "index": "n-sf11", "roughness_alpha": 0.3 } },
        },
        "objects": all, "lights": lights, "camera": camera,
    }))
}

fn pinhole() -> Value {
    json!({ "position": [1, 1.1, 0.05], "look_at": [1, 0.9, 2], "up": [0, 1, 0], "focal_length_mm": 20, "sensor_mm": [36, 24],
        "resolution": [6, 4], "iso": 100, "shutter_s": 0.01, "f_stop": 8 })
}

fn thin_lens() -> Value {
    json!({ "position": [1, 1.1, 0.2], "look_at": [1, 0.9, 2], "up": [0, 1, 0], "focal_length_mm": 100, "sensor_mm": [120, 80],
        "resolution": [6, 4], "iso": 100, "shutter_s": 0.01, "f_stop": 0.8, "focus_distance": 1.2 })
}

fn panel() -> Value {
    json!({ "shape": { "quad": { "vertices": [[0.6, 1.98, 0.6], [1.4, 1.98, 0.6], [1.4, 1.98, 1.4], [0.6, 1.98, 1.4]] } },
        "material": "black", "emission": lamp(500.0) })
}

fn ball(center: [f64; 3], radius: f64, material: &str) -> Value {
    json!({ "shape": { "sphere": { "center": center, "radius": radius } }, "material": material })
}

fn bulb(center: [f64; 3], radius: f64) -> Value {
    json!({ "shape": { "sphere": { "center": center, "radius": radius } }, "material": "grey", "emission": lamp(5000.0) })
}

/// An octahedron with the normals of a sphere: shading and true normals differ a lot.
fn round_octahedron() -> Value {
    let unit = [[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
    let at = unit.map(|v: [f64; 3]| [1.0 + 0.5 * v[0], 0.7 + 0.5 * v[1], 1.2 + 0.5 * v[2]]);
    let triangles = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    json!({ "shape": { "mesh": { "vertices": at, "normals": unit, "triangles": triangles } }, "material": "grey" })
}

/// A camera and a matte board within a block of glass, and a lamp outside.
fn aquarium(glass: &str) -> Scene {
    let objects = json!([
        { "shape": { "box": { "min": [0.3, 0.3, 0.02], "max": [1.7, 1.7, 1.6] } }, "material": glass },
        { "shape": { "quad": { "vertices": [[0.6, 0.5, 1.2], [0.6, 1.2, 1.4], [1.4, 1.2, 1.4], [1.4, 0.5, 1.2]] } }, "material": "grey" },
        panel()
    ]);
    room(objects, json!([]), pinhole())
}

/// All rooms by name.
pub fn rooms() -> Vec<(&'static str, Scene)> {
    let none = json!([]);
    let point = json!([
        { "point": { "position": [0.5, 1.5, 0.7], "emission": { "spectrum": "d65", "level": { "flux_lm": 1000 } } } },
        { "point": { "position": [1.5, 1.8, 1.2], "distribution": { "cosine": { "axis": [0.1, -1, 0.2] } },
            "emission": { "spectrum": "cie-a", "level": { "flux_lm": 500 } } } }
    ]);
    vec![
        ("panel", room(json!([panel(), ball([1., 0.5, 1.], 0.4, "satin")]), none.clone(), pinhole())),
        ("lens", room(json!([panel(), ball([1., 0.5, 1.], 0.4, "grey")]), none.clone(), thin_lens())),
        ("points", room(json!([ball([1., 0.5, 1.], 0.4, "mirror")]), point.clone(), thin_lens())),
        (
            "bulb",
            room(
                json!([bulb([1., 1.5, 1.], 0.05), ball([1., 0.5, 1.], 0.4, "crown")]),
                none.clone(),
                pinhole(),
            ),
        ),
        (
            "bulb in glass",
            room(
                json!([bulb([1., 1.2, 1.2], 0.1), ball([1., 1.2, 1.2], 0.4, "crown")]),
                none.clone(),
                thin_lens(),
            ),
        ),
        ("prism", room(json!([panel(), ball([1., 0.6, 1.2], 0.4, "flint")]), none.clone(), pinhole())),
        ("ground", room(json!([panel(), ball([1., 0.6, 1.2], 0.4, "ground flint")]), point, pinhole())),
        (
            "partly smooth",
            room(
                json!([panel(), { "shape": { "box": { "min": [0.3, 0.3, 0.4], "max": [1.7, 1.7, 0.5] } }, "material": "fickle" }]),
                none.clone(),
                pinhole(),
            ),
        ),
        ("octahedron", room(json!([panel(), round_octahedron()]), none, pinhole())),
        ("aquarium", aquarium("crown")),
        ("ground aquarium", aquarium("ground flint")),
    ]
}
