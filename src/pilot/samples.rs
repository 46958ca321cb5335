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
//! The measure is relative: variance of luminance over squared luminance, plus (1 % of the mean)^2,
//! of cells of the picture that hold some hundred samples each, all lists by the same cells.

use super::work::Counts;
use crate::camera::Sensor;
use crate::integrator::{InOrder, Tracer};
use crate::path::{Eye, Shares, Strategies, Subpaths};
use crate::sampler::{BlockSampler, owen_sobol_2d};
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
/// Share of the mean luminance below which errors count as absolute.
const FLOOR: f64 = 0.01;

/// What is summed for one list of strategies.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    /// Variance of a sample's own pixel.
    own: f64,
    /// Squares of what was left elsewhere.
    splats: f64,
    /// Squares of contributions by expectation.
    predicted: f64,
    /// The same as they came.
    seen: f64,
    /// Light that the list cannot find.
    missing: f64,
}

/// A cell of the picture.
#[derive(Clone, Debug)]
struct Cell {
    /// Samples of its pixels.
    samples: u64,
    /// Luminance that they found.
    own: f64,
    /// Luminance left in it from elsewhere.
    splats: f64,
    lists: Vec<Sums>,
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
    /// Squared luminance of each cell and the floor, in (cd/m2)^2: what variances are relative to.
    pub squares: Vec<f64>,
    /// Mean luminance over that of a pixel, mean over pixels: the relative mean squared error of
    /// one visit for each pixel, by visits in proportion to luminance.
    pub visits: f64,
    /// For each list of strategies, what it would come to.
    pub lists: Vec<Expected>,
    /// What the samples took, by kind.
    pub counts: Counts,
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

    fn cells(&self) -> Vec<Cell> {
        let lists = vec![Sums::default(); self.lists.len()];
        vec![Cell { samples: 0, own: 0.0, splats: 0.0, lists }; self.grid.count()]
    }

    /// Takes the samples; the same on any number of threads.
    pub fn run(&self) -> Findings {
        let (mut cells, mut counts) = (self.cells(), Counts::default());
        let merge = InOrder::new(|_, (piece, of_piece): (Vec<Cell>, Counts)| {
            cells.iter_mut().zip(&piece).for_each(|(cell, more)| cell.add(more));
            counts.add(&of_piece);
        });
        let pieces = self.pixels.div_ceil(PIECE) as usize;
        (0..pieces).into_par_iter().with_max_len(1).for_each(|piece| {
            let first = piece as u64 * PIECE;
            merge.add(piece, self.piece(first, self.pixels.min(first + PIECE)));
        });
        drop(merge);
        self.findings(&cells, counts)
    }

    fn piece(&self, first: u64, end: u64) -> (Vec<Cell>, Counts) {
        let (mut cells, mut counts) = (self.cells(), Counts::default());
        let tracer = Tracer::new(self.scene, self.plan, Eye::Camera(&self.view.camera));
        let mut paths = Subpaths::default();
        paths.shares = Some(Vec::new());
        let mut found = Vec::new();
        for index in first..end {
            self.pixel(index, &tracer, (&mut paths, &mut found), &mut cells, &mut counts);
        }
        (cells, counts)
    }

    /// Looks at one pixel.
    fn pixel(
        &self,
        index: u64,
        tracer: &Tracer<'_>,
        (paths, found): (&mut Subpaths, &mut Vec<Found>),
        cells: &mut [Cell],
        counts: &mut Counts,
    ) {
        let bits = self.pixels.next_power_of_two().trailing_zeros();
        let place = owen_sobol_2d(index as u32, bits, self.seed).map(f64::from);
        let resolution = self.view.camera.resolution().map(f64::from);
        let corner = [0, 1].map(|axis| (place[axis] * resolution[axis]).floor().min(resolution[axis] - 1.0));
        let own_cell = self.grid.at_position(corner.map(|c| c + 0.5));
        let mut blocks = vec![[0.0; BLOCKS as usize]; self.lists.len()];
        for block in 0..BLOCKS {
            let numbers = BlockSampler::new(self.seed, index, block, BLOCK_SAMPLES);
            for sample in 0..BLOCK_SAMPLES {
                found.clear();
                let sensor = &self.view.sensor;
                tracer.sample(corner, &numbers.sample(sample), paths, &mut |path, wavelengths| {
                    let luminance = luminance(sensor, path.estimate, wavelengths);
                    // What is no number tells nothing here; the render will say so.
                    if luminance.is_finite() && path.number != u32::MAX {
                        let cell = path.position.map(|position| self.grid.at_position(position));
                        let [weight, kept] = [path.weight, path.kept].map(f64::from);
                        found.push(Found { luminance, weight, kept, cell, number: path.number });
                    }
                });
                counts.note(paths);
                let shares = paths.shares.as_deref().unwrap_or_default();
                for path in found.iter() {
                    let cell = &mut cells[path.cell.unwrap_or(own_cell)];
                    path.note(&shares[path.number as usize], cell, self.lists, &mut blocks, block as usize);
                }
            }
        }
        let cell = &mut cells[own_cell];
        cell.samples += SAMPLES_PER_PIXEL;
        for (sums, blocks) in cell.lists.iter_mut().zip(&blocks) {
            sums.own += 0.5 * (blocks[0] - blocks[1]).powi(2) / f64::from(BLOCK_SAMPLES);
        }
    }

