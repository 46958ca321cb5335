//! What this scene needs, found out once, and what is left out and why.

use super::Scene;
use crate::camera::Sensor;
use crate::light::Light;
use crate::material::Material;
use crate::path::Strategies;
use crate::spectrum::{GRID_POINTS, WavelengthSampler};

/// How a scene is to be rendered.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Density of the wavelengths that paths carry.
    pub wavelengths: WavelengthSampler,
    /// The strategies that are used.
    pub strategies: Strategies,
    /// Whether the densities of a path differ between its wavelengths.
    pub lanes_differ: bool,
    /// Whether any medium absorbs, so that paths must know what they travel through.
    pub tracks_media: bool,
    /// The decisions in plain words, each with its reason.
    pub reasons: Vec<String>,
}

impl Plan {
    /// The plan for a scene as a sensor sees it, with strategies to choose from.
    pub fn of(scene: &Scene, sensor: &Sensor, strategies: Strategies) -> Self {
        let mut reasons = Vec::new();
        let wavelengths = wavelengths(scene, sensor, &mut reasons);
        let tracks_media = scene.materials.iter().any(|m| m.absorption().is_some());
        if scene.materials.iter().any(Material::disperses) {
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
        if has_point_lights(scene) && scene.materials.iter().any(Material::is_smooth) {
            reasons.push(
                "warning: a point light and smooth mirrors or glass: light that only reaches a surface through \
                 them cannot be found by this integrator and is missing; give the lamp its real size"
                    .into(),
            );
        }
        if scene.emitters.iter().all(|emitter| emitter.weight() == 0.0) {
            reasons.push("nothing shines: the picture is black".into());
        }
        let lanes_differ = scene.materials.iter().any(Material::disperses);
        Self { wavelengths, strategies, lanes_differ, tracks_media, reasons }
    }
}

fn has_point_lights(scene: &Scene) -> bool {
    (0..scene.lights.len()).any(|index| matches!(scene.lights.get(index as u32), Light::Point(_)))
}

/// Wavelengths in proportion to what sensors and lamps make of them; nothing where no
/// sensor responds or no lamp shines.
fn wavelengths(scene: &Scene, sensor: &Sensor, reasons: &mut Vec<String>) -> WavelengthSampler {
    let attention = sensor.attention();
    let mut emission = vec![0.0; GRID_POINTS];
    for index in 0..scene.lights.len() {
        let curve = match scene.lights.get(index as u32) {
            Light::Point(light) => &light.intensity,
            Light::Area(light) => light.radiance(),
        };
        let weight = scene.emitters[index].weight();
        let values: Vec<f64> = (0..GRID_POINTS).map(|i| f64::from(curve.at_grid_point(i))).collect();
        let total: f64 = values.iter().sum();
        if total > 0.0 {
            // A lamp that the sensors hardly see still counts a little.
            let weight = weight.max(f64::MIN_POSITIVE) / total;
            emission.iter_mut().zip(values).for_each(|(sum, v)| *sum += weight * v);
        }
    }
    let product: Vec<f64> = attention.iter().zip(&emission).map(|(a, e)| a * e).collect();
    if let Some(sampler) = WavelengthSampler::proportional_to(&product) {
        let lit: Vec<usize> = (0..GRID_POINTS).filter(|&i| product[i] > 0.0).collect();
        let (first, last) = (360 + lit[0], 360 + lit[lit.len() - 1]);
        reasons.push(format!(
            "wavelengths from {first} to {last} nm, drawn as sensor and lamps weigh them: elsewhere nothing shines or nothing responds"
        ));
        return sampler;
    }
    WavelengthSampler::even()
}
