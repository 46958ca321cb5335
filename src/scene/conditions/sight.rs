//! Who sees which lamp: along straight lines, through smooth transparent surfaces as if they
//! did not bend light.

use super::probe::{MOST_SURFACES, SEED};
use crate::geometry::{Ray, SurfacePoint};
use crate::light::Light;
use crate::light::power::EmitterShape;
use crate::sampler::{BlockSampler, Stream};
use crate::scene::Scene;
use crate::spectrum::colour::CIE_1931;
use crate::spectrum::{LANES, WavelengthSampler, Wavelengths};
use std::sync::LazyLock;

/// Looks from points to lamps for one purpose at most: of many lamps, fewer points are asked.
pub(super) const MOST_SIGHTS: usize = 200_000;

/// Wavelengths of equal luminous weight in an equal energy spectrum.
pub(super) static LUMINOUS: LazyLock<Wavelengths> = LazyLock::new(|| {
    let sampler = WavelengthSampler::proportional_to(&CIE_1931.matching[1]).expect("the eye sees something");
    sampler.sample(0.5 / LANES as f32)
});

/// How a lamp is seen from a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sight {
    /// Along a straight line.
    Clear,
    /// Through smooth transparent surfaces.
    ThroughGlass,
}

/// How a light's point is seen from a point; `None` where something is between.
fn sight(scene: &Scene, ray: Ray) -> Option<Sight> {
    let end = ray.origin + ray.direction * ray.t_max;
    let (mut ray, mut sight) = (ray, Sight::Clear);
    for _ in 0..MOST_SURFACES {
        let Some(hit) = scene.geometry.intersect(&ray) else { return Some(sight) };
        let material = &scene.materials[scene.objects[hit.object as usize].material as usize];
        if !(material.is_transparent() && material.is_smooth()) {
            return None;
        }
        sight = Sight::ThroughGlass;
        ray = hit.point.ray_to_position(end)?;
    }
    None
}

/// How a light is seen from a point, by one of its points.
pub(super) fn sight_of(scene: &Scene, from: &SurfacePoint, light: u32) -> Option<Sight> {
    let towards = scene.lights.get(light).sample_towards(&scene.geometry, from, [0.5; 2], &LUMINOUS)?;
    (towards.shadow_ray.direction.dot(from.normal) > 0.0).then(|| sight(scene, towards.shadow_ray))?
}

/// Probability that a ray scattered in proportion to the cosine meets a light that is seen
/// from a point; `None` where it is not, and for lights without a surface.
pub(super) fn meeting(scene: &Scene, from: &SurfacePoint, light: u32) -> Option<f64> {
    /// Points of the light that are looked at, in pairs across its middle.
    const LOOKS: [[f32; 2]; 4] = [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]];
    let lamp = scene.lights.get(light);
    if !lamp.has_surface() {
        return None;
    }
    let look = |u: &[f32; 2]| {
        let towards = lamp.sample_towards(&scene.geometry, from, *u, &LUMINOUS)?;
        let cosine = f64::from(towards.shadow_ray.direction.dot(from.normal));
        (cosine > 0.0 && sight(scene, towards.shadow_ray).is_some())
            .then(|| cosine / (std::f64::consts::PI * f64::from(towards.pdf_solid_angle)))
    };
    let sum: f64 = LOOKS.iter().filter_map(look).sum();
    (sum > 0.0).then(|| (sum / LOOKS.len() as f64).min(1.0))
}

/// Share of a light's flux that falls on smooth surfaces first, from points on these: rays from
/// a lamp far away would hardly find them.
pub(super) fn onto_smooth(scene: &Scene, light: u32) -> f64 {
    const POINTS: usize = 2048;
    const FEWEST: usize = 16;
    let points = (MOST_SIGHTS / scene.lights.len()).clamp(FEWEST, POINTS) as u32;
    let geometry = &scene.geometry;
    let smooth = (0..).zip(&scene.objects).filter(|(_, object)| {
        scene.materials[object.material as usize].at(&LUMINOUS).is_delta() && object.light != Some(light)
    });
    let mut upto = Vec::new();
    let mut area = 0.0;
    for primitive in smooth.flat_map(|(index, _)| geometry.primitives_of(index)) {
        area += f64::from(geometry.area_of(primitive));
        upto.push((area, primitive));
    }
    if upto.is_empty() {
        return 0.0;
    }
    let numbers = BlockSampler::new(SEED, u64::from(light), 1, points);
    let received = |index: u32| {
        let sampler = numbers.sample(index);
        let place = sampler.fine(Stream::EmissionChoice, 0) * area;
        let (_, primitive) = upto[upto.partition_point(|(upto, _)| *upto <= place).min(upto.len() - 1)];
        let point = geometry.primitive(primitive).sample_area(sampler.pair(Stream::EmissionPoint, 0));
        irradiance_per_flux(scene, light, &point, sampler.pair(Stream::LightPoint, 0))
    };
    ((0..points).map(received).sum::<f64>() / f64::from(points) * area).min(1.0)
}

/// Irradiance at a point, on the side that faces a light, over the light's flux, per square
/// scene unit; zero where anything is between.
fn irradiance_per_flux(scene: &Scene, light: u32, at: &SurfacePoint, u: [f32; 2]) -> f64 {
    let lamp = scene.lights.get(light);
    let Some(towards) = lamp.sample_towards(&scene.geometry, at, u, &LUMINOUS) else { return 0.0 };
    if sight(scene, towards.shadow_ray) != Some(Sight::Clear) {
        return 0.0;
    }
    let direction = towards.shadow_ray.direction;
    let cosine = f64::from(direction.dot(at.normal).abs());
    cosine
        * match (lamp, scene.emitters[light as usize].shape) {
            (Light::Point(point), EmitterShape::Point { solid_angle_sr }) => {
                let distance2 = f64::from((point.position - at.position).length_squared());
                f64::from(point.distribution.towards(-direction)) / (solid_angle_sr * distance2)
            }
            (_, EmitterShape::Surface { area_m2, .. }) => {
                let area = area_m2 / scene.geometry.metres_per_unit().powi(2);
                1.0 / (f64::from(towards.pdf_solid_angle) * std::f64::consts::PI * area)
            }
            (Light::Area(_), EmitterShape::Point { .. }) => 0.0,
        }
}
