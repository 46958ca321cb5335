//! Which strategies of a list a scene has a use for.
//!
//! One is left out where it cannot make a path that carries light, or where every path that it
//! makes is found by others that are surer of it. No other: whether a strategy that finds light
//! is worth its cost is a matter of measurement, not of planning.

use super::item::Decisions;
use super::leaving::{ASKS_EYE, ASKS_LIGHTS, DIRECT_ASKS_EYE, JOINS, LIGHT_TO_EYE, MEETS_EYE, MEETS_LIGHTS};
use crate::light::Light;
use crate::material::Material;
use crate::path::Strategies;
use crate::scene::Scene;
use crate::scene::reach::is_in_view;
use glam::DVec3;

/// What of a scene decides which strategies carry light.
struct Case {
    aperture: bool,
    areas_shine: bool,
    points_shine: bool,
    /// Some point light that shines may be in the picture.
    points_in_view: bool,
    smooth: bool,
    /// Some surface that is no mirror reflects or transmits.
    scatters: bool,
    /// All of those lie in one plane.
    one_plane: bool,
}

impl Case {
    fn of(scene: &Scene) -> Self {
        let aperture = scene.view.as_ref().is_some_and(|view| view.camera.has_aperture());
        let shining = || {
            let lights = (0..scene.lights.len()).filter(|index| scene.emitters[*index].weight() > 0.0);
            lights.map(|index| scene.lights.get(index as u32))
        };
        let is_point = |light: &&Light| !light.has_surface();
        Self {
            aperture,
            areas_shine: shining().any(|light| light.has_surface()),
            points_shine: shining().any(|light| is_point(&light)),
            points_in_view: shining().filter(is_point).any(|light| aperture || is_in_view(scene, light)),
            smooth: scene.used_materials().any(Material::is_smooth),
            scatters: scene.used_materials().any(scatters),
            one_plane: in_one_plane(scene),
        }
    }
}

/// The strategies of a list that a scene has a use for.
pub(super) fn needed(scene: &Scene, listed: Strategies, decisions: &mut Decisions<'_>) -> Strategies {
    let case = Case::of(scene);
    let mut strategies = listed;
    let mut drop = |planned: &mut bool, name, unneeded, reason: &str| {
        if *planned {
            *planned = !decisions.leave_out(name, unneeded, reason, "");
        }
    };
    const NOTHING_SCATTERS: &str = "nothing matte or rough reflects: ";
    drop(
        &mut strategies.meets_lights,
        MEETS_LIGHTS,
        !case.areas_shine,
        "point lights only: no ray meets a light",
    );
    drop(
        &mut strategies.asks_lights,
        ASKS_LIGHTS,
        !case.scatters,
        &format!("{NOTHING_SCATTERS}no light is asked for"),
    );
    let planes = "what is matte or rough lies in one plane: no light goes from there to there";
    let nothing_to_join = format!("{NOTHING_SCATTERS}nothing can be joined");
    drop(
        &mut strategies.joins,
        JOINS,
        !case.scatters || case.one_plane,
        if case.scatters { planes } else { &nothing_to_join },
    );
    // In a plane without mirrors all light that the eye could be asked for is direct.
    let direct_only = case.one_plane && !case.smooth && listed.asks_lights;
    let reason = if case.scatters {
        "what is matte or rough lies in one plane and nothing is smooth: all light is direct, and found by asking the lights"
    } else {
        &nothing_to_join
    };
    drop(&mut strategies.asks_eye, ASKS_EYE, !case.scatters || direct_only, reason);
    if strategies.asks_eye {
        drop(
            &mut strategies.direct_asks_eye,
            DIRECT_ASKS_EYE,
            listed.asks_lights,
            "direct light: vertices in view ask the lights, which is surer than light that finds the picture",
        );
    }
    let point_lights = if case.points_shine {
        "no point light is in view: the eye meets by itself what shines there"
    } else {
        "no point lights: the eye meets by itself what shines in its view"
    };
    let seen_otherwise = !case.areas_shine || listed.meets_lights;
    drop(&mut strategies.light_to_eye, LIGHT_TO_EYE, seen_otherwise && !case.points_in_view, point_lights);
    let reason = if case.aperture {
        "no specular surface between light and eye: light is joined to the lens, none has to meet it, and no caustic needs it"
    } else {
        "pinhole: no light meets the eye by itself"
    };
    let joined_to_lens = listed.asks_eye && !case.smooth;
    drop(&mut strategies.meets_eye, MEETS_EYE, !case.aperture || joined_to_lens, reason);
    strategies
}

/// Whether light goes on from a material in a direction that is not the only one.
fn scatters(material: &Material) -> bool {
    let is_black = matches!(material, Material::Lambertian { reflectance, .. } if reflectance.is_zero());
    !material.is_smooth() && !is_black
}

/// Whether all surfaces that scatter lie in one plane, but for the rounding of positions; false
/// where nothing scatters.
fn in_one_plane(scene: &Scene) -> bool {
    /// Sine of the angle between normals that count as one, and distance over extent of points
    /// that count as in a plane: some roundings of `f32`.
    const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;
    let geometry = &scene.geometry;
    let is_seen = |primitive: &u32| {
        let object = &scene.objects[geometry.object_of(*primitive) as usize];
        scatters(&scene.materials[object.material as usize])
    };
    let mut plane: Option<(DVec3, DVec3)> = None;
    for index in (0..geometry.primitive_count()).filter(is_seen) {
        let primitive = geometry.primitive(index);
        let Some(normal) = primitive.flat_normal() else { return false };
        let normal = normal.as_dvec3();
        for u in [[0.0, 0.0], [0.9, 0.1], [0.1, 0.9]] {
            let point = primitive.sample_area(u).position.as_dvec3();
            let (through, along) = *plane.get_or_insert((point, normal));
            let span = point - through;
            let reach = point.abs().max_element().max(through.abs().max_element());
            if normal.cross(along).length() > ROUNDING || span.dot(along).abs() > ROUNDING * reach {
                return false;
            }
        }
    }
    plane.is_some()
}
