//! A complete path judged from its vertices alone, slowly and without memory.
//!
//! Value and densities follow from positions, normals and materials, whoever made the path.
//! What the walks and joins multiply up on their way is held against this.

use super::eye::Eye;
use super::strategies::Strategies;
use super::vertex::{Kind, Vertex};
use crate::geometry::SurfacePoint;
use crate::material::Quantity;
use crate::measure::solid_angle_per_area;
use crate::scene::Scene;
use crate::spectrum::{LANES, Spectrum, Wavelengths};
use glam::Vec3A;

/// A complete path: its vertices from the light to the eye, the first of them a light's.
///
/// Of each vertex only point, kind and the delta flag are used; media that absorb are not
/// looked at.
#[derive(Clone)]
pub struct Whole<'a, 'e> {
    scene: &'a Scene,
    eye: &'e Eye<'a>,
    wavelengths: Wavelengths,
    vertices: Vec<Vertex>,
    light: u32,
    primitive: Option<u32>,
}

/// Logarithm of a density for each lane; minus infinity where it is zero.
type Logarithms = [f64; LANES];

impl<'a, 'e> Whole<'a, 'e> {
    /// A path from its vertices; `None` where the first belongs to no light.
    pub fn new(
        scene: &'a Scene,
        eye: &'e Eye<'a>,
        wavelengths: &Wavelengths,
        vertices: Vec<Vertex>,
    ) -> Option<Self> {
        let (light, primitive) = match vertices.first()?.kind {
            Kind::Light { light, primitive } => (light, primitive),
            Kind::Surface(surface) => (surface.light?, Some(surface.primitive)),
            Kind::Eye { .. } => return None,
        };
        Some(Self { scene, eye, wavelengths: *wavelengths, vertices, light, primitive })
    }

    fn count(&self) -> usize {
        self.vertices.len()
    }

    fn point(&self, index: usize) -> &SurfacePoint {
        &self.vertices[index].point
    }

    fn direction(&self, from: usize, to: usize) -> Vec3A {
        let span = self.point(to).position.as_dvec3() - self.point(from).position.as_dvec3();
        span.normalize_or_zero().as_vec3a()
    }

    /// |cos| at `to` over squared distance; zero for points without area.
    fn per_area(&self, from: usize, to: usize) -> f64 {
        if to == 0 && self.primitive.is_none() || to + 1 == self.count() && !self.eye.has_aperture() {
            return 0.0;
        }
        solid_angle_per_area(self.point(from).position, self.point(to).position, self.point(to).normal)
    }

    fn squared_distance(&self, a: usize, b: usize) -> f64 {
        (self.point(a).position.as_dvec3() - self.point(b).position.as_dvec3()).length_squared()
    }

    /// Scattering at a vertex from one neighbour to the other: value with the shading cosine
    /// towards `to`, and density; both in the measure of deltas where the vertex is one.
    fn scattered(
        &self,
        from: usize,
        at: usize,
        to: usize,
        quantity: Quantity,
    ) -> Option<(Spectrum, Spectrum, f64)> {
        let mut vertex = self.vertices[at];
        let surface = *vertex.surface()?;
        vertex.to_previous = self.direction(at, from);
        let direction = self.direction(at, to);
        let wo = surface.shading.to_local(vertex.to_previous);
        let wi = surface.shading.to_local(direction);
        if !vertex.is_delta {
            let both = vertex.scatter(direction, quantity);
            return Some((both.value, both.pdf, 1.0));
        }
        // The last number below one chooses transmission wherever there is some.
        let crosses = wo.z * wi.z < 0.0;
        let u_lobe = if crosses { 1.0 - f32::EPSILON / 2.0 } else { 0.0 };
        let drawn = surface.bsdf.sample(wo, u_lobe, [0.5; 2], quantity)?;
        let mut value = drawn.value;
        if quantity == Quantity::Importance {
            value *= vertex.adjoint_factor(direction);
        }
        (drawn.is_transmission == crosses)
            .then(|| (value, drawn.pdf, f64::from(surface.bsdf.delta_measure(wi))))
    }

    /// Radiance times the eye's response along the path over its density in area: per lane.
    ///
    /// Deltas are in their own measure, so that the value over a density from
    /// [`Self::density`] is an estimate.
    pub fn value(&self) -> Option<[f64; LANES]> {
        let last = self.count() - 1;
        let emission = self.scene.lights.get(self.light).emission(&self.wavelengths);
        let mut value = emission.0.map(f64::from);
        value = value.map(|v| v * self.emitted_share());
        for at in 1..last {
            let (scattered, _, delta) = self.scattered(at + 1, at, at - 1, Quantity::Radiance)?;
            // The shading cosine towards the light stands in for the true one.
            let geometry = delta * self.cosine(at - 1, at) / self.squared_distance(at - 1, at);
            (0..LANES).for_each(|lane| value[lane] *= f64::from(scattered[lane]) * geometry);
        }
        let sight = self.eye.sees(self.point(last), self.direction(last, last - 1))?;
        // W cos: response times both densities of the eye; its cosine is in the geometry.
        let seen = f64::from(self.eye.response()) * sight.pdf_solid_angle * self.eye.pdf_area();
        let geometry = self.cosine(last - 1, last) / self.squared_distance(last - 1, last);
        Some(value.map(|v| v * seen * geometry))
    }

    /// Cosine at a vertex towards another; one for a point light, whose intensity knows none.
    fn cosine(&self, at: usize, towards: usize) -> f64 {
        if at == 0 && self.primitive.is_none() {
            return 1.0;
        }
        f64::from(self.point(at).normal.dot(self.direction(at, towards)).abs())
    }

