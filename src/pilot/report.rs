//! What a pilot tells: what was picked, from which figures, and what that has cost.

use super::NEAR_TIE;
use super::selection::Selection;
use super::work::Counts;
use crate::integrator::Cost;
use serde::Serialize;

/// Said of chains that could have won, and for which the work is too little.
pub(super) const UNTRIED: &str = "not tried: too little is to be rendered";

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
    /// What was picked, as `bdpt` or `bdpt --groups path,splats`.
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

    /// How efficient the pick is expected to be beside another.
    fn over(&self, name: &str) -> Option<String> {
        let place = |name: &str| self.candidates.iter().position(|row| row.name.to_string() == name);
        let (other, picked) = (place(name)?, place(&self.pick.to_string())?);
        let row = &self.candidates[other];
        if other == picked {
            return None;
        }
        if row.excluded.is_some() && name == "path" {
            return Some("path misses light".to_owned());
        }
        if row.excluded.as_deref() == Some(UNTRIED) {
            return Some(format!("{name} was not tried, as too little is to be rendered, and may be better"));
        }
        let ratio = 1.0 / row.efficiency?;
        Some(if other > picked && ratio <= NEAR_TIE {
            format!("as good as {name} within 5 %, and simpler")
        } else {
            format!("{} the efficiency of {name} expected", times(ratio))
        })
    }
}

/// A ratio in words, to two digits: a pilot knows no more.
fn times(ratio: f64) -> String {
    /// Above it, a ratio is a matter of what was met by chance.
    const MOST: f64 = 100.0;
    match ratio {
        ratio if ratio > MOST => format!("more than {MOST} times"),
        ratio if ratio >= 9.95 => format!("{ratio:.0} times"),
        ratio if ratio >= 0.995 => format!("{ratio:.1} times"),
        ratio => format!("{ratio:.2} times"),
    }
}

impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "auto: {}", self.pick)?;
        if let Some(reason) = &self.reason {
            return write!(f, ": {reason}");
        }
        let others: Vec<String> =
            ["path", "bdpt", "mlt"].into_iter().filter_map(|name| self.over(name)).collect();
        write!(f, ": {}; the pilot took {:.1} s", others.join("; "), self.wall_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::Integrator;

    #[test]
    fn ratios_are_said_no_more_exactly_than_they_are_known() {
        let said = [0.9612, 1.0, 1.249, 9.949, 9.96, 29.49, 100.0, 100.5, 1e9, f64::INFINITY].map(times);
        let expected = ["0.96", "1.0", "1.2", "9.9", "10", "29", "100"].map(|words| format!("{words} times"));
        assert_eq!(said[..7], expected);
        assert!(said[7..].iter().all(|words| words == "more than 100 times"));
    }

    #[test]
    fn a_near_tie_and_chains_that_were_not_tried_are_said_to_be_such() {
        let row = |integrator, relmse, excluded: Option<&str>| Row {
            name: Selection::whole(integrator),
            relmse_per_sample: relmse,
            scatter_per_sample: relmse,
            seconds_per_sample: 1e-6,
            efficiency: None,
            excluded: excluded.map(ToOwned::to_owned),
            mutations: 0,
        };
        let rows = vec![
            row(Integrator::Path, Some(1.03), None),
            row(Integrator::Bdpt, Some(1.0), None),
            row(Integrator::Mlt, None, Some(UNTRIED)),
        ];
        let words = Report::of(rows.clone(), 0, 1, 0, 1.0, Counts::default()).to_string();
        assert!(
            words.contains("auto: path: as good as bdpt within 5 %, and simpler; mlt was not tried"),
            "{words}"
        );
        // What is simpler than the pick is not said to be more than it is.
        let words = Report::of(rows, 1, 1, 0, 1.0, Counts::default()).to_string();
        assert!(words.contains("auto: bdpt: 1.0 times the efficiency of path expected;"), "{words}");
    }
}
