//! What every list of strategies would make of the picture, from one pilot of all of them.
//!
//! Each sample takes every bidirectional strategy, and every path that it finds is weighed anew
//! for each list ([`Shares`]): so all lists are judged by the same random numbers, and even light
//! that a list hardly ever finds, and would not miss by its own scatter, is seen through the
//! strategies that do find it. The variance that is estimated for a list is
//!
//! scatter between blocks of samples + (predicted - seen) squares of contributions,
//!
//! where *seen* are squares of what the list's own strategies brought, and *predicted* is the mean
//! of those, told from all strategies ([`Shares::second_moment`]). Both have the same expectation,
//! so the sum is that of the scatter; what is rare and bright is exchanged for its expectation.
//! Roulette and the choice among joints belong to the strategy that found a path and cancel in
//! both terms.
//!
//! What the exchange adds has the mean zero, but a pixel in the middle of a caustic that happens to be
//! looked at can take more off than there is. So the sum is taken for no less than its own standard
//! error over pixels, as far as *predicted*, of which it is a part, allows, and for no less than a
//! tenth of the scatter.
//!
//! The measure is relative: variance of luminance over squared luminance, plus (1 % of the mean)^2,
//! of cells of the picture that hold some hundred samples each, all lists by the same cells. Lamps
//! in view, and what they shine on straight, differ from pixel to pixel: that light is taken from the
//! pixel's own samples, which know it well.

use super::work::Counts;
use crate::camera::Sensor;
use crate::integrator::{InOrder, Tracer};
use crate::path::{Eye, Shares, Strategies, Subpaths};
use crate::sampler::{BlockSampler, Sampler, owen_sobol_2d};
use crate::scene::{Plan, Scene, View};
use crate::spectrum::{Spectrum, Wavelengths};
use rayon::prelude::*;

/// Samples of a block: as in a render, for stratification to count.
const BLOCK_SAMPLES: u32 = 16;
/// Blocks in every pixel looked at: their scatter is the variance.
const BLOCKS: u32 = 2;
/// Samples of a pixel that is looked at.
pub const SAMPLES_PER_PIXEL: u64 = (BLOCK_SAMPLES * BLOCKS) as u64;
/// Pixels looked at of a cell, on average.
const PIXELS_PER_CELL: u64 = 16;
/// Cells at most.
const MOST_CELLS: f64 = 1024.0;
/// Pixels of one piece of parallel work.
const PIECE: u64 = 32;
/// Channel of the luminance.
const LUMINANCE: usize = 1;
/// Share of its scatter that an error is taken for at least.
const LEAST_OF_SCATTER: f64 = 0.1;
/// Share of the mean luminance below which errors count as absolute.
const FLOOR: f64 = 0.01;

/// What is summed for one list of strategies, of a pixel that is looked at or of what is left in a
/// cell from elsewhere.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    /// Squares by the scatter, summed over samples.
    scatter: f64,
    /// Squares of contributions by expectation.
    predicted: f64,
    /// The same as they came.
    seen: f64,
    /// Light that the list cannot find.
    missing: f64,
}

impl Sums {
    fn add(&mut self, other: &Self) {
        self.scatter += other.scatter;
        self.predicted += other.predicted;
        self.seen += other.seen;
        self.missing += other.missing;
    }
}

/// Light that was found, and what lists of strategies make of it.
#[derive(Clone, Debug)]
struct Light {
    /// Luminance, summed over samples; of a pixel without direct light.
    luminance: f64,
    lists: Vec<Sums>,
}

/// A pixel that was looked at.
#[derive(Clone, Debug)]
struct Pixel {
    /// Its middle, in shares of the picture's width and height.
    place: [f64; 2],
    cell: usize,
    light: Light,
    /// Luminance of direct light, summed over samples.
    direct: f64,
}

/// Cells that the picture is cut into.
#[derive(Clone, Copy, Debug)]
pub struct Grid {
    resolution: [u32; 2],
    cells: [usize; 2],
}