    /// What the light sends along the path, relative to its emission; the cosine apart.
    fn emitted_share(&self) -> f64 {
        let light = self.scene.lights.get(self.light);
        let direction = self.direction(0, 1);
        match light {
            crate::light::Light::Point(point) => f64::from(point.distribution.towards(direction)),
            crate::light::Light::Area(area) => {
                f64::from(u8::from(area.shines(self.point(0).normal, direction)))
            }
        }
    }

    /// Logarithm of the density with which a strategy makes the path, for each lane as hero.
    pub fn density(&self, from_light: usize) -> Logarithms {
        let count = self.count();
        let mut sum = [0.0; LANES];
        let mut multiply = |lanes: Spectrum, factor: f64| {
            (0..LANES).for_each(|lane| sum[lane] += (f64::from(lanes[lane]) * factor).ln());
        };
        for index in 0..from_light {
            let (lanes, factor) = self.drawn_from_light(index, from_light);
            multiply(lanes, factor);
        }
        for index in from_light..count {
            let (lanes, factor) = self.drawn_from_eye(index);
            multiply(lanes, factor);
        }
        sum
    }

    /// Densities for the hero of every vertex, for a walk from the light and for one from the
    /// eye; and that of the light's vertex where its neighbour asks for it.
    pub fn vertex_densities(&self) -> (Vec<[f64; 2]>, f64) {
        let hero = |(lanes, factor): (Spectrum, f64)| f64::from(lanes.hero()) * factor;
        let each = |index: usize| {
            [hero(self.drawn_from_light(index, self.count())), hero(self.drawn_from_eye(index))]
        };
        ((0..self.count()).map(each).collect(), hero(self.drawn_from_light(0, 1)))
    }

    /// Density of a vertex for a subpath of `vertices` from the light.
    fn drawn_from_light(&self, index: usize, vertices: usize) -> (Spectrum, f64) {
        let lights = &self.scene.lights;
        let light = lights.get(self.light);
        match index {
            0 if vertices == 1 => {
                let from = self.point(1);
                let probability = lights.probability_towards(from.position, self.light);
                let Some(primitive) = self.primitive else { return (Spectrum::ONE, probability) };
                let towards = light.pdf_towards(&self.scene.geometry, from, self.point(0), primitive);
                (Spectrum::ONE, probability * f64::from(towards) * self.per_area(1, 0))
            }
            0 => (Spectrum::ONE, lights.probability_emitting(self.light) * light.pdf_area()),
            1 => {
                let density = light.pdf_emission(self.point(0).normal, self.direction(0, 1));
                (Spectrum::ONE, density * self.per_area(0, 1))
            }
            _ => self.drawn(index - 2, index - 1, index, Quantity::Importance),
        }
    }

    /// Density of a vertex for a subpath from the eye.
    fn drawn_from_eye(&self, index: usize) -> (Spectrum, f64) {
        let last = self.count() - 1;
        if index == last {
            return (Spectrum::ONE, self.eye.pdf_area());
        }
        if index + 1 == last {
            let sight = self.eye.sees(self.point(last), self.direction(last, index));
            let density = sight.map_or(0.0, |sight| sight.pdf_solid_angle);
            return (Spectrum::ONE, density * self.per_area(last, index));
        }
        self.drawn(index + 2, index + 1, index, Quantity::Radiance)
    }

    fn drawn(&self, from: usize, at: usize, to: usize, quantity: Quantity) -> (Spectrum, f64) {
        match self.scattered(from, at, to, quantity) {
            Some((_, pdf, delta)) => (pdf, delta * self.per_area(at, to)),
            None => (Spectrum::ZERO, 0.0),
        }
    }

    /// Whether light is scattered at a vertex by a Dirac delta.
    pub fn is_delta(&self, index: usize) -> bool {
        self.vertices[index].is_delta
    }

    /// Whether a strategy of a list can make the path at all.
    pub fn is_made_by(&self, strategies: &Strategies, from_light: usize) -> bool {
        let count = self.count();
        let joins = from_light > 0 && from_light < count;
        let deltas = joins && (self.vertices[from_light - 1].is_delta || self.vertices[from_light].is_delta);
        !deltas
            && strategies.plans(from_light, count - from_light)
            && mean(&self.density(from_light)) > f64::NEG_INFINITY
    }

    /// Weights of all strategies of a list by the power heuristic, by number of vertices from
    /// the light.
    pub fn weights(&self, strategies: &Strategies) -> Vec<f64> {
        let logarithms: Vec<f64> = (0..=self.count())
            .map(|s| if self.is_made_by(strategies, s) { mean(&self.density(s)) } else { f64::NEG_INFINITY })
            .collect();
        let largest = logarithms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let squares: Vec<f64> = logarithms.iter().map(|ln| (2.0 * (ln - largest)).exp()).collect();
        let sum: f64 = squares.iter().sum();
        squares.iter().map(|square| square / sum).collect()
    }

    /// The estimate of a strategy: value over the mean density of the lanes.
    pub fn estimate(&self, from_light: usize) -> Option<[f64; LANES]> {
        let density = mean(&self.density(from_light));
        Some(self.value()?.map(|v| (v.ln() - density).exp()))
    }
}

/// Logarithm of the mean over lanes.
fn mean(logarithms: &Logarithms) -> f64 {
    let largest = logarithms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if largest == f64::NEG_INFINITY {
        return largest;
    }
    largest + (logarithms.iter().map(|ln| (ln - largest).exp()).sum::<f64>() / LANES as f64).ln()
}
