//! The loop that fills the film: block after block of samples, every pixel the same number.
//!
//! A row's samples are taken in order by one thread and added up in f64, and rows are added to
//! the film in their order, so the picture does not depend on how many threads there are.

use super::in_order::InOrder;
use super::tracer::Tracer;
use crate::camera::Film;
use crate::metropolis::Outcome;
use crate::path::Subpaths;
use crate::sampler::BlockSampler;
use crate::scene::{Plan, View};
use crate::spectrum::Spectrum;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Samples of one block: enough for stratification to pay, few enough for the number of
/// blocks to give a variance.
const BLOCK_SAMPLES: u32 = 16;
/// Blocks that a render has at least, where it has as many samples.
const FEWEST_BLOCKS: u32 = 4;

/// When a render ends, and what its random numbers start from.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Samples per pixel; reached exactly unless time runs out first.
    pub samples_per_pixel: u64,
    /// Time after which no further block is begun.
    pub time: Option<Duration>,
    /// Names the run.
    pub seed: u64,
}

/// Told how a render goes.
pub trait Progress: Sync {
    /// After each block: samples per pixel so far, and the film.
    fn block(&self, budget: &Budget, started: Instant, film: &Film);
    /// Within a block: samples per pixel so far, those of the block in proportion to the rows
    /// that are done.
    fn within_block(&self, _budget: &Budget, _started: Instant, _samples: f64) {}
}

/// No report at all.
#[derive(Clone, Copy, Debug)]
pub struct Silent;

impl Progress for Silent {
    fn block(&self, _: &Budget, _: Instant, _: &Film) {}
}

/// A finished render.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The picture and its error.
    pub film: Film,
    /// Time it took.
    pub elapsed: Duration,
    /// What chains say about themselves, where there were any.
    pub metropolis: Option<Outcome>,
}

pub(super) fn render(
    tracer: &Tracer<'_>,
    view: &View,
    plan: &Plan,
    budget: &Budget,
    progress: &dyn Progress,
) -> Rendering {
    let started = Instant::now();
    let mut film = Film::new(view.camera.resolution(), view.sensor.channels.len(), plan.strategies.splats());
    let mut block = 0;
    while film.samples_per_pixel() < budget.samples_per_pixel {
        let late = budget.time.is_some_and(|limit| started.elapsed() >= limit);
        // One block cannot give an error estimate; the second is taken even when late.
        if late && block >= 2 {
            break;
        }
        let left = budget.samples_per_pixel - film.samples_per_pixel();
        let size = block_size(budget, film.samples_per_pixel()).min(left) as u32;
        let taken = film.samples_per_pixel() as f64;
        let within = |share: f64| progress.within_block(budget, started, taken + share * f64::from(size));
        let of = BlockOf { seed: budget.seed, number: block, size };
        render_block(tracer, view, &mut film, &of, &within);
        film.finish_block(size);
        block += 1;
        progress.block(budget, started, &film);
    }
    Rendering { film, elapsed: started.elapsed(), metropolis: None }
}

/// Samples of the next block. Against the clock blocks double from one, so that even a short
/// time holds several.
fn block_size(budget: &Budget, taken: u64) -> u64 {
    let fitting = match budget.time {
        Some(_) => taken,
        None => budget.samples_per_pixel / u64::from(FEWEST_BLOCKS),
    };
    fitting.clamp(1, u64::from(BLOCK_SAMPLES))
}

/// One block of a run.
pub(super) struct BlockOf {
    pub seed: u64,
    pub number: u32,
    pub size: u32,
}

/// What a row of a block's samples has found.
struct RowResult {
    /// Sums of the row's own pixels, channel by channel.
    own: Vec<f64>,
    /// Pixels elsewhere that light was joined to the eye at, in the order found.
    splat_pixels: Vec<u32>,
    /// What they recorded, channel by channel.
    splat_values: Vec<f64>,
    non_finite: u64,
}

pub(super) fn render_block(
    tracer: &Tracer<'_>,
    view: &View,
    film: &mut Film,
    block: &BlockOf,
    report_share: &(dyn Fn(f64) + Sync),
) {
    let [_, height] = view.camera.resolution();
    let rows_done = AtomicU64::new(0);
    let merge = InOrder::new(|row, result: RowResult| {
        film.add_row(row, &result.own, block.size);
        film.add_splats(&result.splat_pixels, &result.splat_values);
        film.non_finite_samples += result.non_finite;
    });
    (0..height as usize).into_par_iter().with_max_len(1).for_each(|row| {
        let result = render_row(tracer, view, block, row);
        merge.add(row, result);
        let done = rows_done.fetch_add(1, Ordering::Relaxed) + 1;
        report_share(done as f64 / f64::from(height));
    });
}

fn render_row(tracer: &Tracer<'_>, view: &View, block: &BlockOf, row: usize) -> RowResult {
    let [width, _] = view.camera.resolution();
    let sensor = &view.sensor;
    let channels = sensor.channels.len();
    let mut result = RowResult {
        own: vec![0.0; width as usize * channels],
        splat_pixels: Vec::new(),
        splat_values: Vec::new(),
        non_finite: 0,
    };
    let mut paths = Subpaths::default();
    for (column, own) in result.own.chunks_exact_mut(channels).enumerate() {
        let pixel = row as u64 * u64::from(width) + column as u64;
        let numbers = BlockSampler::new(block.seed, pixel, block.number, block.size);
        for index in 0..block.size {
            let sampler = numbers.sample(index);
            let corner = [column as f64, row as f64];
            let mut radiance = Spectrum::ZERO;
            let wavelengths =
                tracer.sample(corner, &sampler, &mut paths, &mut |contribution, wavelengths| {
                    let weighed = contribution.estimate * contribution.weight;
                    if !weighed.is_finite() {
                        result.non_finite += 1;
                    } else if let Some([x, y]) = contribution.position {
                        result.splat_pixels.push(y as u32 * width + x as u32);
                        let first = result.splat_values.len();
                        result.splat_values.resize(first + channels, 0.0);
                        let values = &mut result.splat_values[first..];
                        sensor.record(weighed, wavelengths, |channel, value| values[channel] = value);
                    } else {
                        radiance += weighed;
                    }
                });
            sensor.record(radiance, &wavelengths, |channel, value| own[channel] += value);
        }
    }
    result
}