impl Grid {
    /// Of a picture of which so many pixels are looked at.
    fn of(resolution: [u32; 2], pixels: u64) -> Self {
        let [width, height] = resolution.map(f64::from);
        let count = ((pixels / PIXELS_PER_CELL) as f64).clamp(1.0, MOST_CELLS);
        let side = |length: f64, other: f64| {
            ((count * length / other).sqrt().round() as usize).clamp(1, length as usize)
        };
        Self { resolution, cells: [side(width, height), side(height, width)] }
    }

    /// The cell at a place, in shares of the picture's width and height.
    pub fn at(&self, place: [f64; 2]) -> usize {
        let along =
            |axis: usize| ((place[axis] * self.cells[axis] as f64) as usize).min(self.cells[axis] - 1);
        along(1) * self.cells[0] + along(0)
    }

    fn at_position(&self, position: [f64; 2]) -> usize {
        self.at([0, 1].map(|axis| position[axis] / f64::from(self.resolution[axis])))
    }

    const fn count(&self) -> usize {
        self.cells[0] * self.cells[1]
    }
}

/// What a pilot of all strategies has found.
#[derive(Clone, Debug)]
pub struct Findings {
    /// The cells.
    pub grid: Grid,
    /// Luminance of each cell in cd/m2, without direct light.
    pub levels: Vec<f64>,
    /// What is added to squared luminance, in (cd/m2)^2, before variances are held against it.
    pub floor: f64,
    /// Mean luminance over that of a pixel, mean over pixels: the relative mean squared error of
    /// one visit for each pixel, by visits in proportion to luminance.
    pub visits: f64,
    /// For each list of strategies, what it would come to.
    pub lists: Vec<Expected>,
    /// What the samples took, by kind.
    pub counts: Counts,
    /// The pixels that were looked at.
    pixels: Vec<Pixel>,
}

impl Findings {
    /// Whether any light was found.
    pub fn found_light(&self) -> bool {
        self.floor > 0.0
    }

    /// Relative mean squared error of a list of strategies that the pilot samples, at the pixels
    /// looked at alone, without what is left in them from elsewhere; against indirect light that
    /// `level` knows better than the cells do, at a place of the picture in shares of its sides.
    pub fn at_pixels(&self, list: usize, level: impl Fn([f64; 2]) -> f64) -> f64 {
        let samples = (self.pixels.len() as u64 * SAMPLES_PER_PIXEL) as f64;
        let mut tally = Tally::default();
        for pixel in &self.pixels {
            let whole = level(pixel.place) + pixel.direct / SAMPLES_PER_PIXEL as f64;
            tally.add_pixel(&pixel.light.lists[list], samples * (whole * whole + self.floor));
        }
        tally.error()
    }

    /// The same against the cells.
    pub fn at_pixels_by_cells(&self, list: usize) -> f64 {
        self.at_pixels(list, |place| self.levels[self.grid.at(place)])
    }
}

/// Sums over the picture, held against squared luminance.
#[derive(Clone, Debug, Default)]
struct Tally {
    scatter: f64,
    predicted: f64,
    exchanged: f64,
    /// Scatter and what is exchanged of each pixel.
    pixels: Vec<f64>,
}

impl Tally {
    fn add(&mut self, sums: &Sums, over: f64) {
        let Sums { scatter, predicted, seen, .. } = sums;
        if over > 0.0 {
            self.scatter += scatter / over;
            self.predicted += predicted / over;
            self.exchanged += (predicted - seen) / over;
        }
    }

    fn add_pixel(&mut self, sums: &Sums, over: f64) {
        self.add(sums, over);
        let Sums { scatter, predicted, seen, .. } = sums;
        self.pixels.push(if over > 0.0 { (scatter + predicted - seen) / over } else { 0.0 });
    }

    /// Standard error of the sum, by the pixels' differences.
    fn standard_error(&self) -> f64 {
        let count = self.pixels.len() as f64;
        let mean = self.pixels.iter().sum::<f64>() / count;
        let squares = self.pixels.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
        if count > 1.0 { (squares * count / (count - 1.0)).sqrt() } else { 0.0 }
    }

