//! The loop that fills the film: block after block of samples, every pixel the same number.
//!
//! A row's samples are taken in order by one thread and added up in f64, and rows are added to
//! the film in their order, so the picture does not depend on how many threads there are.

use super::in_order::for_each_in_order;
use super::run::{Gathered, Source};
use super::stopping::Budget;
use super::tracer::Tracer;
use crate::camera::{Film, Sensor};
use crate::path::{BothFates, Contribution, Subpaths};
use crate::replay::{Faults, PixelSample, SampleName};
use crate::sampler::{BlockSampler, Sampler};
use crate::scene::{Plan, View};
use crate::spectrum::{Spectrum, Wavelengths};
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

    fn block_size(&self, budget: &Budget, taken: u64, _block: u32) -> u64 {
        next_block_size(budget, taken)
    }

    fn block(&self, gathered: &mut Gathered, block: &BlockOf, report_share: &(dyn Fn(f64) + Sync)) {
        render_block(&self.tracer, self.view, &mut gathered.film, block, report_share);
        gathered.film.finish_block(block.size);
    }

    fn picture<'g>(&self, gathered: &'g Gathered) -> Cow<'g, Film> {
        Cow::Borrowed(&gathered.film)
    }
}

/// Samples of the next block. Where it is open how many there will be, blocks double from one, so
/// that even a short run holds several.
fn next_block_size(budget: &Budget, taken: u64) -> u64 {
    let fitting = if budget.is_open() { taken } else { budget.samples_per_pixel / u64::from(FEWEST_BLOCKS) };
    fitting.clamp(1, u64::from(BLOCK_SAMPLES))
}

/// Samples of a whole block of a render that is told its samples per pixel.
pub fn block_size(samples_per_pixel: u64) -> u32 {
    let left = Budget { samples_per_pixel, time: None, error: None, seed: 0 };
    next_block_size(&left, 0).min(samples_per_pixel.max(1)) as u32
}

/// Samples of one block of a run of independent samples, or of one of its halves, that has taken
/// so many samples per pixel.
///
/// # Errors
/// The number of blocks that were taken, where the block is none of them.
pub fn size_of_block(budget: &Budget, samples_per_pixel: u64, number: u32) -> Result<u32, u64> {
    // Blocks grow up to this size; only the last one may be smaller again.
    let whole = next_block_size(budget, u64::MAX);
    let (mut taken, mut before) = (0, 0);
    while taken < samples_per_pixel {
        let size = next_block_size(budget, taken).min(samples_per_pixel - taken);
        if before == u64::from(number) {
            return Ok(size as u32);
        }
        if size == whole {
            break;
        }
        taken += size;
        before += 1;
    }
    let left = samples_per_pixel - taken;
    let blocks = before + left.div_ceil(whole);
    if u64::from(number) >= blocks {
        return Err(blocks);
    }
    Ok(whole.min(left - (u64::from(number) - before) * whole) as u32)
}

/// One block of a run.
pub(crate) struct BlockOf {
    pub seed: u64,
    pub number: u32,
    pub size: u32,
    pub direct_light: bool,
}

/// What a row of a block's samples has found.
struct RowResult {
    /// Sums of the row's own pixels, channel by channel.
    own: Vec<f64>,
    taken: Taken,
    faults: Faults,
    fates: BothFates,
}

/// What samples leave in pixels that are not their own, and what one leaves in its own.
#[derive(Debug, Default)]
pub struct Taken {
    /// Pixels elsewhere that light was joined to the eye at, in the order found.
    pub splat_pixels: Vec<u32>,
    /// What they recorded, channel by channel.
    pub splat_values: Vec<f64>,
    /// What the last sample recorded in its own pixel, channel by channel.
    pub own: Vec<f64>,
}

