//! Two subpaths become complete paths: every way to join them, judged and handed on.

use super::eye::Eye;
use super::media::Media;
use super::strategies::Strategies;
use super::vertex::{Kind, Vertex};
use super::walk::{Heading, Walker, transmittance};
use super::weights::{Density, Judged, Known, Made, Side};
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
    /// Probability with which the contribution was kept; the estimate is larger by its inverse.
    pub kept: f32,
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
pub struct Subpaths {
    /// From a light on.
    pub light: Vec<Vertex>,
    /// From the eye on.
    pub eye: Vec<Vertex>,
    /// Light emitted along the first.
    pub emitted: Spectrum,
    /// Density with which the second vertex of the first would ask for its first.
    pub asked: f64,
    known: Vec<Known>,
    proposals: Vec<Proposal>,
}

/// A contribution that an obstacle may still take away.
#[derive(Clone, Copy, Debug)]
struct Proposal {
    contribution: Contribution,
    /// What it would add to the picture, in any unit.
    size: f32,
}

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
    /// Solid angle at the vertex that asks over area at the point; zero for a point light.
    per_area: f64,
}

impl Source<'_> {
    const fn end(&self) -> End {
        End { point: self.point, light: Some((self.index, self.primitive)) }
    }

    const fn starts(&self) -> AreaPdf {
        AreaPdf::of_all_lanes(self.started)
    }

    /// Density with which light from here reaches a vertex.
    fn reaches(&self, vertex: &Vertex) -> AreaPdf {
        let span = vertex.point.position - self.point.position;
        let density = self.light.pdf_emission(self.point.normal, span.normalize_or_zero());
        AreaPdf::of_all_lanes(density * vertex.solid_angle_per_area_from(self.point.position))
    }
}

impl<'a, D: Density> Joiner<'a, '_, D> {
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
        for s in 2..=paths.light.len() {
            if !paths.light[s - 1].is_mirror() && self.walker.plan.strategies.plans(s, t) {
                self.propose(paths, s);
            }
        }
        let total: f32 = paths.proposals.iter().map(|proposal| proposal.size).sum();
        let mut left = match paths.proposals.len() {
            0 => return,
            1 => 0.0,
            _ => self.walker.sampler.single(Stream::Visibility, t as u32) * total,
        };
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
        let kept = size / total;
        put(&Contribution { estimate: contribution.estimate * (1.0 / kept), kept, ..*contribution });
    }

    fn propose(&self, paths: &mut Subpaths, s: usize) {
        let walker = &self.walker;
        let t = paths.eye.len();
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
        let contribution = self.judged(paths, &joint, Found::here(estimate));
        let size = contribution.estimate.mean() * contribution.weight;
        if size > 0.0 {
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
        let choice = walker.sampler.fine(Stream::LightChoice, name);
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
        let aperture = self.eye.has_aperture();
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
        Contribution { s, t, estimate, weight: judged.weight as f32, position, end, kept: 1.0 }
    }
}

/// What a joint adds to the densities that both subpaths keep.
#[derive(Clone, Copy, Debug)]
struct Fresh {
    /// Density from the eye of the last vertex from the light.
    light_last: AreaPdf,
    /// Density from the eye of the one before it.
    light_before: AreaPdf,
    /// Density from the light of the last vertex from the eye.
    eye_last: AreaPdf,
    /// Density from the light of the one before it.
    eye_before: AreaPdf,
}

impl Default for Fresh {
    fn default() -> Self {
        let none = AreaPdf::ZERO;
        Self { light_last: none, light_before: none, eye_last: none, eye_before: none }
    }
}

/// Where two subpaths are joined.
#[derive(Clone, Copy, Debug)]
struct Joint {
    s: usize,
    t: usize,
    /// Density of the light's vertex where its neighbour asks for it.
    asked: f64,
    /// Density of the light's vertex where a subpath starts from it.
    started: f64,
    fresh: Fresh,
    /// The vertex on the lens that light has met, for t = 0.
    lens: Option<Known>,
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

impl Joint {
    /// The weight from the sums that the walks have kept; not a number where those do not
    /// suffice.
    #[inline]
    fn quick_weight(&self, paths: &Subpaths, eye: &Eye<'_>, strategies: &Strategies) -> f64 {
        let light = self.light_side(paths, strategies).sum();
        let mut eye = self.eye_side(paths, eye, strategies).sum();
        if self.s == 1 {
            eye *= (self.started / self.asked).powi(2);
        }
        1.0 / (1.0 + light + eye)
    }

    /// Share of a strategy that is listed and joins no delta.
    #[inline]
    fn share(&self, strategies: &Strategies, s: usize, joins: bool) -> f64 {
        if !joins || !strategies.plans(s, self.s + self.t - s) {
            0.0
        } else if s == 1 && self.s != 1 {
            (self.asked / self.started).powi(2)
        } else {
            1.0
        }
    }

