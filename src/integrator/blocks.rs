//! The loop that fills the film: block after block of samples, every pixel the same number.
//!
//! A row's samples are taken in order by one thread and added up in f64, and rows are added to
//! the film in their order, so the picture does not depend on how many threads there are.

use super::in_order::InOrder;
use super::run::{Gathered, Source};
use super::stopping::Budget;
use super::tracer::Tracer;
use crate::camera::Film;
use crate::path::Subpaths;
use crate::sampler::BlockSampler;
use crate::scene::{Plan, View};
use crate::spectrum::Spectrum;
use rayon::prelude::*;
use std::borrow::Cow;
use std::sync::atomic::{AtomicU64, Ordering};

/// Samples of one block: enough for stratification to pay, few enough for the number of
/// blocks to give a variance.
const BLOCK_SAMPLES: u32 = 16;
/// Blocks that a render has at least, where it has as many samples.
const FEWEST_BLOCKS: u32 = 4;

/// Independent samples under a plan.
pub(super) struct Samples<'a> {
    pub tracer: Tracer<'a>,
    pub view: &'a View,
    pub plan: &'a Plan,
}

impl Source for Samples<'_> {
    fn begin(&self) -> Gathered {
        let channels = self.view.sensor.channels.len();
        let film = Film::new(self.view.camera.resolution(), channels, self.plan.strategies.splats());
        Gathered { film, chains: None }
    }

    /// Where it is open how many there will be, blocks double from one, so that even a short
    /// run holds several.
    fn block_size(&self, budget: &Budget, taken: u64, _block: u32) -> u64 {
        let fitting =
            if budget.is_open() { taken } else { budget.samples_per_pixel / u64::from(FEWEST_BLOCKS) };
        fitting.clamp(1, u64::from(BLOCK_SAMPLES))
    }

    fn block(&self, gathered: &mut Gathered, block: &BlockOf, report_share: &(dyn Fn(f64) + Sync)) {
        render_block(&self.tracer, self.view, &mut gathered.film, block, report_share);
        gathered.film.finish_block(block.size);
    }

    fn picture<'g>(&self, gathered: &'g Gathered) -> Cow<'g, Film> {
        Cow::Borrowed(&gathered.film)
    }
}

/// One block of a run.
pub(crate) struct BlockOf {
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
