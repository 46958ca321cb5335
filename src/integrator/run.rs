//! A run on its way: block after block, until each half has been told to end.
//!
//! All that a run knows between two blocks is in [`State`], which can be written down and gone
//! on from. Random numbers are named by seed and block, so that what follows does not depend on
//! how often the run was interrupted.

use super::blocks::BlockOf;
use super::cost::{Cost, Stopwatch, cpu_seconds};
use super::depth::Truncation;
use super::stopping::{Budget, Pace, Reason};
use crate::camera::Film;
use crate::metropolis::{Chains, Learned, Outcome};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::time::{Duration, Instant};

/// Told how a render goes.
pub trait Progress: Sync {
    /// After each block of every half: the time that the run has taken so far, and its picture.
    fn block<'f>(&self, budget: &Budget, elapsed: Duration, picture: &dyn Fn() -> Cow<'f, Film>);

    /// Within a block: samples per pixel so far, those of the block in proportion to the rows
    /// that are done.
    fn within_block(&self, _budget: &Budget, _elapsed: Duration, _samples: f64) {}

    /// After [`Self::block`], and once more when the run has ended: what it can be gone on from.
    fn keep(&self, _state: &State, _has_ended: bool) {}
}

/// No report at all.
#[derive(Clone, Copy, Debug)]
pub struct Silent;

impl Progress for Silent {
    fn block<'f>(&self, _: &Budget, _: Duration, _: &dyn Fn() -> Cow<'f, Film>) {}
}

/// A finished render.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The picture and its error.
    pub film: Film,
    /// Time it took, in all parts together.
    pub elapsed: Duration,
    /// What chains say about themselves, where there were any.
    pub metropolis: Option<Outcome>,
    /// What a limit on bounces has cut off, and what was trapped.
    pub truncation: Truncation,
    /// What ended each half of the picture, or the whole of it.
    pub ends: Vec<End>,
    /// What all parts have cost.
    pub spent: Spent,
    /// What chains have learned before the first block has cost; `None` where there are none.
    pub bootstrap: Option<Cost>,
    /// What the blocks have cost.
    pub blocks: Cost,
}

/// The end of a half.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct End {
    /// Samples per pixel of it in the picture.
    pub samples_per_pixel: u64,
    /// What ended it.
    pub by: Reason,
}

/// What a run has cost so far, in all its processes. What was lost in an interruption is not in it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spent {
    /// Rendering, what chains learn before their first block included.
    pub rendering: Cost,
    /// Processor seconds of the whole process, loading included, where the system tells.
    pub cpu_seconds: Option<f64>,
    /// Processes that the run has taken: one, and one more for every time it was gone on with.
    pub parts: u32,
}

/// What a half has gathered.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Gathered {
    /// Counts samples and blocks; the sums as well, where samples are independent.
    pub(crate) film: Film,
    /// What chains leave.
    pub(crate) chains: Option<Chains>,
}

/// A half of a run, or the whole of one that is told its samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Half {
    gathered: Gathered,
    /// Seconds that its blocks took.
    seconds: f64,
    /// What it says about the other half; about itself, if it is the only one.
    verdict: Option<Reason>,
    /// What enters the picture, where this half was told to end and goes on to decide.
    ended_with: Option<Gathered>,
}

impl Half {
    fn estimate(&self) -> &Gathered {
        self.ended_with.as_ref().unwrap_or(&self.gathered)
    }
}

/// All that a run knows between two blocks.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct State {
    /// What was learned before the first block.
    pub(crate) learned: Option<Learned>,
    halves: Vec<Half>,
    /// What came before the first block.
    before: Cost,
    spent: Spent,
}

/// What takes blocks of samples.
pub(crate) trait Source {
    /// Nothing gathered yet.
    fn begin(&self) -> Gathered;
    /// Samples per pixel of the next block of a half that has so many.
    fn block_size(&self, budget: &Budget, taken: u64, block: u32) -> u64;
    /// Takes a block.
    fn block(&self, gathered: &mut Gathered, block: &BlockOf, report_share: &(dyn Fn(f64) + Sync));
    /// The picture of a half, with the errors of its pixels.
    fn picture<'g>(&self, gathered: &'g Gathered) -> Cow<'g, Film>;
    /// The same with what its pixels share, which takes longer.
    fn finished<'g>(&self, gathered: &'g Gathered) -> Cow<'g, Film> {
        self.picture(gathered)
    }
}

