//! Reflections that hardly end.
//!
//! Where each surface passes on the share q of the light to the next, levels add up to 1 /
//! (1 - q) of what lamps give directly, the nth reflection brings q^n of the first, and a
//! relative error of all reflectances, small beside the loss 1 - q, makes one of q / (1 - q)
//! times that in the level. There is no depth limit, so that none of it is missing; at q = 1 it
//! has no end, and a render that finds no loss cuts its paths off.

use super::probe::Probe;
use super::{ALL, Condition, EXTREME_AMPLIFICATION, Kind, percent, short};
use crate::integrator::DIVERGENT_BOUNCES;

/// Beyond this share the walks do not tell it from one, and no level can be expected.
const LOSSLESS: f64 = 1.0 - 1e-6;
/// Below this loss a render may find none: its 256 walks of 1000 bounces end 26 times at this
/// one, and with less than 1e-8 at most twice, which counts as never.
const MAY_GO_UNSEEN: f64 = 1e-4;

pub(super) fn conditions(probe: &Probe) -> Option<Condition> {
    let kept = probe.kept.filter(|kept| *kept > 1.0 - 1.0 / EXTREME_AMPLIFICATION)?;
    let limit = format!(
        "the level is more than {EXTREME_AMPLIFICATION} times that of direct light: reflectances known to 1 % leave it known to {EXTREME_AMPLIFICATION} % at best"
    );
    // Rounding may leave a little more than has arrived.
    let loss = (1.0 - kept).max(0.0);
    let condition =
        Condition::new("high_albedo", "the scene", limit).figure("mean_loss_per_reflection", loss);
    let cut_off = format!(
        "a render whose walks of 1000 bounces find no loss cuts paths off after {DIVERGENT_BOUNCES}, and says so"
    );
    if kept > LOSSLESS {
        return Some(
            condition
                .effect(
                    Kind::Bias,
                    ALL,
                    format!("closed and without loss that can be told: light adds up without end, no level exists; {cut_off}"),
                )
                .remedy("give surfaces a reflectance below 1, or open the scene"),
        );
    }
    let reflections = 1.0 / loss;
    let until = |share: f64| share.ln() / kept.ln();
    let cost = format!(
        "{} reflections on average; 1 % of the light comes after {} of them, 0.1 % after {}: paths are that much longer, and as much noise takes as much more time; {}",
        short(reflections),
        short(until(0.01).ceil()),
        short(until(0.001).ceil()),
        if loss < MAY_GO_UNSEEN { cut_off.as_str() } else { "none is cut off" }
    );
    let amplification = kept / loss;
    // So small a wrongness is possible however small the loss is: it takes 1 % of it.
    let sensitive = format!(
        "the level goes inversely with the {} that a reflection loses: reflectances wrong by {} make both wrong by 1 %",
        percent(loss),
        percent(0.01 / amplification)
    );
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
