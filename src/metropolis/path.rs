//! The state of a chain: a complete path, and what follows for changing it.
//!
//! Vertices are numbered from the light. All that acceptance needs follows from positions,
//! normals and materials, whoever made the path ([`Path::judge`]): what it contributes, and the
//! density of each vertex as seen from either end. Dirac deltas stand by their coefficients, in
//! the measure n^2 |cos| dw (see [`crate::measure`]), and cancel between contribution and
//! density.

use super::node::Node;
use crate::spectrum::{LANES, Spectrum, Wavelengths};
use glam::Vec3A;

/// Logarithm of a density for each lane as hero; the hero's alone where lanes do not differ.
pub type Logarithms = [f64; LANES];

/// What scattering at a vertex between its neighbours comes to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scattering {
    /// Radiance from the light's side to the eye's: f |cos|, or the coefficient of a delta in
    /// its measure.
    pub(super) value: Spectrum,
    /// Density in sr^-1 of going on to the light's side for a walk from the eye.
    pub(super) to_light: Spectrum,
    /// Density in sr^-1 of going on to the eye's side for a walk from the light.
    pub(super) to_eye: Spectrum,
    /// What brings the delta's coefficients to their measure, on either side; 1 otherwise.
    pub(super) measure: [f64; 2],
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
    /// Whether its worth was not a number when it was judged.
    pub(super) is_faulty: bool,
    /// Logarithm of the target function, in the unit of [`super::World::light_unit`].
    pub ln_target: f64,
    /// Logarithm of the density with which a fresh path is this one, for the hero.
    pub ln_fresh: f64,
    /// Unit directions from each vertex to the next.
    pub(super) directions: Vec<Vec3A>,
    /// |cos| / d^2 at each vertex as seen from the next one, and at the next one as seen from
    /// this; zero for points without area.
    pub(super) per_area: Vec<[f64; 2]>,
    pub(super) scatterings: Vec<Option<Scattering>>,
    /// Density of each vertex for walks from the light and from the eye.
    pub(super) from_light: Vec<Logarithms>,
    pub(super) from_eye: Vec<Logarithms>,
    /// Density of the first vertex where the second asks for it.
    pub(super) asked: f64,
    /// Density with which each strategy makes the path, by vertices from the light.
    pub(super) strategies: Vec<Logarithms>,
    /// Counted vertices before each one, and all of them at the end.
    pub(super) counted: Vec<usize>,
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
            is_faulty: false,
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

    /// Whether a judgement since the last time of asking was not a number.
    pub fn take_fault(&mut self) -> bool {
        std::mem::take(&mut self.is_faulty)
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

    /// What scatters at a vertex towards the eye, once the path has been judged that far: f |cos|,
    /// or the coefficient of a delta.
    pub fn scattering_value(&self, index: usize) -> Option<Spectrum> {
        Some(self.scatterings.get(index)?.as_ref()?.value)
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

    /// Logarithm of the target over the density of a fresh path: what such a path estimates.
    pub fn ln_estimate(&self) -> f64 {
        self.ln_target - self.ln_fresh
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
