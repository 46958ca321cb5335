//! What a run says about itself: which mutations did what, and whether the chains agree.

use super::mutation::Mutation;
use super::normalisation::Estimates;
use super::path::Path;
use super::world::World;
use serde::{Deserialize, Serialize};

/// What happened to each mutation of a chain.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Counts {
    by_mutation: [Count; Mutation::ALL.len()],
    /// Longest run of turns in which one path stayed.
    pub longest_rejection: u64,
}

#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Count {
    proposed: u64,
    complete: u64,
    accepted: u64,
    expected: f64,
    new_kinds: u64,
    stood: f64,
}

impl Counts {
    /// Notes one turn: whether there was a path to decide on, its acceptance, and the outcome.
    pub fn note(&mut self, mutation: Mutation, complete: bool, acceptance: f64, accepted: bool) {
        let count = &mut self.by_mutation[mutation as usize];
        count.proposed += 1;
        count.complete += u64::from(complete);
        count.accepted += u64::from(accepted);
        count.expected += acceptance;
    }

    /// Notes that a mutation has led to a path of another kind: of more or fewer vertices or
    /// deltas.
    pub fn note_new_kind(&mut self, mutation: Mutation) {
        self.by_mutation[mutation as usize].new_kinds += 1;
    }

    /// Notes by how much a path counted that a mutation had made.
    pub fn note_stood(&mut self, made_by: Mutation, weight: f64) {
        self.by_mutation[made_by as usize].stood += weight;
    }

    /// Adds those of another chain.
    pub fn merge(&mut self, other: &Self) {
        for (count, more) in self.by_mutation.iter_mut().zip(&other.by_mutation) {
            count.proposed += more.proposed;
            count.complete += more.complete;
            count.accepted += more.accepted;
            count.expected += more.expected;
            count.new_kinds += more.new_kinds;
            count.stood += more.stood;
        }
        self.longest_rejection = self.longest_rejection.max(other.longest_rejection);
    }

    /// The table of the report.
    pub fn rows(&self) -> Vec<MutationRow> {
        let all: f64 = self.by_mutation.iter().map(|count| count.stood).sum();
        Mutation::ALL
            .iter()
            .zip(&self.by_mutation)
            .map(|(mutation, count)| MutationRow {
                mutation: mutation.name(),
                proposed: count.proposed,
                complete: count.complete,
                accepted: count.accepted,
                acceptance: if count.proposed > 0 { count.expected / count.proposed as f64 } else { 0.0 },
                new_kinds: count.new_kinds,
                contribution: if all > 0.0 { count.stood / all } else { 0.0 },
            })
            .collect()
    }
}

/// One mutation in the report.
#[derive(Clone, Debug, Serialize)]
pub struct MutationRow {
    /// Which.
    pub mutation: &'static str,
    /// How often it was tried.
    pub proposed: u64,
    /// How often that gave a path that carries light.
    pub complete: u64,
    /// How often the path was taken.
    pub accepted: u64,
    /// Mean acceptance probability.
    pub acceptance: f64,
    /// How often the path taken was of another kind, of more or fewer vertices or deltas.
    pub new_kinds: u64,
    /// Share of the picture, direct light apart, that is made of paths that it has made.
    pub contribution: f64,
}

/// Blocks of the picture, along each side, that chains are compared in.
const SIDE: usize = 4;

/// How often a chain was in each block of the picture.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Blocks {
    turns: u64,
    sums: [f64; SIDE * SIDE],
    squares: [f64; SIDE * SIDE],
}

impl Default for Blocks {
    fn default() -> Self {
        Self { turns: 0, sums: [0.0; SIDE * SIDE], squares: [0.0; SIDE * SIDE] }
    }
}

