//! Reflections that hardly end.
//!
//! Where each surface passes on the share q of the light to the next, levels add up to 1 /
//! (1 - q) of what lamps give directly, the nth reflection brings q^n of the first, and a
//! relative error of all reflectances makes one of q / (1 - q) times that in the level.
//! There is no depth limit, so that none of it is missing; at q = 1 it has no end.

use super::probe::Probe;
use super::{ALL, Condition, EXTREME_AMPLIFICATION, Kind, percent, short};

/// Beyond this share the walks do not tell it from one, and no level can be expected.
const LOSSLESS: f64 = 1.0 - 1e-6;

pub(super) fn conditions(probe: &Probe) -> Option<Condition> {
    let kept = probe.kept.filter(|kept| *kept > 1.0 - 1.0 / EXTREME_AMPLIFICATION)?;
    let limit = format!(
        "the level is more than {EXTREME_AMPLIFICATION} times that of direct light: reflectances known to 1 % leave it known to {EXTREME_AMPLIFICATION} %"
    );
    let condition =
        Condition::new("high_albedo", "the scene", limit).figure("mean_kept_per_reflection", kept);
    if kept > LOSSLESS {
        return Some(
            condition
                .effect(
                    Kind::Bias,
                    ALL,
                    "closed and without loss: light adds up without end, no level exists",
                )
                .remedy("give surfaces a reflectance below 1, or open the scene"),
        );
    }
    let reflections = 1.0 / (1.0 - kept);
    let until = |share: f64| share.ln() / kept.ln();
    let cost = format!(
        "{} reflections on average; 1 % of the light comes after {} of them, 0.1 % after {}: none is cut off, paths are that much longer, and as much noise takes as much more time",
        short(reflections),
        short(until(0.01).ceil()),
        short(until(0.001).ceil())
    );
    let amplification = kept / (1.0 - kept);
    let sensitive =
        format!("reflectances wrong by 1 % make the level wrong by {}", percent(0.01 * amplification));
    Some(
        condition
            .figure("mean_reflections", reflections)
            .figure("reflections_until_1_percent", until(0.01).ceil())
            .figure("reflections_until_0_1_percent", until(0.001).ceil())
            .figure("error_amplification", amplification)
            .effect(Kind::Sensitivity, ALL, sensitive)
            .effect(Kind::Cost, ALL, cost)
            .remedy("measure the reflectances: no sample count makes up for them"),
    )
}