/// Counts what a run costs, from what it has cost before this process.
pub(crate) struct Clock {
    watch: Stopwatch,
    earlier: Spent,
}

impl Clock {
    /// Starts to count; `from` is a state that is gone on from.
    pub fn start(from: Option<&State>) -> Self {
        let none = Spent { rendering: Cost::NOTHING, cpu_seconds: Some(0.0), parts: 0 };
        Self { watch: Stopwatch::start(), earlier: from.map_or(none, |state| state.spent) }
    }

    fn elapsed(&self) -> Duration {
        self.spent().elapsed()
    }

    fn spent(&self) -> Spent {
        Spent {
            rendering: self.earlier.rendering.plus(self.watch.cost()),
            cpu_seconds: self.earlier.cpu_seconds.zip(cpu_seconds()).map(|(earlier, now)| earlier + now),
            parts: self.earlier.parts.saturating_add(1),
        }
    }
}

impl Spent {
    /// Wall-clock time of rendering.
    pub fn elapsed(&self) -> Duration {
        Duration::try_from_secs_f64(self.rendering.wall_s).unwrap_or_default()
    }
}

impl State {
    /// A run that has learned what it needs and taken no block.
    pub(crate) fn begin(
        source: &dyn Source,
        budget: &Budget,
        clock: &Clock,
        learned: Option<Learned>,
    ) -> Self {
        let half = || Half { gathered: source.begin(), seconds: 0.0, verdict: None, ended_with: None };
        let halves = (0..budget.halves()).map(|_| half()).collect();
        let spent = clock.spent();
        Self { learned, halves, before: spent.rendering, spent }
    }

    /// Takes blocks until the run has ended.
    pub(crate) fn run(
        &mut self,
        source: &dyn Source,
        budget: &Budget,
        clock: &Clock,
        progress: &dyn Progress,
    ) {
        while !self.judge(source, budget) {
            let film = &self.halves[0].gathered.film;
            let (taken, number) = (film.samples_per_pixel(), film.blocks());
            let left = budget.most_of_half() - taken;
            let size = source.block_size(budget, taken, number).min(left) as u32;
            for half in 0..self.halves.len() {
                let before = self.samples_per_pixel() as f64;
                let within = |share: f64| {
                    progress.within_block(budget, clock.elapsed(), before + share * f64::from(size));
                };
                let began = Instant::now();
                let of = BlockOf { seed: budget.seed_of(half), number, size, direct_light: false };
                source.block(&mut self.halves[half].gathered, &of, &within);
                self.halves[half].seconds += began.elapsed().as_secs_f64();
            }
            self.spent = clock.spent();
            progress
                .block(budget, clock.elapsed(), &|| self.picture_of(|half| source.picture(&half.gathered)));
            progress.keep(self, false);
        }
        self.spent = clock.spent();
        progress.keep(self, true);
    }

    /// Whether every half has its verdict. A half that is told to end while it has not decided
    /// itself leaves what it has to the picture and goes on.
    fn judge(&mut self, source: &dyn Source, budget: &Budget) -> bool {
        let before_s = self.before.wall_s;
        for half in self.halves.iter_mut().filter(|half| half.verdict.is_none()) {
            let film = &half.gathered.film;
            let pace = Pace {
                samples_per_pixel: film.samples_per_pixel(),
                pixels: film.pixels() as u64,
                blocks: film.blocks(),
                seconds: half.seconds,
            };
            half.verdict = budget.verdict(pace, before_s, || source.picture(&half.gathered).relative_error());
        }
        if let [one, other] = self.halves.as_mut_slice() {
            end_with(one, other);
            end_with(other, one);
        }
        self.has_ended()
    }

    /// Whether nothing is left to be done.
    pub fn has_ended(&self) -> bool {
        self.halves.iter().all(|half| half.verdict.is_some())
    }

