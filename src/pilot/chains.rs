//! A short run of chains, to see whether they would be better than independent samples.
//!
//! The run is a real one of few mutations on a small picture, with searches and blocks of its own:
//! the scatter between its blocks is what is measured, held against the same squares as that of
//! samples. What it learns before its first block is done again by the render and counted there.

use super::samples::Findings;
use crate::camera::Film;
use crate::integrator::{Budget, Integrator, Silent};
use crate::scene::{Plan, Scene, View};

/// Mutations per pixel: each is a block of its own.
const BLOCKS: u64 = 8;
/// Channel of the luminance.
const LUMINANCE: usize = 1;

/// What chains were found to be worth.
#[derive(Clone, Copy, Debug)]
pub struct Chained {
    /// Relative mean squared error of one mutation per pixel.
    pub relmse: f64,
    /// Mutations that were taken.
    pub mutations: u64,
}

/// Runs chains of about so many mutations; `None` where they found nothing to start from.
pub fn measure(
    scene: &Scene,
    view: &View,
    plan: &Plan,
    findings: &Findings,
    (seed, mutations): (u64, u64),
) -> Option<Chained> {
    let view = smaller(view, mutations / BLOCKS);
    let budget = Budget { samples_per_pixel: BLOCKS, time: None, error: None, seed };
    let rendering = Integrator::Mlt.render(scene, &view, plan, &budget, &Silent);
    let found_nothing = rendering.metropolis.is_none_or(|outcome| outcome.report.is_none());
    if found_nothing {
        return None;
    }
    let film = &rendering.film;
    let relmse = BLOCKS as f64 * relative(film, findings);
    Some(Chained { relmse, mutations: BLOCKS * film.pixels() as u64 })
}

/// The view in about so many pixels, or in as many as it has.
fn smaller(view: &View, pixels: u64) -> View {
    let [width, height] = view.camera.resolution().map(f64::from);
    let scale = (pixels as f64 / (width * height)).sqrt().min(1.0);
    let mut view = view.clone();
    if scale < 1.0 {
        let resolution = [width, height].map(|side| ((side * scale).round() as u32).max(1));
        view.camera = view.camera.with_resolution(resolution);
    }
    view
}

/// Mean over pixels of variance over what samples found the squared luminance to be.
fn relative(film: &Film, findings: &Findings) -> f64 {
    let [width, height] = film.resolution().map(|side| side as usize);
    let of_pixel = |pixel: usize| {
        let place = [(pixel % width, width), (pixel / width, height)]
            .map(|(index, side)| (index as f64 + 0.5) / side as f64);
        let square = findings.squares[findings.grid.at(place)];
        let variance = film.standard_error(pixel, LUMINANCE).powi(2);
        if square > 0.0 { variance / square } else { 0.0 }
    };
    (0..film.pixels()).map(of_pixel).sum::<f64>() / film.pixels() as f64
}
