//! The scenes on which algorithms are compared are sound, bright and soon free of noise.

mod common;

use common::{SIGMAS, scene, scenes};
use etalon::camera::Film;
use etalon::integrator::{Budget, Integrator, Silent, render};
use etalon::scene::Plan;
use serde_json::Value;

const LUMINANCE: usize = 1;

fn path_traced(json: &Value, samples_per_pixel: u64) -> Film {
    let scene = scene(json);
    let view = scene.view().expect("a camera");
    let plan = Plan::of(&scene, &view.sensor, Integrator::Path.strategies());
    let budget = Budget { samples_per_pixel, time: None, seed: 1 };
    render(&scene, view, &plan, &budget, &Silent).film
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
        assert_eq!(film.non_finite_samples, 0, "{name}");
        assert!(error < 0.3, "{name}: relative error {error}");
        let view = scene(&json).view.expect("a camera");
        let level = mean_luminance(&film) / view.facts().white_luminance_cd_m2;
        assert!((0.05..1.5).contains(&level), "{name}: {level} of white");
    }
}

fn pixels(film: &Film) -> std::ops::Range<usize> {
    0..film.pixels()
}

fn mean_luminance(film: &Film) -> f64 {
    pixels(film).map(|p| film.mean(p, LUMINANCE)).sum::<f64>() / film.pixels() as f64
}
