//! The state of a chain: a complete path, judged from its vertices alone.
//!
//! Vertices are numbered from the light. All that acceptance needs follows from positions,
//! normals and materials, whoever made the path: what it contributes, and the density of each
//! vertex as seen from either end. Dirac deltas stand by their coefficients, in the measure
//! n^2 |cos| dw (see [`crate::measure`]), and cancel between contribution and density.

use super::grow::{SURE_VERTICES, SURVIVAL};
use super::world::World;
use crate::geometry::SurfacePoint;
use crate::light::Light;
use crate::material::Quantity;
use crate::path::{Kind, Surface, transmittance};
use crate::spectrum::{LANES, Spectrum, Wavelengths};
use glam::Vec3A;

/// A vertex of a complete path.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// Where it is.
    pub point: SurfacePoint,
    /// What is there; the first vertex of a path is always a light, the last always the eye.
    pub kind: Kind,
    /// Whether the path goes on from here by a Dirac delta.
    pub is_delta: bool,
}

impl Node {
    /// A point of the eye.
    pub const fn eye(point: SurfacePoint, has_area: bool) -> Self {
        Self { point, kind: Kind::Eye { has_area }, is_delta: false }
    }

    /// A point of a light.
    pub const fn light(point: SurfacePoint, light: u32, primitive: Option<u32>) -> Self {
        Self { point, kind: Kind::Light { light, primitive }, is_delta: false }
    }

    /// The surface, unless the vertex is an end.
    pub const fn surface(&self) -> Option<&Surface> {
        match &self.kind {
            Kind::Surface(surface) => Some(surface),
            Kind::Eye { .. } | Kind::Light { .. } => None,
        }
    }

    /// Whether nothing can be joined to the vertex.
    pub fn is_mirror(&self) -> bool {
        self.surface().is_some_and(|surface| surface.bsdf.is_delta())
    }

    /// Whether fresh paths count the vertex: not a mirror, unless it shines by itself.
    pub fn counts(&self) -> bool {
        !self.is_mirror() || self.surface().is_some_and(|surface| surface.light.is_some())
    }

    /// The vertex as the end of a path that has met a light; `None` where nothing shines.
    pub fn as_light(&self) -> Option<Self> {
        let surface = self.surface()?;
        Some(Self::light(self.point, surface.light?, Some(surface.primitive)))
    }
}

/// Logarithm of a density for each lane as hero; the hero's alone where lanes do not differ.
pub type Logarithms = [f64; LANES];

/// What scattering at a vertex between its neighbours comes to.
#[derive(Clone, Copy, Debug)]
struct Scattering {
    /// Radiance from the light's side to the eye's: f |cos|, or the coefficient of a delta in
    /// its measure.
    value: Spectrum,
    /// Density in sr^-1 of going on to the light's side for a walk from the eye.
    to_light: Spectrum,
    /// Density in sr^-1 of going on to the eye's side for a walk from the light.
    to_eye: Spectrum,
    /// What brings the delta's coefficients to their measure, on either side; 1 otherwise.
    measure: [f64; 2],
}

/// A complete path and what it is worth.
#[derive(Clone, Debug)]
pub struct Path {
    /// The vertices from the light to the eye.
    pub nodes: Vec<Node>,
    /// The number that the wavelengths were drawn with.
    pub u_wavelength: f32,
    /// The wavelengths.
    pub wavelengths: Wavelengths,
    /// Where in the picture, in pixels.
    pub position: [f64; 2],
    /// What each channel records, over the target function.
    pub channels: Vec<f64>,
    /// Logarithm of the target function.
    pub ln_target: f64,
    /// Logarithm of the density with which a fresh path is this one, for the hero.
    pub ln_fresh: f64,
    /// Unit directions from each vertex to the next.
    directions: Vec<Vec3A>,
    /// |cos| / d^2 at each vertex as seen from the next one, and at the next one as seen from
    /// this; zero for points without area.
    per_area: Vec<[f64; 2]>,
    scatterings: Vec<Option<Scattering>>,
    /// Density of each vertex for walks from the light and from the eye.
    from_light: Vec<Logarithms>,
    from_eye: Vec<Logarithms>,
    /// Density of the first vertex where the second asks for it.
    asked: f64,
    /// Density with which each strategy makes the path, by vertices from the light.
    strategies: Vec<Logarithms>,
    /// Counted vertices before each one, and all of them at the end.
    counted: Vec<usize>,
}

