//! Two subpaths become complete paths: every way to join them, judged and handed on.

use super::eye::Eye;
use super::media::Media;
use super::vertex::{Kind, Vertex};
use super::walk::{Heading, Walker, transmittance};
use super::weights::{Density, Known, Made};
use crate::geometry::{Ray, SurfacePoint};
use crate::light::Light;
use crate::material::Quantity;
use crate::measure::{AreaPdf, solid_angle_per_area};
use crate::sampler::Stream;
use crate::spectrum::Spectrum;
use std::marker::PhantomData;

/// A complete path's estimate of what the eye records.
#[derive(Clone, Copy, Debug)]
pub struct Contribution {
    /// Vertices from the light.
    pub s: usize,
    /// Vertices from the eye.
    pub t: usize,
    /// Estimate by this strategy alone: radiance in W sr^-1 m^-2 nm^-1 times the eye's response.
    pub estimate: Spectrum,
    /// The strategy's share among those that find the path.
    pub weight: f32,
    /// Where in the picture, unless where the subpath from the eye began.
    pub position: Option<[f64; 2]>,
    /// The vertex that belongs to no subpath: of the light for s = 1, of the eye for t < 2.
    pub end: Option<End>,
}

/// An end of a path that was found from its neighbour.
#[derive(Clone, Copy, Debug)]
pub struct End {
    /// Where it is.
    pub point: SurfacePoint,
    /// Light in the scene and primitive in the geometry, for a light.
    pub light: Option<(u32, Option<u32>)>,
}

impl End {
    const fn of_eye(point: SurfacePoint) -> Self {
        Self { point, light: None }
    }
}

/// The two subpaths of a sample; kept between samples for its memory.
#[derive(Debug, Default)]
pub struct Subpaths<'a> {
    /// From a light on.
    pub light: Vec<Vertex<'a>>,
    /// From the eye on.
    pub eye: Vec<Vertex<'a>>,
    /// Light emitted along the first.
    pub emitted: Spectrum,
    /// Density with which the second vertex of the first would ask for its first.
    pub asked: f64,
    known: Vec<Known>,
}

/// Joins subpaths in all ways that a plan lists.
pub struct Joiner<'a, 'd, D> {
    /// What the walks happened in.
    pub walker: Walker<'a, 'd>,
    /// What the paths end at.
    pub eye: &'d Eye<'a>,
    /// What the eye is in.
    pub eye_media: Media<'a>,
    /// How densities are kept.
    pub densities: PhantomData<D>,
}

/// A light's point that was asked for, or met.
struct Source<'l> {
    light: &'l Light,
    index: u32,
    primitive: Option<u32>,
    point: SurfacePoint,
    /// Density of the point for a subpath from the light.
    started: f64,
    /// Density of the point for a vertex that asks.
    asked: f64,
}

impl Source<'_> {
    const fn end(&self) -> End {
        End { point: self.point, light: Some((self.index, self.primitive)) }
    }

    fn known(&self, eye: AreaPdf, lanes: Spectrum) -> Known {
        Known { light: AreaPdf::of_all_lanes(self.started), eye, lanes, is_delta: false }
    }

    /// Density with which light from here reaches a vertex.
    fn reaches(&self, vertex: &Vertex<'_>) -> AreaPdf {
        let span = vertex.point.position - self.point.position;
        let density = self.light.pdf_emission(self.point.normal, span.normalize_or_zero());
        AreaPdf::of_all_lanes(density * vertex.solid_angle_per_area_from(self.point.position))
    }
}

