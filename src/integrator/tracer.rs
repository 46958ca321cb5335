//! One sample of light transport: both subpaths, and every strategy of the plan.
//!
//! Path tracing, light tracing and bidirectional path tracing are this loop with three lists
//! of strategies; what a list does not need is not walked.

use crate::path::{
    Contribution, Density, Eye, EyeRay, Joiner, Lanes, Media, Subpaths, Walker, needs_no_vertices,
};
use crate::sampler::{Sampler, Stream};
use crate::scene::{Plan, Scene};
use crate::spectrum::{Spectrum, Wavelengths};
use std::marker::PhantomData;

/// Estimates what an eye records of a scene.
#[derive(Clone, Copy)]
pub struct Tracer<'a> {
    scene: &'a Scene,
    plan: &'a Plan,
    eye: Eye<'a>,
    /// What the eye is in.
    media: Media,
}

/// What decides a sample.
#[derive(Clone, Copy)]
pub struct Draw<'d> {
    /// Position in the picture, in pixels from the top left corner; in the unit square for an
    /// instrument.
    pub position: [f64; 2],
    /// The wavelengths that the paths carry.
    pub wavelengths: &'d Wavelengths,
    /// The random numbers.
    pub sampler: &'d Sampler,
}

impl<'a> Tracer<'a> {
    /// A tracer for an eye in a scene under its plan.
    pub fn new(scene: &'a Scene, plan: &'a Plan, eye: Eye<'a>) -> Self {
        let start = match eye {
            Eye::Camera(camera) => camera.placement().position.as_vec3a(),
            Eye::Irradiance(point) => point.position + point.normal * point.error,
            Eye::Radiance(ray) => ray.origin,
        };
        let media = if plan.tracks_media { Media::around(scene, start) } else { Media::NONE };
        Self { scene, plan, eye, media }
    }

    /// Hands every contribution of one sample to `put`: radiance in W sr^-1 m^-2 nm^-1 at each
    /// wavelength (irradiance in W m^-2 nm^-1 for an irradiance meter), whose mean over lanes
    /// and samples is the truth.
    pub fn trace(&self, draw: &Draw<'_>, paths: &mut Subpaths, put: &mut impl FnMut(&Contribution)) {
        let most_vertices = self.plan.most_bounces.map_or(usize::MAX, |most| most as usize + 2);
        let put = &mut |found: &Contribution| {
            if found.s + found.t <= most_vertices || !found.estimate.is_finite() {
                put(found);
            }
        };
        if paths.forgetful && paths.shares.is_none() && needs_no_vertices(self.plan) {
            self.trace_forgetfully(draw, paths, put);
        } else if self.plan.lanes_differ {
            self.trace_with::<Lanes>(draw, paths, put);
        } else {
            self.trace_with::<f64>(draw, paths, put);
        }
    }

    /// One sample with its wavelengths and its place within a pixel drawn from the sampler;
    /// `corner` is the pixel's top left one. The wavelengths come back.
    pub fn sample(
        &self,
        corner: [f64; 2],
        sampler: &Sampler,
        paths: &mut Subpaths,
        put: &mut impl FnMut(&Contribution, &Wavelengths),
    ) -> Wavelengths {
        let wavelengths = self.plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
        let [x, y] = sampler.pair(Stream::Pixel, 0).map(f64::from);
        let position = [corner[0] + x, corner[1] + y];
        let draw = Draw { position, wavelengths: &wavelengths, sampler };
        self.trace(&draw, paths, &mut |contribution| put(contribution, &wavelengths));
        wavelengths
    }

    /// What the sample adds where it was drawn; contributions elsewhere in the picture are
    /// left out.
    pub fn gather(&self, draw: &Draw<'_>, paths: &mut Subpaths) -> Spectrum {
        self.gather_seen(draw, paths, |_| {})
    }

    /// The same; `see` is shown every contribution.
    pub fn gather_seen(
        &self,
        draw: &Draw<'_>,
        paths: &mut Subpaths,
        mut see: impl FnMut(&Contribution),
    ) -> Spectrum {
        let mut sum = Spectrum::ZERO;
        self.trace(draw, paths, &mut |contribution| {
            see(contribution);
            if contribution.position.is_none() || matches!(self.eye, Eye::Irradiance(_)) {
                sum += contribution.estimate * contribution.weight;
            }
        });
        sum
    }