/// Which of the two sides of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Towards the light.
    Light,
    /// Towards the eye.
    Eye,
}

impl Path {
    /// No path yet.
    pub fn empty(wavelengths: Wavelengths) -> Self {
        Self {
            nodes: Vec::new(),
            u_wavelength: 0.0,
            wavelengths,
            position: [0.0; 2],
            channels: Vec::new(),
            ln_target: f64::NEG_INFINITY,
            ln_fresh: f64::NEG_INFINITY,
            directions: Vec::new(),
            per_area: Vec::new(),
            scatterings: Vec::new(),
            from_light: Vec::new(),
            from_eye: Vec::new(),
            asked: f64::NEG_INFINITY,
            strategies: Vec::new(),
            counted: Vec::new(),
        }
    }

    /// Number of vertices.
    pub const fn count(&self) -> usize {
        self.nodes.len()
    }

    /// Number of counted vertices, and of those among the first `s`.
    pub fn counted(&self, s: usize) -> (usize, usize) {
        (self.counted[self.count()], self.counted[s])
    }

    /// Takes over vertices and wavelengths of another path, unjudged.
    pub fn copy_nodes(&mut self, other: &Self) {
        self.nodes.clone_from(&other.nodes);
        self.u_wavelength = other.u_wavelength;
        self.wavelengths = other.wavelengths;
    }

    /// Whether a vertex scatters by a delta.
    pub fn is_delta(&self, index: usize) -> bool {
        self.nodes[index].is_delta
    }

    /// Unit direction from a vertex to its neighbour.
    pub fn direction(&self, index: usize, towards: End) -> Vec3A {
        match towards {
            End::Eye => self.directions[index],
            End::Light => -self.directions[index - 1],
        }
    }

    /// Whether the path goes through the surface at a vertex.
    pub fn crosses(&self, index: usize) -> bool {
        let normal = self.nodes[index].surface().map_or(Vec3A::ZERO, |surface| surface.shading.normal);
        normal.dot(self.direction(index, End::Light)) * normal.dot(self.direction(index, End::Eye)) < 0.0
    }

    /// Logarithm of the density with which a strategy makes the path, for the hero.
    pub fn ln_strategy(&self, s: usize) -> f64 {
        self.strategies[s][0]
    }

    /// Logarithm of the density, for the hero, of the vertices from `first` up to `last` where
    /// all others are given and a strategy of `s` vertices from the light makes them.
    pub fn ln_between(&self, first: usize, last: usize, s: usize) -> f64 {
        if !self.joins(s) {
            return f64::NEG_INFINITY;
        }
        let drawn = |index: usize| {
            if index >= s {
                self.from_eye[index][0]
            } else if s == 1 {
                self.asked
            } else {
                self.from_light[index][0]
            }
        };
        (first..last).map(drawn).sum()
    }

    /// Whether the subpaths of a strategy can be joined: no delta at either end of the joint.
    pub fn joins(&self, s: usize) -> bool {
        s == 0 || s == self.count() || !self.nodes[s - 1].is_delta && !self.nodes[s].is_delta
    }

    /// Logarithm of the density of the vertices from `first` to the one before the eye, for a
    /// ray that is moved in the picture or turned at a vertex and else follows the deltas.
    pub fn ln_moved_from_eye(&self, first: usize) -> f64 {
        let last = self.count() - 1;
        (first..last)
            .map(|index| {
                let measure = match &self.scatterings[index + 1] {
                    Some(scattering) if self.is_delta(index + 1) => scattering.measure[0].ln(),
                    _ if index + 1 == last => self.from_eye[index][0] - self.per_area[index][0].ln(),
                    _ => 0.0,
                };
                measure + self.per_area[index][0].ln()
            })
            .sum()
    }

