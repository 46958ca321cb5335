//! How closed a scene is, and how little its surfaces take: what decides how long paths get.
//!
//! What surfaces reflect at most is read off their materials, and bounds the albedo for certain.
//! Whether light gets out, or ever meets what absorbs, is a question of geometry: random walks
//! from the lights give evidence, not proof.

use super::{Plan, Scene};
use crate::camera::Sensor;
use crate::material::Material;
use crate::path::{Strategies, Subpaths, TRAPPED_BOUNCES, Walker};
use crate::sampler::{BlockSampler, Sampler, Stream};
use crate::spectrum::{Dense, GRID_POINTS};

/// Walks from the lights.
const WALKS: u32 = 1 << 10;
/// Names their random numbers.
const SEED: u64 = 0x0063_6c6f_7375_7265;

/// What walks from the lights have met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closure {
    /// Largest share of light that any surface in use sends on, at any wavelength: no path keeps
    /// more per bounce. 1 where there is clear glass, which loses nothing.
    pub largest_albedo: f64,
    /// Walks that were made; none where nothing shines.
    pub walks: u32,
    /// Those that left the scene.
    pub left: u32,
    /// Those that had lost nothing after [`TRAPPED_BOUNCES`] bounces, or ended before by nothing
    /// but rounding.
    pub trapped: u32,
    /// Bounces of a walk on average, those of trapped ones up to that limit.
    pub mean_bounces: f64,
}

impl Closure {
    /// Whether no walk has left the scene.
    pub const fn is_closed(&self) -> bool {
        self.walks > 0 && self.left == 0
    }

    /// Whether no walk has left the scene and all but a few have lost nothing: radiance then has no
    /// finite value wherever it is seen. Rounding ends a walk in some thousand.
    pub const fn is_lossless(&self) -> bool {
        self.is_closed() && self.walks - self.trapped <= self.walks / 128
    }

    /// Share of its power that light keeps per bounce on average, as if all bounces were alike.
    pub fn mean_albedo(&self) -> f64 {
        self.mean_bounces / (1.0 + self.mean_bounces)
    }
}

/// What walks from a scene's lights meet.
pub fn closure(scene: &Scene) -> Closure {
    let largest_albedo = scene.used_materials().map(largest_albedo).fold(0.0, f64::max);
    let mut found = Closure { largest_albedo, walks: 0, left: 0, trapped: 0, mean_bounces: 0.0 };
    if scene.lights.is_empty() {
        return found;
    }
    let sensor = scene.view.as_ref().map_or_else(Sensor::cie, |view| view.sensor.clone());
    let plan = Plan {
        most_bounces: Some(TRAPPED_BOUNCES),
        strategies: Strategies::LIGHT,
        ..Plan::of(scene, &sensor, Strategies::LIGHT)
    };
    let numbers = BlockSampler::new(SEED, 0, 0, WALKS);
    let mut paths = Subpaths::default();
    let mut bounces = 0;
    for index in 0..WALKS {
        bounces += walk(scene, &plan, &numbers.sample(index), &mut paths, &mut found);
    }
    found.mean_bounces = f64::from(bounces) / f64::from(found.walks.max(1));
    found
}

/// Follows one walk; its bounces.
fn walk(scene: &Scene, plan: &Plan, sampler: &Sampler, paths: &mut Subpaths, found: &mut Closure) -> u32 {
    let wavelengths = plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
    let walker = Walker { scene, plan, wavelengths: &wavelengths, sampler };
    let chosen = scene.lights.choose_emitting(sampler.fine(Stream::EmissionChoice, 0));
    let Some((index, probability)) = chosen else { return 0 };
    let [u_point, u_direction] =
        [Stream::EmissionPoint, Stream::EmissionDirection].map(|stream| sampler.pair(stream, 0));
    let emitted = scene.lights.get(index).emit(&scene.geometry, u_point, u_direction);
    let Some(emitted) = emitted else { return 0 };
    let (start, mut heading) = walker.from_light(index, probability, &emitted);
    found.walks += 1;
    paths.clear();
    paths.light.push(start);
    loop {
        let from = paths.light.last().expect("the light is there");
        let Some(vertex) = walker.arrive(from, &mut heading) else {
            found.left += 1;
            break;
        };
        paths.light.push(vertex);
        if !walker.leave(&mut paths.light, &mut heading) {
            break;
        }
    }
    let fate = heading.fate;
    found.trapped += u32::from(fate.trapped.is_some() || fate.ended_by_rounding);
    heading.bounce
}

/// Largest share of light that a material sends on, at any wavelength and angle.
fn largest_albedo(material: &Material) -> f64 {
    let largest = |spectrum: &Dense| {
        (0..GRID_POINTS).map(|point| f64::from(spectrum.at_grid_point(point))).fold(0.0, f64::max)
    };
    match material {
        Material::Lambertian { reflectance, .. } | Material::Mirror { reflectance, .. } => {
            largest(reflectance)
        }
        // Light that only passes by outside of glass loses nothing, whatever is absorbed inside,
        // and all metals reflect everything at grazing incidence.
        Material::Dielectric { .. } | Material::Conductor { .. } => 1.0,
    }
}
