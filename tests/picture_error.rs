//! What a picture says of its own error, held against how pictures of independent runs scatter.
//!
//! The mean of all runs but one is the truth that the one is held against: its own noise adds
//! 1 / (RUNS - 1) of the variance, which is taken off. False alarms: once in a thousand for each
//! of the two sides of each law, were every statement exact.

mod common;

use common::{scene, scenes};
use etalon::camera::{Film, PictureError};
use etalon::integrator::{Budget, Integrator, Silent};
use etalon::scene::Plan;
use rayon::prelude::*;
use serde_json::json;
use statrs::distribution::{Binomial, ContinuousCDF, DiscreteCDF, FisherSnedecor};

const RUNS: u64 = 192;
const LUMINANCE: usize = 1;
/// Probability of a false alarm of each comparison.
const ALARM: f64 = 1e-3;
/// What the picture in place of the truth may bend the estimate by, at errors of up to about 10 %.
const MOST_BIAS: f64 = 0.1;

/// Samples that bring the error to 10 % or below, in 16 blocks where pixels share paths.
const fn samples_per_pixel(integrator: Integrator) -> u64 {
    if matches!(integrator, Integrator::Path) { 64 } else { 256 }
}

/// Pictures of a room of matte surfaces.
fn films(integrator: Integrator) -> Vec<Film> {
    let mut json = scenes::diffuse();
    json["camera"]["resolution"] = json!([16, 12]);
    let scene = scene(&json);
    let view = scene.view().expect("a camera");
    let plan = Plan::of(&scene, &view.sensor, integrator.strategies());
    let run = |run: u64| {
        let seed = (run << 8) + integrator as u64;
        let budget =
            Budget { samples_per_pixel: samples_per_pixel(integrator), time: None, error: None, seed };
        integrator.render(&scene, view, &plan, &budget, &Silent).film
    };
    (0..RUNS).into_par_iter().map(run).collect()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

/// Variance of the mean luminance of the pictures, and what they say of it: by squares of pixels,
/// and as if pixels shared nothing.
fn whole(films: &[Film]) -> [f64; 3] {
    let pixels = films[0].pixels();
    let level = |film: &Film| mean((0..pixels).map(|pixel| film.mean(pixel, LUMINANCE)));
    let all = mean(films.iter().map(level));
    let count = films.len() as f64;
    let scatter = mean(films.iter().map(|film| (level(film) - all).powi(2))) * count / (count - 1.0);
    let stated = |film: &Film| film.cell_errors().and_then(|cells| cells.of_whole()).expect("many blocks");
    let naive = |film: &Film| {
        mean((0..pixels).map(|pixel| film.standard_error(pixel, LUMINANCE).powi(2))) / pixels as f64
    };
    [scatter, mean(films.iter().map(|film| stated(film).powi(2))), mean(films.iter().map(naive))]
}

/// relMSE of each picture against the mean of the others.
fn realised(films: &[Film]) -> Vec<f64> {
    let (pixels, count) = (films[0].pixels(), films.len() as f64);
    let sum = |pixel| films.iter().map(|film| film.mean(pixel, LUMINANCE)).sum::<f64>();
    let sums: Vec<f64> = (0..pixels).map(sum).collect();
    let floor = (0.01 * sums.iter().sum::<f64>() / count / pixels as f64).powi(2);
    let of_film = |film: &Film| {
        mean((0..pixels).map(|pixel| {
            let value = film.mean(pixel, LUMINANCE);
            let truth = (sums[pixel] - value) / (count - 1.0);
            (value - truth).powi(2) * (count - 1.0) / count / (truth * truth + floor)
        }))
    };
    films.iter().map(of_film).collect()
}

/// Holds all that films say against their scatter.
fn examine(integrator: Integrator) -> Vec<Film> {
    let films = films(integrator);
    let name = integrator.name();
    let [scatter, stated, naive] = whole(&films);
    let truths = realised(&films);
    let errors: Vec<PictureError> = films.iter().map(|film| film.error().expect("light")).collect();
    let holds = |(error, truth): &(&PictureError, &f64)| {
        let [low, high] = error.relmse_ci95.expect("many blocks");
        (low..=high).contains(*truth)
    };
    let held = errors.iter().zip(&truths).filter(holds).count() as u64;
    let ratio = mean(errors.iter().map(|error| error.relmse)) / mean(truths.iter().copied());
    let heavy = errors.iter().filter(|error| error.heavy_tail).count();
    println!(
        "{name}: {} blocks, relative error {:.3}, estimated over real {ratio:.3}, held {held} of {RUNS}, heavy {heavy}, scatter of the whole over stated {:.3}, over naive {:.3}",
        films[0].blocks(),
        mean(truths.iter().copied()).sqrt(),
        scatter / stated,
        scatter / naive
    );
    let blocks = f64::from(films[0].blocks());
    let law = FisherSnedecor::new(RUNS as f64 - 1.0, RUNS as f64 * (blocks - 1.0)).expect("a law");
    let [low, high] = [ALARM, 1.0 - ALARM].map(|p| law.inverse_cdf(p));
    assert!((low..=high).contains(&(scatter / stated)), "{name}: whole picture, {low} to {high}");
    let fewest = Binomial::new(0.95, RUNS).expect("a law").inverse_cdf(ALARM);
    assert!(held >= fewest, "{name}: the interval held {held} of {RUNS}, fewer than {fewest}");
    assert!((ratio - 1.0).abs() < MOST_BIAS, "{name}: estimated over real {ratio}");
    assert_eq!(heavy, 0, "{name}");
    films
}

#[test]
fn path_tracing_knows_its_error() {
    let films = examine(Integrator::Path);
    assert!(films.iter().all(|film| !film.is_correlated()));
}

/// Pixels share paths: as if they shared nothing, the error of the whole picture would be wrong.
#[test]
fn light_tracing_knows_its_error() {
    let films = examine(Integrator::Light);
    assert!(films.iter().all(|film| film.is_correlated() && film.blocks() >= 16));
    let [scatter, _, naive] = whole(&films);
    let law = FisherSnedecor::new(RUNS as f64 - 1.0, RUNS as f64 * 15.0).expect("a law");
    let [low, high] = [ALARM, 1.0 - ALARM].map(|p| law.inverse_cdf(p));
    assert!(!(low..=high).contains(&(scatter / naive)), "{scatter} against {naive}");
}

#[test]
fn bidirectional_path_tracing_knows_its_error() {
    let films = examine(Integrator::Bdpt);
    assert!(films.iter().all(|film| film.is_correlated() && film.blocks() >= 16));
}

#[test]
fn chains_know_their_error() {
    let films = examine(Integrator::Mlt);
    assert!(films.iter().all(|film| film.is_correlated() && film.blocks() >= 16));
}
