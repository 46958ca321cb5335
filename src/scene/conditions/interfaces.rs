//! Media that nearly match, and media that let hardly anything through.

use super::{ALL, Condition, EXTREME_AMPLIFICATION, Kind, objects_of, percent, samples_for_1_percent, short};
use crate::material::Material;
use crate::scene::Scene;
use crate::spectrum::colour::CIE_1931;
use crate::spectrum::{Dense, GRID_POINTS};

/// Reflectance at normal incidence below which an interface nearly matches: fewer than one
/// path in a million is reflected by it, so that 1 % takes more than 10^10 samples.
const LEAST_REFLECTANCE: f64 = 1e-6;

pub(super) fn conditions(scene: &Scene) -> Vec<Condition> {
    let mut found = Vec::new();
    for (index, material) in scene.materials.iter().enumerate() {
        let Material::Dielectric { excess_index, absorption, .. } = material else { continue };
        let Some(objects) = objects_of(scene, index) else { continue };
        found.extend(matched_index(excess_index, &objects));
        let depth = absorption.as_ref().and_then(|absorption| {
            optical_depth(
                absorption,
                largest_extent(scene, index),
                scene.geometry.metres_per_unit(),
                &objects,
            )
        });
        found.extend(depth);
    }
    found
}

fn matched_index(excess: &Dense, objects: &str) -> Option<Condition> {
    let sizes = (0..GRID_POINTS).map(|point| f64::from(excess.at_grid_point(point)));
    let largest = sizes.max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    let reflectance = (largest / (2.0 + largest)).powi(2);
    if reflectance >= LEAST_REFLECTANCE {
        return None;
    }
    let condition = Condition::new(
        "matched_index",
        objects,
        format!("a reflectance below {LEAST_REFLECTANCE:e} at normal incidence: paths find it less than once in a million"),
    )
    .figure("index_minus_one", largest)
    .figure("normal_reflectance", reflectance);
    Some(if reflectance == 0.0 {
        condition
            .effect(Kind::Cost, ALL, "the surface does nothing but make paths two vertices longer")
            .remedy("leave the object out, unless it absorbs")
    } else {
        let what = format!(
            "its reflection is found once in {} samples: {} samples for 1 % of itself; what passes it is no noisier. The difference of the indices keeps all its digits",
            short(1.0 / reflectance),
            short(samples_for_1_percent(1.0 / reflectance))
        );
        condition.effect(Kind::Noise, ALL, what)
    })
}

/// The longest side of the objects of a material, in scene units.
fn largest_extent(scene: &Scene, material: usize) -> f64 {
    let of_material = (0..).zip(&scene.objects).filter(|(_, object)| object.material as usize == material);
    of_material.map(|(index, _)| super::scale::extent(scene, index)).fold(0.0, f64::max)
}

fn optical_depth(absorption: &Dense, length: f64, metres_per_unit: f64, objects: &str) -> Option<Condition> {
    let y_bar = &CIE_1931.matching[1];
    let at = |point: usize| f64::from(absorption.at_grid_point(point)) * length;
    let (mut passed, mut total, mut weighted) = (0.0, 0.0, 0.0);
    for (point, weight) in y_bar.iter().enumerate() {
        let share = weight * (-at(point)).exp();
        passed += share;
        weighted += share * at(point);
        total += weight;
    }
    // Where nothing at all passes, the least depth says by how much.
    let least = (0..GRID_POINTS).map(at).fold(f64::INFINITY, f64::min);
    let depth = if passed > 0.0 { weighted / passed } else { least };
    (depth > EXTREME_AMPLIFICATION).then(|| {
        let limit = format!(
            "an optical depth above {EXTREME_AMPLIFICATION} along its longest side: an absorption coefficient or a thickness known to 1 % leaves the transmitted light known to {EXTREME_AMPLIFICATION} %"
        );
        let what = format!(
            "{} of the light passes the longest side, and a coefficient or a length wrong by 1 % makes that wrong by {}",
            percent(passed / total),
            percent((0.01 * depth).exp_m1())
        );
        Condition::new("optical_depth", objects, limit)
            .figure("longest_side_m", length * metres_per_unit)
            .figure("optical_depth", depth)
            .figure("transmittance", passed / total)
            .effect(Kind::Sensitivity, ALL, what)
    })
}
