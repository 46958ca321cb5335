//! Lamps that are hard to find: small ones behind smooth surfaces, hidden ones, faint ones.
//!
//! What is found with probability p by chance has a relative variance of (1 - p) / p per
//! sample, so that N samples leave a relative error of sqrt((1 - p) / (p N)).

use super::probe::Probe;
use super::sight::{Sight, sight_of};
use super::{
    ALL, Condition, EXTREME_VARIANCE, Kind, ORDINARY_SPP, ordinary_error, percent, samples_for_1_percent,
    short, worst,
};
use crate::geometry::SurfacePoint;
use crate::scene::Scene;

pub(super) fn conditions(scene: &Scene, probe: &Probe) -> Vec<Condition> {
    let shining = (0..scene.lights.len()).filter(|light| scene.emitters[*light].weight() > 0.0);
    let small = shining.filter_map(|light| small_emitter(scene, probe, light)).collect();
    let mut found = Vec::new();
    found.extend(worst(small, |c| c.value("relative_variance_per_sample").unwrap_or(0.0)));
    found.extend(hidden_lamps(scene, probe));
    found.extend(unequal_lights(scene, probe));
    found
}

/// The limit on a probability of finding something by chance.
pub(super) fn by_chance() -> String {
    format!(
        "found by chance less than once in {EXTREME_VARIANCE} samples: the default of {ORDINARY_SPP} samples leaves a relative error above 100 %"
    )
}

/// Relative variance of what is found with a probability.
pub(super) fn variance(probability: f64) -> f64 {
    (1.0 - probability) / probability
}

/// A lamp whose light reaches matte surfaces through or by smooth ones, and that a ray
/// scattered there meets by chance only.
fn small_emitter(scene: &Scene, probe: &Probe, light: usize) -> Option<Condition> {
    let (probability, onto_smooth) = (probe.meets[light]?, probe.onto_smooth[light]);
    let variance = variance(probability);
    if onto_smooth == 0.0 || variance < EXTREME_VARIANCE {
        return None;
    }
    let through = share(probe.first.iter().map(|gathering| gathering.through_smooth));
    let by_chance = format!(
        "light of this lamp that smooth glass or a mirror casts on other surfaces is met once in {} samples: {} samples for 1 %, an error of {} after {ORDINARY_SPP}; the picture's own estimate of error does not see what was never met",
        short(1.0 / probability),
        short(samples_for_1_percent(variance)),
        percent(ordinary_error(variance))
    );
    let mut condition = Condition::new("small_emitter", &scene.emitters[light].name, self::by_chance())
        .figure("hit_probability", probability)
        .figure("relative_variance_per_sample", variance)
        .figure("samples_for_1_percent", samples_for_1_percent(variance))
        .figure("share_of_flux_onto_smooth", onto_smooth)
        .figure("share_of_picture_through_smooth", through)
        .effect(Kind::Noise, &["path"], by_chance);
    if through > 0.0 {
        let seen = format!(
            "where such light is seen through smooth surfaces again ({} of the picture), no joint of subpaths helps: bdpt meets it as rarely with every sample, mlt with every search for a start, from where it explores",
            percent(through)
        );
        condition = condition.effect(Kind::Noise, &["bdpt", "mlt"], seen);
    }
    let rare = format!(
        "walks from the lamp bring such light: {} of them set out to a smooth surface",
        percent(onto_smooth)
    );
    let condition = condition.effect(Kind::Noise, &["light", "bdpt", "mlt"], rare);
    Some(condition.remedy(if through > 0.0 {
        "--integrator mlt, which has to meet such light by chance only for its starts; or a larger lamp of the same flux, if that may be"
    } else {
        "--integrator bdpt or mlt"
    }))
}

