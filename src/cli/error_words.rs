//! The error of a picture in words, with what a smaller one would take.

use etalon::camera::PictureError;
use etalon::image::{ErrorFacts, Facts};
use etalon::integrator::USUAL_TARGETS;

/// What a render says of its error after its samples and its time; empty where nothing is known.
pub fn error_words(facts: &Facts) -> String {
    let Some(error) = &facts.error else {
        return facts
            .relative_error
            .map_or_else(String::new, |error| format!(", relative error {}", per_cent(error)));
    };
    let now = error.picture.relmse.sqrt();
    if now > MOST_KNOWN {
        return format!(", relative error {} or more: too few samples to tell", per_cent(now));
    }
    let projected = projection(facts, now);
    let of = if facts.missing.is_empty() { "" } else { " of the light that it can find" };
    if error.picture.heavy_tail {
        return format!(", relative error {} or more{of}: {}{projected}", per_cent(now), heavy(error));
    }
    format!(", relative error {}{of}{}{projected}", per_cent(now), sureness(&error.picture))
}

/// Relative error above which the estimate is a bound: it divides by the picture, in which a pixel that one
/// bright sample holds is off by about its own value at most, however rare such samples are.
const MOST_KNOWN: f64 = 0.3;

/// The interval, or why there is none.
fn sureness(picture: &PictureError) -> String {
    /// Blocks whose scatter has a scatter.
    const FEWEST_BLOCKS: u32 = 3;
    match picture.relmse_ci95 {
        Some([low, high]) => format!(" (95 %: {} to {})", number(low.sqrt()), number(high.sqrt())),
        None if picture.blocks < FEWEST_BLOCKS => {
            " (no interval: from fewer than three blocks of samples)".to_owned()
        }
        None => " (no interval: a few blocks outweigh all others)".to_owned(),
    }
}

/// Why the estimate is not to be trusted.
fn heavy(error: &ErrorFacts) -> String {
    let trimmed = per_cent(error.picture.relmse_trimmed.sqrt());
    format!("rare samples carry most of it (without the noisiest 0.1 % of the pixels {trimmed})")
}

/// What the error that was asked for takes, or else the next usual one.
fn projection(facts: &Facts, now: f64) -> String {
    /// Errors that are closer than this are not worth another render.
    const WORTH: f64 = 0.6;
    let missed = facts.stopping.error.filter(|target| *target < now * WORTH);
    let usual = || USUAL_TARGETS.into_iter().find(|target| *target < now * WORTH);
    let Some(target) = missed.or_else(usual) else { return String::new() };
    let cost = facts.times.to_reach(target, now);
    format!("; {} would take about {}", target_words(target), duration(cost.wall_s))
}

fn target_words(share: f64) -> String {
    format!("{} %", (1e6 * share).round() / 1e4)
}

fn per_cent(share: f64) -> String {
    format!("{} %", number(share))
}

/// A share of one in per cent, to three figures or two decimal places.
fn number(share: f64) -> String {
    let value = 100.0 * share;
    let places = if value >= 100.0 {
        0
    } else if value >= 10.0 {
        1
    } else {
        2
    };
    format!("{value:.places$}")
}

/// A time in the two largest units that matter.
pub fn duration(seconds: f64) -> String {
    /// Beyond this nobody waits: a thousand years.
    const MOST_S: f64 = 1e3 * 365.25 * 86_400.0;
    if seconds < 9.95 {
        return format!("{seconds:.1} s");
    }
    if seconds > MOST_S {
        return "more than a thousand years".to_owned();
    }
    let whole = seconds.round() as u64;
    let [minutes, hours, days] = [60, 3_600, 86_400].map(|unit| whole / unit);
    match (days, hours, minutes) {
        (0, 0, 0) => format!("{whole} s"),
        (0, 0, minutes) => format!("{minutes} min {} s", whole % 60),
        (0, hours, minutes) => format!("{hours} h {} min", minutes % 60),
        (days, hours, _) => format!("{days} d {} h", hours % 24),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_told_in_two_units() {
        let told = [0.04, 9.9, 9.96, 59.4, 59.6, 320.0, 3_600.0, 90_000.0, 1e12].map(duration);
        let truth = [
            "0.0 s",
            "9.9 s",
            "10 s",
            "59 s",
            "1 min 0 s",
            "5 min 20 s",
            "1 h 0 min",
            "1 d 1 h",
            "more than a thousand years",
        ];
        assert_eq!(told, truth);
    }

    #[test]
    fn a_missing_interval_has_a_reason() {
        let of = |blocks: u32, relmse_ci95: Option<[f64; 2]>| {
            sureness(&PictureError {
                relmse: 1e-4,
                relmse_ci95,
                relmse_trimmed: 1e-4,
                blocks,
                correlated: true,
                heavy_tail: false,
            })
        };
        assert_eq!(of(16, Some([1e-4, 4e-4])), " (95 %: 1.00 to 2.00)");
        assert!(of(2, None).contains("fewer than three blocks"));
        assert!(of(16, None).contains("outweigh"));
    }

    #[test]
    fn targets_are_told_as_they_were_typed() {
        assert_eq!([0.01, 0.005, 0.025, 0.001].map(target_words), ["1 %", "0.5 %", "2.5 %", "0.1 %"]);
        assert_eq!([0.0231, 0.23, 2.31].map(number), ["2.31", "23.0", "231"]);
    }
}
