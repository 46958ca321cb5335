//! The run: what is learned, then blocks of chains beside blocks of direct light.

use super::chain::{Chain, Splats};
use super::film::ChainFilm;
use super::mutation::{Origin, Place};
use super::normalisation::Estimates;
use super::numbers::Numbers;
use super::report::{Convergence, Counts, Report};
use super::start::{ENOUGH_FOUND, Use};
use super::world::World;
use crate::camera::Film;
use crate::integrator::{Bounded, Budget, DirectLight, InOrder, Progress, Rendering};
use crate::path::Eye;
use crate::replay::Faults;
use crate::sampler::mix;
use crate::scene::{Plan, Scene, View};
use rayon::prelude::*;
use serde::Serialize;
use std::time::Instant;

/// Chains of a block, whatever the number of threads.
const CHAINS: usize = 32;
/// Vertices after which a scene in which nothing was found is given up: some four million
/// paths of four vertices, and fewer between mirrors. Against the clock it is so many for each
/// path of a round of learning.
const MOST_VERTICES: u64 = 1 << 24;
const VERTICES_PER_PATH: u64 = 64;
/// Paths that carry light that a run is to find by searches of fixed size, for its level's sake.
const FINDS_PER_RUN: u64 = 64;
/// Blocks of a run that is told its samples; the scatter between them is the error.
const BLOCKS: u64 = 16;
/// Against the clock, a block takes this share of the samples before it.
const GROWTH: u64 = 8;
/// Mutations that a chain takes between two looks at the film.
const STRETCH: u64 = 1 << 15;
/// Rounds of learning how long fresh paths are to be; fresh paths of each, and half as many
/// mutations: this share of the mutations of a run, at least and at most so many.
const LEARNING_ROUNDS: u64 = 2;
const LEARNING_SHARE: u64 = 16;
/// What a thread can be expected to do, where the run is told its time.
const MUTATIONS_PER_S: f64 = 2e5;
const LEARNING: [u64; 2] = [1 << 12, 1 << 22];
/// Fresh paths in search of starts: this share of a block's mutations, at least and at most.
const SEARCH_SHARE: u64 = 8;
const SEARCH: [u64; 2] = [1 << 10, 1 << 20];
/// Mutations per sample of direct light, where there is some and where none was seen.
const PER_DIRECT: [u64; 2] = [2, 16];

/// What a run of chains comes to beside the picture.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// How sure it is; `None` where no chain could start.
    pub report: Option<Report>,
    /// Fresh paths after which the search for light beyond the direct was given up.
    pub found_none_in: Option<u64>,
    /// Whether there is direct light in the picture.
    pub direct_light: bool,
}

impl Outcome {
    /// With 95 % confidence, a fresh path finds light with less than this probability: none in
    /// N has a chance of (1 - p)^N, about exp(-N p).
    pub fn most_probable_hit(&self) -> Option<f64> {
        self.found_none_in.map(|paths| 3.0 / paths as f64)
    }
}

/// A run on its way.
struct Run<'w, 'a> {
    world: &'w World<'a>,
    seed: u64,
    /// Counts samples and blocks; the sums are kept apart.
    film: Film,
    chain_film: ChainFilm,
    direct: DirectLight<'a>,
    per_direct: u64,
    /// Fresh paths among which there was none for chains to start from.
    found_none_in: Option<u64>,
    /// Fresh paths that each block looks at, so that the run finds enough to know its level.
    search_at_least: u64,
    /// Vertices after which a search gives up.
    most_vertices: u64,
    counts: Counts,
    estimates: Estimates,
    convergence: Convergence,
    faults: Faults,
}

