//! An ideal mirror whose reflectance does not depend on the angle.

use glam::Vec3A;

use super::BsdfSample;
use super::facing::{Upright, mirrored};
use crate::spectrum::Spectrum;

/// A delta into the mirrored direction.
#[derive(Clone, Copy, Debug)]
pub struct Mirror {
    /// Share of the power that is reflected, in [0, 1].
    pub reflectance: Spectrum,
    /// Whether the back (z < 0) reflects too; otherwise it is black.
    pub two_sided: bool,
}

impl Mirror {
    pub(super) fn sample(&self, wo: Vec3A) -> Option<BsdfSample> {
        Upright::of_opaque(wo, self.two_sided)?;
        Some(BsdfSample {
            wi: mirrored(wo),
            value: self.reflectance,
            pdf: Spectrum::ONE,
            is_delta: true,
            is_transmission: false,
            hero_only: false,
        })
    }
}
