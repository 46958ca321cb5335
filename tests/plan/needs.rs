//! Scenes against what they are expected to need.

use crate::common::{scene, scenes as common};
use crate::scenes;
use etalon::camera::Sensor;
use etalon::integrator::Integrator;
use etalon::light::Light;
use etalon::scene::{Decision, Leaving, PLAN_ITEMS, Plan, Scene, View};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// What a matte scene with one lamp of daylight before a pinhole has no use for, for
/// bidirectional path tracing, which lists every strategy.
const MATTE: [&str; 8] = [
    // The table of daylight ends at 780 nm.
    "outer-wavelengths",
    "even-wavelengths",
    "lane-densities",
    "media",
    "lens",
    "lamp-choice",
    "direct-asks-eye",
    "meets-eye",
];

/// A scene, and what it needs.
type Needs = (fn() -> Value, &'static str);

/// Every small scene: what differs from [`MATTE`], `+` for what is left out besides, `-` for what
/// is needed here.
#[rustfmt::skip]
pub const SMALL: [Needs; 21] = [
    (common::diffuse, "+light-to-eye"),
    (common::glossy, "+light-to-eye"),
    (common::glass, "+light-to-eye"),
    (common::dispersive_prism, "-lane-densities -lamp-choice +light-to-eye"),
    (common::metal, "+light-to-eye"),
    // Nothing is smooth: light is joined to the lens.
    (common::thin_lens, "-lens +light-to-eye"),
    (common::tiny_bulb, "+light-to-eye"),
    (common::large_panel, "+light-to-eye"),
    // Above the picture.
    (common::point_light, "+meets-lights +light-to-eye"),
    (common::light_in_glass, "+light-to-eye"),
    (common::camera_in_glass, "+light-to-eye"),
    (common::camera_in_absorbing_glass, "-media +light-to-eye"),
    (common::smooth_normals, "+light-to-eye"),
    (common::ball, "+light-to-eye"),
    // Its glass both absorbs and disperses; its point lights hang above the picture.
    (common::many_lamps, "-lane-densities -media -lamp-choice +light-to-eye"),
    (scenes::band, "+light-to-eye"),
    (scenes::lines, "+light-to-eye"),
    (scenes::chart, "-direct-asks-eye +joins +asks-eye +light-to-eye"),
    (scenes::mirrors, "-direct-asks-eye +asks-lights +joins +asks-eye +light-to-eye"),
    // A lens takes every point light for one in view.
    (scenes::point_in_glass, "-lens -meets-eye +meets-lights"),
    (scenes::point_in_view, "+meets-lights"),
];

/// The same of the reference scenes.
const REFERENCE: [(&str, &str); 13] = [
    ("cornell", "+light-to-eye"),
    ("cornell-ccd", "+light-to-eye"),
    ("cornell-photo", "+light-to-eye"),
    ("door-ajar", "-outer-wavelengths +light-to-eye"),
    ("pool", "-outer-wavelengths -media +light-to-eye"),
    // A lens before smooth glass or metal.
    ("schoedl-2007", "-outer-wavelengths -lens -meets-eye +light-to-eye"),
    ("schoedl-2007-glass-bulb", "-outer-wavelengths -lens -meets-eye +light-to-eye"),
    ("schoedl-2007-small-bulb", "-outer-wavelengths -lens -meets-eye +light-to-eye"),
    ("slit-room", "-outer-wavelengths +light-to-eye"),
    ("stanford", "+light-to-eye"),
    ("stanford-left", "+light-to-eye"),
    ("yale-brown", "-outer-wavelengths +light-to-eye"),
    ("yale-grey", "-outer-wavelengths +light-to-eye"),
];

fn expected(differences: &str) -> Vec<&str> {
    let mut items: Vec<&str> = MATTE.to_vec();
    for difference in differences.split_whitespace() {
        match difference.split_at(1) {
            ("+", item) => items.push(item),
            (_, item) => items.retain(|other| *other != item),
        }
    }
    items.sort_unstable();
    items
}

/// What a plan leaves out.
pub fn left_out(plan: &Plan) -> Vec<&'static str> {
    let items = plan.items.iter().filter(|item| item.decision == Decision::LeftOut);
    let mut names: Vec<&str> = items.map(|item| item.name).collect();
    names.sort_unstable();
    names
}

fn of_bdpt(scene: &Scene, leaving: &Leaving) -> Plan {
    let view = scene.view().expect("a camera");
    Plan::under(scene, &view.sensor, Integrator::Bdpt.strategies(), leaving)
}

