//! From absolute tristimulus values to a display picture: anchor, white balance, encoding.

use super::Exposure;
use crate::spectrum::colour::{Xyz, adapt, srgb_encode, xyz_to_linear_srgb};

/// White point of sRGB, CIE D65, on the scale Y = 1.
const D65_WHITE: Xyz = [0.950_455_927_051_672, 1.0, 1.089_057_750_759_878];

/// How a picture is developed.
#[derive(Clone, Copy, Debug)]
pub struct Development {
    /// Luminance in cd/m2 that becomes display white.
    pub white_luminance_cd_m2: f64,
    /// Tristimulus values of the light that is to look white; `None` adapts nothing.
    pub white: Option<Xyz>,
}

impl Development {
    /// The development that an exposure's anchor asks for.
    pub fn new(exposure: &Exposure, white: Option<Xyz>) -> Self {
        Self { white_luminance_cd_m2: exposure.white_luminance().0, white }
    }

    /// Linear sRGB with 1 at display white, not clipped.
    pub fn linear(&self, xyz_cd_m2: Xyz) -> [f64; 3] {
        let adapted = match self.white {
            Some(white) if white[1] > 0.0 => adapt(xyz_cd_m2, white.map(|c| c / white[1]), D65_WHITE),
            _ => xyz_cd_m2,
        };
        xyz_to_linear_srgb(adapted).map(|c| c / self.white_luminance_cd_m2)
    }

    /// sRGB-encoded values in 0..1, clipped channel by channel.
    pub fn display(&self, xyz_cd_m2: Xyz) -> [f64; 3] {
        self.linear(xyz_cd_m2).map(srgb_encode)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chosen_white_is_developed_neutral() {
        let tungsten = [1.0985, 1.0, 0.3558];
        let development = Development { white_luminance_cd_m2: 200.0, white: Some(tungsten) };
        let [r, g, b] = development.linear(tungsten.map(|c| c * 100.0));
        for channel in [r, g, b] {
            assert!((channel - 0.5).abs() < 1e-6, "{r} {g} {b}");
        }
    }
}