impl Taken {
    /// Takes one sample in the pixel whose top left corner is given. What it leaves that is not
    /// finite is left out, and their number comes back with the wavelengths. `see` is shown every
    /// contribution.
    pub fn take(
        &mut self,
        tracer: &Tracer<'_>,
        sensor: &Sensor,
        (corner, width): ([f64; 2], u32),
        sampler: &Sampler,
        paths: &mut Subpaths,
        mut see: impl FnMut(&Contribution),
    ) -> (Wavelengths, u64) {
        let channels = sensor.channels.len();
        let mut radiance = Spectrum::ZERO;
        let mut non_finite = 0;
        let (splat_pixels, splat_values) = (&mut self.splat_pixels, &mut self.splat_values);
        let wavelengths = tracer.sample(corner, sampler, paths, &mut |contribution, wavelengths| {
            see(contribution);
            let weighed = contribution.estimate * contribution.weight;
            if !weighed.is_finite() {
                non_finite += 1;
            } else if let Some([x, y]) = contribution.position {
                let first = splat_values.len();
                splat_values.resize(first + channels, 0.0);
                let values = &mut splat_values[first..];
                sensor.record(weighed, wavelengths, |channel, value| values[channel] = value);
                if values.iter().all(|value| value.is_finite()) {
                    splat_pixels.push(y as u32 * width + x as u32);
                } else {
                    splat_values.truncate(first);
                    non_finite += 1;
                }
            } else {
                radiance += weighed;
            }
        });
        self.own.clear();
        sensor.record(radiance, &wavelengths, |_, value| self.own.push(value));
        // Finite parts may have a sum, or a mean over lanes, that is not.
        if !self.own.iter().all(|value| value.is_finite()) {
            self.own.fill(0.0);
            non_finite += 1;
        }
        (wavelengths, non_finite)
    }
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
    let take = |row: usize, result: RowResult| {
        film.add_row(row, &result.own, block.size);
        film.add_splats(&result.taken.splat_pixels, &result.taken.splat_values);
        film.faults.merge(result.faults);
        film.fates.merge(&result.fates);
    };
    let work = |row: usize| {
        let result = render_row(tracer, view, block, row);
        let done = rows_done.fetch_add(1, Ordering::Relaxed) + 1;
        report_share(done as f64 / f64::from(height));
        result
    };
    for_each_in_order(height as usize, work, take);
}

fn render_row(tracer: &Tracer<'_>, view: &View, block: &BlockOf, row: usize) -> RowResult {
    let [width, _] = view.camera.resolution();
    let sensor = &view.sensor;
    let channels = sensor.channels.len();
    let mut result = RowResult {
        own: vec![0.0; width as usize * channels],
        taken: Taken::default(),
        faults: Faults::default(),
        fates: BothFates::default(),
    };
    let mut paths = Subpaths::forgetful();
    for (column, own) in result.own.chunks_exact_mut(channels).enumerate() {
        let pixel = row as u64 * u64::from(width) + column as u64;
        let numbers = BlockSampler::new(block.seed, pixel, block.number, block.size);
        for index in 0..block.size {
            let corner = [column as f64, row as f64];
            let sampler = numbers.sample(index);
            let (_, non_finite) =
                result.taken.take(tracer, sensor, (corner, width), &sampler, &mut paths, |_| {});
            own.iter_mut().zip(&result.taken.own).for_each(|(sum, value)| *sum += value);
            result.faults.note(non_finite, || {
                SampleName::Pixel(PixelSample {
                    pixel: [column as u32, row as u32],
                    seed: block.seed,
                    block: block.number,
                    block_size: block.size,
                    index,
                    direct_light: block.direct_light,
                })
            });
        }
    }
    result.fates = paths.fates;
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sizes of the blocks that the loop of a run takes.
    fn taken(budget: &Budget) -> Vec<u32> {
        let (mut sizes, mut taken) = (Vec::new(), 0);
        while taken < budget.most_of_half() {
            let size = next_block_size(budget, taken).min(budget.most_of_half() - taken);
            sizes.push(size as u32);
            taken += size;
        }
        sizes
    }

    #[test]
    fn blocks_have_the_sizes_that_runs_take() {
        for error in [None, Some(0.01)] {
            for samples_per_pixel in (1..=130).chain([1000, 1001]) {
                let budget = Budget { samples_per_pixel, time: None, error, seed: 0 };
                let sizes = taken(&budget);
                for (number, size) in (0..).zip(&sizes) {
                    let found = size_of_block(&budget, budget.most_of_half(), number);
                    assert_eq!(found, Ok(*size), "block {number} of {budget:?}");
                }
                for beyond in [sizes.len() as u32, u32::MAX] {
                    let found = size_of_block(&budget, budget.most_of_half(), beyond);
                    assert_eq!(found, Err(sizes.len() as u64), "{budget:?}");
                }
            }
        }
        let fifty = Budget { samples_per_pixel: 50, time: None, error: None, seed: 0 };
        assert_eq!(taken(&fifty), [12, 12, 12, 12, 2]);
        let open = Budget { samples_per_pixel: 100, error: Some(0.1), ..fifty };
        assert_eq!(taken(&open), [1, 1, 2, 4, 8, 16, 16, 2]);
    }
}
