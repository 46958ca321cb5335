//! Groups of bidirectional strategies that are left out together, and what a list of strategies
//! would make of a path that another list has found.
//!
//! Which strategies pay differs from scene to scene (Grittmann et al. 2022, "Efficiency-aware
//! multiple importance sampling for bidirectional rendering algorithms"). One sample under every
//! strategy tells of all groups: each path that it finds knows how likely the other strategies
//! were to find it ([`Shares`]).

use super::strategies::Strategies;
use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};

/// Groups of strategies that are used together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Groups {
    /// Subpaths from the eye that meet lights and ask them.
    pub path: bool,
    /// Vertices of both subpaths that are joined.
    pub joins: bool,
    /// Subpaths from lights that ask the eye and meet it, and leave light anywhere in the picture.
    pub splats: bool,
}

impl Groups {
    /// Path tracing.
    pub const PATH: Self = Self { path: true, joins: false, splats: false };
    /// Light tracing.
    pub const LIGHT: Self = Self { path: false, joins: false, splats: true };
    /// Bidirectional path tracing.
    pub const ALL: Self = Self { path: true, joins: true, splats: true };

    /// The strategies of the groups.
    pub const fn strategies(self) -> Strategies {
        let Self { path, joins, splats } = self;
        Strategies {
            meets_lights: path,
            asks_lights: path,
            joins,
            asks_eye: splats,
            direct_asks_eye: splats,
            light_to_eye: splats,
            meets_eye: splats,
            only: None,
        }
    }

    fn listed(self) -> [(&'static str, bool); 3] {
        [("path", self.path), ("joins", self.joins), ("splats", self.splats)]
    }

    /// The groups of a list of names, as `path,splats`.
    ///
    /// # Errors
    /// Where a name is that of no group, or none is given.
    pub fn named(names: &str) -> Result<Self> {
        let mut groups = Self { path: false, joins: false, splats: false };
        for name in names.split(',').map(str::trim) {
            match name {
                "path" => groups.path = true,
                "joins" => groups.joins = true,
                "splats" => groups.splats = true,
                _ => {
                    let known = Self::ALL.listed().into_iter().map(|(name, _)| name);
                    return Err(Error::unknown_name("group of strategies", name, known));
                }
            }
        }
        Ok(groups)
    }
}

impl std::fmt::Display for Groups {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let names: Vec<&str> = self.listed().iter().filter(|(_, on)| *on).map(|(name, _)| *name).collect();
        f.write_str(&names.join(","))
    }
}

/// Kinds of strategies, each of which is listed or not as a whole.
pub(super) const KINDS: usize = 7;

/// Kind of strategy (s, t).
const fn kind(s: usize, t: usize) -> usize {
    match (s, t) {
        (0, _) => 0,
        (_, 0) => 6,
        (1, 1) => 5,
        (1, _) => 1,
        (2, 1) => 4,
        (_, 1) => 3,
        _ => 2,
    }
}

/// Densities with which strategies of each kind find a path, relative to the density of the one
/// that has found it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shares {
    squares: [f64; KINDS],
    cubes: [f64; KINDS],
    /// Probability with which roulette let the path live; the densities know nothing of it.
    pub survival: f64,
    of: [usize; 2],
}

impl Shares {
    /// Of a path that strategy (s, t) has found, and nothing known of the others yet.
    pub(super) fn new(s: usize, t: usize, survival: f64) -> Self {
        let mut shares = Self { squares: [0.0; KINDS], cubes: [0.0; KINDS], survival, of: [s, t] };
        shares.add(s, t, 1.0);
        shares
    }

    /// Adds a strategy by the square of its density.
    pub(super) fn add(&mut self, s: usize, t: usize, squared: f64) {
        self.squares[kind(s, t)] += squared;
        self.cubes[kind(s, t)] += squared * squared.sqrt();
    }

    /// Nothing is left for lists that have the strategy (s, t), which is more likely beyond any
    /// number. Others go by what was added before; what was not is unlikely beside it, or found by it.
    pub(super) fn set_beyond(&mut self, s: usize, t: usize) {
        self.squares[kind(s, t)] = f64::INFINITY;
    }

    fn sum(of: &[f64; KINDS], strategies: &Strategies) -> f64 {
        let Strategies {
            meets_lights,
            asks_lights,
            joins,
            asks_eye,
            direct_asks_eye,
            light_to_eye,
            meets_eye,
            ..
        } = *strategies;
        let listed = [
            meets_lights,
            asks_lights,
            joins,
            asks_eye,
            asks_eye && direct_asks_eye,
            light_to_eye,
            meets_eye,
        ];
        of.iter().zip(listed).filter(|(_, listed)| *listed).map(|(sum, _)| sum).sum()
    }

