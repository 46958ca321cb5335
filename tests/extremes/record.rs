//! What a case measures: expected value, measured value, what may lie between them, and how
//! much of that is used.

use crate::common::SIGMAS;
use std::time::{SystemTime, UNIX_EPOCH};

/// How hard a case is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// With the seed of always.
    Fixed,
    /// With a fresh seed and larger samples.
    Nightly,
}

/// Times as many samples by night.
const NIGHTLY_SAMPLES: u64 = 16;

/// One quantity of a case.
#[derive(Clone, Debug)]
pub struct Line {
    pub what: String,
    pub expected: String,
    pub measured: String,
    /// What may lie between them, in words.
    pub bound: String,
    /// Share of the bound that is used; `None` where the values must be the same.
    pub used: Option<f64>,
    pub holds: bool,
}

/// What a case leaves.
#[derive(Clone, Debug)]
pub struct Record {
    effort: Effort,
    seed: u64,
    pub lines: Vec<Line>,
    /// What holds instead of what the catalogue asks, or what else is to be known.
    pub notes: Vec<String>,
}

impl Record {
    pub fn new(effort: Effort) -> Self {
        let seed = match effort {
            Effort::Fixed => 1,
            Effort::Nightly => std::env::var("ETALON_SEED").ok().map_or_else(fresh_seed, |text| {
                text.parse().unwrap_or_else(|_| panic!("ETALON_SEED={text}: a whole number is wanted"))
            }),
        };
        Self { effort, seed, lines: Vec::new(), notes: Vec::new() }
    }

    /// The seed of the case's random numbers.
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// Whether the case is run by night.
    pub fn is_nightly(&self) -> bool {
        self.effort == Effort::Nightly
    }

    /// What is asked for by day, and by night.
    pub fn by_day_or_night<T>(&self, day: T, night: T) -> T {
        if self.is_nightly() { night } else { day }
    }

    /// So many samples, or more by night.
    pub const fn samples(&self, fixed: u64) -> u64 {
        match self.effort {
            Effort::Fixed => fixed,
            Effort::Nightly => fixed * NIGHTLY_SAMPLES,
        }
    }

    /// Says what holds instead of what the catalogue asks, and why; or what else is to be known.
    pub fn note(&mut self, text: impl Into<String>) {
        self.notes.push(text.into());
    }

    /// |measured - expected| <= bound * |expected|.
    pub fn relative(&mut self, what: impl Into<String>, measured: f64, expected: f64, bound: f64) {
        let used = ((measured - expected) / expected).abs() / bound;
        self.push(what, number(expected), number(measured), format!("{bound:.0e} of it"), used);
    }

    /// |measured - expected| <= bound.
    pub fn absolute(&mut self, what: impl Into<String>, measured: f64, expected: f64, bound: f64) {
        let used = (measured - expected).abs() / bound;
        self.push(what, number(expected), number(measured), format!("{bound:.0e}"), used);
    }

    /// A mean with its standard error against the truth: within five standard errors (a false
    /// alarm once in 1.7 million), which must themselves be below `most_noise` of the truth, so
    /// that the test can see something. `rounding` of the truth is allowed beside them.
    pub fn mean(
        &mut self,
        what: impl Into<String>,
        mean: f64,
        standard_error: f64,
        truth: f64,
        most_noise: f64,
    ) {
        /// What single precision along a path may leave, relative.
        const ROUNDING: f64 = 2e-5;
        let what = what.into();
        let measured = format!("{} ± {}", number(mean), number(standard_error));
        let allowed = SIGMAS * standard_error + ROUNDING * truth.abs();
        let used = (mean - truth).abs() / allowed;
        let bound = format!("{SIGMAS} standard errors, each below {most_noise:.0e} of it");
        let is_sharp = standard_error <= most_noise * truth.abs();
        self.push(what, number(truth), measured, bound, if is_sharp { used } else { f64::NAN });
    }

    /// Two independent means that are to be the same: within five standard errors of their
    /// difference, itself below `most_noise` of the second.
    pub fn same_mean(&mut self, what: impl Into<String>, one: [f64; 2], other: [f64; 2], most_noise: f64) {
        let error = one[1].hypot(other[1]);
        let used = (one[0] - other[0]).abs() / (SIGMAS * error);
        let [measured, expected] =
            [one, other].map(|[mean, error]| format!("{} ± {}", number(mean), number(error)));
        let bound = format!("{SIGMAS} standard errors, together below {most_noise:.0e} of it");
        let is_sharp = error > 0.0 && error <= most_noise * other[0].abs();
        self.push(what, expected, measured, bound, if is_sharp { used } else { f64::NAN });
    }

    /// measured <= limit.
    pub fn at_most(&mut self, what: impl Into<String>, measured: f64, limit: f64) {
        self.push(what, format!("≤ {}", number(limit)), number(measured), String::new(), measured / limit);
    }

    /// measured >= limit, both positive.
    pub fn at_least(&mut self, what: impl Into<String>, measured: f64, limit: f64) {
        self.push(what, format!("≥ {}", number(limit)), number(measured), String::new(), limit / measured);
    }

    /// Two values that must be the same.
    pub fn exactly<T: PartialEq + std::fmt::Display>(
        &mut self,
        what: impl Into<String>,
        measured: T,
        expected: T,
    ) {
        let holds = measured == expected;
        let (expected, measured) = (expected.to_string(), measured.to_string());
        self.lines.push(Line {
            what: what.into(),
            expected,
            measured,
            bound: "the same".into(),
            used: None,
            holds,
        });
    }

    /// Something that must be so.
    pub fn holds(&mut self, what: impl Into<String>, so: bool) {
        self.exactly(what, if so { "yes" } else { "no" }, "yes");
    }

    /// A text that must hold another one.
    pub fn says(&mut self, what: impl Into<String>, text: &str, part: &str) {
        let holds = text.contains(part);
        let measured = if holds { "said".to_owned() } else { format!("not in: {}", text.trim()) };
        let expected = format!("“{part}”");
        self.lines.push(Line {
            what: what.into(),
            expected,
            measured,
            bound: "said".into(),
            used: None,
            holds,
        });
    }

    /// A share of the bound that is no number does not hold.
    fn push(
        &mut self,
        what: impl Into<String>,
        expected: String,
        measured: String,
        bound: String,
        used: f64,
    ) {
        let holds = used <= 1.0;
        self.lines.push(Line { what: what.into(), expected, measured, bound, used: Some(used), holds });
    }

    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// Expected and measured side by side, for each quantity that does not hold.
    pub fn misses(&self) -> Vec<String> {
        let missed = self.lines.iter().filter(|line| !line.holds);
        missed
            .map(|line| {
                let used = line
                    .used
                    .map_or_else(String::new, |used| format!(", of which {:.0} % is used", 100.0 * used));
                format!(
                    "{}: expected {}, measured {} (bound: {}{used})",
                    line.what, line.expected, line.measured, line.bound
                )
            })
            .collect()
    }
}

/// A seed that no run had before.
fn fresh_seed() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_nanos() as u64)
}

/// A number as the page shows it: eight digits, no more than it has.
pub fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || !value.is_finite() {
        format!("{value}")
    } else if (1e-4..1e7).contains(&size) {
        let decimals = (7 - size.log10().floor() as i32).max(0) as usize;
        let text = format!("{value:.decimals$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        let text = format!("{value:.7e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        format!("{}e{exponent}", mantissa.trim_end_matches('0').trim_end_matches('.'))
    }
}
