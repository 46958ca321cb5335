//! Where chains start, and how often fresh paths are how long.
//!
//! Chains that set out from paths drawn in proportion to what they count are in equilibrium
//! from the start (Veach 1997, section 11.3.1).

use super::mutation::{Mutator, Place};
use super::normalisation::Estimates;
use super::numbers::Numbers;
use super::path::{Path, ln_sum};
use super::world::World;
use rayon::prelude::*;
use std::collections::HashMap;

/// Fresh paths of one piece of parallel work.
const PIECE: u64 = 512;

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
}

/// A fresh path that carries light, by what makes it again.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    names: [u64; 4],
    ln_estimate: f64,
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

    /// Learns from `count` paths, which are then forgotten, how long fresh paths should be.
    pub fn learn(&mut self, seed: u64, round: u64, count: u64) {
        let each = |path: &Path, _| {
            let n = path.count();
            // Shares by the power heuristic: what each strategy is good for by itself.
            let squares: Vec<f64> = (0..=n).map(|s| 2.0 * path.ln_strategy(s)).collect();
            let all = ln_sum(squares.iter().copied());
            let moment = |s: usize| {
                let ln_share = squares[s] - all;
                let ln = 2.0 * path.ln_estimate() + 2.0 * ln_share + path.ln_fresh - 0.5 * squares[s];
                ln.exp()
            };
            let planned = (0..=n).filter(|s| squares[*s].is_finite());
            planned.map(|s| (path.counted(s), moment(s))).collect::<Vec<_>>()
        };
        let (found, _) = self.fresh_paths([seed, Use::Pilot as u64, round], count, each);
        let mut moments: HashMap<(usize, usize), f64> = HashMap::new();
        for (lengths, moment) in found.into_iter().flatten() {
            *moments.entry(lengths).or_default() += moment;
        }
        self.lengths = self.lengths.learned(|n, s| moments.get(&(n, s)).copied().unwrap_or(0.0));
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
