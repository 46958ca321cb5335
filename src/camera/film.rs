//! The film: sums in f64, and enough of their squares to know the error.
//!
//! Samples come in blocks. Within a block they are stratified, so their scatter says nothing
//! about the error of their mean; different blocks are drawn independently, and the scatter
//! of block sums gives an unbiased variance.

use super::cells::{CellErrors, Cells};
use super::picture_error::{self, Known, PictureError};
use super::witnesses::{Batches, Scatter};
use crate::path::BothFates;
use crate::replay::Faults;
use serde::{Deserialize, Serialize};

/// Channel of luminance.
pub(crate) const LUMINANCE: usize = 1;

/// Sums over the blocks of one channel of one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BlockStatistics {
    /// Sum of all samples.
    pub sum: f64,
    /// Sum over blocks of (block sum)^2 / (samples in the block).
    pub square: f64,
}

impl BlockStatistics {
    /// Adds a block of `count` samples that sum to `sum`.
    pub fn add_block(&mut self, sum: f64, count: u32) {
        self.sum += sum;
        self.square += sum * sum / f64::from(count);
    }

    /// Standard error of the mean of `samples` samples in `blocks` blocks of any sizes;
    /// `None` from fewer than two blocks.
    ///
    /// For independent blocks with variance s^2 n_b of a sum of n_b samples,
    /// E\[square - sum^2 / n\] = (blocks - 1) s^2.
    pub fn standard_error(&self, samples: u64, blocks: u32) -> Option<f64> {
        let n = samples as f64;
        let scatter = (self.square - self.sum * self.sum / n).max(0.0);
        (blocks > 1).then(|| (scatter / f64::from(blocks - 1) / n).sqrt())
    }
}

/// What a film keeps of each block beside its pixels, to know what these share.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Watch {
    cells: Cells,
    batches: Batches,
}

/// The same of a picture that was put together from others.
#[derive(Clone, Debug)]
pub(crate) struct Finished {
    pub scatters: Vec<Scatter>,
    pub cells: Option<CellErrors>,
    pub correlated: bool,
}

/// A picture being gathered.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Film {
    resolution: [u32; 2],
    channels: usize,
    /// Pixel by pixel in rows, channel by channel.
    statistics: Vec<BlockStatistics>,
    /// Sums of the block being taken, where light may arrive at any pixel at any time.
    block: Option<Vec<f64>>,
    /// What pixels share; `None` where nobody asks.
    watch: Option<Watch>,
    /// That of a picture that was put together.
    #[serde(skip)]
    finished: Option<Finished>,
    /// Samples that every pixel has.
    samples_per_pixel: u64,
    /// Blocks that every pixel has.
    blocks: u32,
    /// Contributions that were not finite; each is counted as zero and reported.
    pub faults: Faults,
    /// What became of the walks that the picture is made of.
    pub fates: BothFates,
}

impl Film {
    /// An empty film; `splats` where pixels receive more than their own samples.
    pub fn new(resolution: [u32; 2], channels: usize, splats: bool) -> Self {
        let pixels = resolution[0] as usize * resolution[1] as usize;
        let watch = Watch { cells: Cells::new(resolution), batches: Batches::new(pixels) };
        Self { watch: Some(watch), ..Self::plain(resolution, channels, splats) }
    }

    /// One that knows errors of pixels alone.
    pub(crate) fn plain(resolution: [u32; 2], channels: usize, splats: bool) -> Self {
        let pixels = resolution[0] as usize * resolution[1] as usize;
        Self {
            block: splats.then(|| vec![0.0; pixels * channels]),
            watch: None,
            finished: None,
            resolution,
            channels,
            statistics: vec![BlockStatistics::default(); pixels * channels],
            samples_per_pixel: 0,
            blocks: 0,
            faults: Faults::default(),
            fates: BothFates::default(),
        }
    }

    /// Width and height in pixels.
    pub const fn resolution(&self) -> [u32; 2] {
        self.resolution
    }

    /// Channels per pixel.
    pub const fn channels(&self) -> usize {
        self.channels
    }

    /// Samples taken in every pixel so far.
    pub const fn samples_per_pixel(&self) -> u64 {
        self.samples_per_pixel
    }

    /// Blocks taken in every pixel so far.
    pub const fn blocks(&self) -> u32 {
        self.blocks
    }

    /// Whether it is a film of this size, all of it: one from a file may be anything.
    pub(crate) fn fits(&self, resolution: [u32; 2], channels: usize) -> bool {
        let values = resolution[0] as usize * resolution[1] as usize * channels;
        self.resolution == resolution
            && self.channels == channels
            && self.statistics.len() == values
            && self.block.as_ref().is_none_or(|block| block.len() == values)
            && self
                .watch
                .as_ref()
                .is_none_or(|watch| watch.cells.fits(resolution) && watch.batches.fits(self.pixels()))
    }

