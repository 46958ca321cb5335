//! Ground glass: facets that reflect and refract after Fresnel (Walter et al. 2007).
//!
//! All wavelengths stay together: a pair of directions is joined, at each wavelength, by
//! another facet, and each lane has its own value and density. A lane whose media match so
//! well that the refracted lobe is narrower than what directions resolve passes straight
//! through as a delta instead; the lobes know nothing of it.

use glam::{DVec3, Vec3A};

use super::facing::Upright;
use super::ggx::facet_along;
use super::{BsdfSample, BsdfValue, Ggx, Interface, Quantity, SmoothDielectric};
use crate::spectrum::{LANES, Spectrum};

/// Width of the refracted lobe, |n_inside / n_outside - 1| alpha, from which on it is a
/// lobe: a hundred times the rounding of directions in `f32`, two seconds of arc.
const RESOLVED_WIDTH: f32 = 1e-5;

/// GGX facets between transparent media; `+z` is outside.
#[derive(Clone, Copy, Debug)]
pub struct RoughDielectric {
    /// The relative index.
    pub interface: Interface,
    /// How the facets are tilted.
    pub facets: Ggx,
}

impl RoughDielectric {
    /// Whether all lanes pass as deltas.
    pub(super) fn is_delta(&self) -> bool {
        (0..LANES).all(|lane| !self.is_resolved(lane))
    }

    fn is_resolved(&self, lane: usize) -> bool {
        self.interface.excess()[lane].abs() * self.facets.min_alpha() >= RESOLVED_WIDTH
    }

    pub(super) fn evaluate(&self, wo: Vec3A, wi: Vec3A, quantity: Quantity) -> BsdfValue {
        let Some(upright) = Upright::of(wo) else { return BsdfValue::ZERO };
        let seen = self.interface.seen_from(wo.z > 0.0);
        let (wo, wi) = (upright.turn(wo), upright.turn(wi));
        let mut both = if wi.z > 0.0 {
            self.reflection(&seen, wo, wi)
        } else if wi.z < 0.0 {
            self.transmission(&seen, wo, wi, quantity)
        } else {
            BsdfValue::ZERO
        };
        for lane in (0..LANES).filter(|&lane| !self.is_resolved(lane)) {
            (both.value[lane], both.pdf[lane]) = (0.0, 0.0);
        }
        both
    }

    fn reflection(&self, seen: &Interface, wo: Vec3A, wi: Vec3A) -> BsdfValue {
        let Some(reflection) = self.facets.reflection(wo, wi) else { return BsdfValue::ZERO };
        let share = |lane| seen.shares(lane, reflection.cos_facet).reflected as f32;
        let shares = if seen.is_flat() { Spectrum::splat(share(0)) } else { Spectrum::from_fn(share) };
        BsdfValue { value: shares * reflection.value, pdf: shares * reflection.pdf }
    }

    fn transmission(&self, seen: &Interface, wo: Vec3A, wi: Vec3A, quantity: Quantity) -> BsdfValue {
        let shadowing = self.facets.through_over_cos(wo, wi);
        let visible = self.facets.visible_over_density(wo);
        let mut both = BsdfValue::ZERO;
        let is_flat = seen.is_flat();
        for lane in 0..if is_flat { 1 } else { LANES } {
            let Some(crossing) = self.crossing(seen, lane, wo, wi) else { continue };
            let eta_squared = 1.0 + seen.eta_squared_minus_one(lane);
            let value = crossing * shadowing;
            both.value[lane] = match quantity {
                Quantity::Radiance => value,
                Quantity::Importance => value * eta_squared,
            };
            both.pdf[lane] = crossing * visible * eta_squared;
        }
        if is_flat {
            // Without dispersion all wavelengths are joined by one facet.
            (both.value, both.pdf) = (Spectrum::splat(both.value[0]), Spectrum::splat(both.pdf[0]));
        }
        both
    }

