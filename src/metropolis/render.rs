//! The run: what is learned, then blocks of chains beside blocks of direct light.

use super::chain::{Chain, Splats};
use super::film::ChainFilm;
use super::lengths::Lengths;
use super::mutation::{Origin, Place};
use super::normalisation::Estimates;
use super::numbers::Numbers;
use super::report::{Convergence, Counts, Report};
use super::start::{ENOUGH_FOUND, Use};
use super::world::World;
use crate::camera::{Film, Finished};
use crate::integrator::{
    BlockOf, Bounded, Budget, Clock, DirectLight, FEWEST_SAMPLES, Gathered, InOrder, Progress, Rendering,
    Silent, Source, State,
};
use crate::path::Eye;
use crate::replay::Faults;
use crate::sampler::mix;
use crate::scene::{Plan, Scene, View};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Chains of a block, whatever the number of threads.
const CHAINS: usize = 32;
/// Vertices after which a scene in which nothing was found is given up: some four million
/// paths of four vertices, and fewer between mirrors. Against the clock it is so many for each
/// path of a round of learning.
const MOST_VERTICES: u64 = 1 << 24;
const VERTICES_PER_PATH: u64 = 64;
/// Paths that carry light that a run is to find by searches of fixed size, for its level's sake.
const FINDS_PER_RUN: u64 = 64;
/// Blocks of a run that is told its samples, at least; the scatter between them is the error.
const BLOCKS: u64 = 16;
/// Where it is open how many samples there will be, a block takes this share of those before it.
const GROWTH: u64 = 8;
/// Mutations of the longest block, some ten minutes of one thread: a run can be gone on with
/// from the end of a block only.
const MOST_MUTATIONS: u64 = 1 << 27;
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

/// What a run learns before its first block.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Learned {
    lengths: Lengths,
    /// Fresh paths among which there was none for chains to start from.
    found_none_in: Option<u64>,
    /// Fresh paths that each block looks at, so that the run finds enough to know its level.
    search_at_least: u64,
    /// Vertices after which a search gives up.
    most_vertices: u64,
    /// Paths whose worth was not a number.
    faults: Faults,
}

impl Learned {
    /// Whether paths can be drawn by it: one from a file may be anything.
    pub(crate) fn is_sound(&self) -> bool {
        self.lengths.is_sound()
    }
}

/// What chains leave.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Chains {
    film: ChainFilm,
    direct: Film,
    counts: Counts,
    estimates: Estimates,
    convergence: Convergence,
    faults: Faults,
}

impl Chains {
    /// Whether it is of a picture of this size: one from a file may be anything.
    pub(crate) fn fits(&self, resolution: [u32; 2], channels: usize) -> bool {
        self.film.fits(resolution, channels) && self.direct.fits(resolution, channels)
    }

    /// Adds those of another half.
    fn merge(&mut self, other: &Self) {
        self.counts.merge(&other.counts);
        self.estimates.merge(&other.estimates);
        self.convergence.extend(&other.convergence);
    }
}

/// Chains of mutated paths beside samples of direct light.
struct Mutated<'w, 'a> {
    world: &'w World<'a>,
    learned: &'w Learned,
    direct: DirectLight<'a>,
    per_direct: u64,
}

/// Renders a view by chains of mutated paths.
pub fn render(
    scene: &Scene,
    view: &View,
    plan: &Plan,
    budget: &Budget,
    progress: &dyn Progress,
) -> Rendering {
    go_on(scene, view, plan, budget, progress, None)
}

/// What a short run leaves at a pixel, in cd/m2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AtPixel {
    /// Light that chains bring.
    pub chains: f64,
    /// Its standard error.
    pub chains_error: f64,
    /// Direct light.
    pub direct: f64,
    /// Its standard error.
    pub direct_error: f64,
}

/// What a short run leaves.
#[derive(Clone, Debug)]
pub(crate) struct Short {
    /// Luminances at each pixel.
    pub pixels: Vec<AtPixel>,
    /// Fresh paths that a run of any length looks at before and beside its chains, for its starts
    /// and for its level, beyond those in proportion to its mutations.
    pub needed_paths: f64,
}