    /// The relative mean squared error.
    fn error(&self) -> f64 {
        let least = self.standard_error().min(self.predicted).max(LEAST_OF_SCATTER * self.scatter);
        (self.scatter + self.exchanged).max(least)
    }
}

/// What is expected of a list of strategies.
#[derive(Clone, Copy, Debug, Default)]
pub struct Expected {
    /// Relative mean squared error of one sample per pixel.
    pub relmse: f64,
    /// The same by the scatter of the pilot alone.
    pub scatter: f64,
    /// Share of the light that the list cannot find.
    pub missing: f64,
}

/// A pilot that is to be run.
pub struct Pilot<'a> {
    scene: &'a Scene,
    view: &'a View,
    plan: &'a Plan,
    /// What is judged, beside whether the pilot samples all of its strategies.
    lists: &'a [(Strategies, bool)],
    grid: Grid,
    seed: u64,
    pixels: u64,
}

impl<'a> Pilot<'a> {
    /// Of so many pixels of a view, under the plan of all strategies.
    pub fn new(
        scene: &'a Scene,
        view: &'a View,
        plan: &'a Plan,
        lists: &'a [(Strategies, bool)],
        (seed, pixels): (u64, u64),
    ) -> Self {
        let grid = Grid::of(view.camera.resolution(), pixels);
        Self { scene, view, plan, lists, grid, seed, pixels }
    }

    fn light(&self) -> Light {
        Light { luminance: 0.0, lists: vec![Sums::default(); self.lists.len()] }
    }

    /// Takes the samples; the same on any number of threads.
    pub fn run(&self) -> Findings {
        let (mut pixels, mut counts) = (Vec::new(), Counts::default());
        let mut splats = vec![self.light(); self.grid.count()];
        let merge = InOrder::new(|_, piece: Piece| {
            pixels.extend(piece.pixels);
            splats.iter_mut().zip(&piece.splats).for_each(|(cell, more)| cell.add(more));
            counts.add(&piece.counts);
        });
        let pieces = self.pixels.div_ceil(PIECE) as usize;
        (0..pieces).into_par_iter().with_max_len(1).for_each(|piece| {
            let first = piece as u64 * PIECE;
            merge.add(piece, self.piece(first, self.pixels.min(first + PIECE)));
        });
        drop(merge);
        self.findings(pixels, &splats, counts)
    }

    fn piece(&self, first: u64, end: u64) -> Piece {
        let splats = vec![self.light(); self.grid.count()];
        let mut piece = Piece { pixels: Vec::new(), splats, counts: Counts::default() };
        let tracer = Tracer::new(self.scene, self.plan, Eye::Camera(&self.view.camera));
        let mut paths = Subpaths::default();
        paths.shares = Some(Vec::new());
        let mut found = Vec::new();
        for index in first..end {
            self.pixel(index, &tracer, (&mut paths, &mut found), &mut piece);
        }
        piece
    }

