//! How often a fresh path is made with how many vertices, and by which strategy.
//!
//! Mirrors are not counted: a walk follows them as far as they lead, and how many there are is
//! the scene's affair. Counted are the ends, and the vertices where something can be joined or
//! light met ([`super::path::Node::counts`]).

use super::numbers::Numbers;
use crate::path::Strategies;
use serde::{Deserialize, Serialize};

/// Probability of every number of counted vertices, and of those from the light, for a fresh
/// path.
///
/// Short paths have a table; longer ones a geometric tail, so that every path is possible.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Lengths {
    strategies: Strategies,
    /// By vertices (from [`FEWEST`] on), then by vertices from the light.
    table: Vec<Vec<f64>>,
    /// Probability of all longer paths together.
    tail: f64,
    /// Probability that a path of the tail has one more vertex.
    ratio: f64,
}

/// Counted vertices of the shortest path that is not direct light: from a point light over
/// mirrors onto the lens.
pub const FEWEST: usize = 2;
/// Counted vertices of the longest path in the table.
const LONGEST: usize = 24;
/// Probability that a path goes on by a vertex while nothing is known.
const UNKNOWN_RATIO: f64 = 0.7;
/// Weight of meeting a light by chance beside that of every other strategy while nothing is
/// known: for light seen over mirrors that comes over mirrors it is the only one.
const MEETING_WEIGHT: f64 = 3.0;
/// Share of the probability that stays as it was while nothing was known.
const UNKNOWN_SHARE: f64 = 0.2;

impl Lengths {
    /// The distribution while nothing is known of the scene.
    pub fn unknown(strategies: Strategies) -> Self {
        let mut left = 1.0;
        let table = (FEWEST..=LONGEST)
            .map(|vertices| {
                let planned = planned(&strategies, vertices);
                let here = if planned.is_empty() { 0.0 } else { left * (1.0 - UNKNOWN_RATIO) };
                left -= here;
                let mut row = vec![0.0; vertices + 1];
                let weight = |s: usize| if s == 0 { MEETING_WEIGHT } else { 1.0 };
                let all: f64 = planned.iter().map(|s| weight(*s)).sum();
                planned.iter().for_each(|s| row[*s] = here * weight(*s) / all);
                row
            })
            .collect();
        Self { strategies, table, tail: left, ratio: UNKNOWN_RATIO }
    }

    /// The distribution that follows from how large the contributions of each strategy were:
    /// root of the mean square of what one path of it counts, by `second_moment(vertices, s)`.
    ///
    /// A path costs in proportion to its vertices; the best share of samples for independent
    /// estimates goes with the root of second moment over cost.
    #[must_use]
    pub fn learned(&self, second_moment: impl Fn(usize, usize) -> f64) -> Self {
        let unknown = Self::unknown(self.strategies);
        let root = |vertices: usize, s: usize| {
            let root = (second_moment(vertices, s) / vertices as f64).sqrt();
            if is_planned(&self.strategies, vertices, s) && root.is_finite() { root } else { 0.0 }
        };
        let rows: Vec<Vec<f64>> = (FEWEST..=LONGEST).map(|n| (0..=n).map(|s| root(n, s)).collect()).collect();
        let sums: Vec<f64> = rows.iter().map(|row| row.iter().sum()).collect();
        let total: f64 = sums.iter().sum();
        if total <= 0.0 {
            return unknown;
        }
        // What lies beyond the table decays as its second half does.
        let half = sums.len() / 2;
        let [first, second]: [f64; 2] = [sums[..half].iter().sum(), sums[half..].iter().sum()];
        let ratio = (second / first).powf(1.0 / half as f64).clamp(UNKNOWN_RATIO, 0.995);
        let beyond = sums[sums.len() - 1] * ratio / (1.0 - ratio);
        let scale = (1.0 - UNKNOWN_SHARE) / (total + beyond);
        let mix = |known: &[f64], unknown: &[f64]| {
            known.iter().zip(unknown).map(|(k, u)| scale * k + UNKNOWN_SHARE * u).collect()
        };
        let table = rows.iter().zip(&unknown.table).map(|(k, u)| mix(k, u)).collect();
        Self { table, tail: scale * beyond + UNKNOWN_SHARE * unknown.tail, ratio, ..unknown }
    }

    /// The same among the strategies of a plan.
    #[must_use]
    pub(super) fn among(self, strategies: Strategies) -> Self {
        Self { strategies, ..self }
    }

    /// Whether it is a distribution: one from a file may be anything.
    pub(super) fn is_sound(&self) -> bool {
        let is_share = |share: &f64| (0.0..=1.0).contains(share);
        let rows = self.table.iter().zip(FEWEST..);
        self.table.len() == LONGEST + 1 - FEWEST
            && rows.into_iter().all(|(row, vertices)| row.len() == vertices + 1 && row.iter().all(is_share))
            && is_share(&self.tail)
            && self.ratio > 0.0
            && self.ratio < 1.0
    }

