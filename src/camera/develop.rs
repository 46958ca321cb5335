//! From absolute values to a display picture: anchor, white balance, matrix, encoding.

use super::Exposure;
use crate::error::{Error, Result};
use crate::spectrum::colour::{Xyz, adapt, srgb_encode, xyz_to_linear_srgb};
use serde::{Deserialize, Serialize};

/// White point of sRGB, CIE D65, on the scale Y = 1.
pub(super) const D65_WHITE: Xyz = [0.950_455_927_051_672, 1.0, 1.089_057_750_759_878];

/// Encoding of a developed picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Tone {
    /// That of sRGB, IEC 61966-2-1.
    #[default]
    Srgb,
    /// None: levels proportional to light.
    Linear,
    /// Light to the power of one over this number.
    Gamma(f64),
}

impl Tone {
    /// The encoded value in 0..1 of a linear one, clipped.
    pub fn encode(self, linear: f64) -> f64 {
        match self {
            Self::Srgb => srgb_encode(linear),
            Self::Linear => linear.clamp(0.0, 1.0),
            Self::Gamma(gamma) => linear.clamp(0.0, 1.0).powf(1.0 / gamma),
        }
    }

    /// Refuses a gamma that encodes nothing.
    pub fn check(self) -> Result<Self> {
        match self {
            Self::Gamma(gamma) if !(gamma > 0.0 && gamma.is_finite()) => {
                Err(Error::new(format!("a gamma of {gamma} is not a positive number"))
                    .hint("for example 2.2")
                    .under("gamma"))
            }
            _ => Ok(self),
        }
    }
}

/// From what a camera's channels hold to a colour space.
///
/// Channels are white-balanced first: each is divided by what it holds of the light that is
/// white, so that a white surface has the same number in every channel. A matrix to `xyz`
/// turns (1, 1, …) into the white of D65, one to `srgb` into (1, 1, 1).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Matrix {
    /// What the three rows give.
    pub to: MatrixTarget,
    /// Three rows, each with one number for every channel of the sensor.
    pub rows: Vec<Vec<f64>>,
}

/// What a matrix leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum MatrixTarget {
    /// CIE 1931 X, Y, Z under D65.
    Xyz,
    /// Linear sRGB.
    Srgb,
}

impl MatrixTarget {
    /// What it is called.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Xyz => "X, Y, Z under D65",
            Self::Srgb => "linear sRGB",
        }
    }
}

impl Matrix {
    /// Refuses a matrix that does not fit a sensor of so many channels.
    pub fn check(&self, channels: usize) -> Result<()> {
        /// Far beyond what any sensor's channels need, and within what colours can be computed of.
        const LARGEST: f64 = 1e6;
        if self.rows.len() != 3 {
            return Err(Error::new(format!("a matrix of {} rows", self.rows.len()))
                .hint("give three rows, for X, Y, Z or R, G, B")
                .under("rows"));
        }
        for (index, row) in self.rows.iter().enumerate() {
            if row.len() != channels {
                return Err(Error::new(format!("{} numbers for {channels} channels", row.len()))
                    .hint("give one number for every channel of the sensor")
                    .under(index)
                    .under("rows"));
            }
            if let Some(number) = row.iter().find(|n| !n.is_finite() || n.abs() > LARGEST) {
                return Err(Error::new(format!("{number:e} is no entry of a colour matrix"))
                    .hint(format!("give numbers between -{LARGEST:e} and {LARGEST:e}"))
                    .under(index)
                    .under("rows"));
            }
        }
        Ok(())
    }

    /// Linear sRGB of white-balanced channels.
    pub fn apply(&self, balanced: &[f64]) -> [f64; 3] {
        let product: [f64; 3] =
            std::array::from_fn(|i| self.rows[i].iter().zip(balanced).map(|(m, c)| m * c).sum());
        match self.to {
            MatrixTarget::Srgb => product,
            MatrixTarget::Xyz => xyz_to_linear_srgb(product),
        }
    }
}

/// How tristimulus values are developed.
#[derive(Clone, Copy, Debug)]
pub struct Development {
    /// Luminance in cd/m2 that becomes display white.
    pub white_luminance_cd_m2: f64,
    /// Tristimulus values of the light that is to look white; `None` adapts nothing.
    pub white: Option<Xyz>,
    /// Encoding.
    pub tone: Tone,
}

impl Development {
    /// The development that an exposure's anchor asks for, encoded as sRGB.
    pub fn new(exposure: &Exposure, white: Option<Xyz>) -> Self {
        Self { white_luminance_cd_m2: exposure.white_luminance().0, white, tone: Tone::Srgb }
    }

    /// Linear sRGB with 1 at display white, not clipped.
    pub fn linear(&self, xyz_cd_m2: Xyz) -> [f64; 3] {
        let adapted = match self.white {
            Some(white) if white[1] > 0.0 => adapt(xyz_cd_m2, white.map(|c| c / white[1]), D65_WHITE),
            _ => xyz_cd_m2,
        };
        xyz_to_linear_srgb(adapted).map(|c| c / self.white_luminance_cd_m2)
    }

    /// Encoded values in 0..1, clipped channel by channel.
    pub fn display(&self, xyz_cd_m2: Xyz) -> [f64; 3] {
        self.linear(xyz_cd_m2).map(|c| self.tone.encode(c))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chosen_white_is_developed_neutral() {
        let tungsten = [1.0985, 1.0, 0.3558];
        let development =
            Development { white_luminance_cd_m2: 200.0, white: Some(tungsten), tone: Tone::Linear };
        let [r, g, b] = development.linear(tungsten.map(|c| c * 100.0));
        for channel in [r, g, b] {
            assert!((channel - 0.5).abs() < 1e-6, "{r} {g} {b}");
        }
    }

    #[test]
    fn a_matrix_to_xyz_shows_the_white_of_d65_neutral() {
        let rows = D65_WHITE.map(|c| vec![0.25 * c, 0.75 * c]).to_vec();
        let matrix = Matrix { to: MatrixTarget::Xyz, rows };
        matrix.check(2).expect("it fits");
        for channel in matrix.apply(&[0.5, 0.5]) {
            assert!((channel - 0.5).abs() < 1e-6, "{channel}");
        }
    }

    #[test]
    fn tones_meet_at_black_and_white_and_differ_between() {
        for (tone, grey) in
            [(Tone::Linear, 0.18), (Tone::Gamma(2.0), 0.18_f64.sqrt()), (Tone::Srgb, 0.461_356)]
        {
            assert_eq!(tone.encode(-1.0), 0.0);
            assert!((tone.encode(7.0) - 1.0).abs() < 1e-12 && tone.encode(7.0) <= 1.0);
            assert!((tone.encode(0.18) - grey).abs() < 1e-6, "{tone:?}");
        }
    }
}
