//! Small scenes with a camera, each about one thing, on which algorithms must agree.
//!
//! Most stand in a closed room of 2 m: x from -1 to 1, y (up) from 0 to 2, z from -1 to 1. The
//! camera is near one wall and looks along z; left in the picture is +x, the red wall. All is
//! lit well enough for a few hundred paths per pixel to tell algorithms apart.

use serde_json::{Value, json};

/// Width and height of the pictures in pixels.
const SIDE_PX: u32 = 24;

/// Luminance of the ball's lamp alone, cd/m2; the ball doubles it.
pub const BALL_LUMINANCE_CD_M2: f64 = 10.0;
/// Reflectance of the ball: everywhere inside, luminance is [`BALL_LUMINANCE_CD_M2`] over one
/// minus this.
pub const BALL_REFLECTANCE: f64 = 0.5;

/// All scenes, by the name that each bears.
pub fn all() -> Vec<Value> {
    vec![
        diffuse(),
        glossy(),
        glass(),
        dispersive_prism(),
        metal(),
        thin_lens(),
        tiny_bulb(),
        large_panel(),
        point_light(),
        light_in_glass(),
        camera_in_glass(),
        camera_in_absorbing_glass(),
        smooth_normals(),
        ball(),
    ]
}

/// Matte walls and a block under a lamp in the ceiling.
pub fn diffuse() -> Value {
    room("diffuse", json!({}), vec![panel(0.5), block()])
}

/// A room that is lit through a crack in the lid of a lamp's box alone.
pub fn crack() -> Value {
    crack_of(0.008)
}

/// The same with a crack of half a width in metres.
pub fn crack_of(wide: f64) -> Value {
    let mut json = diffuse();
    json["name"] = json!("crack");
    let objects = json["objects"].as_array_mut().expect("objects");
    let lid = |vertices: [[f64; 3]; 4]| json!({ "shape": { "quad": { "vertices": vertices } }, "material": "white" });
    // The lamp hangs at 1.99 m; the lid under it leaves this by 10 cm free.
    let (low, high) = (-1.0, 1.0);
    for [x, z] in [[low, -wide], [wide, high]] {
        objects.push(lid([[x, 1.9, low], [z, 1.9, low], [z, 1.9, high], [x, 1.9, high]]));
    }
    for [x, z] in [[low, -0.05], [0.05, high]] {
        objects.push(lid([[-wide, 1.9, x], [wide, 1.9, x], [wide, 1.9, z], [-wide, 1.9, z]]));
    }
    json
}

/// A rough metal plate, and a rough glass ball above it.
pub fn glossy() -> Value {
    let materials = json!({
        "plate": { "conductor": { "metal": "copper", "roughness_alpha": 0.3 } },
        "ground glass": { "dielectric": { "index": 1.5, "roughness_alpha": 0.4 } },
    });
    let plate = object(cuboid([-0.8, 0.05, -0.6], [0.8, 0.1, 0.9]), "plate");
    room("glossy", materials, vec![panel(0.6), plate, object(sphere([0.0, 0.7, 0.2], 0.4), "ground glass")])
}

/// A smooth glass ball whose caustic a large lamp makes.
pub fn glass() -> Value {
    let materials = json!({ "glass": { "dielectric": { "index": 1.5 } } });
    room("glass", materials, vec![panel(0.7), object(sphere([0.0, 0.6, 0.1], 0.4), "glass")])
}

/// A strip of daylight behind a ridge of flint, which gives it coloured edges.
pub fn dispersive_prism() -> Value {
    let materials = json!({ "flint": { "dielectric": { "index": { "abbe": { "nd": 1.7, "vd": 10 } } } } });
    let outline = [[-0.5, 0.1], [0.5, 0.1], [0.0, -0.08]];
    let vertices: Vec<[f64; 3]> =
        [0.4, 1.7].iter().flat_map(|&y| outline.map(|[x, z]: [f64; 2]| [x, y, z])).collect();
    let triangles = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]];
    let prism = object(json!({ "mesh": { "vertices": vertices, "triangles": triangles } }), "flint");
    let corners = [[0.12, 0.4, 0.98], [-0.12, 0.4, 0.98], [-0.12, 1.7, 0.98], [0.12, 1.7, 0.98]];
    let strip = lamp(json!({ "quad": { "vertices": corners } }), 60.0);
    let mut scene = room("dispersive-prism", materials, vec![panel(0.6), strip, prism]);
    scene["camera"]["iso"] = json!(400);
    scene
}