/// A short run; `None` where chains found nothing to start from.
pub(crate) fn short_run(scene: &Scene, view: &View, plan: &Plan, budget: &Budget) -> Option<Short> {
    const LUMINANCE: usize = 1;
    let clock = Clock::start(None);
    let mut world = World::new(scene, view, plan);
    // The level need not be as sure as a picture's.
    let learned = Learned { search_at_least: 0, ..learn(&mut world, budget) };
    let direct = DirectLight::new(scene, view, plan);
    let is_seen = direct.is_seen(direct_seed(budget.seed));
    let per_direct = PER_DIRECT[usize::from(!is_seen)];
    let source = Mutated { world: &world, learned: &learned, direct, per_direct };
    let mut state = State::begin(&source, budget, &clock, Some(learned.clone()));
    state.run(&source, budget, &clock, &Silent);
    let chains = state.estimates().next()?.chains.as_ref()?;
    if learned.found_none_in.is_some() || chains.estimates.found == 0 {
        return None;
    }
    let unit = f64::from(world.light_unit);
    let (b, b_error) = (unit * chains.estimates.mean(), unit * chains.estimates.standard_error());
    let at = |pixel: usize| {
        let (share, error) = chains.film.share(pixel, LUMINANCE);
        AtPixel {
            chains: b * share,
            chains_error: (b * error).hypot(share * b_error),
            direct: chains.direct.mean(pixel, LUMINANCE),
            direct_error: chains.direct.standard_error(pixel, LUMINANCE),
        }
    };
    let paths_per_find = chains.estimates.paths as f64 / chains.estimates.found as f64;
    let finds = LEARNING_ROUNDS * ENOUGH_FOUND as u64 + FINDS_PER_RUN;
    let pixels = (0..chains.direct.pixels()).map(at).collect();
    Some(Short { pixels, needed_paths: paths_per_find * finds as f64 })
}

/// Goes on with a run from a state, or begins one.
pub(crate) fn go_on(
    scene: &Scene,
    view: &View,
    plan: &Plan,
    budget: &Budget,
    progress: &dyn Progress,
    from: Option<State>,
) -> Rendering {
    let clock = Clock::start(from.as_ref());
    let eye = Eye::Camera(&view.camera);
    let bounded = Bounded::of(scene, plan, eye);
    let mut world = World::new(scene, view, &bounded.plan);
    let learned = match from.as_ref().and_then(|state| state.learned.clone()) {
        Some(learned) => {
            world.lengths = learned.lengths.clone().among(plan.strategies);
            learned
        }
        None => learn(&mut world, budget),
    };
    let direct = DirectLight::new(scene, view, &bounded.plan);
    let is_seen = direct.is_seen(direct_seed(budget.seed));
    let source =
        Mutated { world: &world, learned: &learned, direct, per_direct: PER_DIRECT[usize::from(!is_seen)] };
    let mut state = from.unwrap_or_else(|| State::begin(&source, budget, &clock, Some(learned.clone())));
    state.run(&source, budget, &clock, progress);
    let outcome = outcome(&world, &learned, &state);
    let mut rendering = state
        .finish(&source, Some(outcome), |_| bounded.truncation(&bounded.fates_beside_chains(scene, eye)));
    rendering.film.faults.merge(learned.faults.clone());
    rendering
}

/// Learns how long fresh paths are to be. The halves of a run share it: what it was learned from
/// enters neither.
fn learn(world: &mut World<'_>, budget: &Budget) -> Learned {
    let mutations = mutations(budget, world.resolution);
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
    Learned {
        lengths: world.lengths.clone(),
        found_none_in,
        search_at_least: needed.div_ceil(fewest_blocks(budget)),
        most_vertices: most,
        faults,
    }
}

