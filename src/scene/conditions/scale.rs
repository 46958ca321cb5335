//! Things hardly larger than the spacing of 32-bit positions where they stand.

use super::{ALL, Condition, EXTREME_BIAS, Kind, percent};
use crate::geometry::Bounds;
use crate::scene::Scene;

/// Longest side of an object, in scene units.
pub(super) fn extent(scene: &Scene, object: u32) -> f64 {
    let bounds = bounds(scene, object);
    f64::from((bounds.max - bounds.min).max_element())
}

fn bounds(scene: &Scene, object: u32) -> Bounds {
    let of = |id| scene.geometry.primitive(id).bounds();
    scene.geometry.primitives_of(object).map(of).fold(Bounds::EMPTY, |all, one| all.union(&one))
}

/// Spacing of positions about an object over its longest side.
fn coarseness(scene: &Scene, object: u32) -> f64 {
    let bounds = bounds(scene, object);
    let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
    f64::from(reach.next_up() - reach) / f64::from((bounds.max - bounds.min).max_element())
}

pub(super) fn conditions(scene: &Scene) -> Option<Condition> {
    let coarse = (0..scene.geometry.object_count()).map(|object| (coarseness(scene, object), object));
    let coarse: Vec<(f64, u32)> = coarse.filter(|(coarseness, _)| *coarseness > EXTREME_BIAS).collect();
    let (worst, object) = coarse.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let metres = scene.geometry.metres_per_unit();
    let everything = scene.geometry.bounds();
    let reach = f64::from(everything.min.abs().max(everything.max.abs()).max_element());
    let size = f64::from((everything.max - everything.min).max_element());
    let what = format!(
        "places and lengths of it are rounded by up to {} of its size, areas by twice that; shadows of what is nearer to it than the spacing are lost",
        percent(worst)
    );
    let limit =
        format!("the spacing of 32-bit positions is more than {} of the object", percent(EXTREME_BIAS));
    let more = coarse.len() - 1;
    let name = &scene.objects[object as usize].name;
    let place = if more > 0 { format!("{name} and {more} more") } else { name.clone() };
    Some(
        Condition::new("coarse_positions", place, limit)
            .figure("spacing_m", worst * extent(scene, object) * metres)
            .figure("longest_side_m", extent(scene, object) * metres)
            .figure("scene_reach_m", reach * metres)
            .figure("scene_size_m", size * metres)
            .figure("spacing_per_size", worst)
            .effect(Kind::Bias, ALL, what)
            .remedy(if reach > 2.0 * size {
                "move the scene to the origin"
            } else {
                "move the origin to the smallest things, or render them in a scene of their own"
            }),
    )
}