/// A smooth golden ball before a mirror.
pub fn metal() -> Value {
    let materials = json!({
        "gold": { "conductor": { "metal": "gold" } },
        "mirror": { "mirror": { "reflectance": 0.9 } },
    });
    let corners = [[0.8, 0.2, 0.98], [-0.8, 0.2, 0.98], [-0.8, 1.7, 0.98], [0.8, 1.7, 0.98]];
    let mirror = object(json!({ "quad": { "vertices": corners } }), "mirror");
    let ball = object(sphere([0.2, 0.5, 0.2], 0.4), "gold");
    room("metal", materials, vec![panel(0.6), mirror, ball])
}

/// A wide open lens focused on the nearest of three posts.
pub fn thin_lens() -> Value {
    let post = |x: f64, z: f64| object(cuboid([x - 0.08, 0.0, z - 0.08], [x + 0.08, 1.4, z + 0.08]), "blue");
    let posts = vec![panel(0.6), post(0.25, -0.35), post(-0.05, 0.2), post(-0.5, 0.8)];
    let mut scene = room("thin-lens", json!({}), posts);
    let camera = &mut scene["camera"];
    // A pupil of 80 mm, and as little light as through the other scenes' lenses.
    camera["focal_length_mm"] = json!(40);
    camera["sensor_mm"] = json!([50, 50]);
    camera["focus_distance"] = json!(0.6);
    camera["f_stop"] = json!(0.5);
    camera["iso"] = json!(12.5);
    scene
}

/// A bulb of 5 mm radius among matte things.
pub fn tiny_bulb() -> Value {
    room("tiny-bulb", json!({}), vec![lamp(sphere([0.2, 1.5, 0.0], 0.005), 400.0), block()])
}

/// A ceiling that shines all over.
pub fn large_panel() -> Value {
    room("large-panel", json!({}), vec![panel(0.99), block()])
}

/// A lamp without size among matte and rough things.
pub fn point_light() -> Value {
    let materials = json!({ "silver": { "conductor": { "metal": "silver", "roughness_alpha": 0.4 } } });
    let ball = object(sphere([-0.4, 0.4, 0.3], 0.35), "silver");
    let mut scene = room("point-light", materials, vec![block(), ball]);
    scene["lights"] = json!([{ "point": { "position": [0.1, 1.5, -0.1], "emission": daylight(400.0) } }]);
    scene
}

/// Lamps of every kind, enough of them for a hierarchy, and round and rough things below.
pub fn many_lamps() -> Value {
    let materials = json!({
        "brass": { "conductor": { "metal": { "n": 0.5, "k": 2.5 }, "roughness_alpha": 0.2 } },
        "tinted": { "dielectric": { "index": "n-bk7", "absorption_per_m": 0.8 } },
        "frosted": { "dielectric": { "index": 1.5, "roughness_alpha": 0.15 } },
    });
    let spread = |i: u32, step: f64| (f64::from(i) * step).fract();
    let at =
        |i: u32| [1.8 * spread(i, 0.618) - 0.9, 1.6 + 0.3 * spread(i, 0.414), 1.8 * spread(i, 0.732) - 0.9];
    let mut things: Vec<Value> = (0..12).map(|i| lamp(sphere(at(i), 0.02), 3.0 + f64::from(i))).collect();
    let below = |i: u32| json!({ "disk": { "center": at(i), "normal": [0.1, -1, 0.2], "radius": 0.03 } });
    things.extend((12..20).map(|i| lamp(below(i), 5.0)));
    things.push(object(cuboid([-0.7, 0.0, -0.2], [-0.3, 0.5, 0.3]), "tinted"));
    things.push(object(sphere([0.5, 0.4, 0.3], 0.3), "frosted"));
    let rod = json!({ "cylinder": { "from": [-0.2, 0.1, 0.5], "to": [0.3, 1.1, 0.7], "radius": 0.1 } });
    things.push(object(rod, "brass"));
    let mut scene = room("many-lamps", materials, things);
    let point = |i: u32| {
        let mut light = json!({ "point": { "position": at(i), "emission": daylight(6.0) } });
        if i.is_multiple_of(2) {
            light["point"]["distribution"] = json!({ "cosine": { "axis": [0.2, -1, 0.1] } });
        }
        light
    };
    scene["lights"] = (20..32).map(point).collect();
    scene
}

