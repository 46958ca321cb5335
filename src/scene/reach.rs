//! Which paths no strategy can make: found from what a scene is made of, before rendering.
//!
//! A path is a word (Heckbert 1990): L the light, E the eye, D a vertex that strategies can
//! join at, S a smooth mirror or refraction, which they cannot. A strategy makes a word where
//! it can join two neighbours, or where light meets an extended eye or the eye meets an
//! extended light. What is left for a point light, a pinhole and a list of strategies is a
//! short list of classes.

use super::Scene;
use crate::light::Light;
use crate::material::Material;
use crate::path::Strategies;

/// A class of paths that would carry light but is missing from the picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unreachable {
    /// The class as a word.
    pub word: &'static str,
    /// What it is in plain words, with the names of the lights.
    pub meaning: String,
}

/// What decides which words are made.
#[derive(Clone, Copy, Debug)]
struct Case {
    strategies: Strategies,
    light_has_area: bool,
    eye_has_area: bool,
}

impl Case {
    /// Whether any strategy makes a path with these vertices between light and eye, `true` for
    /// those that can be joined at.
    fn makes(&self, between: &[bool]) -> bool {
        let Self { strategies, light_has_area, eye_has_area } = *self;
        let (first, last) = (between.first().copied(), between.last().copied());
        strategies.meets_lights && light_has_area
            || strategies.meets_eye && eye_has_area
            || between.is_empty() && strategies.light_to_eye
            || first == Some(true) && strategies.asks_lights
            || last == Some(true) && strategies.asks_eye
            || strategies.joins && between.windows(2).any(|pair| pair[0] && pair[1])
    }
}

/// A word for each class, shortest first, with an example and what it means; `true` stands for
/// D.
const CLASSES: [(&str, &[bool], &str); 7] = [
    ("L E", &[], "seen directly"),
    ("L D E", &[true], "on matte or rough surfaces that it lights directly"),
    ("L D D+ E", &[true, true], "between matte or rough surfaces"),
    ("L S+ E", &[false], "seen through smooth glass or in smooth mirrors"),
    ("L S+ D E", &[false, true], "on matte or rough surfaces behind smooth glass or mirrors (caustics)"),
    ("L D S+ E", &[true, false], "on matte or rough surfaces that are seen through smooth glass or mirrors"),
    (
        "L S+ (D S+)+ E",
        &[false, true, false],
        "on matte or rough surfaces behind smooth glass or mirrors, seen through smooth glass or mirrors",
    ),
];

/// The classes that a scene may hold and that no strategy of a list makes for its camera.
pub fn unreachable(scene: &Scene, strategies: &Strategies) -> Vec<Unreachable> {
    let eye_has_area = scene.view.as_ref().is_some_and(|view| view.camera.has_aperture());
    unreachable_by(scene, strategies, eye_has_area, |light| is_in_view(scene, light))
}

/// The same for an instrument: `is_open` where it collects light from all sides.
pub fn unreachable_by_instrument(scene: &Scene, strategies: &Strategies, is_open: bool) -> Vec<Unreachable> {
    let Strategies { asks_eye, light_to_eye, .. } = *strategies;
    let strategies = Strategies {
        asks_eye: asks_eye && is_open,
        light_to_eye: light_to_eye && is_open,
        meets_eye: false,
        ..*strategies
    };
    // No ray of a luminance meter is aimed at a point.
    unreachable_by(scene, &strategies, false, |light| light.has_surface())
}

fn unreachable_by(
    scene: &Scene,
    strategies: &Strategies,
    eye_has_area: bool,
    sees: impl Fn(&Light) -> bool,
) -> Vec<Unreachable> {
    let smooth = scene.used_materials().any(Material::is_smooth);
    let joinable = scene.used_materials().any(|material| !material.is_smooth());
    let mut found = Vec::new();
    for (word, between, meaning) in CLASSES {
        let exists = between.iter().all(|joins| if *joins { joinable } else { smooth });
        let names: Vec<&str> = (0..scene.lights.len())
            .filter(|index| {
                let light = scene.lights.get(*index as u32);
                let light_has_area = matches!(light, Light::Area(_));
                exists
                    && scene.emitters[*index].weight() > 0.0
                    && (!between.is_empty() || sees(light))
                    && !Case { strategies: *strategies, light_has_area, eye_has_area }.makes(between)
            })
            .map(|index| scene.emitters[index].name.as_str())
            .collect();
        if !names.is_empty() {
            let lights = names.join(", ");
            found.push(Unreachable { word, meaning: format!("light of {lights} {meaning}") });
        }
    }
    found
}

/// Whether the camera sees a light itself; taken for granted of lights with an area.
pub(super) fn is_in_view(scene: &Scene, light: &Light) -> bool {
    let (Some(view), Light::Point(lamp)) = (&scene.view, light) else { return true };
    let eye = view.camera.point_at(view.camera.placement().position.as_vec3a());
    let Some(ray) = eye.ray_to_position(lamp.position) else { return false };
    let in_picture = view.camera.picture_position(eye.position, ray.direction).is_some();
    in_picture && lamp.distribution.towards(-ray.direction) > 0.0 && !scene.geometry.occluded(&ray)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn missing(strategies: Strategies, light_has_area: bool, eye_has_area: bool) -> Vec<&'static str> {
        let case = Case { strategies, light_has_area, eye_has_area };
        CLASSES.iter().filter(|(_, between, _)| !case.makes(between)).map(|(word, ..)| *word).collect()
    }

    #[test]
    fn what_each_list_cannot_make_is_named() {
        let none: [&str; 0] = [];
        assert_eq!(missing(Strategies::PATH, true, false), none);
        assert_eq!(missing(Strategies::ALL, true, false), none);
        assert_eq!(missing(Strategies::ALL, false, true), none);
        assert_eq!(missing(Strategies::ALL, false, false), ["L S+ E", "L S+ (D S+)+ E"]);
        assert_eq!(missing(Strategies::PATH, false, false), ["L E", "L S+ E", "L S+ D E", "L S+ (D S+)+ E"]);
        assert_eq!(missing(Strategies::LIGHT, true, false), ["L S+ E", "L D S+ E", "L S+ (D S+)+ E"]);
        assert_eq!(missing(Strategies::LIGHT, false, true), none);
    }
}
