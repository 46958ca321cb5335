//! A look at the scene with a few thousand rays: where the picture's light can be gathered,
//! which lamps are seen from there, how much a reflection keeps, how bright the picture is.
//!
//! Random numbers are fixed, so that a scene always gives the same figures. Shares carry the
//! error of so many draws: they decide what is said, and are no measurement.

use super::super::{MeterKind, Plan, Scene, View};
use super::sight::{LUMINOUS, MOST_SIGHTS, meeting, onto_smooth};
use crate::geometry::{Ray, SurfacePoint};
use crate::integrator::{Draw, Integrator, Tracer};
use crate::material::Quantity;
use crate::path::{Eye, Subpaths};
use crate::sampler::{BlockSampler, Sampler, Stream};
use crate::spectrum::{LANES, Wavelengths};

/// Walks from an eye that is alone: eight for each of 24 x 24 places of a picture.
const WALKS: u32 = 24 * 24 * 8;
/// Surfaces that a walk meets at most.
pub(super) const MOST_SURFACES: usize = 64;
/// A walk that keeps less than this says nothing more.
const LEAST_KEPT: f64 = 0.01;
/// Cells of the trial picture along a side, and samples in each.
const CELLS: u32 = 8;
const CELL_SAMPLES: u32 = 32;
/// Eyes among which the rays are shared out at most; more eyes get as many each.
const SHARING: u32 = 16;
/// Of the fixed random numbers.
pub(super) const SEED: u64 = 0x00e7_a10e;

/// A point where light can be gathered.
#[derive(Clone, Copy, Debug)]
pub struct Gathering {
    /// The point, its normal on the side that is looked at.
    pub point: SurfacePoint,
    /// Whether it is seen through smooth glass or in a mirror.
    pub through_smooth: bool,
}

/// What the rays found.
pub struct Probe {
    /// What light is gathered for, in words.
    pub of: &'static str,
    /// What the eye sees, one point for each walk.
    pub first: Vec<Gathering>,
    /// Where light scattered there meets the next surface that is not smooth; walks that
    /// escape or end on the way have none.
    pub second: Vec<Option<Gathering>>,
    /// Share of the light at a surface that arrives at the next one; `None` where no walk
    /// meets two.
    pub kept: Option<f64>,
    /// Luminance of the cells of a trial picture in cd/m2, rising; empty without a camera.
    pub luminances: Vec<f64>,
    /// Probability that a scattered ray meets each light: the median over the points above
    /// that see it, freely or through smooth surfaces; `None` where none does.
    pub meets: Vec<Option<f64>>,
    /// Share of each light's flux that falls on smooth surfaces first.
    pub onto_smooth: Vec<f64>,
}

impl Probe {
    /// Looks at a scene.
    pub fn new(scene: &Scene, view: Option<&View>) -> Self {
        let mut trails = Trails::default();
        let mut eyes: Vec<Eye<'_>> = scene.meters.iter().map(|meter| eye_of(&meter.kind)).collect();
        eyes.extend(view.map(|view| Eye::Camera(&view.camera)));
        let walks = WALKS / (eyes.len() as u32).clamp(1, SHARING);
        for (eye, index) in eyes.iter().zip(0..) {
            let size = view.filter(|_| matches!(eye, Eye::Camera(_))).map(|view| view.camera.resolution());
            let numbers = BlockSampler::new(SEED, index, 0, walks);
            trails.look(scene, eye, (0..walks).map(|walk| numbers.sample(walk)), size, &LUMINOUS);
        }
        let Trails { first, second, arrived, came_on } = trails;
        let mut probe = Self {
            of: if view.is_some() { "the picture" } else { "the meters" },
            first,
            second,
            kept: (arrived > 0.0).then(|| came_on / arrived),
            luminances: Vec::new(),
            meets: Vec::new(),
            onto_smooth: Vec::new(),
        };
        let lights = 0..scene.lights.len() as u32;
        probe.meets = lights.clone().map(|light| probe.probability_of_meeting(scene, light)).collect();
        probe.onto_smooth = lights.map(|light| onto_smooth(scene, light)).collect();
        if let Some(view) = view {
            probe.luminances = trial(scene, view, probe.kept);
        }
        probe
    }

    /// Median luminance of the trial picture, cd/m2.
    pub fn median_luminance(&self) -> Option<f64> {
        self.luminances.get(self.luminances.len() / 2).copied()
    }

    /// From one point in how many so many lamps are looked for.
    pub fn step(&self, lamps: usize) -> usize {
        (self.first.len() * lamps).div_ceil(MOST_SIGHTS).max(1)
    }

    fn probability_of_meeting(&self, scene: &Scene, light: u32) -> Option<f64> {
        let step = self.step(scene.lights.len());
        let both = self.first.iter().step_by(step).chain(self.second.iter().step_by(step).flatten());
        let mut found: Vec<f64> = both.filter_map(|g| meeting(scene, &g.point, light)).collect();
        found.sort_by(f64::total_cmp);
        found.get(found.len() / 2).copied()
    }
}