    /// Probability of a path of `vertices` with `s` of them from the light.
    pub fn probability(&self, vertices: usize, s: usize) -> f64 {
        if vertices <= LONGEST {
            return vertices.checked_sub(FEWEST).map_or(0.0, |row| self.table[row][s]);
        }
        if !is_planned(&self.strategies, vertices, s) {
            return 0.0;
        }
        let further = (vertices - LONGEST - 1) as f64;
        let here = self.tail * (1.0 - self.ratio) * self.ratio.powf(further);
        here / planned_of_many(&self.strategies, vertices) as f64
    }

    /// Draws vertices, and vertices from the light.
    pub fn draw(&self, numbers: &mut Numbers) -> Option<(usize, usize)> {
        let rows = self.table.iter().map(|row| row.iter().sum());
        let row = numbers.choose(rows.chain(std::iter::once(self.tail)))?;
        if let Some(row_shares) = self.table.get(row) {
            return Some((FEWEST + row, numbers.choose(row_shares.iter().copied())?));
        }
        let further = ((1.0 - numbers.fine()).ln() / self.ratio.ln()) as usize;
        let vertices = LONGEST + 1 + further;
        let planned = planned(&self.strategies, vertices);
        let index = numbers.index(planned.len());
        Some((vertices, *planned.get(index)?))
    }
}

/// Vertices from the light of the strategies for paths of so many vertices.
fn planned(strategies: &Strategies, vertices: usize) -> Vec<usize> {
    (0..=vertices).filter(|s| is_planned(strategies, vertices, *s)).collect()
}

/// How many these are for four or more vertices.
fn planned_of_many(strategies: &Strategies, vertices: usize) -> usize {
    let ends = [0, 1, vertices - 1, vertices];
    let joins = if strategies.joins { vertices - 3 } else { 0 };
    joins + ends.iter().filter(|s| is_planned(strategies, vertices, **s)).count()
}

/// Whether a strategy for paths of so many counted vertices is of use. Light that reaches what
/// the eye is joined to comes over mirrors wherever it is not direct, and what asks a light at
/// the first vertex is direct.
const fn is_planned(strategies: &Strategies, vertices: usize, s: usize) -> bool {
    match (vertices, s) {
        (2, _) => s == 2 && strategies.meets_eye,
        (3, 1) => false,
        (3, 2) => strategies.asks_eye,
        _ => strategies.plans(s, vertices - s),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The probabilities of all paths add up to one, before and after learning; the tail is
    /// summed up to where what is left is below 1e-9.
    #[test]
    fn probabilities_add_up_to_one() {
        for strategies in [Strategies::ALL, Strategies::PATH] {
            let unknown = Lengths::unknown(strategies);
            for vertices in [4, 5, 30] {
                let count = planned(&strategies, vertices).len();
                assert_eq!(planned_of_many(&strategies, vertices), count);
            }
            let learned = unknown.learned(|n, s| if s > 1 { 0.8_f64.powi(2 * n as i32) } else { 0.0 });
            for lengths in [unknown, learned] {
                let all = (FEWEST..400).flat_map(|n| (0..=n).map(move |s| (n, s)));
                let sum: f64 = all.map(|(n, s)| lengths.probability(n, s)).sum();
                assert!((sum - 1.0).abs() < 1e-9, "{sum}");
            }
        }
    }

    /// Drawn as often as stated: chi-squared over the paths of up to 30 vertices that are
    /// expected at least 20 times; false alarm rate below 1e-3.
    #[test]
    fn drawn_as_often_as_stated() {
        use statrs::distribution::{ChiSquared, ContinuousCDF};
        const DRAWS: usize = 200_000;
        let lengths = Lengths::unknown(Strategies::ALL).learned(|n, s| (n * s) as f64);
        let mut numbers = Numbers::of(&[3]);
        let mut counts = std::collections::HashMap::new();
        for _ in 0..DRAWS {
            *counts.entry(lengths.draw(&mut numbers).expect("there are strategies")).or_insert(0.0) += 1.0;
        }
        let (mut chi2, mut cells) = (0.0, 0.0);
        for n in FEWEST..30 {
            for s in 0..=n {
                let expected = lengths.probability(n, s) * DRAWS as f64;
                if expected >= 20.0 {
                    let count: f64 = counts.get(&(n, s)).copied().unwrap_or(0.0);
                    chi2 += (count - expected).powi(2) / expected;
                    cells += 1.0;
                }
            }
        }
        let p = 1.0 - ChiSquared::new(cells).expect("positive").cdf(chi2);
        assert!(p > 1e-3, "chi2 = {chi2} over {cells} cells");
    }
}
