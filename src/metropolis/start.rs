//! Where chains start, and how often fresh paths are how long.
//!
//! Chains that set out from paths drawn in proportion to what they count are in equilibrium
//! from the start (Veach 1997, section 11.3.1).

use super::chain::Chain;
use super::lengths::Lengths;
use super::mutation::{Mutation, Mutator, Origin, Place};
use super::normalisation::Estimates;
use super::numbers::Numbers;
use super::path::{Path, ln_sum};
use super::world::World;
use crate::replay::Faults;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Fresh paths of one piece of parallel work.
const PIECE: u64 = 512;

/// Paths found that are enough to choose starts from.
pub const ENOUGH_FOUND: usize = 32;
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

/// What a search among fresh paths comes to.
#[derive(Debug, Default)]
pub struct Search {
    /// Those that carry light.
    pub found: Vec<Found>,
    /// What all of them estimate.
    pub estimates: Estimates,
    /// Vertices that were looked at: what the search has cost.
    pub vertices: u64,
    /// Paths whose worth was not a number.
    pub faults: Faults,
}

impl Search {
    /// Adds a further search.
    pub fn extend(&mut self, other: Self) {
        self.found.extend(other.found);
        self.estimates.merge(&other.estimates);
        self.vertices += other.vertices;
        self.faults.merge(other.faults);
    }
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
    /// Makes `count` fresh paths; the order of those found does not depend on the number of
    /// threads.
    pub fn search(&self, seed: u64, block: u64, count: u64) -> Search {
        let piece = |first: u64| {
            let mut mutator = Mutator::new(self, Place { key: 0, chain: 0, bits: 0, drawn: 0 });
            mutator.origin = Origin { seed, block: Some(block), chain: None, number: first };
            let mut path = Path::empty(self.plan.wavelengths.sample(0.0));
            let mut piece = Search::default();
            for index in first..count.min(first + PIECE) {
                let names = [seed, Use::Start as u64, block, index];
                let made = mutator.fresh(&mut path, &mut Numbers::of(&names));
                mutator.note_fault(Mutation::Fresh, &mut path, false);
                mutator.origin.number += 1;
                piece.estimates.add(made.map(|()| path.ln_estimate().exp()));
                piece.vertices += mutator.draft.vertices();
                if made.is_some() {
                    piece.found.push(Found { names, ln_estimate: path.ln_estimate() });
                }
            }
            piece.faults = mutator.faults;
            piece
        };
        let pieces: Vec<Search> =
            (0..count.div_ceil(PIECE)).into_par_iter().map(|index| piece(index * PIECE)).collect();
        let mut all = Search::default();
        pieces.into_iter().for_each(|piece| all.extend(piece));
        all
    }

    /// Learns from chains, which are then forgotten, how long fresh paths should be: chains
    /// know light that fresh paths hardly find.
    pub fn learn(&mut self, seed: u64, starts: Vec<Path>, mutations: u64) {
        let each = |(index, start): (usize, Path)| {
            let names = [seed, Use::PilotChain as u64, index as u64];
            let place = Place { key: seed, chain: 0, bits: 0, drawn: 0 };
            let origin = Origin { seed, block: None, chain: Some(index as u32), number: 0 };
            let mut chain = Chain::new(self, place, origin, start, Numbers::of(&names));
            let mut moments = Moments::default();
            // A chain is at a path in proportion to its target.
            chain.explore(mutations, |path| moments.add(path));
            moments
        };
        let found: Vec<Moments> = starts.into_par_iter().enumerate().map(each).collect();
        self.lengths = Moments::together(found).lengths(&self.lengths);
    }

    /// Looks for paths that carry light until there are enough to start from, or none is to be
    /// expected after `most` vertices. Its estimates tell nothing of the level: it ends when it
    /// finds something. It looks at `first` paths, and then always at as many as before.
    pub fn find(&self, seed: u64, first: u64, most: u64) -> Search {
        let mut all = Search::default();
        if self.scene.lights.is_empty() {
            return all;
        }
        let mut count = first;
        while all.found.len() < ENOUGH_FOUND && all.vertices < most {
            let searched = all.estimates.paths;
            all.extend(self.search(seed, u64::MAX - searched, count));
            count = all.estimates.paths;
        }
        all
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