    /// Adds the sums of a row's own samples, `count` in each pixel, channel by channel.
    pub fn add_row(&mut self, row: usize, sums: &[f64], count: u32) {
        let first = row * self.resolution[0] as usize * self.channels;
        let range = first..first + sums.len();
        match &mut self.block {
            Some(block) => block[range].iter_mut().zip(sums).for_each(|(total, sum)| *total += sum),
            None => {
                let statistics = &mut self.statistics[range];
                statistics.iter_mut().zip(sums).for_each(|(statistic, sum)| statistic.add_block(*sum, count));
                if let Some(watch) = &mut self.watch {
                    watch.add_row(row, sums, self.channels);
                }
            }
        }
    }

    /// Adds contributions to pixels wherever they are: `values` holds one number per channel
    /// for each of `pixels`.
    pub fn add_splats(&mut self, pixels: &[u32], values: &[f64]) {
        let Some(block) = &mut self.block else { return };
        for (pixel, values) in pixels.iter().zip(values.chunks_exact(self.channels)) {
            let first = *pixel as usize * self.channels;
            block[first..].iter_mut().zip(values).for_each(|(total, value)| *total += value);
        }
    }

    /// Notes that every pixel has received one block of `count` samples.
    pub fn finish_block(&mut self, count: u32) {
        if let (Some(block), Some(watch)) = (&self.block, &mut self.watch) {
            let row_length = self.resolution[0] as usize * self.channels;
            for (row, sums) in block.chunks_exact(row_length).enumerate() {
                watch.add_row(row, sums, self.channels);
            }
        }
        if let Some(watch) = &mut self.watch {
            watch.cells.finish_block(count);
            watch.batches.finish_block(f64::from(count));
        }
        if let Some(block) = &mut self.block {
            for (statistic, sum) in self.statistics.iter_mut().zip(block) {
                statistic.add_block(*sum, count);
                *sum = 0.0;
            }
        }
        self.samples_per_pixel += u64::from(count);
        self.blocks += 1;
    }

    /// Mean of a channel in a pixel, pixels counted in rows from the top left.
    pub fn mean(&self, pixel: usize, channel: usize) -> f64 {
        self.statistics[pixel * self.channels + channel].sum / self.samples_per_pixel as f64
    }

    /// Standard error of that mean; NaN while only one block is there and nothing is known.
    pub fn standard_error(&self, pixel: usize, channel: usize) -> f64 {
        self.statistics[pixel * self.channels + channel]
            .standard_error(self.samples_per_pixel, self.blocks)
            .unwrap_or(f64::NAN)
    }

    /// The same film with other means and standard errors: `change` is given pixel, channel,
    /// mean and standard error.
    #[must_use]
    pub fn map(&self, change: impl Fn(usize, usize, f64, f64) -> (f64, f64)) -> Self {
        let mut film = self.clone();
        film.set(|pixel, channel| {
            change(pixel, channel, self.mean(pixel, channel), self.standard_error(pixel, channel))
        });
        film
    }

    /// Sets means and standard errors for the samples and blocks that are noted.
    fn set(&mut self, value: impl Fn(usize, usize) -> (f64, f64)) {
        self.block = None;
        let n = self.samples_per_pixel as f64;
        for (index, statistic) in self.statistics.iter_mut().enumerate() {
            let (mean, error) = value(index / self.channels, index % self.channels);
            let scatter = error * error * n * f64::from(self.blocks.saturating_sub(1));
            let sum = mean * n;
            *statistic = BlockStatistics { sum, square: sum * sum / n + scatter };
        }
    }

    /// The mean of two pictures that share no random numbers, each of weight one half whatever
    /// its samples.
    #[must_use]
    pub fn mean_with(&self, other: &Self) -> Self {
        let mut both = self.clone();
        both.samples_per_pixel = self.samples_per_pixel.saturating_add(other.samples_per_pixel);
        // Two means are estimated from the blocks, not one.
        both.blocks = self.blocks.saturating_add(other.blocks).saturating_sub(1);
        both.finished = Some(self.finished_mean_with(other));
        both.watch = None;
        both.faults.merge(other.faults.clone());
        both.fates.merge(&other.fates);
        both.set(|pixel, channel| {
            let mean = 0.5 * (self.mean(pixel, channel) + other.mean(pixel, channel));
            let errors = [self, other].map(|film| film.standard_error(pixel, channel));
            (mean, 0.5 * errors[0].hypot(errors[1]))
        });
        both
    }

    /// Whether no pixel has received any light.
    pub fn is_black(&self) -> bool {
        self.statistics.iter().all(|statistic| statistic.sum == 0.0)
    }

    /// Number of pixels.
    pub const fn pixels(&self) -> usize {
        self.resolution[0] as usize * self.resolution[1] as usize
    }

    /// Whether pixels share random numbers.
    pub fn is_correlated(&self) -> bool {
        self.finished.as_ref().map_or(self.block.is_some(), |finished| finished.correlated)
    }

    /// Independent causes of its error, at some pixels.
    pub(crate) fn scatters(&self) -> Vec<Scatter> {
        match (&self.finished, &self.watch) {
            (Some(finished), _) => finished.scatters.clone(),
            (None, Some(watch)) => watch.batches.scatter(1.0).into_iter().collect(),
            (None, None) => Vec::new(),
        }
    }

