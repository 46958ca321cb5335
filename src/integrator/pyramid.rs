//! One picture for each strategy: what people draw to understand bidirectional rendering.

use super::blocks::BlockOf;
use super::in_order::for_each_in_order;
use super::stopping::Budget;
use super::tracer::Tracer;
use crate::camera::Film;
use crate::path::Subpaths;
use crate::sampler::BlockSampler;
use crate::scene::{Plan, View};
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

/// What the samples of a row have found.
#[derive(Default)]
struct RowResult {
    /// Strategy, pixel and weight of each contribution, in the order found.
    entries: Vec<((usize, usize), u32, f64)>,
    /// What each records, channel by channel.
    values: Vec<f64>,
    non_finite: u64,
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
    let empty = || Film::plain([width, height], channels, true);
    let mut pyramid: Pyramid = (2..=longest)
        .flat_map(|n| (0..=n).map(move |s| (s, n - s)))
        .filter(|(s, t)| plan.strategies.plans(*s, *t))
        .map(|strategy| (strategy, StrategyFilms { unweighted: empty(), weighted: empty() }))
        .collect();
    let mut taken = 0;
    for number in 0.. {
        let size = BLOCK_SAMPLES.min(budget.samples_per_pixel - taken) as u32;
        if size == 0 {
            break;
        }
        let block = BlockOf { seed: budget.seed, number, size, direct_light: false };
        let work = |row: usize| find(tracer, view, &block, row as u32, longest);
        for_each_in_order(height as usize, work, |_, result| add(&mut pyramid, &result, channels));
        for films in pyramid.values_mut() {
            films.unweighted.finish_block(size);
            films.weighted.finish_block(size);
        }
        taken += u64::from(size);
    }
    pyramid
}

fn add(pyramid: &mut Pyramid, result: &RowResult, channels: usize) {
    for ((strategy, pixel, weight), values) in result.entries.iter().zip(result.values.chunks_exact(channels))
    {
        let films = pyramid.get_mut(strategy).expect("only listed strategies are found");
        films.unweighted.add_splats(&[*pixel], values);
        let weighted: Vec<f64> = values.iter().map(|value| value * weight).collect();
        films.weighted.add_splats(&[*pixel], &weighted);
    }
    for films in pyramid.values_mut() {
        films.unweighted.faults.count += result.non_finite;
    }
}

/// The contributions of a row's samples.
fn find(tracer: &Tracer<'_>, view: &View, block: &BlockOf, row: u32, longest: usize) -> RowResult {
    let [width, _] = view.camera.resolution();
    let channels = view.sensor.channels.len();
    let mut result = RowResult::default();
    let mut paths = Subpaths::default();
    for column in 0..width {
        let own = row * width + column;
        let numbers = BlockSampler::new(block.seed, u64::from(own), block.number, block.size);
        for index in 0..block.size {
            let sampler = numbers.sample(index);
            let corner = [f64::from(column), f64::from(row)];
            tracer.sample(corner, &sampler, &mut paths, &mut |found, wavelengths| {
                if found.s + found.t > longest {
                    return;
                }
                if !found.estimate.is_finite() {
                    result.non_finite += 1;
                    return;
                }
                let pixel = found.position.map_or(own, |[x, y]| y as u32 * width + x as u32);
                result.entries.push(((found.s, found.t), pixel, f64::from(found.weight)));
                let first = result.values.len();
                result.values.resize(first + channels, 0.0);
                let values = &mut result.values[first..];
                view.sensor.record(found.estimate, wavelengths, |channel, value| values[channel] = value);
            });
        }
    }
    result
}