/// A lamp inside a glass ball: no light but through smooth glass.
pub fn light_in_glass() -> Value {
    let materials = json!({ "glass": { "dielectric": { "index": 1.5 } } });
    let ball = object(sphere([0.1, 1.0, 0.4], 0.45), "glass");
    room("light-in-glass", materials, vec![lamp(sphere([0.1, 1.0, 0.4], 0.27), 400.0), ball])
}

/// Camera and a matte ball inside a block of glass, the room outside: the aquarium.
pub fn camera_in_glass() -> Value {
    aquarium("camera-in-glass", json!({ "dielectric": { "index": 1.5 } }))
}

/// The aquarium in glass that swallows red.
pub fn camera_in_absorbing_glass() -> Value {
    let absorption =
        json!({ "table": { "wavelengths_nm": [360, 500, 600, 830], "values": [0.2, 0.2, 1, 1] } });
    let glass = json!({ "dielectric": { "index": 1.5, "absorption_per_m": absorption } });
    aquarium("camera-in-absorbing-glass", glass)
}

fn aquarium(name: &str, glass: Value) -> Value {
    let water = object(cuboid([-0.7, 0.3, -0.98], [0.7, 1.6, -0.1]), "glass");
    let fish = object(sphere([-0.15, 0.85, -0.45], 0.13), "white");
    let mut scene = room(name, json!({ "glass": glass }), vec![panel(0.95), water, fish, block()]);
    // Radiance in glass is larger by n^2.
    scene["camera"]["iso"] = json!(200);
    scene
}

/// Coarse balls with normals that make them look round: one matte, one glossy.
pub fn smooth_normals() -> Value {
    let materials = json!({ "iron": { "conductor": { "metal": "iron", "roughness_alpha": 0.3 } } });
    let ball = |at: [f64; 3], material: &str| {
        let mut ball = object(json!({ "obj": { "file": "tests/files/coarse-ball.obj" } }), material);
        ball["transform"] = json!([{ "scale": [0.35, 0.35, 0.35] }, { "translate": at }]);
        ball
    };
    let balls = vec![panel(0.6), ball([0.4, 0.6, 0.2], "orange"), ball([-0.4, 0.6, 0.2], "iron")];
    room("smooth-normals", materials, balls)
}

/// Inside a matte ball that shines all over: [`BALL_LUMINANCE_CD_M2`] / (1 -
/// [`BALL_REFLECTANCE`]) everywhere.
pub fn ball() -> Value {
    let mut shell = object(sphere([0.0, 0.0, 0.0], 1.0), "shell");
    shell["emission"] = json!({
        "spectrum": "d65", "level": { "luminance_cd_m2": BALL_LUMINANCE_CD_M2 }, "two_sided": true,
    });
    json!({
        "name": "ball", "length_unit": "m", "objects": [shell],
        "materials": { "shell": { "lambertian": { "reflectance": BALL_REFLECTANCE } } },
        "camera": camera([0.3, 0.2, -0.4], [0.0, 0.0, 1.0]),
    })
}