    /// Standard errors of mean luminance over squares of pixels; `None` before two blocks.
    pub fn cell_errors(&self) -> Option<CellErrors> {
        match (&self.finished, &self.watch) {
            (Some(finished), _) => finished.cells.clone(),
            (None, Some(watch)) => watch.cells.errors(self.samples_per_pixel, self.blocks),
            (None, None) => None,
        }
    }

    /// The same picture, put together from what has these errors.
    #[must_use]
    pub(crate) fn with_finished(mut self, finished: Finished) -> Self {
        self.watch = None;
        self.finished = Some(finished);
        self
    }

    fn finished_mean_with(&self, other: &Self) -> Finished {
        let scatters = [self, other].into_iter().flat_map(Self::scatters);
        Finished {
            scatters: scatters.map(|scatter| scatter.times(0.5)).collect(),
            cells: self.cell_errors().zip(other.cell_errors()).map(|(one, two)| one.with(&two).times(0.5)),
            correlated: self.is_correlated() || other.is_correlated(),
        }
    }

    /// Channel of luminance; that of a film of one channel is its only one.
    fn luminance_channel(&self) -> usize {
        LUMINANCE.min(self.channels - 1)
    }

    /// Estimated relative error of the luminance picture: the root of its relMSE, which is the mean
    /// over pixels of variance / (luminance^2 + (1 % of the mean)^2). `None` before two blocks, and
    /// of a black picture: light that was not found has an error that nobody knows.
    pub fn relative_error(&self) -> Option<f64> {
        if self.blocks < 2 {
            return None;
        }
        let (channel, pixels) = (self.luminance_channel(), self.pixels());
        let luminance: Vec<f64> = (0..pixels).map(|pixel| self.mean(pixel, channel)).collect();
        let weights = picture_error::weights(&luminance)?;
        let term = |(pixel, weight): (usize, &f64)| self.standard_error(pixel, channel).powi(2) * weight;
        Some((weights.iter().enumerate().map(term).sum::<f64>() / pixels as f64).sqrt())
    }

    /// Estimated relMSE of the luminance picture, how sure it is and whether to believe it; `None`
    /// where [`Self::relative_error`] is.
    pub fn error(&self) -> Option<PictureError> {
        if self.blocks < 2 {
            return None;
        }
        let channel = self.luminance_channel();
        let luminance: Vec<f64> = (0..self.pixels()).map(|pixel| self.mean(pixel, channel)).collect();
        let standard_errors: Vec<f64> =
            (0..self.pixels()).map(|pixel| self.standard_error(pixel, channel)).collect();
        picture_error::estimate(&Known {
            luminance: &luminance,
            standard_errors: &standard_errors,
            scatters: &self.scatters(),
            blocks: self.blocks,
            correlated: self.is_correlated(),
        })
    }
}

impl Watch {
    /// Adds what the pixels of a row have received of the block being taken, channel by channel.
    fn add_row(&mut self, row: usize, sums: &[f64], channels: usize) {
        let channel = LUMINANCE.min(channels - 1);
        let luminance = |column: usize| sums[column * channels + channel];
        let width = sums.len() / channels;
        let first = row * width;
        self.cells.add_row(row, (0..width).map(luminance));
        self.batches.add(first..first + width, |pixel| luminance(pixel - first));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A film of one value that blocks of unequal size gave.
    fn film(blocks: &[(f64, u32)]) -> Film {
        let mut film = Film::new([1, 1], 1, false);
        for (sum, count) in blocks {
            film.add_row(0, &[*sum], *count);
            film.finish_block(*count);
        }
        film
    }

    #[test]
    fn the_mean_of_two_pictures_weighs_both_alike() {
        let (one, other) = (film(&[(1.0, 1), (3.0, 1)]), film(&[(4.0, 1), (8.0, 1), (24.0, 4)]));
        let both = one.mean_with(&other);
        // Means 2 and 6; by hand, squared errors (10 - 8) / 1 / 2 = 1 and (224 - 216) / 2 / 6 = 2/3.
        assert!((both.mean(0, 0) - 4.0).abs() < 1e-15);
        let truth = 0.5 * (1.0_f64 + 2.0 / 3.0).sqrt();
        assert!((both.standard_error(0, 0) / truth - 1.0).abs() < 1e-12);
        assert_eq!((both.samples_per_pixel(), both.blocks()), (8, 4));
        let single = film(&[(1.0, 1)]);
        assert!(single.mean_with(&single).standard_error(0, 0).is_nan(), "one block each says nothing");
    }

    #[test]
    fn unequal_blocks_give_the_textbook_error() {
        // Blocks of 1, 2 and 3 samples; by hand: sum 12, mean 2,
        // square = 1 + 25/2 + 36/3 = 25.5, scatter = 25.5 - 24 = 1.5, error^2 = 1.5/2/6.
        let mut statistics = BlockStatistics::default();
        for (sum, count) in [(1.0, 1), (5.0, 2), (6.0, 3)] {
            statistics.add_block(sum, count);
        }
        let error = statistics.standard_error(6, 3).expect("three blocks");
        assert!((error - 0.125_f64.sqrt()).abs() < 1e-15);
        assert_eq!(statistics.standard_error(6, 1), None);
    }
}