    /// Weight that the strategy which has found the path has among those of a list by the power
    /// heuristic; zero where it is not listed.
    pub fn weight(&self, strategies: &Strategies) -> f64 {
        let [s, t] = self.of;
        if strategies.plans(s, t) { 1.0 / Self::sum(&self.squares, strategies) } else { 0.0 }
    }

    /// What the path adds to the second moment of a list of strategies, relative to the square of
    /// its value over the density of the one that has found it; `None` where the list cannot make
    /// the path.
    ///
    /// With relative densities r, strategy i of the list finds the path with weight r_i^2 / sum r^2
    /// and estimate 1 / r_i: the squares of what they contribute have the mean
    /// sum r^3 / (sum r^2)^2, which is at most 1 / sqrt(sum r^2). That bound, very large for a list that
    /// is unlikely beyond the range of powers, stands for the mean where these are lost.
    pub fn second_moment(&self, strategies: &Strategies) -> Option<f64> {
        /// Sums whose powers `f64` holds.
        const IN_RANGE: std::ops::Range<f64> = 1e-140..1e140;
        let squares = Self::sum(&self.squares, strategies);
        (squares > 0.0).then(|| {
            if IN_RANGE.contains(&squares) {
                Self::sum(&self.cubes, strategies) / (squares * squares)
            } else {
                1.0 / squares.sqrt()
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_named_as_they_are_printed() {
        for name in ["path", "splats", "path,splats", "path,joins", "path,joins,splats", "joins"] {
            assert_eq!(Groups::named(name).expect("known").to_string(), name);
        }
        assert_eq!(Groups::named("splats, path").expect("any order").to_string(), "path,splats");
        let wrong = Groups::named("path,splat").expect_err("no such group").to_string();
        assert!(wrong.contains("did you mean \"splats\"?"), "{wrong}");
    }

    #[test]
    fn groups_are_the_lists_of_strategies() {
        assert_eq!(Groups::PATH.strategies(), Strategies::PATH);
        assert_eq!(Groups::LIGHT.strategies(), Strategies::LIGHT);
        assert_eq!(Groups::ALL.strategies(), Strategies::ALL);
    }

    /// Three strategies of relative densities 1, 2 and 3: by hand.
    #[test]
    fn shares_are_those_of_the_power_heuristic() {
        let mut shares = Shares::new(0, 3, 1.0);
        shares.add(1, 2, 4.0);
        shares.add(3, 0, 9.0);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-14;
        assert!(close(shares.weight(&Strategies::ALL), 1.0 / 14.0));
        assert!(close(shares.weight(&Strategies::PATH), 1.0 / 5.0));
        assert_eq!(shares.weight(&Strategies::LIGHT), 0.0);
        assert!(close(shares.second_moment(&Strategies::ALL).expect("made"), 36.0 / 196.0));
        assert!(close(shares.second_moment(&Strategies::PATH).expect("made"), 9.0 / 25.0));
        assert!(close(shares.second_moment(&Strategies::LIGHT).expect("made"), 27.0 / 81.0));
        let joins = Groups { path: false, joins: true, splats: false };
        assert_eq!(shares.second_moment(&joins.strategies()), None);
    }

    /// Where one strategy is likely beyond any number, lists that have it are left nothing to find by
    /// others, and to lists that are unlikely beyond any number a path is worth very much.
    #[test]
    fn shares_beyond_the_range_of_powers_stay_numbers() {
        let mut shares = Shares::new(1, 2, 1.0);
        shares.set_beyond(3, 0);
        assert_eq!([shares.weight(&Strategies::ALL), shares.weight(&Strategies::PATH)], [0.0, 1.0]);
        assert_eq!(shares.second_moment(&Strategies::ALL), Some(0.0));
        assert_eq!(shares.second_moment(&Strategies::PATH), Some(1.0));
        let path_under = |squared: f64| {
            let mut shares = Shares::new(3, 0, 1.0);
            shares.add(1, 2, squared);
            shares.second_moment(&Strategies::PATH).expect("made")
        };
        for exponent in [-280, -100, 0, 100, 230] {
            let expected = 10_f64.powi(-exponent / 2);
            let found = path_under(10_f64.powi(exponent));
            assert!((found / expected - 1.0).abs() < 1e-9, "1e{exponent}: {found}");
        }
    }
}
