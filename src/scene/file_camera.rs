//! The camera of a scene, key by key.

use super::file::{SensorFile, SpectrumFile, Vector};
use crate::camera::{Matrix, Tone};
use crate::units::{FStop, Iso, Seconds};
use serde::{Deserialize, Serialize};

/// The camera: where it is, its optics, its exposure.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CameraFile {
    /// Position of the pinhole or the lens' centre.
    pub position: Vector,
    /// A point in the middle of the picture; give this or `direction`.
    #[serde(default)]
    pub look_at: Option<Vector>,
    /// Optical axis, of any length; give this or `look_at`.
    #[serde(default)]
    pub direction: Option<Vector>,
    /// A direction that is up in the picture.
    pub up: Vector,
    /// Focal length in mm.
    pub focal_length_mm: f64,
    /// Width and height of the sensor in mm.
    pub sensor_mm: [f64; 2],
    /// Width and height of the picture in pixels.
    pub resolution: [u32; 2],
    /// Where the optical axis meets the picture, in pixels from its middle (right, down).
    #[serde(default)]
    pub principal_point_px: [f64; 2],
    /// Distance of the sharp plane along the axis, in the scene's length unit. With it the
    /// lens has its real aperture; without it the camera is a pinhole with everything sharp.
    #[serde(default)]
    pub focus_distance: Option<f64>,
    /// f-number.
    pub f_stop: FStop,
    /// Exposure time in seconds.
    pub shutter_s: Seconds,
    /// Exposure index.
    pub iso: Iso,
    /// Which ISO 12232 speed point the developed picture is anchored to.
    #[serde(default)]
    pub anchor: Anchor,
    /// Lens constant q of H = q L t / N^2, of the optical axis where a `vignetting` is given.
    /// Left out: 0.65 (ISO 12232), with vignetting 0.693, which is 0.65 without its fall-off to
    /// 10 degrees. Not beside `lens_transmission`, which gives (pi/4) (f/i)^2 for focal length
    /// f and image distance i.
    #[serde(default)]
    pub exposure_constant_q: Option<f64>,
    /// Transmission of the lens, 0 to 1, by wavelength; it weights the `sensor.*` channels.
    /// Left out: its mean is in the lens constant.
    #[serde(default)]
    pub lens_transmission: Option<SpectrumFile>,
    /// How illuminance falls off towards the corners. Default none.
    #[serde(default)]
    pub vignetting: VignettingFile,
    /// `cie-1931`, a tabulated camera sensitivity (a built-in one by name, or a CSV file), or a
    /// set of filters before a detector.
    #[serde(default = "standard_observer")]
    pub sensor: SensorFile,
    /// Illuminant that is developed as white: a spectrum; left out, nothing is adapted.
    #[serde(default)]
    pub white_balance: Option<SpectrumFile>,
    /// Electronics of the sensor: electrons, full well, digital values. Default none: pictures
    /// are developed from light itself.
    #[serde(default)]
    pub electronics: Option<ElectronicsFile>,
    /// Noise of the electronics. Default none.
    #[serde(default)]
    pub noise: Option<NoiseFile>,
    /// Matrix and encoding of developed pictures.
    #[serde(default)]
    pub development: DevelopmentFile,
}

fn standard_observer() -> SensorFile {
    SensorFile::Name(crate::camera::CIE_SENSOR.to_owned())
}

/// The speed point of ISO 12232 that fixes the level of a developed picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Anchor {
    /// Saturation-based speed: 1.0 is the saturation exposure 78 lx s / ISO.
    #[default]
    Saturation,
    /// Standard output sensitivity: 10 lx s / ISO is developed to 0.18.
    Sos,
    /// Exposure meter: the luminance K N^2 / (t ISO), K = 12.5, is developed to 0.18.
    Meter,
}

/// How illuminance at the sensor falls off from the optical axis.
#[derive(Clone, Debug, Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum VignettingFile {
    /// Not at all.
    #[default]
    None,
    /// As the fourth power of the cosine of the angle from the axis: a thin lens.
    Cos4,
    /// As measured along a radius.
    RadialTable {
        /// CSV file with the columns `radius_mm` (on the sensor) or `angle_deg`, and
        /// `relative_illuminance` (1 on the axis). Path, relative to the scene file.
        file: String,
    },
    /// As in a picture of an even field, linear in light: EXR (channel Y, or G), PNG or TIFF. It
    /// spans the camera's picture, and its middle tenth counts as 1.
    FlatField {
        /// Path, relative to the scene file.
        file: String,
    },
}

/// Electronics of a sensor, after EMVA 1288. Every pixel counts every channel.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ElectronicsFile {
    /// Electrons per photon where the sensor is most efficient, 0 to 1; the sensitivities give
    /// the shape. Of a filter set: of the detector alone.
    pub quantum_efficiency: f64,
    /// Width and height of a pixel's light-sensitive area in um. Left out: `sensor_mm` over
    /// `resolution`.
    #[serde(default)]
    pub pixel_pitch_um: Option<[f64; 2]>,
    /// Electrons that a pixel holds. Left out: it never fills.
    #[serde(default)]
    pub full_well_electrons: Option<f64>,
    /// Standard deviation of the amplifier's noise in electrons; counts with `noise` only.
    #[serde(default)]
    pub read_noise_electrons: f64,
    /// Electrons per second that come without light.
    #[serde(default)]
    pub dark_current_electrons_per_s: f64,
    /// Bits of a digital value, 1 to 16. Left out: no digital values, electrons are developed.
    #[serde(default)]
    pub bit_depth: Option<u8>,
    /// Electrons for one digital number at `base_iso`. Left out: the full well is the largest
    /// digital value.
    #[serde(default)]
    pub electrons_per_dn: Option<f64>,
    /// ISO setting of that gain; at twice the ISO half as many electrons make one number.
    #[serde(default = "base_iso")]
    pub base_iso: f64,
    /// Digital value of no electrons.
    #[serde(default)]
    pub black_level_dn: f64,
}

const fn base_iso() -> f64 {
    100.0
}

/// Noise of the electronics; the seed decides it, not the number of threads.
#[derive(Clone, Copy, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct NoiseFile {
    /// Seed of the random numbers.
    #[serde(default)]
    pub seed: u64,
    /// Whether photons and dark electrons arrive at random. Default true.
    #[serde(default = "yes")]
    pub shot: bool,
    /// Whether the amplifier adds its noise. Default true.
    #[serde(default = "yes")]
    pub read: bool,
}

const fn yes() -> bool {
    true
}

/// How pictures are developed.
#[derive(Clone, Debug, Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct DevelopmentFile {
    /// From the sensor's white-balanced channels to colours. Left out: pictures are made of
    /// X, Y, Z.
    #[serde(default)]
    pub matrix: Option<Matrix>,
    /// Whether the matrix is computed instead: the one that shows the 24 reflectances of the
    /// ColorChecker best under the white, for a sensor of three channels. Default false.
    #[serde(default)]
    pub fit_matrix: bool,
    /// Encoding. Default `srgb`.
    #[serde(default)]
    pub tone: Tone,
}