/// The closed room with things in it; their materials beside those that every room has.
fn room(name: &str, materials: Value, things: Vec<Value>) -> Value {
    let mut scene = json!({
        "name": name, "length_unit": "m", "objects": walls(),
        "materials": {
            "white": { "lambertian": { "reflectance": "cornell-white" } },
            "red": { "lambertian": { "reflectance": "cornell-red" } },
            "green": { "lambertian": { "reflectance": "cornell-green" } },
            "blue": { "lambertian": { "reflectance": "colorchecker-blue" } },
            "orange": { "lambertian": { "reflectance": "colorchecker-orange" } },
            "black": { "lambertian": { "reflectance": 0 } },
        },
        "camera": camera([0.0, 1.0, -0.9], [0.0, 0.85, 0.0]),
    });
    scene["objects"].as_array_mut().expect("walls").extend(things);
    for (name, material) in materials.as_object().expect("materials by name") {
        scene["materials"][name] = material.clone();
    }
    scene
}

fn walls() -> Vec<Value> {
    let wall =
        |corners: [[f64; 3]; 4], material| object(json!({ "quad": { "vertices": corners } }), material);
    let (low, high) = (0.0, 2.0);
    vec![
        wall([[1.0, low, -1.0], [1.0, low, 1.0], [-1.0, low, 1.0], [-1.0, low, -1.0]], "white"),
        wall([[1.0, high, -1.0], [1.0, high, 1.0], [-1.0, high, 1.0], [-1.0, high, -1.0]], "white"),
        wall([[1.0, low, 1.0], [1.0, high, 1.0], [-1.0, high, 1.0], [-1.0, low, 1.0]], "white"),
        wall([[1.0, low, -1.0], [1.0, high, -1.0], [-1.0, high, -1.0], [-1.0, low, -1.0]], "white"),
        wall([[1.0, low, -1.0], [1.0, high, -1.0], [1.0, high, 1.0], [1.0, low, 1.0]], "red"),
        wall([[-1.0, low, -1.0], [-1.0, high, -1.0], [-1.0, high, 1.0], [-1.0, low, 1.0]], "green"),
    ]
}

/// A square lamp under the ceiling, by half its side.
fn panel(half: f64) -> Value {
    let corners = [[half, 1.99, -half], [half, 1.99, half], [-half, 1.99, half], [-half, 1.99, -half]];
    lamp(json!({ "quad": { "vertices": corners } }), 400.0)
}

fn block() -> Value {
    let mut block = object(cuboid([-0.25, 0.0, -0.25], [0.25, 0.7, 0.25]), "blue");
    block["transform"] = json!([
        { "rotate": { "axis": [0, 1, 0], "degrees": 25 } }, { "translate": [0.35, 0, 0.4] },
    ]);
    block
}

fn lamp(shape: Value, flux_lm: f64) -> Value {
    let mut lamp = object(shape, "black");
    lamp["emission"] = daylight(flux_lm);
    lamp
}

fn daylight(flux_lm: f64) -> Value {
    json!({ "spectrum": "d65", "level": { "flux_lm": flux_lm } })
}

fn object(shape: Value, material: &str) -> Value {
    json!({ "shape": shape, "material": material })
}

fn sphere(center: [f64; 3], radius: f64) -> Value {
    json!({ "sphere": { "center": center, "radius": radius } })
}

fn cuboid(min: [f64; 3], max: [f64; 3]) -> Value {
    json!({ "box": { "min": min, "max": max } })
}

/// A pinhole camera with a square picture of 64 degrees.
fn camera(position: [f64; 3], look_at: [f64; 3]) -> Value {
    json!({
        "position": position, "look_at": look_at, "up": [0, 1, 0],
        "focal_length_mm": 20, "sensor_mm": [25, 25], "resolution": [SIDE_PX, SIDE_PX],
        "f_stop": 4, "shutter_s": 0.1, "iso": 800, "white_balance": "d65",
    })
}