    /// Logarithm of the density of the vertices after `given` up to the one before the eye, for
    /// a ray that is turned at the given one and else follows the deltas towards the eye.
    pub fn ln_moved_from_light(&self, given: usize) -> f64 {
        (given + 1..self.count() - 1)
            .map(|index| {
                let measure = match &self.scatterings[index - 1] {
                    Some(scattering) if self.is_delta(index - 1) => scattering.measure[1].ln(),
                    _ => 0.0,
                };
                measure + self.per_area[index - 1][1].ln()
            })
            .sum()
    }

    /// Whether the eye sees the light straight or over smooth surfaces, or sees there a surface
    /// that the light shines on straight: what is left to standard sampling.
    fn is_direct(&self) -> bool {
        let rough = (1..self.count() - 1).filter(|index| !self.is_delta(*index));
        let meets = matches!(self.nodes[0].kind, Kind::Light { primitive: Some(_), .. }) || self.count() == 2;
        let mut rough = rough.peekable();
        match rough.next() {
            None => meets,
            Some(first) => first == 1 && rough.peek().is_none(),
        }
    }

    /// Judges the path; false where a chain has nothing to do with it: it carries nothing, is
    /// direct light, or cannot be made afresh.
    pub fn judge(&mut self, world: &World<'_>) -> bool {
        self.ln_target = f64::NEG_INFINITY;
        if self.count() < 3 || self.is_direct() {
            return false;
        }
        self.measure(world);
        let last = self.count() - 1;
        let sight = world.eye.sees(&self.nodes[last].point, self.direction(last, End::Light));
        let Some(sight) = sight else { return false };
        self.position = sight.position;
        let lanes = world.lanes();
        if !self.scatter() {
            return false;
        }
        let Some((value, ln_value)) = self.value(world, sight.pdf_solid_angle) else { return false };
        self.densities(world, sight.pdf_solid_angle, lanes);
        self.combine(world, lanes);
        let fresh = &self.strategies_together(world, lanes);
        let mean = mean(&fresh[..lanes]);
        self.ln_fresh = fresh[0];
        // All wavelengths of a path count, weighed by the density that each would have made the
        // path with (Wilkie et al. 2014): the rest is what one fresh path estimates.
        self.channels.clear();
        let mut total = 0.0;
        let channels = &mut self.channels;
        world.sensor.record(value, &self.wavelengths, |channel, recorded| {
            total += recorded.abs() * world.weights[channel];
            channels.push(recorded);
        });
        self.ln_target = total.ln() + ln_value + fresh[0] - mean;
        self.channels.iter_mut().for_each(|channel| *channel /= total);
        self.ln_target.is_finite() && self.ln_fresh.is_finite()
    }

    /// Logarithm of the target over the density of a fresh path: what such a path estimates.
    pub fn ln_estimate(&self) -> f64 {
        self.ln_target - self.ln_fresh
    }

    /// Lengths and directions between the vertices.
    fn measure(&mut self, world: &World<'_>) {
        self.directions.clear();
        self.per_area.clear();
        let last = self.count() - 1;
        for (index, pair) in self.nodes.windows(2).enumerate() {
            let [from, to] = [pair[0].point, pair[1].point];
            let span = to.position.as_dvec3() - from.position.as_dvec3();
            let squared = span.length_squared();
            let direction = span / squared.sqrt();
            let cosine = |point: &SurfacePoint| point.normal.as_dvec3().dot(direction).abs() / squared;
            let meets_light = index > 0 || matches!(pair[0].kind, Kind::Light { primitive: Some(_), .. });
            let meets_eye = index + 1 < last || world.eye.has_aperture();
            let or_zero = |meets: bool, value: f64| if meets { value } else { 0.0 };
            self.per_area.push([or_zero(meets_light, cosine(&from)), or_zero(meets_eye, cosine(&to))]);
            self.directions.push(direction.as_vec3a());
        }
    }

    /// Scattering at every vertex between the ends; false where one of them is black.
    fn scatter(&mut self) -> bool {
        self.scatterings.clear();
        self.scatterings.push(None);
        for index in 1..self.count() - 1 {
            let Some(scattering) = self.scattering(index) else { return false };
            if scattering.value.is_black() {
                return false;
            }
            self.scatterings.push(Some(scattering));
        }
        self.scatterings.push(None);
        true
    }

