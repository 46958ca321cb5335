//! The loop that fills the film: block after block of samples, every pixel the same number.
//!
//! A pixel's samples are taken in order by one thread and added up in f64, so the picture
//! does not depend on how many threads there are.

use super::path::PathTracer;
use crate::camera::{BlockStatistics, Film, Sensor};
use crate::sampler::{BlockSampler, Sampler, Stream};
use crate::scene::{Plan, View};
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
}

pub(super) fn render(
    tracer: &PathTracer<'_>,
    view: &View,
    plan: &Plan,
    budget: &Budget,
    progress: &dyn Progress,
) -> Rendering {
    let started = Instant::now();
    let mut film = Film::new(view.camera.resolution(), view.sensor.channels.len());
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
        render_block(tracer, view, plan, &mut film, &of, &within);
        film.finish_block(size);
        block += 1;
        progress.block(budget, started, &film);
    }
    Rendering { film, elapsed: started.elapsed() }
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
struct BlockOf {
    seed: u64,
    number: u32,
    size: u32,
}

fn render_block(
    tracer: &PathTracer<'_>,
    view: &View,
    plan: &Plan,
    film: &mut Film,
    block: &BlockOf,
    report_share: &(dyn Fn(f64) + Sync),
) {
    let [width, height] = view.camera.resolution();
    let channels = film.channels();
    let non_finite = AtomicU64::new(0);
    let rows_done = AtomicU64::new(0);
    film.rows_mut().enumerate().par_bridge().for_each(|(row, pixels)| {
        for (column, statistics) in pixels.chunks_exact_mut(channels).enumerate() {
            let pixel = row as u64 * u64::from(width) + column as u64;
            let numbers = BlockSampler::new(block.seed, pixel, block.number, block.size);
            let mut sums = vec![0.0; channels];
            for index in 0..block.size {
                let sampler = numbers.sample(index);
                let place = [column as f64, row as f64];
                if !sample(tracer, view, plan, place, &sampler, &mut sums) {
                    non_finite.fetch_add(1, Ordering::Relaxed);
                }
            }
            add(statistics, &sums, block.size);
        }
        let done = rows_done.fetch_add(1, Ordering::Relaxed) + 1;
        report_share(done as f64 / f64::from(height));
    });
    film.non_finite_samples += non_finite.into_inner();
}

/// Adds one sample of a pixel to the channels' sums; false, and nothing added, where it is
/// not finite.
fn sample(
    tracer: &PathTracer<'_>,
    view: &View,
    plan: &Plan,
    [left, top]: [f64; 2],
    sampler: &Sampler,
    sums: &mut [f64],
) -> bool {
    let [x, y] = sampler.pair(Stream::Pixel, 0).map(f64::from);
    let u_lens = if view.camera.has_aperture() { sampler.pair(Stream::Lens, 0) } else { [0.0; 2] };
    let wavelengths = plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
    let ray = view.camera.ray([left + x, top + y], u_lens);
    let radiance = tracer.radiance(ray, &wavelengths, sampler);
    if !radiance.is_finite() {
        return false;
    }
    let sensor: &Sensor = &view.sensor;
    sensor.record(radiance, &wavelengths, |channel, value| sums[channel] += value);
    true
}

fn add(statistics: &mut [BlockStatistics], sums: &[f64], size: u32) {
    for (statistic, sum) in statistics.iter_mut().zip(sums) {
        statistic.add_block(*sum, size);
    }
}
