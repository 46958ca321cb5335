//! What a picture costs, in seconds of the clock and of the processor, and what a better one would.
//!
//! The variance of a mean falls in proportion to its samples, and so to the time of taking them;
//! what comes before the first sample is paid once. So the cost of another error is
//! before + render (error now / error then)^2.

use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Time that a part of a run takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Seconds of the clock.
    pub wall_s: f64,
    /// Seconds of all processors together; `None` where the system does not tell.
    pub cpu_s: Option<f64>,
}

impl Cost {
    /// Both together.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        let cpu_s = self.cpu_s.zip(other.cpu_s).map(|(one, two)| one + two);
        Self { wall_s: self.wall_s + other.wall_s, cpu_s }
    }

    /// None at all.
    pub const NOTHING: Self = Self { wall_s: 0.0, cpu_s: Some(0.0) };

    /// What is left of it without a part.
    #[must_use]
    pub fn minus(self, part: Self) -> Self {
        let cpu_s = self.cpu_s.zip(part.cpu_s).map(|(all, part)| (all - part).max(0.0));
        Self { wall_s: (self.wall_s - part.wall_s).max(0.0), cpu_s }
    }

    /// So many times as much.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self { wall_s: self.wall_s * factor, cpu_s: self.cpu_s.map(|cpu_s| cpu_s * factor) }
    }
}

/// Measures a cost from now on.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    started: Instant,
    cpu_s: Option<f64>,
}

impl Stopwatch {
    /// Starts.
    pub fn start() -> Self {
        Self { started: Instant::now(), cpu_s: cpu_seconds() }
    }

    /// What this process has taken since.
    pub fn cost(&self) -> Cost {
        let cpu_s = cpu_seconds().zip(self.cpu_s).map(|(now, before)| now - before);
        Cost { wall_s: self.started.elapsed().as_secs_f64(), cpu_s }
    }
}

/// What the parts of a run take, one after another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Times {
    /// Before the run: the program's start and the scene; of the latest process, where several
    /// have taken turns, as every one of them pays it.
    pub load: Option<Cost>,
    /// The choice of an algorithm, where it was left to the program.
    pub pilot: Option<Cost>,
    /// What chains learn before their first block.
    pub bootstrap: Option<Cost>,
    /// The blocks of samples, in all processes together.
    pub render: Cost,
}

/// Relative errors that the cost is told for.
pub const USUAL_TARGETS: [f64; 7] = [0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001];

impl Times {
    /// Cost, from the start, of a picture of this relative error by a run like this one, whose own
    /// picture has `relative_error`.
    pub fn to_reach(&self, target: f64, relative_error: f64) -> Cost {
        let before = [self.load, self.pilot, self.bootstrap].into_iter().flatten();
        before.fold(self.render.times(1.0 / share_done(target, relative_error)), Cost::plus)
    }
}

/// Share of the samples of such an error that are there: (error now / error then)^-2.
pub fn share_done(target: f64, relative_error: f64) -> f64 {
    (target / relative_error).powi(2)
}

/// Processor time of this process in seconds, user and system, where the system tells.
pub(crate) fn cpu_seconds() -> Option<f64> {
    cpu_time::ProcessTime::try_now().ok().map(|time| time.as_duration().as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_the_error_takes_four_times_the_samples_and_one_start() {
        let cost = |wall_s: f64| Cost { wall_s, cpu_s: Some(2.0 * wall_s) };
        let times =
            Times { load: Some(cost(1.0)), pilot: None, bootstrap: Some(cost(2.0)), render: cost(10.0) };
        assert_eq!(times.to_reach(0.02, 0.02), cost(13.0));
        assert_eq!(times.to_reach(0.01, 0.02), cost(43.0));
        let untold = Times { render: Cost { wall_s: 10.0, cpu_s: None }, ..times };
        assert_eq!(untold.to_reach(0.01, 0.02), Cost { wall_s: 43.0, cpu_s: None });
    }
}