impl<'a, D: Density> Joiner<'a, '_, D> {
    /// s = 0: the subpath from the eye has met a surface that shines.
    pub fn met_light(&self, paths: &mut Subpaths<'a>, put: &mut impl FnMut(&Contribution)) {
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
        let asks = !before.is_delta && strategies.plans(1, t - 1);
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
        let source =
            Source { light, index, primitive: Some(surface.primitive), point: last.point, started, asked };
        let reaches = source.reaches(before);
        let estimate = last.throughput * light.emission(self.walker.wavelengths);
        let first = source.known(last.forward, last.lanes);
        paths.gather(&self.walker, 0, t - 1, Some(first));
        if let Some(second) = paths.known.get_mut(1) {
            second.light = reaches;
        }
        self.hand_on(&paths.known, [0, t], asked, estimate, (None, None), put);
    }

    /// s = 1: the last vertex from the eye asks a light.
    pub fn ask_light(&self, paths: &mut Subpaths<'a>, put: &mut impl FnMut(&Contribution)) {
        let walker = &self.walker;
        let strategies = &walker.plan.strategies;
        let t = paths.eye.len();
        let [.., before, last] = &paths.eye[..] else { return };
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
        let from = last.point.position;
        let per_area = if source.primitive.is_some() {
            solid_angle_per_area(from, source.point.position, source.point.normal)
        } else {
            0.0
        };
        let first = source.known(AreaPdf::of_direction(scattered.pdf, per_area), Spectrum::ONE);
        let reverse = strategies.joins_both_ways().then(|| {
            let reverse = last.reverse_pdf(direction, Quantity::Radiance);
            (source.reaches(last), AreaPdf::of_direction(reverse, before.solid_angle_per_area_from(from)))
        });
        paths.gather(walker, 0, t, Some(first));
        if let (Some((second, third)), [_, x1, x2, ..]) = (reverse, &mut paths.known[..]) {
            x1.light = second;
            x2.light = third;
        }
        self.hand_on(&paths.known, [1, t], source.asked, estimate, (None, Some(source.end())), put);
    }

    /// s > 1, t > 1: a vertex that light has reached, by its index, and the last one from the
    /// eye.
    pub fn join(&self, paths: &mut Subpaths<'a>, s: usize, put: &mut impl FnMut(&Contribution)) {
        let walker = &self.walker;
        let t = paths.eye.len();
        let [.., before_eye, eye] = &paths.eye[..] else { return };
        let (before_light, light) = (&paths.light[s - 2], &paths.light[s - 1]);
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
        let Some(ray) = eye.point.ray_to(&light.point) else { return };
        if walker.scene.geometry.occluded(&ray) {
            return;
        }
        if walker.plan.tracks_media {
            estimate *= self.transmitted(&eye.media_towards(towards_light), ray.t_max);
        }
        let (eye_at, light_at) = (eye.point.position, light.point.position);
        let light_known = Known {
            light: light.forward,
            eye: AreaPdf::of_direction(seen.pdf, light.solid_angle_per_area_from(eye_at)),
            lanes: light.lanes,
            is_delta: false,
        };
        let eye_known = Known {
            light: AreaPdf::of_direction(lit.pdf, eye.solid_angle_per_area_from(light_at)),
            eye: eye.forward,
            lanes: eye.lanes,
            is_delta: false,
        };
        let before_light_pdf = AreaPdf::of_direction(
            light.reverse_pdf(towards_eye, Quantity::Importance),
            before_light.solid_angle_per_area_from(light_at),
        );
        let before_eye_pdf = AreaPdf::of_direction(
            eye.reverse_pdf(towards_light, Quantity::Radiance),
            before_eye.solid_angle_per_area_from(eye_at),
        );
        paths.gather(walker, s, t, None);
        paths.known[s - 1] = light_known;
        paths.known[s - 2].eye = before_light_pdf;
        if let Some(known) = paths.known.get_mut(s) {
            *known = eye_known;
        }
        if let Some(known) = paths.known.get_mut(s + 1) {
            known.light = before_eye_pdf;
        }
        let asked = paths.asked;
        self.hand_on(&paths.known, [s, t], asked, estimate, (None, None), put);
    }

    /// t = 1, s > 1: a vertex that light has reached, by its index, asks the eye.
    pub fn ask_eye(&self, paths: &mut Subpaths<'a>, s: usize, put: &mut impl FnMut(&Contribution)) {
        let walker = &self.walker;
        if !walker.plan.strategies.plans(s, 1) {
            return;
        }
        let Some(end) = self.eye_point(s) else { return };
        let (before, light) = (&paths.light[s - 2], &paths.light[s - 1]);
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
        let light_known = Known {
            light: light.forward,
            eye: AreaPdf::of_all_lanes(sight.pdf_solid_angle * light.solid_angle_per_area_from(eye_at)),
            lanes: light.lanes,
            is_delta: false,
        };
        let eye_known = Known {
            light: AreaPdf::of_direction(lit.pdf, end.solid_angle_per_area_from(light_at)),
            eye: end.forward,
            lanes: Spectrum::ONE,
            is_delta: false,
        };
        let before_pdf = AreaPdf::of_direction(
            light.reverse_pdf(towards_eye, Quantity::Importance),
            before.solid_angle_per_area_from(light_at),
        );
        paths.gather(walker, s, 0, None);
        paths.known[s - 1] = light_known;
        paths.known[s - 2].eye = before_pdf;
        paths.known.push(eye_known);
        let asked = paths.asked;
        let place = (Some(sight.position), Some(End::of_eye(end.point)));
        self.hand_on(&paths.known, [s, 1], asked, estimate, place, put);
    }

    /// s = t = 1: a light is joined to the eye.
    pub fn light_to_eye(&self, put: &mut impl FnMut(&Contribution)) {
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
        let per_area = if source.primitive.is_some() {
            let at = source.point;
            solid_angle_per_area(end.point.position, at.position, at.normal)
        } else {
            0.0
        };
        let seen = AreaPdf::of_all_lanes(sight.pdf_solid_angle * per_area);
        let known = [
            source.known(seen, Spectrum::ONE),
            Known { light: source.reaches(&end), eye: end.forward, lanes: Spectrum::ONE, is_delta: false },
        ];
        let place = (Some(sight.position), Some(source.end()));
        self.hand_on(&known, [1, 1], source.asked, estimate, place, put);
    }

    /// t = 0: the subpath from the light has met the eye on the way of `heading`.
    pub fn met_eye(
        &self,
        paths: &mut Subpaths<'a>,
        heading: &Heading<'a>,
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
        let eye_known = Known {
            light: heading.pdf_area(last, &end),
            eye: end.forward,
            lanes: heading.lanes,
            is_delta: false,
        };
        let last_eye =
            AreaPdf::of_all_lanes(sight.pdf_solid_angle * last.solid_angle_per_area_from(point.position));
        let asked = if s == 2 { self.asked_by(last, &end) } else { paths.asked };
        paths.gather(walker, s - 1, 0, None);
        paths.known[s - 2].eye = last_eye;
        paths.known.push(eye_known);
        let place = (Some(sight.position), Some(End::of_eye(point)));
        self.hand_on(&paths.known, [s, 0], asked, estimate, place, put);
    }

    /// Density with which a vertex would ask for the point that a subpath from a light began
    /// at.
    pub fn asked_by(&self, start: &Vertex<'_>, asking: &Vertex<'_>) -> f64 {
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
        let choice = walker.sampler.fine(Stream::LightChoice, name);
        let lights = &walker.scene.lights;
        let (index, probability) = lights.choose_towards(point.position, choice)?;
        let light = lights.get(index);
        let u = walker.sampler.pair(Stream::LightPoint, name);
        let sample = light.sample_towards(&walker.scene.geometry, point, u, walker.wavelengths)?;
        let drawn = probability * f64::from(sample.pdf_solid_angle);
        let asked = if sample.primitive.is_some() {
            drawn * solid_angle_per_area(point.position, sample.point.position, sample.point.normal)
        } else {
            drawn
        };
        let started = lights.probability_emitting(index) * light.pdf_area();
        let source =
            Source { light, index, primitive: sample.primitive, point: sample.point, started, asked };
        Some((source, sample.shadow_ray, sample.radiance * (1.0 / drawn) as f32))
    }

    fn eye_point(&self, name: usize) -> Option<Vertex<'a>> {
        let aperture = self.eye.has_aperture();
        let u = if aperture { self.walker.sampler.pair(Stream::Splat, name as u32) } else { [0.0; 2] };
        Some(self.eye_vertex(self.eye.point(u)?))
    }

    fn eye_vertex(&self, point: SurfacePoint) -> Vertex<'a> {
        self.walker.eye_vertex(self.eye, point, self.eye_media)
    }

    fn transmitted(&self, media: &Media<'a>, distance: f32) -> Spectrum {
        let absorption = media.absorption();
        absorption.map_or(Spectrum::ONE, |a| transmittance(a, distance, self.walker.wavelengths))
    }

    fn hand_on(
        &self,
        known: &[Known],
        [s, t]: [usize; 2],
        asked: f64,
        estimate: Spectrum,
        (position, end): (Option<[f64; 2]>, Option<End>),
        put: &mut impl FnMut(&Contribution),
    ) {
        let made = Made { vertices: known, count: s + t, from_light: s, asked };
        let judged = made.judge::<D>(&self.walker.plan.strategies);
        let estimate = estimate * (1.0 / judged.lane_mean) as f32;
        put(&Contribution { s, t, estimate, weight: judged.weight as f32, position, end });
    }
}

impl<'a> Subpaths<'a> {
    /// Forgets both subpaths.
    pub fn clear(&mut self) {
        self.light.clear();
        self.eye.clear();
    }

    /// Collects what weights need of the first `s` vertices from the light (or of one given
    /// instead) and of the first `t` from the eye, numbered from the light.
    fn gather(&mut self, walker: &Walker<'_, '_>, s: usize, t: usize, first: Option<Known>) {
        self.known.clear();
        self.known.extend(first);
        for vertex in &self.light[..s] {
            self.known.push(Known {
                light: vertex.forward,
                eye: vertex.reverse,
                lanes: vertex.lanes,
                is_delta: vertex.is_delta,
            });
        }
        // No strategy differs by the vertices beyond the span.
        let count = self.known.len() + t;
        let (_, most) = walker.plan.strategies.span(count.max(2));
        let wanted = (most + 1).saturating_sub(self.known.len()).min(t);
        for vertex in self.eye[..t].iter().rev().take(wanted) {
            self.known.push(Known {
                light: vertex.reverse,
                eye: vertex.forward,
                lanes: vertex.lanes,
                is_delta: vertex.is_delta,
            });
        }
    }
}