/// Renders a view by chains of mutated paths.
pub fn render(
    scene: &Scene,
    view: &View,
    plan: &Plan,
    budget: &Budget,
    progress: &dyn Progress,
) -> Rendering {
    let started = Instant::now();
    let bounded = Bounded::of(scene, plan, Eye::Camera(&view.camera));
    let mut world = World::new(scene, view, &bounded.plan);
    let pixels = u64::from(world.resolution[0]) * u64::from(world.resolution[1]);
    let mutations = match budget.time {
        Some(time) => (time.as_secs_f64() * MUTATIONS_PER_S * rayon::current_num_threads() as f64) as u64,
        None => budget.samples_per_pixel.saturating_mul(pixels),
    };
    let learning = (mutations / LEARNING_SHARE).clamp(LEARNING[0], LEARNING[1]);
    let most = match budget.time {
        Some(_) => learning * VERTICES_PER_PATH,
        None => MOST_VERTICES,
    };
    let (mut found_none_in, mut needed) = (None, 0);
    let mut faults = Faults::default();
    for round in 0..LEARNING_ROUNDS {
        let seed = mix(budget.seed ^ mix(Use::Pilot as u64 + (round << 8)));
        let search = world.find(seed, learning, most);
        faults.merge(search.faults.clone());
        if search.found.is_empty() {
            found_none_in = Some(search.estimates.paths);
            break;
        }
        needed = FINDS_PER_RUN * search.estimates.paths / search.found.len() as u64;
        let starts = world.starts(&search.found, CHAINS, &mut Numbers::of(&[seed]));
        world.learn(seed, starts, learning / 2 / CHAINS as u64);
    }
    let direct_seed = mix(budget.seed ^ mix(Use::Direct as u64));
    let direct = DirectLight::new(scene, view, bounded.plan.most_bounces, direct_seed);
    let mut run = Run {
        world: &world,
        seed: budget.seed,
        film: Film::new(world.resolution, view.sensor.channels.len(), false),
        chain_film: ChainFilm::new(pixels as usize, view.sensor.channels.len()),
        per_direct: PER_DIRECT[usize::from(!direct.is_seen())],
        direct,
        found_none_in,
        search_at_least: needed.div_ceil(fewest_blocks(budget)),
        most_vertices: most,
        counts: Counts::default(),
        estimates: Estimates::default(),
        convergence: Convergence::default(),
        faults,
    };
    let mut block = 0;
    while run.film.samples_per_pixel() < budget.samples_per_pixel {
        let late = budget.time.is_some_and(|limit| started.elapsed() >= limit);
        // One block cannot give an error estimate; the second is taken even when late.
        if late && block >= 2 {
            break;
        }
        let taken = run.film.samples_per_pixel();
        let size = block_size(budget, taken, block);
        run.chains(block, size, &|share| {
            progress.within_block(budget, started, taken as f64 + share * size as f64)
        });
        run.direct.block(size.div_ceil(run.per_direct) as u32);
        run.film.finish_block(size as u32);
        block += 1;
        progress.block(budget, started, &run.picture());
    }
    let film = run.picture();
    let direct_light = (0..film.pixels()).any(|pixel| run.direct.film().mean(pixel, 1) > 0.0);
    // Chains without a level are no picture.
    let found_none_in = run.found_none_in.or((run.estimates.found == 0).then_some(run.estimates.paths));
    let report = found_none_in.is_none().then(|| Report::of(&run.counts, &run.estimates, &run.convergence));
    let found_none_in = found_none_in.filter(|_| !scene.lights.is_empty());
    let outcome = Outcome { report, found_none_in, direct_light };
    let fates = bounded.fates_beside_chains(scene, Eye::Camera(&view.camera));
    let truncation = bounded.truncation(&fates);
    Rendering { film, elapsed: started.elapsed(), metropolis: Some(outcome), truncation }
}

/// Blocks that a run takes whatever happens.
fn fewest_blocks(budget: &Budget) -> u64 {
    if budget.time.is_some() { 2 } else { BLOCKS.min(budget.samples_per_pixel) }
}

