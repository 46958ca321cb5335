//! The film of chains: blocks that weigh what their starts weighed.
//!
//! A block's chains set out from paths found by a search of its own. What they leave, times the
//! mean that this search estimated, is an unbiased estimate of the picture however little they
//! have mixed (Veach 1997, section 11.3.1). Blocks are put together in proportion to these means
//! and leave the level of the whole to the normalisation of the run.

use crate::camera::{Batches, CellErrors, CellGrid, LUMINANCE, Scatter};
use serde::{Deserialize, Serialize};

/// Sums over blocks, pixel by pixel in rows, channel by channel.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ChainFilm {
    channels: usize,
    /// Width and height in pixels.
    resolution: [u32; 2],
    /// What the chains of the block being taken have left.
    block: Vec<f64>,
    sums: Vec<f64>,
    squares: Vec<f64>,
    /// Sums of block times weight.
    crossed: Vec<f64>,
    weight: f64,
    weight_squares: f64,
    blocks: u32,
    /// The same of luminance over squares of pixels, and its blocks at some pixels.
    watch: Option<Watch>,
}

/// What is kept of each block to know what pixels share.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Watch {
    /// One pixel for each square of every level.
    cells: Box<ChainFilm>,
    batches: Batches,
}

impl ChainFilm {
    /// An empty film of this width and height in pixels.
    pub fn new(resolution: [u32; 2], channels: usize) -> Self {
        let pixels = resolution[0] as usize * resolution[1] as usize;
        let cells = Box::new(Self::plain(CellGrid::of(resolution).count(), 1));
        let watch = Some(Watch { cells, batches: Batches::new(pixels) });
        Self { watch, resolution, ..Self::plain(pixels, channels) }
    }

    /// One that knows errors of pixels alone.
    fn plain(pixels: usize, channels: usize) -> Self {
        let zeros = || vec![0.0; pixels * channels];
        Self {
            channels,
            resolution: [pixels as u32, 1],
            block: zeros(),
            sums: zeros(),
            squares: zeros(),
            crossed: zeros(),
            weight: 0.0,
            weight_squares: 0.0,
            blocks: 0,
            watch: None,
        }
    }

    /// Whether it is a film of this size, all of it: one from a file may be anything.
    pub fn fits(&self, resolution: [u32; 2], channels: usize) -> bool {
        let pixels = resolution[0] as usize * resolution[1] as usize;
        self.watch.as_ref().is_some_and(|watch| {
            let cells = CellGrid::of(resolution).count();
            watch.cells.watch.is_none() && watch.cells.is_sized(cells, 1) && watch.batches.fits(pixels)
        }) && self.resolution == resolution
            && self.is_sized(pixels, channels)
    }

    fn is_sized(&self, pixels: usize, channels: usize) -> bool {
        let parts = [&self.block, &self.sums, &self.squares, &self.crossed];
        self.channels == channels && parts.iter().all(|part| part.len() == pixels * channels)
    }

    /// Adds what chains leave at pixels: `values` holds a number per channel for each of them.
    pub fn add(&mut self, pixels: &[u32], values: &[f64]) {
        for (pixel, values) in pixels.iter().zip(values.chunks_exact(self.channels)) {
            let first = *pixel as usize * self.channels;
            self.block[first..].iter_mut().zip(values).for_each(|(total, value)| *total += value);
        }
    }

    /// Ends a block of so many mutations per pixel, from starts of this mean.
    pub fn finish_block(&mut self, mutations_per_pixel: u64, mean_of_starts: f64) {
        let weight = mean_of_starts * mutations_per_pixel as f64;
        if let Some(watch) = &mut self.watch {
            let Self { resolution, channels, block, .. } = self;
            let luminance = |pixel: usize| block[pixel * *channels + LUMINANCE.min(*channels - 1)];
            watch.cells.block = CellGrid::of(*resolution).sums(luminance);
            watch.cells.finish_block(mutations_per_pixel, mean_of_starts);
            let pixels = resolution[0] as usize * resolution[1] as usize;
            watch.batches.add(0..pixels, |pixel| mean_of_starts * luminance(pixel));
            watch.batches.finish_block(weight);
        }
        let sums = self.sums.iter_mut().zip(&mut self.squares).zip(&mut self.crossed);
        for (left, ((sum, square), crossed)) in self.block.iter_mut().zip(sums) {
            let value = *left * mean_of_starts;
            *sum += value;
            *square += value * value;
            *crossed += value * weight;
            *left = 0.0;
        }
        self.weight += weight;
        self.weight_squares += weight * weight;
        self.blocks += 1;
    }