/// Mutations that a run can be expected to take.
fn mutations(budget: &Budget, resolution: [u32; 2]) -> u64 {
    if let Some(time) = budget.time {
        return (time.as_secs_f64() * MUTATIONS_PER_S * rayon::current_num_threads() as f64) as u64;
    }
    // Until its error is looked at, a run takes so many in any case.
    let most = if budget.error.is_some() { 2 * FEWEST_SAMPLES } else { u64::MAX };
    let pixels = u64::from(resolution[0]) * u64::from(resolution[1]);
    budget.samples_per_pixel.min(most).saturating_mul(pixels)
}

const fn direct_seed(seed: u64) -> u64 {
    mix(seed ^ mix(Use::Direct as u64))
}

/// What a run says about itself: all that enters the picture, taken together.
fn outcome(world: &World<'_>, learned: &Learned, state: &State) -> Outcome {
    let shares = state.estimates().filter_map(|gathered| {
        gathered.chains.as_ref().and_then(|chains| chains.film.largest_share(&world.weights))
    });
    let largest_pixel_share = shares.reduce(f64::max);
    let mut halves = state.estimates().filter_map(|gathered| gathered.chains.as_ref());
    let is_seen = |chains: &Chains| {
        let direct = &chains.direct;
        (0..direct.pixels()).any(|pixel| direct.mean(pixel, 1) > 0.0)
    };
    let mut all = halves.next().expect("a run of chains gathers chains").clone();
    let mut direct_light = is_seen(&all);
    for half in halves {
        all.merge(half);
        direct_light |= is_seen(half);
    }
    // Chains without a level are no picture.
    let found_none_in = learned.found_none_in.or((all.estimates.found == 0).then_some(all.estimates.paths));
    let report = found_none_in.is_none().then(|| {
        let unit = f64::from(world.light_unit);
        Report::of(&all.counts, &all.estimates, &all.convergence, unit, largest_pixel_share)
    });
    let found_none_in = found_none_in.filter(|_| !world.scene.lights.is_empty());
    Outcome { report, found_none_in, direct_light }
}

/// Blocks that a run takes whatever happens.
fn fewest_blocks(budget: &Budget) -> u64 {
    /// Of a half, against the clock.
    const OF_HALF: u64 = 2;
    // The blocks that an error waits for are more than those of a run that is told its samples.
    if budget.time.is_some() {
        OF_HALF * budget.halves() as u64
    } else {
        BLOCKS.min(budget.samples_per_pixel)
    }
}

/// Samples per pixel of the next block.
fn block_size(budget: &Budget, pixels: u64, taken: u64, block: u64) -> u64 {
    let most = (MOST_MUTATIONS / pixels).clamp(1, u64::from(u32::MAX));
    if budget.is_open() {
        return (taken / GROWTH).clamp(1, most);
    }
    // Of as equal size as whole numbers allow.
    let blocks = BLOCKS.min(budget.samples_per_pixel).max(budget.samples_per_pixel.div_ceil(most));
    let upto =
        |block: u64| (u128::from(budget.samples_per_pixel) * u128::from(block) / u128::from(blocks)) as u64;
    upto(block + 1) - upto(block)
}

impl Source for Mutated<'_, '_> {
    fn begin(&self) -> Gathered {
        let channels = self.world.sensor.channels.len();
        let film = Film::plain(self.world.resolution, channels, false);
        let chains = Chains {
            film: ChainFilm::new(self.world.resolution, channels),
            direct: self.direct.film(),
            counts: Counts::default(),
            estimates: Estimates::default(),
            convergence: Convergence::default(),
            faults: Faults::default(),
        };
        Gathered { film, chains: Some(chains) }
    }

    fn block_size(&self, budget: &Budget, taken: u64, block: u32) -> u64 {
        let [width, height] = self.world.resolution.map(u64::from);
        block_size(budget, width * height, taken, u64::from(block))
    }

    fn block(&self, gathered: &mut Gathered, block: &BlockOf, report_share: &(dyn Fn(f64) + Sync)) {
        let Gathered { film, chains: Some(chains) } = gathered else { return };
        self.chains(chains, block, report_share);
        let direct = u64::from(block.size).div_ceil(self.per_direct) as u32;
        self.direct.block(&mut chains.direct, direct_seed(block.seed), direct);
        film.finish_block(block.size);
    }