/// Samples per pixel of the next block.
fn block_size(budget: &Budget, taken: u64, block: u64) -> u64 {
    if budget.time.is_some() {
        return (taken / GROWTH).clamp(1, u64::from(u32::MAX));
    }
    // Of as equal size as whole numbers allow.
    let blocks = fewest_blocks(budget);
    let upto =
        |block: u64| (u128::from(budget.samples_per_pixel) * u128::from(block) / u128::from(blocks)) as u64;
    (upto(block + 1) - upto(block)).min(u64::from(u32::MAX))
}

impl Run<'_, '_> {
    /// One block: chains of their own, from starts of their own.
    fn chains(&mut self, block: u64, samples_per_pixel: u64, report_share: &(dyn Fn(f64) + Sync)) {
        if self.found_none_in.is_some() {
            return;
        }
        let world = self.world;
        let key = mix(self.seed ^ mix(block ^ mix(Use::Chain as u64)));
        let mutations = samples_per_pixel * self.film.pixels() as u64;
        let count = (mutations / SEARCH_SHARE).clamp(SEARCH[0], SEARCH[1]).max(self.search_at_least);
        let mut search = world.search(self.seed, block, count);
        self.estimates.merge(&search.estimates);
        if search.found.len() < ENOUGH_FOUND {
            search.extend(world.find(key, count, self.most_vertices));
        }
        self.faults.merge(std::mem::take(&mut search.faults));
        if search.found.is_empty() {
            // Nothing was found where a first search did find something: a block of weight zero.
            return;
        }
        let starts =
            world.starts(&search.found, CHAINS, &mut Numbers::of(&[self.seed, Use::Pick as u64, block]));
        let mut chains: Vec<Chain<'_, '_>> = (0..)
            .zip(starts)
            .map(|(chain, start)| {
                let place = Place { key, chain, bits: CHAINS.trailing_zeros(), drawn: 0 };
                let origin = Origin { seed: self.seed, block: Some(block), chain: Some(chain), number: 0 };
                Chain::new(world, place, origin, start, Numbers::of(&[key, u64::from(chain)]))
            })
            .collect();
        let count = chains.len() as u64;
        let length = |chain: u64| mutations / count + u64::from(chain < mutations % count);
        let longest = length(0);
        for first in (0..longest).step_by(STRETCH as usize) {
            let film = &mut self.chain_film;
            let merge = InOrder::new(|_, splats: Splats| film.add(&splats.pixels, &splats.values));
            chains.par_iter_mut().with_max_len(1).enumerate().for_each(|(index, chain)| {
                let mut splats = Splats::default();
                let left = length(index as u64).saturating_sub(first);
                chain.advance(left.min(STRETCH), &mut splats);
                merge.add(index, splats);
            });
            report_share((first + STRETCH).min(longest) as f64 / longest as f64);
        }
        for chain in chains {
            self.counts.merge(&chain.counts);
            self.estimates.merge(&chain.estimates);
            self.faults.merge(chain.faults().clone());
            self.convergence.add(chain.blocks);
        }
        self.chain_film.finish_block(samples_per_pixel, search.estimates.mean());
    }

    /// The picture so far: what the chains left times the normalisation, and direct light.
    fn picture(&self) -> Film {
        let b = if self.estimates.found > 0 { self.estimates.mean() } else { 0.0 };
        let b_error = if self.estimates.found > 0 { self.estimates.standard_error() } else { 0.0 };
        let mut film = self.film.map(|pixel, channel, _, _| {
            let direct = self.direct.film();
            let (share, error) = self.chain_film.share(pixel, channel);
            let (other, other_error) = (direct.mean(pixel, channel), direct.standard_error(pixel, channel));
            let variance = (b * error).powi(2) + (share * b_error).powi(2) + other_error.powi(2);
            (b * share + other, variance.sqrt())
        });
        film.faults = self.direct.film().faults.clone();
        film.faults.merge(self.faults.clone());
        film
    }
}
