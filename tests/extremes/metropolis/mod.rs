//! Chains: where they start, what they know of their level, what they are blind to.

mod chains;
mod levels;
mod nothing;
mod steps;

use crate::case::Case;
use crate::cases;
use chains::*;
use levels::*;
use nothing::*;
use steps::*;

pub const CASES: &[Case] = cases![
    statistical 64 => seeds_agree_and_chains_that_have_not_mixed_say_so,
    statistical 65 => the_interval_of_the_level_holds_the_truth,
    fixed 66 => light_that_is_not_found_is_no_picture,
    fixed 67 => without_lamps_the_picture_is_black_and_says_why,
    statistical 68 => long_rejections_and_large_pixels_are_told,
    statistical 69 => fresh_paths_are_always_among_the_mutations,
    statistical 69 => rooms_beside_one_another_are_as_bright_as_by_independent_samples,
    statistical 70 => chains_leave_paths_that_are_worth_nothing_or_no_number,
    statistical 71 => light_that_is_hardly_luminous_is_seen,
    statistical 72 => steps_round_the_ends_of_the_interval_keep_known_densities,
    statistical 72 => steps_lead_there_as_often_as_back,
];

use etalon::integrator::{Budget, Integrator, Rendering, Silent};
use etalon::metropolis::Report;
use etalon::scene::{Plan, Scene};

/// Independent runs by which an error is known.
const RUNS: u64 = 16;

/// Renders a scene.
fn rendering(scene: &Scene, integrator: Integrator, samples_per_pixel: u64, seed: u64) -> Rendering {
    let view = scene.view().expect("a camera");
    let plan = Plan::of(scene, &view.sensor, integrator.strategies());
    let budget = Budget { samples_per_pixel, time: None, error: None, seed };
    integrator.render(scene, view, &plan, &budget, &Silent)
}

/// What the chains of a run say of themselves; they must have found light.
fn report(rendering: &Rendering) -> &Report {
    let outcome = rendering.metropolis.as_ref().expect("chains");
    outcome.report.as_ref().expect("light was found")
}

/// Mean of a channel over a picture's pixels that are chosen by their column.
fn mean_of(rendering: &Rendering, channel: usize, chosen: impl Fn(u32) -> bool) -> f64 {
    let film = &rendering.film;
    let width = film.resolution()[0];
    let pixels: Vec<usize> = (0..film.pixels()).filter(|pixel| chosen(*pixel as u32 % width)).collect();
    pixels.iter().map(|pixel| film.mean(*pixel, channel)).sum::<f64>() / pixels.len() as f64
}

/// Mean over runs of their own seeds, with its standard error.
fn over_runs(seed: u64, run: impl Fn(u64) -> f64) -> [f64; 2] {
    let values: Vec<f64> = (0..RUNS).map(|index| run(seed.wrapping_add(index))).collect();
    let n = RUNS as f64;
    let mean = values.iter().sum::<f64>() / n;
    [mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt()]
}
