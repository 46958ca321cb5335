//! Pictures of independent runs by any algorithm, as means with errors that owe nothing to what
//! the algorithm says of itself.

use etalon::camera::Film;
use etalon::integrator::{Budget, Integrator, Silent};
use etalon::scene::{Plan, Scene};
use etalon::statistics::{BATCHES, BatchMean};

/// Films of [`BATCHES`] runs, each of so many samples per pixel.
pub fn films(scene: &Scene, integrator: Integrator, samples_per_pixel: u64, seed: u64) -> Vec<Film> {
    let view = scene.view().expect("a camera");
    let plan = Plan::of(scene, &view.sensor, integrator.strategies());
    let run = |run: u64| {
        let seed = (seed.wrapping_mul(16) + integrator as u64).wrapping_mul(BATCHES as u64) + run;
        let budget = Budget { samples_per_pixel, time: None, error: None, seed };
        integrator.render(scene, view, &plan, &budget, &Silent).film
    };
    (0..BATCHES as u64).map(run).collect()
}

/// Mean of a function of each film over the films.
pub fn mean_of(films: &[Film], value: impl Fn(&Film) -> f64) -> BatchMean {
    BatchMean::of(&std::array::from_fn(|run| value(&films[run])))
}

/// Means of X, Y and Z over the picture.
pub fn picture_xyz(films: &[Film]) -> [BatchMean; 3] {
    let whole = |film: &Film, channel| {
        let pixels = 0..film.pixels();
        pixels.map(|pixel| film.mean(pixel, channel)).sum::<f64>() / film.pixels() as f64
    };
    [0, 1, 2].map(|channel| mean_of(films, |film| whole(film, channel)))
}
