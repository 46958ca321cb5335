//! A short run of chains, to see whether they would be better than independent samples.
//!
//! The run is a real one of few mutations, with searches and blocks of its own, on a picture so small
//! that each pixel has many of them, as in the render: where pixels were hardly visited, the scatter
//! between blocks tells of single visits and of nothing else. What the run learns before its first block the render learns again, and
//! pays for.

use super::samples::Findings;
use crate::integrator::Budget;
use crate::metropolis::{AtPixel, short_run};
use crate::scene::{Plan, Scene, View};

/// Pixels of the picture, about.
const PIXELS: u64 = 1 << 12;

/// Factor by which what an error is held against may differ between the two pictures: where it
/// differs more, the chains have not seen all the light that samples did.
const MOST_SCALED: f64 = 100.0;

/// What chains were found to be worth.
#[derive(Clone, Copy, Debug)]
pub struct Chained {
    /// Relative mean squared error of one mutation per pixel.
    pub relmse: f64,
    /// Fresh paths that a run needs however long it is.
    pub needed_paths: f64,
    /// Mutations that were taken.
    pub mutations: u64,
}

/// Runs chains of about so many mutations; `None` where they found nothing to start from. Their
/// error is told on the scale of a list of strategies, by its place among those judged.
///
/// The picture of the chains, each pixel with its neighbours, is finer than the cells of the
/// samples and knows light that samples hardly find: chains and list are compared by it.
pub fn measure(
    scene: &Scene,
    view: &View,
    plan: &Plan,
    (findings, list): (&Findings, usize),
    (seed, mutations): (u64, u64),
) -> Option<Chained> {
    let view = smaller(view, PIXELS);
    let samples_per_pixel = (mutations / PIXELS).max(1);
    let budget = Budget { samples_per_pixel, time: None, error: None, seed };
    let size = view.camera.resolution().map(|side| side as usize);
    let short = short_run(scene, &view, plan, &budget)?;
    let level = |place: [f64; 2]| around(&short.pixels, size, place);
    let of_pixel = |(index, pixel): (usize, &AtPixel)| {
        let place = [(index % size[0], size[0]), (index / size[0], size[1])]
            .map(|(index, side)| (index as f64 + 0.5) / side as f64);
        let whole = level(place) + pixel.direct;
        let over = whole * whole + findings.floor;
        let variance = pixel.chains_error.powi(2) + pixel.direct_error.powi(2);
        if over > 0.0 { variance / over } else { 0.0 }
    };
    let mean = short.pixels.iter().enumerate().map(of_pixel).sum::<f64>() / short.pixels.len() as f64;
    let scale = findings.at_pixels_by_cells(list) / findings.at_pixels(list, level);
    let is_known = scale.is_finite() && scale > 0.0;
    let scale = if is_known { scale.clamp(1.0 / MOST_SCALED, MOST_SCALED) } else { 1.0 };
    Some(Chained {
        relmse: samples_per_pixel as f64 * mean * scale,
        mutations: samples_per_pixel * short.pixels.len() as u64,
        needed_paths: short.needed_paths,
    })
}

/// Light that chains bring at a place and around it: mean over three by three pixels.
fn around(pixels: &[AtPixel], [width, height]: [usize; 2], place: [f64; 2]) -> f64 {
    let near = |share: f64, side: usize| {
        let middle = ((share * side as f64) as usize).min(side - 1);
        middle.saturating_sub(1)..(middle + 2).min(side)
    };
    let columns = near(place[0], width);
    let rows = near(place[1], height);
    let count = columns.len() * rows.len();
    let row =
        |row: usize| columns.clone().map(move |column| pixels[row * width + column].chains).sum::<f64>();
    rows.map(row).sum::<f64>() / count as f64
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
