//! Which scenes have which conditions, written down before looking.

use crate::{add, found, names, pictured, plain, scene, with};
use etalon::scene::Scene;
use etalon::scene::conditions::LOOKED_FOR;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;

fn ball() -> Value {
    json!({ "sphere": { "center": [0.6, 0, 0.4], "radius": 0.2 } })
}

/// A closed black box of 10 cm around a point.
fn black_box(scene: &mut Value, [x, y, z]: [f64; 3]) {
    let shape =
        json!({ "box": { "min": [x - 0.05, y - 0.05, z - 0.05], "max": [x + 0.05, y + 0.05, z + 0.05] } });
    add(scene, shape, json!({ "lambertian": { "reflectance": 0 } }));
}

fn lamp_of(spectrum: Value) -> Scene {
    with(plain(), |s| s["objects"][1]["emission"]["spectrum"] = spectrum)
}

fn exposed(key: &str, value: f64, other: &str, compensation: f64) -> Scene {
    with(pictured(), |s| {
        s["camera"][key] = json!(value);
        s["camera"][other] = json!(compensation);
    })
}

/// For each condition a scene that has it and no other.
fn minimal(name: &str) -> Scene {
    let thing = |material: Value| with(plain(), |s| add(s, ball(), material));
    let dielectric = |index: Value| thing(json!({ "dielectric": { "index": index } }));
    let metal = |alpha: f64| thing(json!({ "conductor": { "metal": "silver", "roughness_alpha": alpha } }));
    match name {
        "small_emitter" => with(plain(), |s| {
            s["objects"][1]["shape"]["sphere"]["radius"] = json!(0.01);
            add(s, ball(), json!({ "dielectric": { "index": 1.5 } }));
        }),
        "hidden_lamps" => with(plain(), |s| {
            s["objects"][1]["shape"]["sphere"]["radius"] = json!(0.02);
            black_box(s, [0.0, 0.0, 2.0]);
        }),
        "unequal_lights" => with(plain(), |s| {
            let emission = json!({ "spectrum": "d65", "level": { "flux_lm": 1e8 } });
            s["lights"] = json!([{ "point": { "position": [1, 0, 1], "emission": emission } }]);
            black_box(s, [1.0, 0.0, 1.0]);
        }),
        "unreachable_light" => with(plain(), |s| {
            let emission = json!({ "spectrum": "d65", "level": { "flux_lm": 100 } });
            s["objects"].as_array_mut().expect("a list").pop();
            s["lights"] = json!([{ "point": { "position": [0, 0, 1.5], "emission": emission } }]);
            add(s, ball(), json!({ "mirror": { "reflectance": 0.9 } }));
        }),
        "near_specular_lobe" => with(plain(), |s| {
            s["objects"][1]["shape"]["sphere"]["radius"] = json!(0.01);
            add(s, ball(), json!({ "conductor": { "metal": "silver", "roughness_alpha": 0.005 } }));
        }),
        "polished_roughness" => metal(5e-5),
        "facet_loss" => metal(0.5),
        "dispersion" => dielectric(json!("n-bk7")),
        "few_wavelengths" => lamp_of(json!("sodium-low-pressure")),
        "dark_range" => lamp_of(json!({ "table": { "wavelengths_nm": [420, 680], "values": [1, 1] } })),
        "sensor_range" => with(pictured(), |s| {
            s["camera"]["sensor"] = json!({ "csv": { "file": "tests/files/infrared-sensor.csv" } });
            // D65 is tabulated up to 780 nm, where this sensor still sees.
            s["objects"][1]["emission"]["spectrum"] = json!({ "blackbody": { "temperature_k": 5000 } });
        }),
        "high_albedo" => with(plain(), |s| {
            add(
                s,
                json!({ "sphere": { "center": [0, 0, 1], "radius": 5 } }),
                json!({ "lambertian": { "reflectance": 0.95 } }),
            );
            s["objects"][0]["material"] = json!("thing");
        }),
        "matched_index" => dielectric(json!(1.000_001)),
        "optical_depth" => thing(json!({ "dielectric": { "index": 1.5, "absorption_per_m": 50 } })),
        "exposure_range" => exposed("iso", 50.0, "shutter_s", 0.001),
        "beyond_half_float" => with(pictured(), |s| {
            s["objects"][1]["emission"]["level"] = json!({ "luminance_cd_m2": 1e6 });
            s["camera"]["shutter_s"] = json!(2.5e-5);
        }),
        "camera_model" => exposed("f_stop", 0.5, "shutter_s", 0.008),
        "coarse_positions" => with(plain(), |s| {
            add(
                s,
                json!({ "sphere": { "center": [1e4, 0, 0], "radius": 0.1 } }),
                json!({ "lambertian": { "reflectance": 0.5 } }),
            );
        }),
        _ => panic!("no scene for {name}"),
    }
}

#[test]
fn every_condition_is_found_where_it_is_and_alone() {
    for (name, _) in LOOKED_FOR {
        let scene = minimal(name);
        assert_eq!(names(&scene), [name], "{:#?}", found(&scene));
    }
}