    /// Looks at one pixel.
    fn pixel(
        &self,
        index: u64,
        tracer: &Tracer<'_>,
        (paths, found): (&mut Subpaths, &mut Vec<Found>),
        piece: &mut Piece,
    ) {
        let bits = self.pixels.next_power_of_two().trailing_zeros();
        let place = owen_sobol_2d(index as u32, bits, self.seed).map(f64::from);
        let resolution = self.view.camera.resolution().map(f64::from);
        let corner = [0, 1].map(|axis| (place[axis] * resolution[axis]).floor().min(resolution[axis] - 1.0));
        let place = [0, 1].map(|axis| (corner[axis] + 0.5) / resolution[axis]);
        let cell = self.grid.at(place);
        let mut pixel = Pixel { place, cell, light: self.light(), direct: 0.0 };
        let mut blocks = vec![[0.0; BLOCKS as usize]; self.lists.len()];
        for block in 0..BLOCKS {
            let numbers = BlockSampler::new(self.seed, index, block, BLOCK_SAMPLES);
            for sample in 0..BLOCK_SAMPLES {
                self.sample(tracer, (corner, &numbers.sample(sample)), paths, found);
                piece.counts.note(paths);
                let shares = paths.shares.as_deref().unwrap_or_default();
                for path in found.iter() {
                    let shares = &shares[path.number as usize];
                    if let Some(cell) = path.cell {
                        path.note(shares, self.lists, &mut piece.splats[cell], |_, sums, value| {
                            sums.scatter += value * value;
                        });
                        continue;
                    }
                    path.note(shares, self.lists, &mut pixel.light, |list, _, value| {
                        blocks[list][block as usize] += value;
                    });
                    if path.is_direct(paths) {
                        pixel.light.luminance -= path.weight * path.luminance;
                        pixel.direct += path.weight * path.luminance;
                    }
                }
            }
        }
        for (sums, blocks) in pixel.light.lists.iter_mut().zip(&blocks) {
            // Of both blocks' samples, each with the variance of one.
            sums.scatter = (blocks[0] - blocks[1]).powi(2);
        }
        piece.pixels.push(pixel);
    }

    fn sample(
        &self,
        tracer: &Tracer<'_>,
        (corner, sampler): ([f64; 2], &Sampler),
        paths: &mut Subpaths,
        found: &mut Vec<Found>,
    ) {
        found.clear();
        tracer.sample(corner, sampler, paths, &mut |path, wavelengths| {
            let luminance = luminance(&self.view.sensor, path.estimate, wavelengths);
            // What is no number tells nothing here; the render will say so. A point of light in view
            // is the same to all.
            if luminance.is_finite() && path.number != u32::MAX && (path.s, path.t) != (1, 1) {
                let cell = path.position.map(|position| self.grid.at_position(position));
                let [weight, kept] = [path.weight, path.kept].map(f64::from);
                found.push(Found {
                    luminance,
                    weight,
                    kept,
                    cell,
                    number: path.number,
                    s: path.s,
                    t: path.t,
                });
            }
        });
    }

    fn findings(&self, pixels: Vec<Pixel>, splats: &[Light], counts: Counts) -> Findings {
        let samples = (self.pixels * SAMPLES_PER_PIXEL) as f64;
        let cells = splats.len() as f64;
        let mut own = vec![(0.0, 0_u64); splats.len()];
        for pixel in &pixels {
            own[pixel.cell].0 += pixel.light.luminance;
            own[pixel.cell].1 += SAMPLES_PER_PIXEL;
        }
        let level = |(light, (own, count)): (&Light, &(f64, u64))| {
            own / (*count).max(1) as f64 + light.luminance * cells / samples
        };
        let levels: Vec<f64> = splats.iter().zip(&own).map(level).collect();
        let mut direct = vec![0.0; splats.len()];
        for pixel in &pixels {
            direct[pixel.cell] += pixel.direct / (own[pixel.cell].1 as f64);
        }
        let whole: Vec<f64> = levels.iter().zip(&direct).map(|(level, direct)| level + direct).collect();
        let indirect = levels.iter().sum::<f64>() / cells;
        let mean = whole.iter().sum::<f64>() / cells;
        let floor = (FLOOR * mean).powi(2);
        let visits =
            levels.iter().zip(&whole).map(|(level, whole)| indirect * level / (whole * whole + floor));
        let visits = visits.filter(|visits| visits.is_finite()).sum::<f64>() / cells;
        let of_list = |list: usize| {
            let is_sampled = self.lists[list].1;
            let sums = |light: &Light| {
                let sums = light.lists[list];
                if is_sampled { sums } else { Sums { scatter: 0.0, seen: 0.0, ..sums } }
            };
            let (mut tally, mut missing) = (Tally::default(), 0.0);
            let over = |level: f64| samples * (level * level + floor);
            for (light, level) in splats.iter().zip(&whole) {
                tally.add(&sums(light), over(*level));
                missing += light.lists[list].missing / samples;
            }
            for pixel in &pixels {
                let level = levels[pixel.cell] + pixel.direct / SAMPLES_PER_PIXEL as f64;
                tally.add_pixel(&sums(&pixel.light), over(level));
                missing += pixel.light.lists[list].missing / samples;
            }
            Expected { relmse: tally.error(), scatter: tally.scatter, missing: missing / mean }
        };
        let lists = (0..self.lists.len()).map(of_list).collect();
        Findings { grid: self.grid, levels, floor, visits, lists, counts, pixels }
    }
}

