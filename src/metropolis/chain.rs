//! One chain: paths, each made from the one before, and what they leave in the picture.

use super::mutation::{Mutation, Mutator, Origin, Place};
use super::normalisation::Estimates;
use super::numbers::Numbers;
use super::path::Path;
use super::report::{Blocks, Counts};
use super::world::World;
use crate::replay::Faults;

/// Probability that a mutation is a fresh path, whatever the path is like: their number must
/// not depend on where the chain is, for what they find tells the level of the picture.
pub const FRESH: f64 = 0.2;

/// How often each of the other mutations is tried, where it applies.
const fn weight(mutation: Mutation) -> f64 {
    match mutation {
        Mutation::Fresh => 0.0,
        Mutation::Bidirectional => 1.0,
        Mutation::LensSubpath => 0.5,
        Mutation::Lens | Mutation::Caustic | Mutation::MultiChain => 1.0,
        Mutation::Wavelength => 0.25,
        Mutation::Primary => 2.0,
    }
}

/// What a stretch of a chain leaves in the picture, in the order in which it was left.
#[derive(Debug, Default)]
pub struct Splats {
    /// Pixels, in rows from the top left.
    pub pixels: Vec<u32>,
    /// For each of them what every channel records, over the normalisation.
    pub values: Vec<f64>,
}

/// A chain on its way.
pub struct Chain<'w, 'a> {
    world: &'w World<'a>,
    mutator: Mutator<'w, 'a>,
    numbers: Numbers,
    state: Path,
    proposal: Path,
    /// Turns that the path has stood for and not yet left in the picture.
    pending: f64,
    /// What made the path; the start is a fresh one.
    made_by: Mutation,
    /// Turns since the path was last replaced.
    rejected: u64,
    /// What happened to each mutation.
    pub counts: Counts,
    /// Where in the picture the chain was.
    pub blocks: Blocks,
    /// What its fresh paths found.
    pub estimates: Estimates,
}

impl<'w, 'a> Chain<'w, 'a> {
    /// A chain that sets out from a path.
    pub fn new(world: &'w World<'a>, place: Place, origin: Origin, start: Path, numbers: Numbers) -> Self {
        let mutator = Mutator { origin, ..Mutator::new(world, place) };
        Self {
            world,
            mutator,
            numbers,
            proposal: Path::empty(start.wavelengths),
            state: start,
            pending: 0.0,
            made_by: Mutation::Fresh,
            rejected: 0,
            counts: Counts::default(),
            blocks: Blocks::default(),
            estimates: Estimates::default(),
        }
    }

    /// Goes on by so many mutations.
    pub fn advance(&mut self, mutations: u64, splats: &mut Splats) {
        for _ in 0..mutations {
            self.step(splats);
        }
        self.leave(splats);
    }

    /// Goes on without a picture; each path that the chain stands at is handed to `each`.
    pub fn explore(&mut self, mutations: u64, mut each: impl FnMut(&Path)) {
        let mut splats = Splats::default();
        for _ in 0..mutations {
            self.step(&mut splats);
            each(&self.state);
            splats.pixels.clear();
            splats.values.clear();
        }
    }

    /// Proposals whose worth was not a number; they were never accepted.
    pub const fn faults(&self) -> &Faults {
        &self.mutator.faults
    }

    fn step(&mut self, splats: &mut Splats) {
        let mutation = self.choose();
        let proposed = self.mutator.propose(mutation, &self.state, &mut self.proposal, &mut self.numbers);
        if mutation == Mutation::Fresh {
            self.estimates.add(proposed.map(|_| self.proposal.ln_estimate().exp()));
        }
        let acceptance = proposed.map_or(0.0, |ln_ratio| {
            let chosen = if mutation == Mutation::Fresh {
                0.0
            } else {
                (share(mutation, &self.proposal) / share(mutation, &self.state)).ln()
            };
            acceptance_of(ln_ratio + chosen)
        });
        let accepted = self.numbers.fine() < acceptance;
        self.counts.note(mutation, proposed.is_some(), acceptance, accepted);
        // Both paths count by what is expected, whichever comes out.
        self.pending += 1.0 - acceptance;
        self.counts.note_stood(self.made_by, 1.0 - acceptance);
        self.counts.note_stood(mutation, acceptance);
        self.blocks.note(self.world, &[(&self.state, 1.0 - acceptance), (&self.proposal, acceptance)]);
        if accepted {
            self.leave(splats);
            if kind(&self.state) != kind(&self.proposal) {
                self.counts.note_new_kind(mutation);
            }
            self.made_by = mutation;
            std::mem::swap(&mut self.state, &mut self.proposal);
            self.pending = acceptance;
            self.rejected = 0;
        } else {
            if acceptance > 0.0 {
                put(self.world, &self.proposal, acceptance, splats);
            }
            self.rejected += 1;
            self.counts.longest_rejection = self.counts.longest_rejection.max(self.rejected);
        }
    }

    fn choose(&mut self) -> Mutation {
        if self.numbers.fine() < FRESH {
            return Mutation::Fresh;
        }
        let weights = Mutation::ALL.iter().map(|mutation| offered(*mutation, &self.state));
        let index = self.numbers.choose(weights).expect("some mutations apply to every path");
        Mutation::ALL[index]
    }

    /// Leaves in the picture what the path has stood for.
    fn leave(&mut self, splats: &mut Splats) {
        if self.pending > 0.0 {
            put(self.world, &self.state, self.pending, splats);
            self.pending = 0.0;
        }
    }
}

/// Probability with which a proposal is accepted, by the logarithm of its ratio. One that is no
/// number is never accepted: `min` would take 1 before it.
pub fn acceptance_of(ln_ratio: f64) -> f64 {
    if ln_ratio.is_nan() { 0.0 } else { ln_ratio.exp().min(1.0) }
}

/// Weight of a mutation at a path.
fn offered(mutation: Mutation, path: &Path) -> f64 {
    let weight = weight(mutation);
    if weight > 0.0 && mutation.applies(path) { weight } else { 0.0 }
}

/// Probability of a mutation among those that apply to a path.
fn share(mutation: Mutation, path: &Path) -> f64 {
    let all: f64 = Mutation::ALL.iter().map(|other| offered(*other, path)).sum();
    offered(mutation, path) / all
}

/// Vertices and deltas of a path.
fn kind(path: &Path) -> (usize, usize) {
    (path.count(), (0..path.count()).filter(|index| path.is_delta(*index)).count())
}

fn put(world: &World<'_>, path: &Path, weight: f64, splats: &mut Splats) {
    splats.pixels.push(world.pixel(path.position));
    splats.values.extend(path.channels.iter().map(|channel| channel * weight));
}