/// Lamps that nothing in the picture sees, not even through glass.
fn hidden_lamps(scene: &Scene, probe: &Probe) -> Option<Condition> {
    if scene.emitters.iter().all(|emitter| emitter.weight() == 0.0) || probe.first.is_empty() {
        return None;
    }
    let lit = |point: &SurfacePoint| {
        (0..scene.lights.len()).any(|light| sight_of(scene, point, light as u32).is_some())
    };
    let step = probe.step(scene.lights.len());
    let direct = share(probe.first.iter().step_by(step).map(|gathering| lit(&gathering.point)));
    let once =
        share(probe.second.iter().step_by(step).map(|second| second.as_ref().is_some_and(|s| lit(&s.point))));
    // The rule of three: with none in so many, 95 % of the time the share is below this.
    let once_at_most = if once > 0.0 { once } else { 3.0 / probe.second.len().div_ceil(step) as f64 };
    let variance = variance(once_at_most);
    if direct > 1.0 / EXTREME_VARIANCE || variance < EXTREME_VARIANCE {
        return None;
    }
    let limit = format!(
        "less than one in {EXTREME_VARIANCE} of the picture's points sees a lamp, and less than one in {EXTREME_VARIANCE} rays scattered there arrives where one does"
    );
    let rare = format!(
        "{}{} of paths scattered once arrive where a lamp shines: a relative variance of {} per sample for that light, an error of {} after {ORDINARY_SPP} samples",
        if once > 0.0 { "" } else { "less than " },
        percent(once_at_most),
        short(variance),
        percent(ordinary_error(variance))
    );
    Some(
        Condition::new("hidden_lamps", probe.of, limit)
            .figure("share_lit_directly", direct)
            .figure("share_lit_after_one_reflection", once)
            .figure("relative_variance_per_sample", variance)
            .figure("samples_for_1_percent", samples_for_1_percent(variance))
            .effect(Kind::Noise, &["path"], rare)
            .effect(
                Kind::Noise,
                &["light", "bdpt"],
                "walks from the lamp have to pass the same openings, and what hides the lamp blocks joints of the two subpaths as well",
            )
            .remedy("--integrator mlt, which keeps to what it has found"),
    )
}

/// Where the picture is lit by lamps alone that are hardly ever asked.
fn unequal_lights(scene: &Scene, probe: &Probe) -> Option<Condition> {
    /// A smaller part of the lit picture is left unsaid.
    const LEAST_SHARE: f64 = 0.01;
    let weights = || scene.emitters.iter().map(crate::light::EmitterFacts::weight).filter(|w| *w > 0.0);
    if weights().count() < 2 {
        return None;
    }
    let asked = |point| -> Option<(f64, u32)> {
        let seen = (0..scene.lights.len() as u32)
            .filter(|light| sight_of(scene, point, *light) == Some(Sight::Clear))
            .map(|light| (scene.lights.probability_towards(point.position, light), light));
        seen.reduce(|a, b| (a.0 + b.0, if b.0 > a.0 { b.1 } else { a.1 }))
    };
    let points = probe.first.iter().step_by(probe.step(scene.lights.len()));
    let lit: Vec<(f64, u32)> = points.filter_map(|g| asked(&g.point)).collect();
    let mut rare: Vec<(f64, u32)> =
        lit.iter().copied().filter(|(p, _)| *p > 0.0 && variance(*p) > EXTREME_VARIANCE).collect();
    let part = rare.len() as f64 / lit.len().max(1) as f64;
    if part < LEAST_SHARE {
        return None;
    }
    rare.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (probability, light) = rare[rare.len() / 2];
    let variance = variance(probability);
    let (least, most) = weights().fold((f64::MAX, 0.0_f64), |(least, most), w| (least.min(w), most.max(w)));
    let what = format!(
        "{} of what lamps light directly is lit by lamps that are asked once in {} samples: an error of {} there after {ORDINARY_SPP}",
        percent(part),
        short(1.0 / probability),
        percent(ordinary_error(variance))
    );
    Some(
        Condition::new("unequal_lights", &scene.emitters[light as usize].name, by_chance())
            .figure("power_ratio", most / least)
            .figure("probability_of_asking", probability)
            .figure("relative_variance_per_sample", variance)
            .figure("share_of_lit_picture", part)
            .effect(Kind::Noise, ALL, what)
            .remedy("leave out lamps that light nothing in the picture"),
    )
}

fn share(list: impl ExactSizeIterator<Item = bool>) -> f64 {
    let count = list.len().max(1);
    list.filter(|so| *so).count() as f64 / count as f64
}