/// A roughness that is rendered as polished hides the light of a point as polish does.
#[test]
fn what_is_as_good_as_polished_counts_as_smooth() {
    let beside_a_point = |alpha: f64| {
        with(plain(), |s| {
            let emission = json!({ "spectrum": "d65", "level": { "flux_lm": 100 } });
            s["objects"].as_array_mut().expect("a list").pop();
            s["lights"] = json!([{ "point": { "position": [0, 0, 1.5], "emission": emission } }]);
            add(s, ball(), json!({ "conductor": { "metal": "silver", "roughness_alpha": alpha } }));
        })
    };
    assert_eq!(names(&beside_a_point(5e-5)), ["polished_roughness", "unreachable_light"]);
    assert_eq!(names(&beside_a_point(0.005)), ["near_specular_lobe"]);
}

/// Many lamps are looked at from fewer points, and those alike are counted.
#[test]
fn many_lamps_take_no_longer_and_are_named_once() {
    let scene = with(plain(), |s| {
        add(s, ball(), json!({ "dielectric": { "index": 1.5 } }));
        for i in 0..2000 {
            let [x, y] = [f64::from(i % 50), f64::from(i / 50)].map(|c| -2.0 + 0.08 * c);
            let sphere = json!({ "sphere": { "center": [x, y, 3], "radius": 0.005 } });
            let emission = json!({ "spectrum": "d65", "level": { "luminance_cd_m2": 1000 } });
            let lamp = json!({ "name": format!("lamp {i}"), "shape": sphere, "material": "black", "emission": emission });
            s["objects"].as_array_mut().expect("a list").push(lamp);
        }
    });
    let started = std::time::Instant::now();
    let conditions = found(&scene);
    assert!(started.elapsed().as_secs_f64() < 10.0, "{:?}", started.elapsed());
    let [condition] = &conditions[..] else { panic!("{conditions:#?}") };
    assert!(condition.name == "small_emitter" && condition.place.contains(" more"), "{condition:#?}");
}

#[test]
fn what_is_ordinary_is_not_listed() {
    for ordinary in [plain(), pictured()] {
        assert_eq!(found(&scene(&ordinary)), []);
    }
}

/// What the reference scenes have: from their lamps' luminances and sizes, their materials and
/// their settings, by hand.
const REFERENCES: [(&str, &[&str]); 13] = [
    // The lamp is tabulated from 400 to 700 nm.
    ("cornell", &["dark_range"]),
    // 0.0137 m2 of lamp half a metre above a mirror: at most one ray in 70 meets it.
    ("cornell-ccd", &["dark_range", "small_emitter"]),
    ("cornell-photo", &["dark_range", "small_emitter"]),
    // 0.15 and 0.2 of roughness, 30 s of exposure, a lamp behind a door.
    ("door-ajar", &["camera_model", "facet_loss", "hidden_lamps"]),
    // A sun of 4e8 cd/m2 and one degree, under water.
    ("pool", &["beyond_half_float", "small_emitter"]),
    // A bulb of 3 cm and 48 000 cd/m2; of 2 mm and 1.1e7 cd/m2.
    ("schoedl-2007", &["small_emitter"]),
    ("schoedl-2007-glass-bulb", &["beyond_half_float", "small_emitter"]),
    ("schoedl-2007-small-bulb", &["beyond_half_float", "small_emitter"]),
    // 0.2 and 0.3 of roughness, a lamp of 2e5 cd/m2 behind a slit.
    ("slit-room", &["beyond_half_float", "facet_loss", "hidden_lamps"]),
    ("stanford", &[]),
    ("stanford-left", &[]),
    // 300 lm from a bulb of 3 mm: 7e5 cd/m2.
    ("yale-brown", &["beyond_half_float"]),
    ("yale-grey", &["beyond_half_float"]),
];

#[test]
fn the_reference_scenes_have_the_conditions_that_follow_from_what_they_are() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference");
    let folders = std::fs::read_dir(&folder).expect("the references are there").map(|f| f.expect("readable"));
    let with_scene = folders.filter(|f| f.path().join("scene.json").is_file());
    let all: BTreeSet<String> = with_scene.map(|f| f.file_name().to_string_lossy().into_owned()).collect();
    assert_eq!(all, REFERENCES.iter().map(|(name, _)| (*name).to_owned()).collect());
    for (name, expected) in REFERENCES {
        let scene = Scene::load(&folder.join(name).join("scene.json")).expect("a sound scene");
        assert_eq!(names(&scene), expected, "{name}: {:#?}", found(&scene));
    }
}

#[test]
fn every_condition_says_what_it_does_and_in_finite_figures() {
    for (name, meaning) in LOOKED_FOR {
        assert!(!meaning.is_empty(), "{name}");
        for condition in found(&minimal(name)) {
            assert!(!condition.effect.is_empty() && !condition.limit.is_empty(), "{condition:#?}");
            assert!(condition.figures.iter().all(|(_, value)| value.is_finite()), "{condition:#?}");
            let json = serde_json::to_value(&condition).expect("plain data");
            for key in ["name", "where", "figures", "limit", "effect", "remedy"] {
                assert!(json.get(key).is_some(), "{key}: {json:#}");
            }
            assert!(json["figures"].as_object().is_some(), "{json:#}");
        }
    }
}

#[test]
fn the_page_has_a_row_for_every_condition() {
    let page =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("validation/conditions.md"));
    let page = page.expect("the page is there");
    let rows: Vec<&str> =
        page.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next()).collect();
    assert_eq!(rows, LOOKED_FOR.map(|(name, _)| name));
}