impl Blocks {
    /// Notes one turn: the paths that it counts, and by how much.
    pub fn note(&mut self, world: &World<'_>, parts: &[(&Path, f64); 2]) {
        self.turns += 1;
        let block = |path: &Path| {
            let cell = |axis: usize| {
                let share = path.position[axis] / f64::from(world.resolution[axis]);
                ((share * SIDE as f64) as usize).min(SIDE - 1)
            };
            cell(1) * SIDE + cell(0)
        };
        let [(a, weight_a), (b, weight_b)] = *parts;
        if weight_b == 0.0 || block(a) == block(b) {
            let block = if weight_a > 0.0 { block(a) } else { block(b) };
            self.sums[block] += weight_a + weight_b;
            self.squares[block] += (weight_a + weight_b).powi(2);
        } else {
            for (path, weight) in [(a, weight_a), (b, weight_b)] {
                self.sums[block(path)] += weight;
                self.squares[block(path)] += weight * weight;
            }
        }
    }
}

/// Whether chains that should have seen the same picture did.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Convergence {
    chains: Vec<Blocks>,
}

impl Convergence {
    /// Adds a chain.
    pub fn add(&mut self, chain: Blocks) {
        self.chains.push(chain);
    }

    /// Adds the chains of another half of the run.
    pub fn extend(&mut self, other: &Self) {
        self.chains.extend_from_slice(&other.chains);
    }

    /// The largest potential scale reduction over the blocks of the picture (Gelman and Rubin
    /// 1992): root of total variance over variance within chains. Near 1 when chains have
    /// mixed; `None` with fewer than two chains. Chains less than half as long as the longest
    /// are left out.
    pub fn scale_reduction(&self) -> Option<f64> {
        // Short chains, of the first blocks against the clock, have seen less than there is.
        let longest = self.chains.iter().map(|chain| chain.turns).max().unwrap_or(0);
        let chains: Vec<&Blocks> =
            self.chains.iter().filter(|chain| chain.turns > 1 && 2 * chain.turns >= longest).collect();
        if chains.len() < 2 {
            return None;
        }
        let count = chains.len() as f64;
        let turns = chains.iter().map(|chain| chain.turns as f64).sum::<f64>() / count;
        let of_block = |block: usize| {
            let means: Vec<f64> = chains.iter().map(|c| c.sums[block] / c.turns as f64).collect();
            let mean = means.iter().sum::<f64>() / count;
            let between = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (count - 1.0);
            let within = chains
                .iter()
                .zip(&means)
                .map(|(c, m)| (c.squares[block] / c.turns as f64 - m * m).max(0.0))
                .sum::<f64>()
                / count;
            match (within > 0.0, between > 0.0) {
                (true, _) => (1.0 - 1.0 / turns + between / within).sqrt(),
                // Each chain stays where it is, and they are in different places.
                (false, true) => f64::INFINITY,
                (false, false) => 1.0,
            }
        };
        (0..SIDE * SIDE).map(of_block).reduce(f64::max)
    }

    /// Chains that were compared.
    pub const fn chains(&self) -> usize {
        self.chains.len()
    }
}

/// Below this the chains count as mixed.
pub const MIXED: f64 = 1.01;

/// How sure a run is.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Chains, independent of each other.
    pub chains: usize,
    /// Mutations of all chains together.
    pub mutations: u64,
    /// Mean of the target function over the picture: the sum over channels of what they record
    /// over the integral of their response; direct light is not in it.
    pub normalisation: f64,
    /// 95 % interval of it.
    pub normalisation_ci95: [f64; 2],
    /// Fresh paths that it comes from.
    pub fresh_paths: u64,
    /// Those of them that found light.
    pub fresh_paths_found: u64,
    /// Longest run of mutations that one path outlived, of those in a chain.
    pub longest_rejection: u64,
    /// Largest share that one pixel has of what the chains left; one path that is hardly left
    /// again makes it large.
    pub largest_pixel_share: Option<f64>,
    /// Largest potential scale reduction between the chains over 16 blocks of the picture.
    pub scale_reduction: Option<f64>,
    /// Whether that is below 1.01.
    pub mixed: bool,
    /// The mutations.
    pub mutation_table: Vec<MutationRow>,
}

