//! Two subpaths become complete paths: every way to join them, judged and handed on.

use super::contribution::{Contribution, End, Proposal, Subpaths};
use super::eye::Eye;
use super::joint::{Fresh, Joint};
use super::media::Media;
use super::source::Source;
use super::strategies::Strategies;
use super::vertex::{Kind, Vertex};
use super::walk::{Heading, Walker, transmittance};
use super::weights::{Density, Judged, Known, Made};
use crate::geometry::{Ray, SurfacePoint};
use crate::light::Light;
use crate::material::Quantity;
use crate::measure::{AreaPdf, solid_angle_per_area};
use crate::sampler::Stream;
use crate::spectrum::Spectrum;
use std::marker::PhantomData;

/// Vertices from a light, up to this one, that every vertex from the eye is joined to: as many
/// as most subpaths have. With all of longer ones the cost would grow with the square.
const NEAREST: usize = 8;

/// Joins subpaths in all ways that a plan lists.
pub struct Joiner<'a, 'd, D> {
    /// What the walks happened in.
    pub walker: Walker<'a, 'd>,
    /// What the paths end at.
    pub eye: &'d Eye<'a>,
    /// What the eye is in.
    pub eye_media: Media,
    /// How densities are kept.
    pub densities: PhantomData<D>,
}
/// An estimate and where it belongs.
#[derive(Clone, Copy, Debug)]
struct Found {
    estimate: Spectrum,
    position: Option<[f64; 2]>,
    end: Option<End>,
}