    fn scattering(&self, index: usize) -> Option<Scattering> {
        let node = &self.nodes[index];
        let surface = node.surface()?;
        let (light, eye) = (self.direction(index, End::Light), self.direction(index, End::Eye));
        if !surface.sides_agree(&node.point, light) || !surface.sides_agree(&node.point, eye) {
            return None;
        }
        let (light, eye) = (surface.shading.to_local(light), surface.shading.to_local(eye));
        if !node.is_delta {
            let both = surface.bsdf.evaluate(eye, light, Quantity::Radiance);
            let to_eye = surface.bsdf.pdf(light, eye, Quantity::Importance);
            return Some(Scattering { value: both.value, to_light: both.pdf, to_eye, measure: [1.0; 2] });
        }
        let crosses = light.z * eye.z < 0.0;
        let u_lobe = super::grow::lobe_number(crosses);
        let drawn = surface.bsdf.sample(eye, u_lobe, [0.5; 2], Quantity::Radiance)?;
        let back = surface.bsdf.sample(light, u_lobe, [0.5; 2], Quantity::Importance)?;
        let measure = [light, eye].map(|w| f64::from(surface.bsdf.delta_measure(w)));
        let is_this =
            |drawn: &crate::material::BsdfSample| drawn.is_delta && drawn.is_transmission == crosses;
        (is_this(&drawn) && is_this(&back)).then_some(Scattering {
            value: drawn.value,
            to_light: drawn.pdf,
            to_eye: back.pdf,
            measure,
        })
    }

    /// Radiance times the eye's response along the path, over a factor of which the logarithm
    /// comes with it; `None` where it is nothing.
    fn value(&self, world: &World<'_>, sight_pdf: f64) -> Option<(Spectrum, f64)> {
        let last = self.count() - 1;
        let Kind::Light { light, .. } = self.nodes[0].kind else { return None };
        let light = world.scene.lights.get(light);
        let share = match light {
            Light::Point(point) => f64::from(point.distribution.towards(self.directions[0])),
            Light::Area(area) => {
                f64::from(u8::from(area.shines(self.nodes[0].point.normal, self.directions[0])))
            }
        };
        let mut value = light.emission(&self.wavelengths);
        let mut ln = (share * f64::from(world.eye.response()) * sight_pdf * world.eye.pdf_area()).ln();
        let mut media = world.eye_media;
        for index in (1..=last).rev() {
            let squared = self.squared_distance(index - 1);
            if world.plan.tracks_media {
                if let Some(absorption) = media.absorption(world.scene) {
                    value *= transmittance(absorption, squared.sqrt() as f32, &self.wavelengths);
                }
                self.enter(index - 1, &mut media);
            }
            let mut geometry = self.per_area[index - 1][0];
            if index == 1 && !light.has_surface() {
                geometry = 1.0 / squared;
            }
            if let Some(scattering) = &self.scatterings[index] {
                value *= scattering.value;
                geometry *= scattering.measure[0];
            }
            // Kept near one: long paths and small solid angles leave the range of numbers.
            let largest = value.max();
            if largest <= 0.0 || !largest.is_finite() {
                return None;
            }
            value *= 1.0 / largest;
            ln += (geometry * f64::from(largest)).ln();
        }
        (ln.is_finite() && value.is_finite()).then_some((value, ln))
    }

    fn squared_distance(&self, index: usize) -> f64 {
        let [a, b] = [index, index + 1].map(|i| self.nodes[i].point.position.as_dvec3());
        (b - a).length_squared()
    }

    /// Follows a walk from the eye through the surface at a vertex.
    fn enter(&self, index: usize, media: &mut crate::path::Media) {
        let Some(surface) = self.nodes[index].surface() else { return };
        if index == 0 || !surface.bsdf.transmits() {
            return;
        }
        let normal = self.nodes[index].point.normal;
        let towards = normal.dot(self.direction(index, End::Light));
        if towards * normal.dot(self.direction(index, End::Eye)) < 0.0 {
            media.cross(surface.object, towards < 0.0);
        }
    }

