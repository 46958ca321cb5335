//! Brushed or blasted metal: facets that reflect after Fresnel.

use glam::Vec3A;

use super::facing::Upright;
use super::ggx::facet_along;
use super::{BsdfSample, BsdfValue, Ggx, SmoothConductor};
use crate::spectrum::Spectrum;

/// GGX facets of metal (Torrance and Sparrow 1967).
#[derive(Clone, Copy, Debug)]
pub struct RoughConductor {
    /// What each facet is made of.
    pub metal: SmoothConductor,
    /// How the facets are tilted.
    pub facets: Ggx,
}

impl RoughConductor {
    pub(super) fn evaluate(&self, wo: Vec3A, wi: Vec3A) -> BsdfValue {
        let Some(upright) = Upright::of_opaque(wo, self.metal.two_sided) else {
            return BsdfValue::ZERO;
        };
        let Some(reflection) = self.facets.reflection(upright.turn(wo), upright.turn(wi)) else {
            return BsdfValue::ZERO;
        };
        BsdfValue {
            value: self.metal.reflected(reflection.cos_facet) * reflection.value,
            pdf: Spectrum::splat(reflection.pdf),
        }
    }

    pub(super) fn sample(&self, wo: Vec3A, u: [f32; 2]) -> Option<BsdfSample> {
        let upright = Upright::of_opaque(wo, self.metal.two_sided)?;
        let seen = upright.turn(wo);
        let h = self.facets.sample_visible(seen, u);
        let wi = upright.turn(2.0 * seen.dot(h) * h - seen);
        BsdfSample::of_lobe(wi, self.evaluate(wo, wi), false)
    }

    /// The numbers that draw `wi`.
    pub(super) fn invert(&self, wo: Vec3A, wi: Vec3A) -> Option<[f32; 2]> {
        let upright = Upright::of_opaque(wo, self.metal.two_sided)?;
        let (wo, wi) = (upright.turn(wo), upright.turn(wi));
        Some(self.facets.invert_visible(wo, facet_along(wo, wi, 1.0)))
    }
}