    /// What the run has cost so far.
    pub const fn spent(&self) -> Spent {
        self.spent
    }

    /// Samples per pixel of all halves.
    pub fn samples_per_pixel(&self) -> u64 {
        self.halves.iter().map(|half| half.gathered.film.samples_per_pixel()).sum()
    }

    /// What enters the picture, half by half.
    pub(crate) fn estimates(&self) -> impl Iterator<Item = &Gathered> {
        self.halves.iter().map(Half::estimate)
    }

    /// What is gathered so far, or what of it enters the picture, as one picture.
    fn picture_of<'s>(&'s self, picture: impl Fn(&'s Half) -> Cow<'s, Film>) -> Cow<'s, Film> {
        let mut films = self.halves.iter().map(picture);
        let first = films.next().expect("a run has one half at least");
        films.fold(first, |sum, film| Cow::Owned(sum.mean_with(&film)))
    }

    /// The finished picture.
    pub(crate) fn finish(
        &self,
        source: &dyn Source,
        metropolis: Option<Outcome>,
        truncation: impl FnOnce(&Film) -> Truncation,
    ) -> Rendering {
        let verdict = |half: usize| self.halves[half].verdict.unwrap_or(Reason::Samples);
        let ends = self.halves.iter().enumerate().map(|(index, half)| End {
            samples_per_pixel: half.estimate().film.samples_per_pixel(),
            by: verdict(self.halves.len() - 1 - index),
        });
        let film = self.picture_of(|half| source.finished(half.estimate())).into_owned();
        let bootstrap = self.learned.is_some().then_some(self.before);
        Rendering {
            bootstrap,
            blocks: self.spent.rendering.minus(bootstrap.unwrap_or(Cost::NOTHING)),
            truncation: truncation(&film),
            film,
            elapsed: self.spent.elapsed(),
            metropolis,
            ends: ends.collect(),
            spent: self.spent,
        }
    }

    /// Whether the parts fit together, and the run that they are of; what does not, if they do
    /// not. A state from a file that was made to look like one may be anything.
    ///
    /// # Errors
    /// What does not fit, in words.
    pub fn check(
        &self,
        resolution: [u32; 2],
        channels: usize,
        has_chains: bool,
        budget: &Budget,
    ) -> Result<(), &'static str> {
        if self.halves.len() != budget.halves() {
            return Err("it has not as many halves as its rule of stopping needs");
        }
        if !(self.before.wall_s.is_finite()
            && self.spent.rendering.wall_s.is_finite()
            && self.spent.rendering.wall_s >= 0.0)
        {
            return Err("its times are no times");
        }
        if self.learned.is_some() != has_chains || self.learned.as_ref().is_some_and(|it| !it.is_sound()) {
            return Err("what it has learned is no distribution");
        }
        /// More samples than any run takes, and blocks: the next ones must be countable.
        const MOST: (u64, u32) = (1 << 48, 1 << 30);
        let blocks = self.halves[0].gathered.film.blocks();
        for half in &self.halves {
            if half.gathered.film.blocks() != blocks || !half.seconds.is_finite() {
                return Err("its halves have not come equally far");
            }
            for gathered in std::iter::once(&half.gathered).chain(&half.ended_with) {
                let film = &gathered.film;
                let is_counted = film.samples_per_pixel() <= budget.most_of_half().min(MOST.0)
                    && film.blocks() <= MOST.1
                    && u64::from(film.blocks()) <= film.samples_per_pixel();
                let chains_fit = gathered.chains.is_some() == has_chains
                    && gathered.chains.as_ref().is_none_or(|chains| chains.fits(resolution, channels));
                if !(is_counted && film.fits(resolution, channels) && chains_fit) {
                    return Err("its films have not the size of the picture");
                }
            }
        }
        Ok(())
    }
}

/// Ends `going_on` in the picture where `decided` says so and it has not decided itself.
fn end_with(decided: &Half, going_on: &mut Half) {
    if decided.verdict.is_some() && going_on.verdict.is_none() && going_on.ended_with.is_none() {
        going_on.ended_with = Some(going_on.gathered.clone());
    }
}