    fn trace_with<D: Density>(
        &self,
        draw: &Draw<'_>,
        paths: &mut Subpaths,
        put: &mut impl FnMut(&Contribution),
    ) {
        let walker = Walker {
            scene: self.scene,
            plan: self.plan,
            wavelengths: draw.wavelengths,
            sampler: draw.sampler,
        };
        let joiner = Joiner { walker, eye: &self.eye, eye_media: self.media, densities: PhantomData::<D> };
        let strategies = &self.plan.strategies;
        paths.clear();
        if strategies.follows_light() {
            walk_from_light(&joiner, paths, put);
        }
        if strategies.follows_eye() {
            self.walk_from_eye(&joiner, draw, paths, put);
        }
        if strategies.light_to_eye {
            joiner.light_to_eye(paths, put);
        }
        if strategies.asks_eye {
            for s in 2..=paths.light.len() {
                if !paths.light[s - 1].is_mirror() {
                    joiner.ask_eye(paths, s, put);
                }
            }
        }
    }

    fn trace_forgetfully(&self, draw: &Draw<'_>, paths: &mut Subpaths, put: &mut impl FnMut(&Contribution)) {
        let Draw { wavelengths, sampler, .. } = *draw;
        let walker = Walker { scene: self.scene, plan: self.plan, wavelengths, sampler };
        paths.clear();
        let fate = walker.trace_forgetfully((&self.eye, self.media), &self.eye_ray(draw), put);
        paths.fates.from_eye.note(fate);
    }

    fn eye_ray(&self, draw: &Draw<'_>) -> EyeRay {
        let aperture = self.eye.has_aperture() || self.plan.draws_any_lens;
        let u_lens = if aperture { draw.sampler.pair(Stream::Lens, 0) } else { [0.0; 2] };
        self.eye.ray(draw.position, u_lens)
    }

    fn walk_from_eye<D: Density>(
        &self,
        joiner: &Joiner<'a, '_, D>,
        draw: &Draw<'_>,
        paths: &mut Subpaths,
        put: &mut impl FnMut(&Contribution),
    ) {
        let walker = &joiner.walker;
        let strategies = &self.plan.strategies;
        let drawn = self.eye_ray(draw);
        let (start, mut heading) = walker.from_eye(&self.eye, &drawn, self.media);
        paths.eye.push(start);
        let mut scattered = false;
        let fate = loop {
            let from = paths.eye.last().expect("the eye is there");
            let Some(vertex) = walker.arrive(from, &mut heading) else { break heading.fate };
            paths.eye.push(vertex);
            if strategies.meets_lights {
                joiner.met_light(paths, put);
            }
            if self.plan.direct_only && scattered {
                break heading.fate;
            }
            if !vertex.is_mirror() {
                if strategies.asks_lights {
                    joiner.ask_light(paths, put);
                }
                if strategies.joins && self.plan.joins_each {
                    joiner.join_each(paths, put);
                } else if strategies.joins {
                    joiner.join(paths, put);
                }
            }
            if !walker.leave(&mut paths.eye, &mut heading) {
                if !heading.is_finite() {
                    joiner.lost((0, paths.eye.len()), put);
                }
                break heading.fate;
            }
            // By what happened there, not by what may: some glass does both.
            scattered |= paths.eye.last().is_some_and(|vertex| !vertex.is_delta);
        };
        paths.fates.from_eye.note(fate);
    }
}

fn walk_from_light<'a, D: Density>(
    joiner: &Joiner<'a, '_, D>,
    paths: &mut Subpaths,
    put: &mut impl FnMut(&Contribution),
) {
    let walker = &joiner.walker;
    let sampler = walker.sampler;
    let lights = &walker.scene.lights;
    let choice = if walker.plan.chooses_lamps { sampler.fine(Stream::EmissionChoice, 0) } else { 0.0 };
    let Some((index, probability)) = lights.choose_emitting(choice) else { return };
    let light = lights.get(index);
    let [u_point, u_direction] =
        [Stream::EmissionPoint, Stream::EmissionDirection].map(|stream| sampler.pair(stream, 0));
    let Some(emitted) = light.emit(&walker.scene.geometry, u_point, u_direction) else { return };
    let (start, mut heading) = walker.from_light(index, probability, &emitted);
    paths.emitted = light.emission(walker.wavelengths);
    paths.light.push(start);
    let fate = loop {
        let from = paths.light.last().expect("the light is there");
        let before = heading;
        let met = if walker.plan.strategies.meets_eye { joiner.eye.meet(&before.ray) } else { None };
        let vertex = walker.arrive(from, &mut heading);
        if let Some((point, distance)) = met
            && vertex.is_none_or(|v| (v.point.position - before.ray.origin).length() > distance)
        {
            joiner.met_eye(paths, &before, point, distance, put);
        }
        let Some(vertex) = vertex else { break heading.fate };
        if paths.light.len() == 1 {
            paths.asked = joiner.asked_by(&start, &vertex);
            heading.asked = paths.asked;
        }
        paths.light.push(vertex);
        if !walker.leave(&mut paths.light, &mut heading) {
            if !heading.is_finite() {
                joiner.lost((paths.light.len(), 0), put);
            }
            break heading.fate;
        }
    };
    paths.fates.from_lights.note(fate);
}
