//! Where chains start, and how often fresh paths are how long.
//!
//! Chains that set out from paths drawn in proportion to what they count are in equilibrium
//! from the start (Veach 1997, section 11.3.1).

use super::chain::Chain;
use super::lengths::Lengths;
use super::mutation::{Mutator, Place};
use super::normalisation::Estimates;
use super::numbers::Numbers;
use super::path::{Path, ln_sum};
use super::world::World;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Fresh paths of one piece of parallel work.
const PIECE: u64 = 512;

/// Paths found that are enough to choose starts from.
pub const ENOUGH_FOUND: usize = 32;
/// Fresh paths after which a scene in which nothing was found is given up.
const MOST_SEARCHED: u64 = 1 << 22;

/// Names of the uses of random numbers within a run.
#[derive(Clone, Copy)]
pub enum Use {
    /// Learning how long paths are.
    Pilot = 1,
    /// Finding where chains start.
    Start = 2,
    /// The chains.
    Chain = 3,
    /// Which of the paths found each chain starts from.
    Pick = 4,
    /// Direct light.
    Direct = 5,
    /// Chains that learn.
    PilotChain = 6,
}

/// A fresh path that carries light, by what makes it again.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    names: [u64; 4],
    ln_estimate: f64,
}

/// Mean of what fresh paths count, of which some were found to count something.
pub fn mean_of(found: &[Found], searched: u64) -> f64 {
    ln_sum(found.iter().map(|path| path.ln_estimate)).exp() / searched as f64
}

/// What one path of each strategy counts, squared, on average over paths: by counted vertices
/// and those from the light.
#[derive(Default)]
struct Moments(BTreeMap<(usize, usize), f64>);

impl Moments {
    /// Adds a path that was drawn in proportion to its target.
    ///
    /// Strategies share paths by the power heuristic here: what each is good for by itself.
    fn add(&mut self, path: &Path) {
        let squares = || (0..=path.count()).map(|s| 2.0 * path.ln_strategy(s));
        let all = ln_sum(squares());
        for (s, square) in squares().enumerate().filter(|(_, square)| square.is_finite()) {
            let ln = path.ln_target + 2.0 * (square - all) - 0.5 * square;
            *self.0.entry(path.counted(s)).or_default() += ln.exp();
        }
    }

    fn together(all: Vec<Self>) -> Self {
        let mut sum = Self::default();
        for (lengths, moment) in all.into_iter().flat_map(|moments| moments.0) {
            *sum.0.entry(lengths).or_default() += moment;
        }
        sum
    }

    fn lengths(&self, before: &Lengths) -> Lengths {
        before.learned(|n, s| self.0.get(&(n, s)).copied().unwrap_or(0.0))
    }
}

impl World<'_> {
    /// Makes `count` fresh paths and hands those that carry light to `each`; their order does
    /// not depend on the number of threads.
    fn fresh_paths<T: Send>(
        &self,
        names: [u64; 3],
        count: u64,
        each: impl Fn(&Path, [u64; 4]) -> T + Sync,
    ) -> (Vec<T>, Estimates) {
        let piece = |first: u64| {
            let mut mutator = Mutator::new(self, Place { key: 0, chain: 0, bits: 0, drawn: 0 });
            let mut path = Path::empty(self.plan.wavelengths.sample(0.0));
            let mut found = Vec::new();
            let mut estimates = Estimates::default();
            for index in first..count.min(first + PIECE) {
                let names = [names[0], names[1], names[2], index];
                let made = mutator.fresh(&mut path, &mut Numbers::of(&names));
                estimates.add(made.map(|()| path.ln_estimate().exp()));
                if made.is_some() {
                    found.push(each(&path, names));
                }
            }
            (found, estimates)
        };
        let pieces: Vec<(Vec<T>, Estimates)> =
            (0..count.div_ceil(PIECE)).into_par_iter().map(|index| piece(index * PIECE)).collect();
        let mut all = Vec::new();
        let mut together = Estimates::default();
        for (found, estimates) in pieces {
            all.extend(found);
            together.merge(&estimates);
        }
        (all, together)
    }

    /// Learns from chains, which are then forgotten, how long fresh paths should be: chains
    /// know light that fresh paths hardly find.
    pub fn learn(&mut self, seed: u64, starts: Vec<Path>, mutations: u64) {
        let each = |(index, start): (usize, Path)| {
            let names = [seed, Use::PilotChain as u64, index as u64];
            let place = Place { key: seed, chain: 0, bits: 0, drawn: 0 };
            let mut chain = Chain::new(self, place, start, Numbers::of(&names));
            let mut moments = Moments::default();
            // A chain is at a path in proportion to its target.
            chain.explore(mutations, |path| moments.add(path));
            moments
        };
        let found: Vec<Moments> = starts.into_par_iter().enumerate().map(each).collect();
        self.lengths = Moments::together(found).lengths(&self.lengths);
    }

    /// Looks for paths that carry light until there are enough to start from, or none is to be
    /// expected. What this search finds tells nothing of the level: it ends when it finds
    /// something. It looks at `first` paths, and then always at as many as before. With the
    /// paths comes how many were looked at.
    pub fn find(&self, seed: u64, first: u64) -> (Vec<Found>, u64) {
        let mut all = Vec::new();
        if self.scene.lights.is_empty() {
            return (all, 0);
        }
        let mut searched = 0;
        let mut count = first;
        while all.len() < ENOUGH_FOUND && searched < MOST_SEARCHED {
            let (found, _) = self.search(seed, u64::MAX - searched, count);
            all.extend(found);
            searched += count;
            count = searched;
        }
        (all, searched)
    }

    /// Looks for paths that carry light among `count` fresh ones.
    pub fn search(&self, seed: u64, block: u64, count: u64) -> (Vec<Found>, Estimates) {
        let each = |path: &Path, names| Found { names, ln_estimate: path.ln_estimate() };
        self.fresh_paths([seed, Use::Start as u64, block], count, each)
    }

    /// Paths for `chains` chains to start from, out of those found in proportion to what they
    /// count.
    pub fn starts(&self, found: &[Found], chains: usize, numbers: &mut Numbers) -> Vec<Path> {
        let all = ln_sum(found.iter().map(|path| path.ln_estimate));
        let offset = numbers.fine();
        let mut upto = 0.0;
        let mut starts = Vec::with_capacity(chains);
        for path in found {
            upto += (path.ln_estimate - all).exp();
            while starts.len() < chains && (starts.len() as f64 + offset) / chains as f64 <= upto {
                starts.extend(self.again(path));
            }
        }
        // Rounding of the sum may leave the last place empty.
        while starts.len() < chains {
            let Some(path) = found.last().and_then(|path| self.again(path)) else { break };
            starts.push(path);
        }
        starts
    }

    fn again(&self, found: &Found) -> Option<Path> {
        let mut mutator = Mutator::new(self, Place { key: 0, chain: 0, bits: 0, drawn: 0 });
        let mut path = Path::empty(self.plan.wavelengths.sample(0.0));
        mutator.fresh(&mut path, &mut Numbers::of(&found.names))?;
        Some(path)
    }

    /// The pixel of a position.
    pub fn pixel(&self, position: [f64; 2]) -> u32 {
        let [x, y] = [0, 1].map(|axis| (position[axis] as u32).min(self.resolution[axis] - 1));
        y * self.resolution[0] + x
    }
}
