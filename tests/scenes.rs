//! The scenes on which algorithms are compared are sound, bright and soon free of noise.

mod common;

use common::{SIGMAS, scene, scenes};
use etalon::camera::Film;
use etalon::integrator::{Budget, Integrator, Silent, render};
use etalon::scene::{Plan, Scene, unreachable};
use serde_json::{Value, json};
use std::path::Path;

const LUMINANCE: usize = 1;

/// Scenes of `reference/` whose light is hard to find.
const HARD: [&str; 5] =
    ["slit-room", "door-ajar", "pool", "schoedl-2007-small-bulb", "schoedl-2007-glass-bulb"];

fn path_traced(json: &Value, samples_per_pixel: u64) -> Film {
    rendered(&scene(json), Integrator::Path, samples_per_pixel)
}

fn rendered(scene: &Scene, integrator: Integrator, samples_per_pixel: u64) -> Film {
    let view = scene.view().expect("a camera");
    let plan = Plan::of(scene, &view.sensor, integrator.strategies());
    let budget = Budget { samples_per_pixel, time: None, error: None, seed: 1 };
    render(scene, view, &plan, &budget, &Silent).film
}

/// Everywhere inside a shining ball the luminance is what it gives off over one minus its
/// reflectance.
#[test]
fn the_ball_has_its_closed_form() {
    let film = path_traced(&scenes::ball(), 256);
    let truth = scenes::BALL_LUMINANCE_CD_M2 / (1.0 - scenes::BALL_REFLECTANCE);
    let mean = mean_luminance(&film);
    let error = pixels(&film).map(|p| film.standard_error(p, LUMINANCE).powi(2)).sum::<f64>().sqrt()
        / film.pixels() as f64;
    assert!(error < 1e-3 * truth, "too noisy to judge: {mean} +- {error}");
    assert!((mean - truth).abs() < SIGMAS * error + 2e-5 * truth, "{mean} +- {error}, truth {truth}");
}

/// Path tracing gets within 30 % of every pixel in 64 samples, root mean square; there is light,
/// and the exposure shows it.
#[test]
fn path_tracing_converges_on_every_scene() {
    for json in scenes::all() {
        let name = json["name"].as_str().expect("a name");
        let film = path_traced(&json, 64);
        let error = film.relative_error().expect("several blocks");
        assert_eq!(film.faults.count, 0, "{name}");
        assert!(error < 0.3, "{name}: relative error {error}");
        let view = scene(&json).view.expect("a camera");
        let level = mean_luminance(&film) / view.facts().white_luminance_cd_m2;
        assert!((0.05..1.5).contains(&level), "{name}: {level} of white");
    }
}

/// No light of a hard scene is out of bidirectional path tracing's reach, and the exposure shows it.
#[test]
fn hard_scenes_are_within_reach_and_well_exposed() {
    for name in HARD {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference").join(name);
        let text = std::fs::read_to_string(folder.join("scene.json")).expect("the scene is there");
        let mut json: Value = serde_json::from_str(&text).expect("JSON");
        json["camera"]["resolution"] = json!([16, 16]);
        let scene = Scene::from_text(&json.to_string(), &folder).unwrap_or_else(|e| panic!("{name}: {e}"));
        let missing = unreachable(&scene, &Integrator::Bdpt.strategies());
        assert!(missing.is_empty(), "{name}: {missing:?}");
        let film = rendered(&scene, Integrator::Bdpt, 256);
        assert_eq!(film.faults.count, 0, "{name}");
        let level = mean_luminance(&film) / scene.view().expect("a camera").facts().white_luminance_cd_m2;
        assert!((0.05..1.5).contains(&level), "{name}: {level} of white");
    }
}

fn pixels(film: &Film) -> std::ops::Range<usize> {
    0..film.pixels()
}

fn mean_luminance(film: &Film) -> f64 {
    pixels(film).map(|p| film.mean(p, LUMINANCE)).sum::<f64>() / film.pixels() as f64
}
