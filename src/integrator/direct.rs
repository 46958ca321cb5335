//! Direct light alone, by standard sampling: what chains of paths leave out.

use super::blocks::{BlockOf, render_block};
use super::tracer::Tracer;
use crate::camera::{Film, Sensor};
use crate::path::{Eye, Strategies, Subpaths};
use crate::sampler::BlockSampler;
use crate::scene::{Plan, Scene, View};

/// A picture of the light that the eye sees straight or over smooth surfaces, and of surfaces
/// seen so that a light shines on straight.
pub struct DirectLight<'a> {
    scene: &'a Scene,
    view: &'a View,
    plan: Plan,
}

/// Samples that tell whether there is any.
const PROBES: u32 = 1 << 13;

impl<'a> DirectLight<'a> {
    /// Of a view, beside what a plan renders.
    pub fn new(scene: &'a Scene, view: &'a View, plan: &Plan) -> Self {
        Self { scene, view, plan: Self::plan(scene, &view.sensor, plan) }
    }

    /// The plan of direct light beside another plan.
    pub fn plan(scene: &Scene, sensor: &Sensor, beside: &Plan) -> Plan {
        let plan = Plan::under(scene, sensor, Strategies::DIRECT, &beside.leaving);
        Plan { direct_only: true, most_bounces: beside.most_bounces, ..plan }
    }

    /// Nothing gathered yet.
    pub fn film(&self) -> Film {
        let channels = self.view.sensor.channels.len();
        Film::new(self.view.camera.resolution(), channels, self.plan.strategies.splats())
    }

    /// Whether some samples, which are then forgotten, find any.
    pub fn is_seen(&self, seed: u64) -> bool {
        let tracer = self.tracer();
        let [width, height] = self.view.camera.resolution();
        let numbers = BlockSampler::new(!seed, 0, 0, PROBES);
        let mut paths = Subpaths::default();
        let mut seen = false;
        for index in 0..PROBES {
            let place = crate::sampler::owen_sobol_2d(index, PROBES.trailing_zeros(), seed);
            let corner = [place[0] * width as f32, place[1] * height as f32].map(|c| f64::from(c.floor()));
            tracer.sample(corner, &numbers.sample(index), &mut paths, &mut |found, _| {
                seen |= !(found.estimate * found.weight).is_black();
            });
        }
        seen
    }

    /// Takes the next block of a film, of so many samples in every pixel.
    pub fn block(&self, film: &mut Film, seed: u64, samples_per_pixel: u32) {
        let of = BlockOf { seed, number: film.blocks(), size: samples_per_pixel, direct_light: true };
        render_block(&self.tracer(), self.view, film, &of, &|_| {});
        film.finish_block(samples_per_pixel);
    }

    fn tracer(&self) -> Tracer<'_> {
        Tracer::new(self.scene, &self.plan, Eye::Camera(&self.view.camera))
    }
}