fn eye_of(kind: &MeterKind) -> Eye<'static> {
    match *kind {
        MeterKind::Illuminance(point) => Eye::Irradiance(point),
        MeterKind::Luminance { position, direction } => Eye::Radiance(Ray::new(position, direction)),
    }
}

#[derive(Default)]
struct Trails {
    first: Vec<Gathering>,
    second: Vec<Option<Gathering>>,
    /// Light that arrives at surfaces that are not smooth, and what of it arrives at the next.
    arrived: f64,
    came_on: f64,
}

impl Trails {
    /// Sends out as many rays as there are random numbers given; `size` is that of the picture.
    fn look(
        &mut self,
        scene: &Scene,
        eye: &Eye<'_>,
        numbers: impl Iterator<Item = Sampler>,
        size: Option<[u32; 2]>,
        w: &Wavelengths,
    ) {
        for sampler in numbers {
            let at = sampler.pair(Stream::Pixel, 0).map(f64::from);
            let position = size.map_or(at, |s| [at[0] * f64::from(s[0]), at[1] * f64::from(s[1])]);
            let drawn = eye.ray(position, sampler.pair(Stream::Lens, 0));
            // An instrument for illuminance is itself where light is gathered.
            let own = matches!(eye, Eye::Irradiance(_))
                .then_some(Gathering { point: drawn.point, through_smooth: false });
            self.walk(scene, drawn.ray, own, &sampler, w);
        }
    }

    fn walk(
        &mut self,
        scene: &Scene,
        mut ray: Ray,
        own: Option<Gathering>,
        numbers: &Sampler,
        w: &Wavelengths,
    ) {
        let mut met: Vec<Gathering> = own.into_iter().collect();
        let (mut carried, mut through_smooth) = ([1.0; LANES], false);
        let mut before: Option<f64> = None;
        for bounce in 0..MOST_SURFACES as u32 {
            let Some(hit) = scene.geometry.intersect(&ray) else { break };
            let material = &scene.materials[scene.objects[hit.object as usize].material as usize];
            let bsdf = material.at(w);
            let wo = hit.shading.to_local(-ray.direction);
            let here = carried.iter().sum::<f64>() / LANES as f64;
            if !bsdf.is_delta() {
                let side = if hit.point.normal.dot(ray.direction) > 0.0 { -1.0 } else { 1.0 };
                let point = SurfacePoint { normal: hit.point.normal * side, ..hit.point };
                met.push(Gathering { point, through_smooth });
                self.came_on += before.map_or(0.0, |_| here);
                if here < LEAST_KEPT || bounce + 1 == MOST_SURFACES as u32 {
                    break;
                }
                self.arrived += here;
                before = Some(here);
            }
            let (u, u_lobe) = (numbers.pair(Stream::Direction, bounce), numbers.single(Stream::Lobe, bounce));
            let Some(drawn) = bsdf.sample(wo, u_lobe, u, Quantity::Importance) else { break };
            for (lane, carried) in carried.iter_mut().enumerate() {
                let of = if drawn.hero_only { 0 } else { lane };
                *carried *= f64::from(drawn.value[of] / drawn.pdf.hero());
            }
            through_smooth = drawn.is_delta;
            ray = hit.point.ray_along(hit.shading.to_world(drawn.wi).normalize());
        }
        if let Some(first) = met.first() {
            self.first.push(*first);
            self.second.push(met.get(1).copied());
        }
    }
}

/// Luminances of a small picture by path tracing, rising.
fn trial(scene: &Scene, view: &View, kept: Option<f64>) -> Vec<f64> {
    /// Channel of the luminance.
    const Y: usize = 1;
    let plan = Plan::of(scene, &view.sensor, Integrator::Path.strategies());
    let tracer = Tracer::new(scene, &plan, Eye::Camera(&view.camera));
    let side = view.camera.resolution().map(|side| f64::from(side) / f64::from(CELLS));
    // Where paths hardly end, fewer of them take as long.
    let share = (10.0 * (1.0 - kept.unwrap_or(0.0))).clamp(0.0, 1.0);
    let samples = ((f64::from(CELL_SAMPLES) * share) as u32).max(1);
    let mut paths = Subpaths::default();
    let mut cell = |index: u32| {
        let numbers = BlockSampler::new(SEED, u64::from(index), 2, samples);
        let mut sum = 0.0;
        for sample in 0..samples {
            let sampler = numbers.sample(sample);
            let wavelengths = plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
            let at = sampler.pair(Stream::Pixel, 0).map(f64::from);
            let corner = [index % CELLS, index / CELLS].map(f64::from);
            let position = [0, 1].map(|axis| (corner[axis] + at[axis]) * side[axis]);
            let draw = Draw { position, wavelengths: &wavelengths, sampler: &sampler };
            let found = tracer.gather(&draw, &mut paths);
            if found.is_finite() {
                view.sensor.record(found, &wavelengths, |channel, value| {
                    sum += if channel == Y { value } else { 0.0 };
                });
            }
        }
        sum / f64::from(samples)
    };
    let mut luminances: Vec<f64> = (0..CELLS * CELLS).map(&mut cell).collect();
    luminances.sort_by(f64::total_cmp);
    luminances
}
