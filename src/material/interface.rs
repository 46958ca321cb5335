//! The boundary between two transparent media, at the wavelengths of one path.

use super::fresnel::{self, Shares};
use crate::spectrum::{LANES, Spectrum};

/// The relative refractive index of a boundary, kept as its excess over one so that media
/// that nearly match keep their full relative precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface {
    /// n_inside / n_outside - 1.
    excess: Spectrum,
}

impl Interface {
    /// From the relative index n_inside / n_outside, all lanes positive.
    pub fn new(eta: Spectrum) -> Self {
        Self::from_excess(eta.map(|eta| eta - 1.0))
    }

    /// From n_inside / n_outside - 1, all lanes greater than -1.
    pub fn from_excess(excess: Spectrum) -> Self {
        debug_assert!(excess.0.iter().all(|&e| e > -1.0), "refractive indices are positive");
        Self { excess }
    }

    /// From the indices of the media on both sides, all positive.
    pub fn between(inside: [f64; LANES], outside: [f64; LANES]) -> Self {
        let excess_of = |lane: usize| ((inside[lane] - outside[lane]) / outside[lane]) as f32;
        Self::from_excess(Spectrum::from_fn(excess_of))
    }

    /// The relative index of the far side, as seen from the side of `wo`.
    pub(super) fn seen_from(self, outside: bool) -> Self {
        if outside { self } else { Self { excess: self.excess.map(|e| -e / (1.0 + e)) } }
    }

    /// Relative index of the far side minus one.
    pub fn excess(&self) -> Spectrum {
        self.excess
    }

    /// Relative index of the far side.
    pub(super) fn eta(&self, lane: usize) -> f32 {
        1.0 + self.excess[lane]
    }

    /// eta^2 - 1, without cancellation.
    pub(super) fn eta_squared_minus_one(&self, lane: usize) -> f32 {
        self.excess[lane] * (2.0 + self.excess[lane])
    }

    /// Whether all wavelengths are refracted into the same direction.
    pub(super) fn is_flat(&self) -> bool {
        self.excess.is_flat()
    }

    /// Reflected and transmitted shares of one lane.
    #[inline]
    pub(super) fn shares(&self, lane: usize, cos_i: f32) -> Shares {
        fresnel::dielectric(f64::from(cos_i), f64::from(self.excess[lane]))
    }
}
