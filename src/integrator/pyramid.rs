//! One picture for each strategy: what people draw to understand bidirectional rendering.

use super::blocks::Budget;
use super::tracer::{Draw, Tracer};
use crate::camera::Film;
use crate::path::Subpaths;
use crate::sampler::{BlockSampler, Stream};
use crate::scene::{Plan, View};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Samples of one block.
const BLOCK_SAMPLES: u64 = 8;

/// What one strategy finds.
#[derive(Clone, Debug)]
pub struct StrategyFilms {
    /// By itself, as if no other strategy were there: its mean is the light of all paths that
    /// it can make.
    pub unweighted: Film,
    /// Its share of the picture: all of these add up to it, longer paths aside.
    pub weighted: Film,
}

/// The films of all strategies with paths of few vertices, by vertices from the light and from
/// the eye.
pub type Pyramid = BTreeMap<(usize, usize), StrategyFilms>;

/// A contribution on its way to the films.
struct Entry {
    strategy: (usize, usize),
    pixel: u32,
    weight: f64,
    values: Vec<f64>,
}

/// Renders every strategy of a plan for paths of at most `longest` vertices.
pub fn render_pyramid(
    tracer: &Tracer<'_>,
    view: &View,
    plan: &Plan,
    budget: &Budget,
    longest: usize,
) -> Pyramid {
    let [width, height] = view.camera.resolution();
    let channels = view.sensor.channels.len();
    let empty = || Film::new([width, height], channels, true);
    let mut pyramid: Pyramid = (2..=longest)
        .flat_map(|n| (0..=n).map(move |s| (s, n - s)))
        .filter(|(s, t)| plan.strategies.plans(*s, *t))
        .map(|strategy| (strategy, StrategyFilms { unweighted: empty(), weighted: empty() }))
        .collect();
    let mut taken = 0;
    for block in 0.. {
        let size = BLOCK_SAMPLES.min(budget.samples_per_pixel - taken) as u32;
        if size == 0 {
            break;
        }
        let rows: Vec<Vec<Entry>> = (0..height)
            .into_par_iter()
            .map(|row| row_entries(tracer, view, plan, (budget.seed, block, size), row))
            .collect();
        for entry in rows.into_iter().flatten() {
            let Some(films) = pyramid.get_mut(&entry.strategy) else { continue };
            films.unweighted.add_splats(&[entry.pixel], &entry.values);
            let weighted: Vec<f64> = entry.values.iter().map(|value| value * entry.weight).collect();
            films.weighted.add_splats(&[entry.pixel], &weighted);
        }
        for films in pyramid.values_mut() {
            films.unweighted.finish_block(size);
            films.weighted.finish_block(size);
        }
        taken += u64::from(size);
    }
    pyramid
}

/// The contributions of a row's samples in the order found; those that are not finite count
/// as zero.
fn row_entries(
    tracer: &Tracer<'_>,
    view: &View,
    plan: &Plan,
    (seed, block, size): (u64, u32, u32),
    row: u32,
) -> Vec<Entry> {
    let [width, _] = view.camera.resolution();
    let mut entries = Vec::new();
    let mut paths = Subpaths::default();
    for column in 0..width {
        let own = row * width + column;
        let numbers = BlockSampler::new(seed, u64::from(own), block, size);
        for index in 0..size {
            let sampler = numbers.sample(index);
            let wavelengths = plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
            let [x, y] = sampler.pair(Stream::Pixel, 0).map(f64::from);
            let position = [f64::from(column) + x, f64::from(row) + y];
            let draw = Draw { position, wavelengths: &wavelengths, sampler: &sampler };
            tracer.trace(&draw, &mut paths, &mut |found| {
                if !found.estimate.is_finite() {
                    return;
                }
                let pixel = found.position.map_or(own, |[x, y]| y as u32 * width + x as u32);
                let mut values = vec![0.0; view.sensor.channels.len()];
                view.sensor.record(found.estimate, &wavelengths, |channel, value| values[channel] = value);
                let weight = f64::from(found.weight);
                entries.push(Entry { strategy: (found.s, found.t), pixel, weight, values });
            });
        }
    }
    entries
}
