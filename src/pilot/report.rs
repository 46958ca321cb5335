//! What a pilot tells: what was picked, from which figures, and what that has cost.

use super::selection::Selection;
use super::work::Counts;
use crate::integrator::Cost;
use crate::path::Groups;
use serde::Serialize;

/// How a choice was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum By {
    /// By a pilot's figures.
    Pilot,
    /// By what the scene is made of.
    Rule,
}

/// What `--integrator auto` says about itself.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// What was picked, as `bdpt` or `bdpt path,splats`.
    pub pick: Selection,
    /// How.
    pub by: By,
    /// Why, where it was by rule.
    pub reason: Option<String>,
    /// What was compared, the simplest first.
    pub candidates: Vec<Row>,
    /// Samples of the pilot.
    pub samples: u64,
    /// Mutations of its chains, learning apart.
    pub mutations: u64,
    /// Wall-clock seconds of the pilot.
    pub wall_s: f64,
    /// Its processor seconds, where the system tells.
    pub cpu_s: Option<f64>,
    /// Processor seconds that the render was expected to take, by counted work.
    pub render_s: Option<f64>,
    /// What the pilot's samples took, by kind.
    pub counts: Option<Counts>,
}

/// One of those compared.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Which.
    pub name: Selection,
    /// Estimated relative mean squared error of the luminance picture with one sample, or
    /// mutation, per pixel; `None` where it was not looked at.
    pub relmse_per_sample: Option<f64>,
    /// The same by the scatter of the pilot's own samples, blind to what they hardly find.
    pub scatter_per_sample: Option<f64>,
    /// Processor seconds of a sample or mutation, by counted work.
    pub seconds_per_sample: f64,
    /// Efficiency over that of the pick.
    pub efficiency: Option<f64>,
    /// Why it could not be picked.
    pub excluded: Option<String>,
    /// Mutations that it was measured by.
    #[serde(skip)]
    pub(super) mutations: u64,
}

impl Row {
    /// Relative mean squared error times seconds.
    pub(super) fn cost(&self) -> f64 {
        self.relmse_per_sample.map_or(f64::INFINITY, |relmse| relmse * self.seconds_per_sample)
    }
}

impl Report {
    /// What the pilot has cost.
    pub const fn cost(&self) -> Cost {
        Cost { wall_s: self.wall_s, cpu_s: self.cpu_s }
    }

    pub(super) const fn by_rule(pick: Selection, reason: String) -> Self {
        Self {
            pick,
            by: By::Rule,
            reason: Some(reason),
            candidates: Vec::new(),
            samples: 0,
            mutations: 0,
            wall_s: 0.0,
            cpu_s: None,
            render_s: None,
            counts: None,
        }
    }

    pub(super) fn of(
        mut candidates: Vec<Row>,
        picked: usize,
        samples: u64,
        mutations: u64,
        render_s: f64,
        counts: Counts,
    ) -> Self {
        let cost = candidates[picked].cost();
        for row in &mut candidates {
            row.efficiency = row.relmse_per_sample.map(|_| cost / row.cost());
        }
        Self {
            pick: candidates[picked].name,
            by: By::Pilot,
            reason: None,
            candidates,
            samples,
            mutations,
            wall_s: 0.0,
            cpu_s: None,
            render_s: Some(render_s),
            counts: Some(counts),
        }
    }

    /// How many times as efficient as another the pick is expected to be.
    fn over(&self, name: &str) -> Option<String> {
        let row = self.candidates.iter().find(|row| row.name.to_string() == name)?;
        if row.name == self.pick {
            return None;
        }
        if row.excluded.is_some() && name == "path" {
            return Some("path misses light".to_owned());
        }
        Some(format!("{:.2} times the efficiency of {name}", 1.0 / row.efficiency?))
    }
}

/// A selection in words.
fn in_words(selection: Selection) -> String {
    match selection.groups {
        Some(Groups { path: true, joins: true, splats: false }) => "bdpt without splats".to_owned(),
        Some(Groups { path: true, joins: false, splats: true }) => "bdpt without joins".to_owned(),
        _ => selection.to_string(),
    }
}

impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "auto: {}", in_words(self.pick))?;
        if let Some(reason) = &self.reason {
            return write!(f, ": {reason}");
        }
        let others: Vec<String> =
            ["path", "bdpt", "mlt"].into_iter().filter_map(|name| self.over(name)).collect();
        write!(f, ": {}; the pilot took {:.1} s", others.join(", "), self.wall_s)
    }
}