    /// Density of every vertex for walks from both ends.
    fn densities(&mut self, world: &World<'_>, sight_pdf: f64, lanes: usize) {
        let last = self.count() - 1;
        let Kind::Light { light: index, primitive } = self.nodes[0].kind else { return };
        let lights = &world.scene.lights;
        let light = lights.get(index);
        let start = &self.nodes[0].point;
        let same = |density: f64| [density.ln(); LANES];
        self.from_light.clear();
        self.from_light.push(same(lights.probability_emitting(index) * light.pdf_area()));
        let emitted = light.pdf_emission(start.normal, self.directions[0]);
        self.from_light.push(same(emitted * self.per_area[0][1]));
        self.from_eye.clear();
        for at in 1..=last {
            let each = |pdf: &Spectrum, factor: f64| {
                let mut logarithms = [0.0; LANES];
                for (lane, logarithm) in logarithms.iter_mut().enumerate().take(lanes) {
                    *logarithm = (f64::from(pdf[lane]) * factor).ln();
                }
                logarithms
            };
            if let Some(scattering) = &self.scatterings[at] {
                let [to_light, to_eye] = scattering.measure;
                self.from_eye.push(each(&scattering.to_light, to_light * self.per_area[at - 1][0]));
                self.from_light.push(each(&scattering.to_eye, to_eye * self.per_area[at][1]));
            }
        }
        self.from_eye.push(same(sight_pdf * self.per_area[last - 1][0]));
        self.from_eye.push(same(world.eye.pdf_area()));
        for index in SURE_VERTICES..=last {
            let survival = SURVIVAL.ln();
            self.from_light[index].iter_mut().for_each(|ln| *ln += survival);
            self.from_eye[last - index].iter_mut().for_each(|ln| *ln += survival);
        }
        let lit = &self.nodes[1].point;
        let probability = lights.probability_towards(lit.position, index);
        self.asked = match primitive {
            None => probability.ln(),
            Some(primitive) => {
                let towards = light.pdf_towards(&world.scene.geometry, lit, start, primitive);
                (probability * f64::from(towards) * self.per_area[0][0]).ln()
            }
        };
    }

    /// Density of every strategy, from the sums over both walks.
    fn combine(&mut self, world: &World<'_>, lanes: usize) {
        let count = self.count();
        self.counted.clear();
        self.counted.push(0);
        for node in &self.nodes {
            self.counted.push(self.counted[self.counted.len() - 1] + usize::from(node.counts()));
        }
        self.strategies.clear();
        self.strategies.resize(count + 1, [0.0; LANES]);
        for lane in 0..lanes {
            let mut sum = 0.0;
            for s in 0..=count {
                let start = if s == 1 { self.asked } else { sum };
                self.strategies[s][lane] = start;
                if s < count {
                    sum += self.from_light[s][lane];
                }
            }
            let mut sum = 0.0;
            for s in (0..=count).rev() {
                if s < count {
                    sum += self.from_eye[s][lane];
                }
                self.strategies[s][lane] += sum;
            }
        }
        for s in 0..=count {
            if !self.joins(s) || !world.plan.strategies.plans(s, count - s) {
                self.strategies[s] = [f64::NEG_INFINITY; LANES];
            }
        }
    }

    /// Density with which a fresh path is this one, for each lane.
    fn strategies_together(&self, world: &World<'_>, lanes: usize) -> Logarithms {
        let count = self.count();
        let mut together = [f64::NEG_INFINITY; LANES];
        for (lane, ln) in together.iter_mut().enumerate().take(lanes) {
            let terms = (0..=count).map(|s| {
                let (all, from_light) = self.counted(s);
                world.lengths.probability(all, from_light).ln() + self.strategies[s][lane]
            });
            *ln = ln_sum(terms);
        }
        together
    }
}

/// Logarithm of a sum of numbers whose logarithms are given.
pub fn ln_sum(terms: impl Iterator<Item = f64> + Clone) -> f64 {
    let largest = terms.clone().fold(f64::NEG_INFINITY, f64::max);
    if !largest.is_finite() {
        return largest;
    }
    largest + terms.map(|ln| (ln - largest).exp()).sum::<f64>().ln()
}

/// Logarithm of the mean over lanes.
fn mean(logarithms: &[f64]) -> f64 {
    ln_sum(logarithms.iter().copied()) - (logarithms.len() as f64).ln()
}