impl Found {
    const fn here(estimate: Spectrum) -> Self {
        Self { estimate, position: None, end: None }
    }
}
impl<'a, D: Density> Joiner<'a, '_, D> {
    /// A walk has come upon something that is no number, and ends: what it would have brought is
    /// not known. The sample must not pass for black. `s` or `t` vertices were walked.
    pub fn lost(&self, (s, t): (usize, usize), put: &mut impl FnMut(&Contribution)) {
        put(&Contribution {
            s,
            t,
            estimate: Spectrum::splat(f32::NAN),
            weight: 1.0,
            position: None,
            end: None,
            kept: 1.0,
            number: u32::MAX,
        });
    }

    /// s = 0: the subpath from the eye has met a surface that shines.
    pub fn met_light(&self, paths: &mut Subpaths, put: &mut impl FnMut(&Contribution)) {
        let [.., before, last] = &paths.eye[..] else { return };
        let Some(surface) = last.surface() else { return };
        let Some(index) = surface.light else { return };
        let strategies = &self.walker.plan.strategies;
        let t = paths.eye.len();
        let light = self.walker.scene.lights.get(index);
        let Light::Area(area) = light else { return };
        if !strategies.plans(0, t) || !area.shines(last.point.normal, last.to_previous) {
            return;
        }
        let lights = &self.walker.scene.lights;
        // Other lists may ask where this one does not.
        let asks = !before.is_delta && (strategies.plans(1, t - 1) || paths.shares.is_some());
        let asked = if asks {
            let from = &before.point;
            let towards =
                light.pdf_towards(&self.walker.scene.geometry, from, &last.point, surface.primitive);
            let per_area = last.solid_angle_per_area_from(from.position);
            lights.probability_towards(from.position, index) * f64::from(towards) * per_area
        } else {
            0.0
        };
        let started = lights.probability_emitting(index) * light.pdf_area();
        let source = Source {
            light,
            index,
            primitive: Some(surface.primitive),
            point: last.point,
            started,
            asked,
            per_area: 0.0,
        };
        let reaches = source.reaches(before);
        let estimate = last.throughput * light.emission(self.walker.wavelengths);
        let fresh = Fresh { eye_last: source.starts(), eye_before: reaches, ..Fresh::default() };
        let joint = Joint { s: 0, t, asked, started, fresh, lens: None };
        self.hand_on(paths, &joint, Found::here(estimate), put);
    }

    /// s = 1: the last vertex from the eye asks a light.
    pub fn ask_light(&self, paths: &mut Subpaths, put: &mut impl FnMut(&Contribution)) {
        let walker = &self.walker;
        let strategies = &walker.plan.strategies;
        let t = paths.eye.len();
        let [.., last] = &paths.eye[..] else { return };
        if !strategies.plans(1, t) {
            return;
        }
        let Some((source, ray, radiance)) = self.source_for(&last.point, t as u32 - 1) else { return };
        let direction = ray.direction;
        let scattered = last.scatter(direction, Quantity::Radiance);
        if scattered.value.is_black() || walker.scene.geometry.occluded(&ray) {
            return;
        }
        let mut estimate = last.throughput * scattered.value * radiance;
        // Light reaches the vertex through the medium on its own side of the surface.
        if walker.plan.tracks_media {
            estimate *= self.transmitted(&last.media_towards(direction), ray.t_max);
        }
        let mut fresh =
            Fresh { light_last: AreaPdf::of_direction(scattered.pdf, source.per_area), ..Fresh::default() };
        if strategies.joins_both_ways() {
            let reverse = last.reverse_pdf(direction, Quantity::Radiance);
            fresh.eye_last = source.reaches(last);
            fresh.eye_before = AreaPdf::of_direction(reverse, last.per_area_of_previous);
        }
        let joint = Joint { s: 1, t, asked: source.asked, started: source.started, fresh, lens: None };
        let found = Found { end: Some(source.end()), ..Found::here(estimate) };
        self.hand_on(paths, &joint, found, put);
    }

    /// s > 1, t > 1: vertices that light has reached and the last one from the eye.
    ///
    /// All joints are judged, and one of them is looked along for obstacles, in proportion to
    /// what it would contribute: mostly all are clear, and one ray tells as much as many.
    pub fn join(&self, paths: &mut Subpaths, put: &mut impl FnMut(&Contribution)) {
        paths.proposals.clear();
        let t = paths.eye.len();
        let [u_far, u_chosen] = self.walker.sampler.pair(Stream::Visibility, t as u32);
        for s in 2..=paths.light.len().min(NEAREST) {
            self.propose(paths, s, 1.0, put);
        }
        // Of the vertices farther down a long subpath, one stands for all.
        let far = paths.light.len().saturating_sub(NEAREST);
        if far > 0 {
            let index = ((u_far * far as f32) as usize).min(far - 1);
            self.propose(paths, NEAREST + 1 + index, 1.0 / far as f32, put);
        }
        let total: f32 = paths.proposals.iter().map(|proposal| proposal.size).sum();
        let mut left = u_chosen * total;
        let within = |proposal: &&Proposal| {
            left -= proposal.size;
            left < 0.0
        };
        // Rounding may leave a little over: the last one takes it.
        let chosen = paths.proposals.iter().find(within).or(paths.proposals.last());
        let Some(Proposal { contribution, size }) = chosen else { return };
        let (light, eye) = (&paths.light[contribution.s - 1], &paths.eye[t - 1]);
        let Some(ray) = eye.point.ray_to(&light.point) else { return };
        if self.walker.scene.geometry.occluded(&ray) {
            return;
        }
        let chosen = size / total;
        let (estimate, kept) = (contribution.estimate * (1.0 / chosen), contribution.kept * chosen);
        put(&Contribution { estimate, kept, ..*contribution });
    }

    /// The same with every joint looked along by itself: for pictures of single strategies, of
    /// which none is to depend on what the others find.
    pub fn join_each(&self, paths: &mut Subpaths, put: &mut impl FnMut(&Contribution)) {
        for s in 2..=paths.light.len() {
            paths.proposals.clear();
            self.propose(paths, s, 1.0, put);
            let Some(Proposal { contribution, .. }) = paths.proposals.pop() else { continue };
            let (light, [.., eye]) = (&paths.light[s - 1], &paths.eye[..]) else { return };
            let Some(ray) = eye.point.ray_to(&light.point) else { continue };
            if !self.walker.scene.geometry.occluded(&ray) {
                put(&contribution);
            }
        }
    }

    /// Judges the joint of a vertex that light has reached, which was picked with a chance. What
    /// is no number cannot be chosen in proportion to it, and is handed on at once.
    fn propose(&self, paths: &mut Subpaths, s: usize, chance: f32, put: &mut impl FnMut(&Contribution)) {
        let walker = &self.walker;
        let t = paths.eye.len();
        if paths.light[s - 1].is_mirror() || !walker.plan.strategies.plans(s, t) {
            return;
        }
        let [.., eye] = &paths.eye[..] else { return };
        let light = &paths.light[s - 1];
        let span = light.point.position - eye.point.position;
        let squared = span.length_squared();
        let towards_light = span / squared.sqrt();
        let towards_eye = -towards_light;
        let seen = eye.scatter(towards_light, Quantity::Radiance);
        if seen.value.is_black() {
            return;
        }
        let lit = light.scatter(towards_eye, Quantity::Importance);
        let mut estimate = eye.throughput * seen.value * lit.value * light.throughput * paths.emitted;
        if estimate.is_black() || squared == 0.0 {
            return;
        }
        estimate *= 1.0 / squared;
        if walker.plan.tracks_media {
            estimate *= self.transmitted(&eye.media_towards(towards_light), squared.sqrt());
        }
        let (eye_at, light_at) = (eye.point.position, light.point.position);
        let fresh = Fresh {
            light_last: AreaPdf::of_direction(seen.pdf, light.solid_angle_per_area_from(eye_at)),
            light_before: AreaPdf::of_direction(
                light.reverse_pdf(towards_eye, Quantity::Importance),
                light.per_area_of_previous,
            ),
            eye_last: AreaPdf::of_direction(lit.pdf, eye.solid_angle_per_area_from(light_at)),
            eye_before: AreaPdf::of_direction(
                eye.reverse_pdf(towards_light, Quantity::Radiance),
                eye.per_area_of_previous,
            ),
        };
        let joint = paths.joint(s, t, fresh, None);
        let found = Found::here(estimate * (1.0 / chance));
        let contribution = Contribution { kept: chance, ..self.judged(paths, &joint, found) };
        let size = contribution.estimate.mean() * contribution.weight;
        if !size.is_finite() {
            put(&Contribution { estimate: Spectrum::splat(size), ..contribution });
        } else if size > 0.0 {
            paths.proposals.push(Proposal { contribution, size });
        }
    }

    /// t = 1, s > 1: a vertex that light has reached, by its index, asks the eye.
    pub fn ask_eye(&self, paths: &mut Subpaths, s: usize, put: &mut impl FnMut(&Contribution)) {
        let walker = &self.walker;
        if !walker.plan.strategies.plans(s, 1) {
            return;
        }
        let Some(end) = self.eye_point(s) else { return };
        let light = &paths.light[s - 1];
        let Some(ray) = light.point.ray_to(&end.point) else { return };
        let towards_eye = ray.direction;
        let Some(sight) = self.eye.sees(&end.point, -towards_eye) else { return };
        let lit = light.scatter(towards_eye, Quantity::Importance);
        if lit.value.is_black() || walker.scene.geometry.occluded(&ray) {
            return;
        }
        let squared = (end.point.position - light.point.position).as_dvec3().length_squared();
        let factor = f64::from(self.eye.response()) * sight.pdf_solid_angle / squared;
        let mut estimate = lit.value * light.throughput * paths.emitted * factor as f32;
        if walker.plan.tracks_media {
            estimate *= self.transmitted(&light.media_towards(towards_eye), ray.t_max);
        }
        let (eye_at, light_at) = (end.point.position, light.point.position);
        let fresh = Fresh {
            light_last: AreaPdf::of_all_lanes(
                sight.pdf_solid_angle * light.solid_angle_per_area_from(eye_at),
            ),
            light_before: AreaPdf::of_direction(
                light.reverse_pdf(towards_eye, Quantity::Importance),
                light.per_area_of_previous,
            ),
            eye_last: AreaPdf::of_direction(lit.pdf, end.solid_angle_per_area_from(light_at)),
            eye_before: AreaPdf::ZERO,
        };
        let joint = paths.joint(s, 1, fresh, None);
        let found = Found { estimate, position: Some(sight.position), end: Some(End::of_eye(end.point)) };
        self.hand_on(paths, &joint, found, put);
    }

    /// s = t = 1: a light is joined to the eye.
    pub fn light_to_eye(&self, paths: &mut Subpaths, put: &mut impl FnMut(&Contribution)) {
        let walker = &self.walker;
        if !walker.plan.strategies.plans(1, 1) {
            return;
        }
        let Some(end) = self.eye_point(1) else { return };
        let Some((source, ray, radiance)) = self.source_for(&end.point, 0) else { return };
        let Some(sight) = self.eye.sees(&end.point, ray.direction) else { return };
        if walker.scene.geometry.occluded(&ray) {
            return;
        }
        let mut estimate = radiance * (f64::from(self.eye.response()) * sight.pdf_solid_angle) as f32;
        if walker.plan.tracks_media {
            estimate *= self.transmitted(&self.eye_media, ray.t_max);
        }
        let fresh = Fresh {
            light_last: AreaPdf::of_all_lanes(sight.pdf_solid_angle * source.per_area),
            eye_last: source.reaches(&end),
            ..Fresh::default()
        };
        let joint = Joint { s: 1, t: 1, asked: source.asked, started: source.started, fresh, lens: None };
        let found = Found { estimate, position: Some(sight.position), end: Some(source.end()) };
        self.hand_on(paths, &joint, found, put);
    }

    /// t = 0: the subpath from the light has met the eye on the way of `heading`.
    pub fn met_eye(
        &self,
        paths: &mut Subpaths,
        heading: &Heading,
        point: SurfacePoint,
        distance: f32,
        put: &mut impl FnMut(&Contribution),
    ) {
        let walker = &self.walker;
        let s = paths.light.len() + 1;
        if !walker.plan.strategies.plans(s, 0) {
            return;
        }
        let Some(sight) = self.eye.sees(&point, -heading.ray.direction) else { return };
        let end = self.eye_vertex(point);
        let last = &paths.light[s - 2];
        let cosine = f64::from(point.normal.dot(heading.ray.direction).abs());
        let factor = f64::from(self.eye.response()) * sight.pdf_solid_angle * end.forward.hero() / cosine;
        let mut estimate = heading.throughput * paths.emitted * factor as f32;
        if walker.plan.tracks_media {
            estimate *= self.transmitted(&heading.media, distance);
        }
        let lens = Known {
            light: heading.pdf_area(last, &end),
            eye: end.forward,
            lanes: heading.lanes,
            is_delta: false,
        };
        let fresh = Fresh {
            light_last: end.forward,
            light_before: AreaPdf::of_all_lanes(
                sight.pdf_solid_angle * last.solid_angle_per_area_from(point.position),
            ),
            ..Fresh::default()
        };
        let mut joint = paths.joint(s, 0, fresh, Some(lens));
        if s == 2 {
            joint.asked = self.asked_by(last, &end);
        }
        let found = Found { estimate, position: Some(sight.position), end: Some(End::of_eye(point)) };
        self.hand_on(paths, &joint, found, put);
    }

    /// Density with which a vertex would ask for the point that a subpath from a light began
    /// at.
    pub fn asked_by(&self, start: &Vertex, asking: &Vertex) -> f64 {
        let Kind::Light { light: index, primitive } = start.kind else { return 0.0 };
        let scene = self.walker.scene;
        let from = &asking.point;
        let probability = scene.lights.probability_towards(from.position, index);
        let Some(primitive) = primitive else { return probability };
        let light = scene.lights.get(index);
        let towards = light.pdf_towards(&scene.geometry, from, &start.point, primitive);
        probability * f64::from(towards) * start.solid_angle_per_area_from(from.position)
    }

    /// Asks a light for a point that may light another one: the source, the ray to it, and
    /// the radiance from there over the density per solid angle.
    fn source_for(&self, point: &SurfacePoint, name: u32) -> Option<(Source<'a>, Ray, Spectrum)> {
        let walker = &self.walker;
        let choice =
            if walker.plan.chooses_lamps { walker.sampler.fine(Stream::LightChoice, name) } else { 0.0 };
        let lights = &walker.scene.lights;
        let (index, probability) = lights.choose_towards(point.position, choice)?;
        let light = lights.get(index);
        let u = walker.sampler.pair(Stream::LightPoint, name);
        let sample = light.sample_towards(&walker.scene.geometry, point, u, walker.wavelengths)?;
        let drawn = probability * f64::from(sample.pdf_solid_angle);
        let (per_area, asked) = match sample.primitive {
            Some(_) => {
                let per_area =
                    solid_angle_per_area(point.position, sample.point.position, sample.point.normal);
                (per_area, drawn * per_area)
            }
            None => (0.0, drawn),
        };
        let started = lights.probability_emitting(index) * light.pdf_area();
        let source = Source {
            light,
            index,
            primitive: sample.primitive,
            point: sample.point,
            started,
            asked,
            per_area,
        };
        Some((source, sample.shadow_ray, sample.radiance * (1.0 / drawn) as f32))
    }

    fn eye_point(&self, name: usize) -> Option<Vertex> {
        let aperture = self.eye.has_aperture() || self.walker.plan.draws_any_lens;
        let u = if aperture { self.walker.sampler.pair(Stream::Splat, name as u32) } else { [0.0; 2] };
        Some(self.eye_vertex(self.eye.point(u)?))
    }

    fn eye_vertex(&self, point: SurfacePoint) -> Vertex {
        self.walker.eye_vertex(self.eye, point, self.eye_media)
    }

    fn transmitted(&self, media: &Media, distance: f32) -> Spectrum {
        let absorption = media.absorption(self.walker.scene);
        absorption.map_or(Spectrum::ONE, |a| transmittance(a, distance, self.walker.wavelengths))
    }

    fn hand_on(
        &self,
        paths: &mut Subpaths,
        joint: &Joint,
        found: Found,
        put: &mut impl FnMut(&Contribution),
    ) {
        put(&self.judged(paths, joint, found));
    }

    fn judged(&self, paths: &mut Subpaths, joint: &Joint, found: Found) -> Contribution {
        let strategies = &self.walker.plan.strategies;
        let number = if paths.shares.is_some() { self.note_shares(paths, joint) } else { u32::MAX };
        let quick = if D::SCALAR { joint.quick_weight(paths, self.eye, strategies) } else { f64::NAN };
        let judged = if quick.is_nan() {
            paths.gather(joint, self.eye, strategies);
            let made = Made {
                vertices: &paths.known,
                count: joint.s + joint.t,
                from_light: joint.s,
                asked: joint.asked,
            };
            made.judge::<D>(strategies)
        } else {
            Judged { weight: quick, lane_mean: 1.0 }
        };
        let Joint { s, t, .. } = *joint;
        let Found { estimate, position, end } = found;
        let estimate = estimate * (1.0 / judged.lane_mean) as f32;
        Contribution { s, t, estimate, weight: judged.weight as f32, position, end, kept: 1.0, number }
    }

    /// Notes what other lists of strategies would make of a path; its number comes back.
    fn note_shares(&self, paths: &mut Subpaths, joint: &Joint) -> u32 {
        let survival_of = |walk: &[Vertex], count: usize| {
            walk[..count.min(walk.len())].last().map_or(1.0, |vertex| f64::from(vertex.survival))
        };
        let survival = survival_of(&paths.light, if joint.s > 1 { joint.s } else { 0 })
            * survival_of(&paths.eye, if joint.t > 1 { joint.t } else { 0 });
        paths.gather(joint, self.eye, &Strategies::ALL);
        let made = Made {
            vertices: &paths.known,
            count: joint.s + joint.t,
            from_light: joint.s,
            asked: joint.asked,
        };
        let shares = made.shares::<D>(survival);
        let all = paths.shares.get_or_insert_default();
        all.push(shares);
        all.len() as u32 - 1
    }
}