    /// What value and density have in common, D T |wo.h| |wi.h| / (wo.h + eta wi.h)^2: both
    /// equations 17 and 21 of Walter et al. with i and o exchanged and n_i = 1.
    fn crossing(&self, seen: &Interface, lane: usize, wo: Vec3A, wi: Vec3A) -> Option<f32> {
        // wo + eta wi, arranged so that media that nearly match do not cancel twice.
        let along = ((wo + wi) + wi * seen.excess()[lane]).normalize_or_zero();
        let h = if along.z < 0.0 { -along } else { along };
        let (cos_o, cos_i) = (wo.dot(h), -wi.dot(h));
        if h.z <= 0.0 || cos_o <= 0.0 || cos_i <= 0.0 {
            return None;
        }
        // wo.h + eta wi.h = cos_o - eta cos_i = (1 - eta^2) / (cos_o + eta cos_i).
        let stretch = seen.eta_squared_minus_one(lane) / (cos_o + seen.eta(lane) * cos_i);
        let transmitted = seen.shares(lane, cos_o).crossing as f32;
        let crossing = self.facets.density(h) * transmitted * cos_o * cos_i / (stretch * stretch);
        crossing.is_finite().then_some(crossing)
    }

    pub(super) fn sample(
        &self,
        wo: Vec3A,
        u_lobe: f32,
        u: [f32; 2],
        quantity: Quantity,
    ) -> Option<BsdfSample> {
        if !self.is_resolved(0) {
            let delta = SmoothDielectric { interface: self.interface };
            let sample = delta.sample(wo, u_lobe, quantity)?;
            return Some(if self.is_delta() { sample } else { sample.for_hero_only() });
        }
        let upright = Upright::of(wo)?;
        let seen = self.interface.seen_from(wo.z > 0.0);
        let above = upright.turn(wo);
        let h = self.facets.sample_visible(above, u);
        let cos_o = above.dot(h);
        let shares = seen.shares(0, cos_o);
        let reflects = u_lobe < shares.reflected as f32 || shares.crossing == 0.0;
        let wi = if reflects {
            2.0 * cos_o * h - above
        } else {
            let m = seen.eta_squared_minus_one(0);
            let q = (cos_o * cos_o + m).max(0.0).sqrt();
            -(above + h * (m / (cos_o + q))) / seen.eta(0)
        };
        if (wi.z > 0.0) != reflects {
            return None;
        }
        let wi = upright.turn(wi);
        BsdfSample::of_lobe(wi, self.evaluate(wo, wi, quantity), !reflects)
    }

    /// The numbers that draw `wi`, a direction of positive density for the hero.
    pub(super) fn invert(&self, wo: Vec3A, wi: Vec3A) -> Option<[f32; 2]> {
        let upright = Upright::of(wo)?;
        Some(self.facets.invert_visible(upright.turn(wo), self.hero_facet(wo, upright, wi)))
    }

    /// Probability of the lobe on the side of `wi`: Fresnel's share for the hero at the facet
    /// between the directions, zero where `wi` is never drawn.
    pub(super) fn lobe_probability(&self, wo: Vec3A, wi: Vec3A, quantity: Quantity) -> f64 {
        if !self.is_resolved(0) {
            return SmoothDielectric { interface: self.interface }.lobe_probability(wo, wi);
        }
        match Upright::of(wo) {
            Some(upright) if self.evaluate(wo, wi, quantity).pdf.hero() > 0.0 => {
                let cos_o = upright.turn(wo).as_dvec3().dot(self.hero_facet(wo, upright, wi));
                self.interface.seen_from(wo.z > 0.0).shares(0, cos_o as f32).of_lobe(wo.z * wi.z)
            }
            _ => 0.0,
        }
    }

    /// The upper side of the facet that joins two directions for the hero.
    fn hero_facet(&self, wo: Vec3A, upright: Upright, wi: Vec3A) -> DVec3 {
        let across = wo.z * wi.z < 0.0;
        let eta =
            if across { 1.0 + f64::from(self.interface.seen_from(wo.z > 0.0).excess().hero()) } else { 1.0 };
        let along = facet_along(upright.turn(wo), upright.turn(wi), eta);
        if along.z < 0.0 { -along } else { along }
    }
}