/// What a piece of the work has found.
struct Piece {
    pixels: Vec<Pixel>,
    splats: Vec<Light>,
    counts: Counts,
}

impl Light {
    fn add(&mut self, other: &Self) {
        self.luminance += other.luminance;
        self.lists.iter_mut().zip(&other.lists).for_each(|(sums, more)| sums.add(more));
    }
}

/// What a path brought.
struct Found {
    luminance: f64,
    weight: f64,
    kept: f64,
    /// Where it belongs, unless to the sample's own pixel.
    cell: Option<usize>,
    number: u32,
    s: usize,
    t: usize,
}

impl Found {
    /// Adds the path to what is known of a pixel or a cell; `add` is handed what each list makes of it.
    fn note(
        &self,
        shares: &Shares,
        lists: &[(Strategies, bool)],
        light: &mut Light,
        mut add: impl FnMut(usize, &mut Sums, f64),
    ) {
        let Self { luminance, weight, kept, .. } = *self;
        let lived = kept * shares.survival;
        light.luminance += weight * luminance;
        for (index, (strategies, _)) in lists.iter().enumerate() {
            let value = shares.weight(strategies) * luminance;
            let sums = &mut light.lists[index];
            add(index, sums, value);
            sums.seen += value * value * lived;
            match shares.second_moment(strategies) {
                Some(moment) => sums.predicted += weight * luminance * luminance * lived * moment,
                None => sums.missing += weight * luminance,
            }
        }
    }

    /// Whether it is light that is seen straight or over smooth surfaces, or that shines straight on
    /// what is seen so.
    fn is_direct(&self, paths: &Subpaths) -> bool {
        let before = self.s + self.t - 2;
        self.s < 2 && paths.eye[..before].iter().skip(1).all(|vertex| vertex.is_delta)
    }
}

/// Luminance in cd/m2 that a radiance is recorded as.
fn luminance(sensor: &Sensor, radiance: Spectrum, wavelengths: &Wavelengths) -> f64 {
    let channel = &sensor.channels[LUMINANCE];
    f64::from((radiance / wavelengths.density * channel.response.at(wavelengths)).mean())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tally(pixels: &[[f64; 3]]) -> Tally {
        let mut tally = Tally::default();
        for [scatter, predicted, seen] in pixels.iter().copied() {
            tally.add_pixel(&Sums { scatter, predicted, seen, missing: 0.0 }, 2.0);
        }
        tally
    }

    #[test]
    fn an_error_is_that_of_the_scatter_with_what_is_exchanged() {
        let found = tally(&[[2.0, 4.0, 3.0]; 4]).error();
        assert!((found - 6.0).abs() < 1e-12, "{found}");
    }

    #[test]
    fn an_error_is_never_less_than_a_share_of_its_scatter() {
        let found = tally(&[[4.0, 1.0, 40.0]; 2]).error();
        assert!((found - 0.4).abs() < 1e-12, "{found}");
        assert_eq!(Tally::default().error(), 0.0);
    }

    /// One pixel takes off much more than all have: the sum is no better known than that, and no
    /// more than what is predicted.
    #[test]
    fn an_error_is_never_less_than_its_standard_error() {
        let mut pixels = vec![[0.1, 2.0, 0.1]; 100];
        pixels[7] = [0.2, 2.0, 250.0];
        let tally = tally(&pixels);
        assert!(tally.scatter + tally.exchanged < 0.0 && tally.standard_error() > 100.0);
        assert!((tally.error() - 100.0).abs() < 1e-9, "{}", tally.error());
    }
}