fn reference() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("reference")
}

fn reference_scene(name: &str) -> Scene {
    Scene::load(&reference().join(name).join("scene.json")).expect("a reference scene")
}

#[test]
fn every_scene_needs_what_it_is_expected_to() {
    for (json, differences) in SMALL {
        let json = json();
        let found = left_out(&of_bdpt(&scene(&json), &Leaving::all()));
        assert_eq!(found, expected(differences), "{}", json["name"]);
    }
    for (name, differences) in REFERENCE {
        let found = left_out(&of_bdpt(&reference_scene(name), &Leaving::all()));
        assert_eq!(found, expected(differences), "{name}");
    }
}

#[test]
fn the_tables_hold_every_scene_and_every_item() {
    let mut folders: Vec<String> = std::fs::read_dir(reference())
        .expect("the reference scenes")
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|folder| folder.join("scene.json").is_file())
        .map(|folder| folder.file_name().expect("a name").to_string_lossy().into_owned())
        .collect();
    folders.sort();
    let mut listed = REFERENCE.map(|(name, _)| name).to_vec();
    listed.sort_unstable();
    assert_eq!(folders, listed);
    let names = |json: &Value| json["name"].as_str().expect("a name").to_owned();
    let small: Vec<String> = SMALL.iter().map(|(json, _)| names(&json())).collect();
    for json in common::all() {
        assert!(small.contains(&names(&json)), "{}", json["name"]);
    }
    for item in PLAN_ITEMS {
        let tables = SMALL.iter().map(|(_, differences)| differences);
        let tables: Vec<_> = tables.chain(REFERENCE.iter().map(|(_, differences)| differences)).collect();
        let is_left_out = tables.iter().any(|differences| expected(differences).contains(&item));
        let is_needed = tables.iter().any(|differences| !expected(differences).contains(&item));
        // No scene wants its wavelengths drawn evenly.
        assert!(is_left_out && (is_needed || item == "even-wavelengths"), "{item}");
    }
}

/// Whatever a plan is told to keep, it keeps, and says why; and the full plan leaves out nothing.
#[test]
fn what_is_to_be_kept_is_kept() {
    for (json, _) in SMALL {
        let scene = scene(&json());
        assert_eq!(left_out(&of_bdpt(&scene, &Leaving::none())), [""; 0]);
        let lean = left_out(&of_bdpt(&scene, &Leaving::all()));
        for item in PLAN_ITEMS {
            let plan = of_bdpt(&scene, &Leaving::all_but([item]).expect("an item"));
            assert!(!left_out(&plan).contains(&item), "{item}");
            if lean.contains(&item) {
                let reason = &plan.item(item).expect("a decision").reason;
                assert!(reason.starts_with("kept as asked for"), "{item}: {reason}");
            }
        }
    }
}

/// No wavelength is left out at which a lamp shines and the observer responds, whatever the plan:
/// between any two grid points, and on any line.
#[test]
fn no_wavelength_is_left_out_that_counts() {
    let small = SMALL.iter().map(|(json, _)| scene(&json()));
    for scene in small.chain(REFERENCE.iter().map(|(name, _)| reference_scene(name))) {
        let View { sensor, .. } = scene.view().expect("a camera");
        for leaving in ["lean", "full", "keep=outer-wavelengths", "keep=even-wavelengths"] {
            let plan = of_bdpt(&scene, &leaving.parse().expect("a setting"));
            assert_covers(&scene, sensor, &plan, leaving);
        }
    }
}

fn assert_covers(scene: &Scene, sensor: &Sensor, plan: &Plan, leaving: &str) {
    let attention = sensor.attention();
    for index in 0..scene.lights.len() {
        let emission = match scene.lights.get(index as u32) {
            Light::Point(light) => &light.intensity,
            Light::Area(light) => light.radiance(),
        };
        let values: Vec<f64> = emission.at_grid_points().zip(&attention).map(|(e, a)| e * a).collect();
        for (cell, ends) in values.windows(2).enumerate() {
            let nm = 360.5 + cell as f64;
            let counts = ends[0] + ends[1] > 0.0;
            assert!(!counts || plan.wavelengths.pdf_per_nm(nm) > 0.0, "{}, {leaving}: {nm} nm", scene.name);
        }
        for (line, power) in emission.lines().filter(|(_, power)| *power > 0.0) {
            let probability = plan.wavelengths.line_probability(line);
            assert!(probability > 0.0, "{}, {leaving}: line {line} of {power}", scene.name);
        }
    }
}
