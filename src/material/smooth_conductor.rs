//! Polished metal: a mirror whose reflectance follows Fresnel.

use glam::Vec3A;

use super::facing::{Upright, mirrored};
use super::{BsdfSample, fresnel};
use crate::spectrum::Spectrum;

/// A delta into the mirrored direction, weighted by Fresnel's reflectance.
#[derive(Clone, Copy, Debug)]
pub struct SmoothConductor {
    /// Real part of the index relative to the medium outside.
    pub n: Spectrum,
    /// Imaginary part (extinction) relative to the medium outside, not negative.
    pub k: Spectrum,
    /// Whether the back (z < 0) reflects too; otherwise it is black.
    pub two_sided: bool,
}

impl SmoothConductor {
    /// Reflected share per lane; `cos_i` is the positive cosine to the facet.
    pub(super) fn reflected(&self, cos_i: f32) -> Spectrum {
        self.n.zip(self.k, |n, k| fresnel::conductor(cos_i.into(), n.into(), k.into()).reflected as f32)
    }

    pub(super) fn sample(&self, wo: Vec3A) -> Option<BsdfSample> {
        Upright::of_opaque(wo, self.two_sided)?;
        Some(BsdfSample {
            wi: mirrored(wo),
            value: self.reflected(wo.z.abs()),
            pdf: Spectrum::ONE,
            is_delta: true,
            is_transmission: false,
            hero_only: false,
        })
    }
}