    fn findings(&self, cells: &[Cell], counts: Counts) -> Findings {
        let samples = (self.pixels * SAMPLES_PER_PIXEL) as f64;
        let share_of_cell = 1.0 / cells.len() as f64;
        let level = |cell: &Cell| {
            let own = if cell.samples > 0 { cell.own / cell.samples as f64 } else { 0.0 };
            own + cell.splats / (samples * share_of_cell)
        };
        let levels: Vec<f64> = cells.iter().map(level).collect();
        let mean = levels.iter().sum::<f64>() * share_of_cell;
        let squares: Vec<f64> = levels.iter().map(|level| level * level + (FLOOR * mean).powi(2)).collect();
        let visits = levels.iter().zip(&squares).map(|(level, square)| mean * level / square);
        let of_list = |list: usize| {
            let mut expected = Expected::default();
            for (cell, square) in cells.iter().zip(&squares).filter(|(_, square)| **square > 0.0) {
                let Sums { own, splats, predicted, seen, missing } = cell.lists[list];
                let scatter = own / (self.pixels as f64) + splats / samples;
                let (found, more) =
                    if self.lists[list].1 { (scatter, predicted - seen) } else { (0.0, predicted) };
                expected.scatter += found / square;
                expected.relmse += (found + more / samples) / square;
                expected.missing += missing / samples;
            }
            expected.missing /= mean;
            expected
        };
        let lists = (0..self.lists.len()).map(of_list).collect();
        Findings {
            grid: self.grid,
            visits: visits.filter(|visits| visits.is_finite()).sum::<f64>() * share_of_cell,
            squares,
            lists,
            counts,
        }
    }
}

impl Cell {
    fn add(&mut self, other: &Self) {
        self.samples += other.samples;
        self.own += other.own;
        self.splats += other.splats;
        for (sums, more) in self.lists.iter_mut().zip(&other.lists) {
            sums.own += more.own;
            sums.splats += more.splats;
            sums.predicted += more.predicted;
            sums.seen += more.seen;
            sums.missing += more.missing;
        }
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
}

impl Found {
    fn note(
        &self,
        shares: &Shares,
        cell: &mut Cell,
        lists: &[(Strategies, bool)],
        blocks: &mut [[f64; BLOCKS as usize]],
        block: usize,
    ) {
        let Self { luminance, weight, kept, .. } = *self;
        let lived = kept * shares.survival;
        *(if self.cell.is_some() { &mut cell.splats } else { &mut cell.own }) += weight * luminance;
        for (index, ((strategies, _), sums)) in lists.iter().zip(&mut cell.lists).enumerate() {
            let value = shares.weight(strategies) * luminance;
            if self.cell.is_some() {
                sums.splats += value * value;
            } else {
                blocks[index][block] += value;
            }
            sums.seen += value * value * lived;
            match shares.second_moment(strategies) {
                Some(moment) => sums.predicted += weight * luminance * luminance * lived * moment,
                None => sums.missing += weight * luminance,
            }
        }
    }
}

/// Luminance in cd/m2 that a radiance is recorded as.
fn luminance(sensor: &Sensor, radiance: Spectrum, wavelengths: &Wavelengths) -> f64 {
    let channel = &sensor.channels[LUMINANCE];
    f64::from((radiance / wavelengths.density * channel.response.at(wavelengths)).mean())
}
