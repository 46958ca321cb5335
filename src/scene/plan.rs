//! What this scene needs, found out once, and what is left out and why.

use super::Scene;
use super::reach::{Unreachable, unreachable};
use crate::camera::Sensor;
use crate::light::Light;
use crate::material::Material;
use crate::path::{Roulette, Strategies};
use crate::spectrum::{GRID_POINTS, WavelengthSampler, between_grid_points};

/// Why a picture is black in every pixel.
pub const NOTHING_SHINES: &str = "nothing shines: the picture is black";

/// How a scene is to be rendered.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Distribution of the wavelengths that paths carry.
    pub wavelengths: WavelengthSampler,
    /// The strategies that are used.
    pub strategies: Strategies,
    /// Whether every joint of two subpaths is looked along, not one in proportion to what they
    /// contribute: for pictures of single strategies.
    pub joins_each: bool,
    /// Whether paths end behind the first vertex that is no mirror: direct light alone.
    pub direct_only: bool,
    /// Bounces after which paths are cut off, which loses light; `None`: only roulette ends them.
    pub most_bounces: Option<u32>,
    /// How paths are ended at random.
    pub roulette: Roulette,
    /// Whether the densities of a path differ between its wavelengths.
    pub lanes_differ: bool,
    /// Whether any medium absorbs, so that paths must know what they travel through.
    pub tracks_media: bool,
    /// The decisions in plain words, each with its reason.
    pub reasons: Vec<String>,
    /// Paths that carry light and that none of the strategies can make.
    pub unreachable: Vec<Unreachable>,
}

impl Plan {
    /// The plan for a scene as a sensor sees it, with strategies to choose from.
    pub fn of(scene: &Scene, sensor: &Sensor, strategies: Strategies) -> Self {
        let mut reasons = Vec::new();
        let wavelengths = wavelengths(scene, sensor, &mut reasons);
        let tracks_media = scene.used_materials().any(|m| m.absorption().is_some());
        if scene.used_materials().any(Material::disperses) {
            reasons.push("a dispersive medium: its smooth refractions keep the hero wavelength alone".into());
        } else {
            reasons.push("no dispersive medium: all wavelengths of a path stay together".into());
        }
        if !tracks_media {
            reasons.push("nothing absorbs between surfaces: media are not tracked".into());
        }
        if scene.view.as_ref().is_some_and(|view| !view.camera.has_aperture()) {
            reasons.push("pinhole: no lens sampling".into());
        }
        let strategies = needed(scene, strategies, &mut reasons);
        let unreachable = unreachable(scene, &strategies);
        if scene.emitters.iter().all(|emitter| emitter.weight() == 0.0) {
            reasons.push(NOTHING_SHINES.into());
        }
        let lanes_differ = scene.used_materials().any(Material::disperses);
        Self {
            wavelengths,
            strategies,
            joins_each: false,
            direct_only: false,
            most_bounces: None,
            roulette: Roulette::Carried,
            lanes_differ,
            tracks_media,
            reasons,
            unreachable,
        }
    }
}

/// The strategies of a list that a scene has a use for.
fn needed(scene: &Scene, listed: Strategies, reasons: &mut Vec<String>) -> Strategies {
    let mut strategies = listed;
    let aperture = scene.view.as_ref().is_some_and(|view| view.camera.has_aperture());
    let areas = (0..scene.lights.len()).any(|index| scene.lights.get(index as u32).has_surface());
    let smooth = scene.used_materials().any(Material::is_smooth);
    let mut drop = |planned: &mut bool, unneeded: bool, reason: &str| {
        if *planned && unneeded {
            *planned = false;
            reasons.push(reason.to_owned());
        }
    };
    drop(&mut strategies.meets_lights, !areas, "point lights only: no ray meets a light");
    drop(&mut strategies.meets_eye, !aperture, "pinhole: no light meets the eye by itself");
    drop(
        &mut strategies.meets_eye,
        listed.asks_eye && !smooth,
        "nothing smooth: light is joined to the lens, none has to meet it",
    );
    drop(
        &mut strategies.light_to_eye,
        listed.meets_lights && !has_point_lights(scene),
        "no point lights: the eye meets by itself what shines in its view",
    );
    drop(
        &mut strategies.direct_asks_eye,
        listed.asks_lights,
        "direct light: vertices in view ask the lights, which is surer than light that finds the picture",
    );
    strategies
}

fn has_point_lights(scene: &Scene) -> bool {
    (0..scene.lights.len()).any(|index| {
        scene.emitters[index].weight() > 0.0 && matches!(scene.lights.get(index as u32), Light::Point(_))
    })
}

/// Wavelengths in proportion to what sensors and lamps make of them, lines among them;
/// nothing where no sensor responds or no lamp shines.
fn wavelengths(scene: &Scene, sensor: &Sensor, reasons: &mut Vec<String>) -> WavelengthSampler {
    let attention = sensor.attention();
    let (mut continuum, mut lines) = (vec![0.0; GRID_POINTS], vec![0.0; scene.lines_nm.len()]);
    for index in 0..scene.lights.len() {
        let emission = match scene.lights.get(index as u32) {
            Light::Point(light) => &light.intensity,
            Light::Area(light) => light.radiance(),
        };
        let values: Vec<f64> = emission.at_grid_points().collect();
        let total: f64 = values.iter().sum::<f64>() + emission.lines().map(|(_, power)| power).sum::<f64>();
        if total > 0.0 {
            // A lamp that the sensors hardly see still counts a little.
            let weight = scene.emitters[index].weight().max(f64::MIN_POSITIVE) / total;
            continuum.iter_mut().zip(values).for_each(|(sum, v)| *sum += weight * v);
            emission.lines().for_each(|(line, power)| lines[line as usize] += weight * power);
        }
    }
    continuum.iter_mut().zip(&attention).for_each(|(weight, a)| *weight *= a);
    let attended = |(nm, weight): (&f64, f64)| (*nm, weight * between_grid_points(&attention, *nm));
    let lines: Vec<(f64, f64)> = scene.lines_nm.iter().zip(lines).map(attended).collect();
    let Some(sampler) = WavelengthSampler::mixture(&continuum, &lines) else {
        return WavelengthSampler::even();
    };
    reasons.extend(continuum_drawn(&continuum));
    reasons.extend(lines_drawn(&lines));
    sampler
}

fn continuum_drawn(weights: &[f64]) -> Option<String> {
    let first = 360 + weights.iter().position(|w| *w > 0.0)?;
    let last = 360 + weights.iter().rposition(|w| *w > 0.0)?;
    Some(format!(
        "wavelengths from {first} to {last} nm, drawn as sensor and lamps weigh them: elsewhere nothing shines or nothing responds"
    ))
}

fn lines_drawn(lines: &[(f64, f64)]) -> Option<String> {
    let count = lines.iter().filter(|(_, weight)| *weight > 0.0).count();
    (count > 0).then(|| {
        let lines = if count == 1 { "spectral line" } else { "spectral lines" };
        format!("{count} {lines}: drawn each by itself, at its wavelength exactly")
    })
}
