//! Paths that carry light and that no strategy of an integrator can make.

use super::probe::Probe;
use super::{Condition, Kind};
use crate::integrator::Integrator;
use crate::scene::{Plan, Scene, Unreachable, View, unreachable_by_instrument};

pub(super) fn conditions(scene: &Scene, view: Option<&View>, probe: &Probe) -> Vec<Condition> {
    let missed = |integrator: Integrator| -> Vec<Unreachable> {
        match view {
            Some(view) => Plan::of(scene, &view.sensor, integrator.strategies()).unreachable,
            None if scene.meters.is_empty() => Vec::new(),
            None => unreachable_by_instrument(scene, &integrator.strategies().for_instruments(), true),
        }
    };
    let by_bdpt = missed(Integrator::Bdpt);
    // What light tracing alone misses is said by the plan of light tracing.
    missed(Integrator::Path)
        .into_iter()
        .map(|class| {
            let by_all = by_bdpt.iter().any(|other| other.word == class.word);
            condition(&class, by_all, probe)
        })
        .collect()
}

fn condition(class: &Unreachable, by_all: bool, probe: &Probe) -> Condition {
    let seen = probe.first.iter().filter(|gathering| gathering.through_smooth).count();
    let what =
        format!("{} is missing from the result, and no number of samples brings it back", class.meaning);
    let condition = Condition::new(
        "unreachable_light",
        class.word,
        "light without extent and an eye without extent: a smooth surface leaves no vertex to join at",
    )
    .figure("share_of_picture_through_smooth", seen as f64 / probe.first.len().max(1) as f64);
    if by_all {
        condition
            .effect(Kind::Bias, &["path", "bdpt", "mlt"], what)
            .remedy("give the lamp its real size, or the camera a lens (focus_distance)")
    } else {
        condition
            .effect(Kind::Bias, &["path"], what)
            .remedy("--integrator bdpt or mlt, or give the lamp its real size")
    }
}