    /// The largest share that one pixel has of what chains left, all channels together: weights
    /// of the channels as in the target function. `None` where they left nothing.
    pub fn largest_share(&self, weights: &[f64]) -> Option<f64> {
        let pixels = self.sums.chunks_exact(self.channels);
        let values =
            pixels.map(|sums| sums.iter().zip(weights).map(|(sum, weight)| sum * weight).sum::<f64>());
        let all: f64 = values.clone().sum();
        (all > 0.0).then(|| values.fold(0.0, f64::max) / all)
    }

    /// How batches of blocks scatter, where the normalisation is this; and that normalisation's own
    /// error, which all pixels share.
    pub fn scatters(&self, normalisation: f64, error: f64) -> Vec<Scatter> {
        let Some(Watch { batches, .. }) = &self.watch else { return Vec::new() };
        // Chains that left nothing have no error, and no level.
        let Some(chains) = batches.scatter(normalisation) else { return Vec::new() };
        vec![chains, batches.level(error / self.weight)]
    }

    /// Standard errors of mean luminance over squares of pixels, where the normalisation and its
    /// error are these; those of `others` in the same picture are added. `None` before two blocks.
    pub fn cell_errors(&self, normalisation: f64, error: f64, others: &CellErrors) -> Option<CellErrors> {
        let cells = &self.watch.as_ref()?.cells;
        if self.weight == 0.0 {
            return Some(others.clone());
        }
        let of_sum = |cell: usize| {
            let (share, scatter) = cells.share(cell, 0);
            (normalisation * scatter).hypot(share * error)
        };
        let of_sums: Vec<f64> = (0..cells.sums.len()).map(of_sum).collect();
        (self.blocks > 1).then(|| CellGrid::of(self.resolution).errors(&of_sums).with(others))
    }

    /// Share of the normalisation that a pixel's channel has, and its standard error: NaN while
    /// only one block is there. Zero before the first.
    ///
    /// The variance is that of a ratio of sums over independent blocks, to first order (Cochran
    /// 1977, "Sampling Techniques", equation 2.39).
    pub fn share(&self, pixel: usize, channel: usize) -> (f64, f64) {
        if self.weight == 0.0 {
            return (0.0, 0.0);
        }
        let index = pixel * self.channels + channel;
        let share = self.sums[index] / self.weight;
        let scatter =
            self.squares[index] - 2.0 * share * self.crossed[index] + share * share * self.weight_squares;
        let blocks = f64::from(self.blocks);
        let variance = blocks / (blocks - 1.0) * scatter.max(0.0) / (self.weight * self.weight);
        (share, if self.blocks > 1 { variance.sqrt() } else { f64::NAN })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metropolis::numbers::Numbers;

    /// Blocks of unequal weight whose chains know only where they started: the whole is right
    /// on average, and its error what is stated. A thousand films of 40 blocks; the mean must
    /// hold to 5 standard errors, the stated variance to 15 % (its own scatter is some 1 %, and
    /// the first order of a ratio leaves a few).
    #[test]
    fn blocks_that_never_mix_add_up() {
        const FILMS: u64 = 1000;
        let (mut sum, mut squares, mut stated) = (0.0, 0.0, 0.0);
        for film in 0..FILMS {
            let mut numbers = Numbers::of(&[film]);
            let mut chains = ChainFilm::new([1, 1], 1);
            for _ in 0..40 {
                // Light of two kinds, 3 and 1 on average: of the first all falls on the pixel.
                let [a, b] = [6.0, 2.0].map(|most| most * numbers.fine());
                chains.add(&[0], &[5.0 * a / (a + b)]);
                chains.finish_block(5, a + b);
            }
            let (share, error) = chains.share(0, 0);
            sum += share;
            squares += share * share;
            stated += error * error;
        }
        let n = FILMS as f64;
        let mean = sum / n;
        let variance = squares / n - mean * mean;
        assert!((mean - 0.75).abs() < 5.0 * (variance / n).sqrt() + 1e-3, "{mean}");
        assert!((stated / n / variance - 1.0).abs() < 0.15, "{} against {variance}", stated / n);
    }
}