    /// What the chains left times the normalisation, and direct light.
    fn picture<'g>(&self, gathered: &'g Gathered) -> Cow<'g, Film> {
        let Gathered { film, chains: Some(chains) } = gathered else {
            return Cow::Borrowed(&gathered.film);
        };
        let [b, b_error] = self.level(chains);
        let direct = &chains.direct;
        let mut film = film.map(|pixel, channel, _, _| {
            let (share, error) = chains.film.share(pixel, channel);
            let (other, other_error) = (direct.mean(pixel, channel), direct.standard_error(pixel, channel));
            let variance = (b * error).powi(2) + (share * b_error).powi(2) + other_error.powi(2);
            (b * share + other, variance.sqrt())
        });
        film.faults = direct.faults.clone();
        film.faults.merge(chains.faults.clone());
        Cow::Owned(film)
    }

    fn finished<'g>(&self, gathered: &'g Gathered) -> Cow<'g, Film> {
        let film = self.picture(gathered);
        let Some(chains) = &gathered.chains else { return film };
        let ([b, b_error], direct) = (self.level(chains), &chains.direct);
        let beside = direct.cell_errors();
        Cow::Owned(film.into_owned().with_finished(Finished {
            scatters: chains.film.scatters(b, b_error).into_iter().chain(direct.scatters()).collect(),
            cells: beside.and_then(|beside| chains.film.cell_errors(b, b_error, &beside)),
            correlated: true,
        }))
    }
}

impl Mutated<'_, '_> {
    /// What chains are normalised by, in cd/m2, and its standard error; zero where none was found.
    fn level(&self, chains: &Chains) -> [f64; 2] {
        let (estimates, unit) = (&chains.estimates, f64::from(self.world.light_unit));
        if estimates.found == 0 {
            return [0.0; 2];
        }
        [unit * estimates.mean(), unit * estimates.standard_error()]
    }

    /// One block: chains of their own, from starts of their own.
    fn chains(&self, gathered: &mut Chains, block: &BlockOf, report_share: &(dyn Fn(f64) + Sync)) {
        let (world, learned) = (self.world, self.learned);
        if learned.found_none_in.is_some() {
            return;
        }
        let (seed, number) = (block.seed, u64::from(block.number));
        let key = mix(seed ^ mix(number ^ mix(Use::Chain as u64)));
        let mutations = u64::from(block.size) * gathered.direct.pixels() as u64;
        let count = (mutations / SEARCH_SHARE).clamp(SEARCH[0], SEARCH[1]).max(learned.search_at_least);
        let mut search = world.search(seed, number, count);
        gathered.estimates.merge(&search.estimates);
        if search.found.len() < ENOUGH_FOUND {
            search.extend(world.find(key, count, learned.most_vertices));
        }
        gathered.faults.merge(std::mem::take(&mut search.faults));
        if search.found.is_empty() {
            // Nothing was found where a first search did find something: a block of weight zero.
            return;
        }
        let starts = world.starts(&search.found, CHAINS, &mut Numbers::of(&[seed, Use::Pick as u64, number]));
        let mut chains: Vec<Chain<'_, '_>> = (0..)
            .zip(starts)
            .map(|(chain, start)| {
                let place = Place { key, chain, bits: CHAINS.trailing_zeros(), drawn: 0 };
                let origin = Origin { seed, block: Some(number), chain: Some(chain), number: 0 };
                Chain::new(world, place, origin, start, Numbers::of(&[key, u64::from(chain)]))
            })
            .collect();
        let count = chains.len() as u64;
        let length = |chain: u64| mutations / count + u64::from(chain < mutations % count);
        let longest = length(0);
        for first in (0..longest).step_by(STRETCH as usize) {
            let film = &mut gathered.film;
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
            gathered.counts.merge(&chain.counts);
            gathered.estimates.merge(&chain.estimates);
            gathered.faults.merge(chain.faults().clone());
            gathered.convergence.add(chain.blocks);
        }
        gathered.film.finish_block(u64::from(block.size), search.estimates.mean());
    }
}