    #[inline]
    fn light_side(&self, paths: &Subpaths, strategies: &Strategies) -> Side {
        let Self { s, fresh, .. } = self;
        let mut side = Side::default();
        if *s == 0 {
            return side;
        }
        let walk = &paths.light;
        let drawn = match (&self.lens, s) {
            (Some(lens), _) => lens.light.hero(),
            (None, 1) => self.asked,
            (None, _) => walk[s - 1].forward.hero(),
        };
        side.last_share = self.share(strategies, s - 1, *s == 1 || !walk[s - 2].is_delta);
        if side.last_share == 0.0 && !strategies.joins_both_ways() {
            return side;
        }
        side.last = fresh.light_last.hero() / drawn;
        if *s > 1 && strategies.joins_both_ways() {
            side.before = fresh.light_before.hero() / walk[s - 2].forward.hero();
            let joins = *s == 2 || !walk[s - 2].is_delta && !walk[s - 3].is_delta;
            side.before_share = self.share(strategies, s - 2, joins);
            side.given_away = if *s > 2 { walk[s - 3].given_away } else { 0.0 };
        }
        side
    }

    #[inline]
    fn eye_side(&self, paths: &Subpaths, eye: &Eye<'_>, strategies: &Strategies) -> Side {
        let Self { s, t, fresh, .. } = self;
        let mut side = Side::default();
        if *t == 0 {
            return side;
        }
        let walk = &paths.eye;
        let drawn = if *t == 1 { eye.pdf_area() } else { walk[t - 1].forward.hero() };
        side.last_share = self.share(strategies, s + 1, *t == 1 || !walk[t - 2].is_delta);
        if side.last_share == 0.0 && !strategies.joins_both_ways() {
            return side;
        }
        side.last = fresh.eye_last.hero() / drawn;
        if *t > 1 && strategies.joins_both_ways() {
            side.before = fresh.eye_before.hero() / walk[t - 2].forward.hero();
            let joins = *t == 2 || !walk[t - 2].is_delta && !walk[t - 3].is_delta;
            side.before_share = self.share(strategies, s + 2, joins);
            side.given_away = if *t > 2 { walk[t - 3].given_away } else { 0.0 };
        }
        side
    }
}

impl Subpaths {
    /// Forgets both subpaths.
    pub fn clear(&mut self) {
        self.light.clear();
        self.eye.clear();
    }

    /// A joint of a subpath from a light that was walked.
    fn joint(&self, s: usize, t: usize, fresh: Fresh, lens: Option<Known>) -> Joint {
        Joint { s, t, asked: self.asked, started: self.light[0].forward.hero(), fresh, lens }
    }

    /// Collects what weights need of the vertices, numbered from the light; those beyond what
    /// any strategy differs by may be missing.
    fn gather(&mut self, joint: &Joint, eye: &Eye<'_>, strategies: &Strategies) {
        let Joint { s, t, fresh, .. } = *joint;
        let open = |density: f64| Known {
            light: AreaPdf::of_all_lanes(density),
            eye: AreaPdf::of_all_lanes(density),
            lanes: Spectrum::ONE,
            is_delta: false,
        };
        self.known.clear();
        if s == 1 {
            self.known.push(open(joint.started));
        }
        let walked = if joint.lens.is_some() { s - 1 } else { s };
        for vertex in self.light.iter().take(if s == 1 { 0 } else { walked }) {
            self.known.push(Known {
                light: vertex.forward,
                eye: vertex.reverse,
                lanes: vertex.lanes,
                is_delta: vertex.is_delta,
            });
        }
        self.known.extend(joint.lens);
        let (_, most) = strategies.span(s + t);
        let wanted = (most + 1).saturating_sub(self.known.len());
        for vertex in self.eye.iter().take(if t == 1 { 0 } else { t }).rev().take(wanted) {
            self.known.push(Known {
                light: vertex.reverse,
                eye: vertex.forward,
                lanes: vertex.lanes,
                is_delta: vertex.is_delta,
            });
        }
        if t == 1 {
            self.known.push(open(eye.pdf_area()));
        }
        if let Some(last) = s.checked_sub(1) {
            self.known[last].eye = fresh.light_last;
            self.known[last].is_delta = false;
        }
        if let Some(before) = s.checked_sub(2) {
            self.known[before].eye = fresh.light_before;
        }
        if let Some(last) = self.known.get_mut(s) {
            last.light = fresh.eye_last;
            last.is_delta = false;
        }
        if let Some(before) = self.known.get_mut(s + 1) {
            before.light = fresh.eye_before;
        }
    }
}