impl Report {
    /// The report of a run whose estimates are in a unit of radiance, with the largest share of
    /// a pixel.
    pub fn of(
        counts: &Counts,
        estimates: &Estimates,
        convergence: &Convergence,
        unit: f64,
        largest_pixel_share: Option<f64>,
    ) -> Self {
        let rows = counts.rows();
        let scale_reduction = convergence.scale_reduction();
        Self {
            chains: convergence.chains(),
            mutations: rows.iter().map(|row| row.proposed).sum(),
            normalisation: if estimates.found > 0 { unit * estimates.mean() } else { 0.0 },
            normalisation_ci95: estimates.interval().map(|end| unit * end),
            fresh_paths: estimates.paths,
            fresh_paths_found: estimates.found,
            longest_rejection: counts.longest_rejection,
            largest_pixel_share,
            scale_reduction,
            mixed: scale_reduction.is_some_and(|reduction| reduction < MIXED),
            mutation_table: rows,
        }
    }
}

impl std::fmt::Display for Report {
    /// Several lines for a terminal.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [low, high] = self.normalisation_ci95;
        let b = self.normalisation;
        writeln!(
            f,
            "normalisation b {b:.6e}, 95 % from {:+.2} to {:+.2} %, of {} fresh paths, {} of which found light",
            100.0 * (low / b - 1.0),
            100.0 * (high / b - 1.0),
            self.fresh_paths,
            self.fresh_paths_found
        )?;
        let mixing = match self.scale_reduction {
            None => "not compared".to_owned(),
            Some(reduction) if self.mixed => format!("{reduction:.4}: mixed"),
            Some(reduction) => {
                format!("{reduction:.4}: not mixed (1.01 and below is); more samples let each chain see more")
            }
        };
        writeln!(f, "{} chains, scale reduction between them {mixing}", self.chains)?;
        write!(f, "longest rejection run {} of {} mutations", self.longest_rejection, self.mutations)?;
        match self.largest_pixel_share {
            Some(share) => writeln!(f, ", largest share of one pixel {:.2} %", 100.0 * share)?,
            None => writeln!(f)?,
        }
        writeln!(
            f,
            "{:<16}{:>12}{:>12}{:>12}{:>12}{:>12}{:>14}",
            "mutation", "proposed", "complete", "accepted", "new kind", "acceptance", "contribution"
        )?;
        for row in &self.mutation_table {
            writeln!(
                f,
                "{:<16}{:>12}{:>12}{:>12}{:>12}{:>11.1}%{:>13.1}%",
                row.mutation,
                row.proposed,
                row.complete,
                row.accepted,
                row.new_kinds,
                100.0 * row.acceptance,
                100.0 * row.contribution
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chain(turns: u64, block: usize) -> Blocks {
        let mut blocks = Blocks { turns, ..Blocks::default() };
        blocks.sums[block] = turns as f64;
        blocks.squares[block] = turns as f64;
        blocks
    }

    /// Chains that never leave the block they are in: together everywhere, and not mixed.
    #[test]
    fn stuck_chains_are_not_mixed() {
        let stuck = |blocks: &[usize]| {
            let chains = blocks.iter().map(|block| chain(1000, *block)).collect();
            Convergence { chains }.scale_reduction()
        };
        assert_eq!(stuck(&[1, 2, 3]), Some(f64::INFINITY));
        assert_eq!(stuck(&[2, 2, 2]), Some(1.0));
        assert_eq!(stuck(&[2]), None);
    }

    /// A few turns of a short chain say nothing about whether long ones agree.
    #[test]
    fn short_chains_are_left_out() {
        let even = || {
            let mut blocks = Blocks { turns: 10_000, ..Blocks::default() };
            blocks.sums = [625.0; SIDE * SIDE];
            blocks.squares = [625.0; SIDE * SIDE];
            blocks
        };
        let chains = vec![even(), even(), chain(3, 0), chain(3, 5)];
        let reduction = Convergence { chains }.scale_reduction().expect("two long chains");
        assert!(reduction < MIXED, "{reduction}");
    }
}
