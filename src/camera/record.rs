//! Everything about a camera that is decided after the light is known, in numbers.
//!
//! It goes into the EXR whole and comes back out of it: a picture is developed from a record
//! and the channels of a file, never from a scene, so that developing later is the same work
//! on the same numbers as developing at once.

use super::develop::{Matrix, Tone};
use super::electrons::{Counter, Electronics, Noise};
use super::{Exposure, Sensor, Stage, Vignetting};
use crate::scene::file::Anchor;
use crate::spectrum::colour::{Xyz, xyz_at, xyz_of_grid};
use crate::spectrum::{FIRST_NM, LampSpectrum, between_grid_points, grid_nm};
use crate::units::{FStop, Iso, Seconds};
use serde::{Deserialize, Serialize};

/// A camera's settings and what follows from them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CameraRecord {
    /// Exposure index.
    pub iso: f64,
    /// Exposure time in seconds.
    pub shutter_s: f64,
    /// f-number.
    pub f_stop: f64,
    /// Lens constant q of luminances in the scene, on the axis.
    pub exposure_constant_q: f64,
    /// The same of what `sensor.*` channels hold: a stated lens transmission is in them already.
    pub sensor_exposure_constant_q: f64,
    /// Luminance that saturates.
    pub saturation_luminance_cd_m2: f64,
    /// Luminance that is developed to display white.
    pub white_luminance_cd_m2: f64,
    /// Speed point of ISO 12232.
    pub anchor: Anchor,
    /// Exposure value at ISO 100.
    pub ev100: f64,
    /// Focal length in mm.
    pub focal_length_mm: f64,
    /// Whether the lens has an opening of the f-number that it was rendered with.
    pub has_aperture: bool,
    /// Whether a lens transmission is stated; it is in the `sensor.*` channels.
    pub has_lens_transmission: bool,
    /// Sensor that the extra channels belong to.
    pub sensor: String,
    /// The channels that the camera records.
    pub channels: Vec<ChannelRecord>,
    /// Electrons for a joule weighted as these channels weight it, at a largest quantum
    /// efficiency of 1.
    pub electrons_per_weighted_joule: f64,
    /// Tristimulus values of the light that is developed white; `None` adapts nothing.
    pub white_xyz: Option<Xyz>,
    /// What the camera sees of that light, or of equal energy.
    pub white: White,
    /// Where the camera stands and what it sees.
    #[serde(flatten)]
    pub optics: Optics,
    /// Fall-off of illuminance from the axis.
    pub vignetting: Vignetting,
    /// Electronics of the sensor, if stated.
    pub electronics: Option<Electronics>,
    /// Noise, if asked for.
    pub noise: Option<Noise>,
    /// From white-balanced channels to X, Y, Z or sRGB; `None` develops X, Y, Z.
    pub matrix: Option<Matrix>,
    /// Whether that matrix was fitted to the sensitivities, so that another white needs another.
    pub has_fitted_matrix: bool,
    /// Encoding of developed pictures.
    pub tone: Tone,
    /// Pixels in which a channel saturates; `None` without electronics.
    #[serde(default)]
    pub saturated_pixels: Option<u64>,
    /// The chain from light to picture, in order.
    #[serde(default, skip_deserializing)]
    pub stages: Vec<Stage>,
    /// What the camera model leaves out at these settings.
    #[serde(default, skip_deserializing)]
    pub warnings: Vec<String>,
}

/// A channel by name, and what its numbers are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChannelRecord {
    /// Name in the EXR.
    pub name: String,
    /// Unit.
    pub unit: String,
}

/// Where a camera stands and what it sees, in metres and right-handed coordinates.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Optics {
    /// Pinhole, or centre of the lens.
    pub position_m: [f64; 3],
    /// Unit vector along the optical axis, into the scene.
    pub look: [f64; 3],
    /// Unit vector up in the picture.
    pub up: [f64; 3],
    /// Unit vector to the right in the picture.
    pub right: [f64; 3],
    /// Width and height in pixels.
    pub resolution: [u32; 2],
    /// Tangents of half the horizontal and half the vertical angle of view.
    pub tan_half_extent: [f64; 2],
    /// Offset of the principal point from the picture's middle, in pixels (right, down).
    pub principal_point_px: [f64; 2],
    /// Distance of the image behind the lens.
    pub image_distance_mm: f64,
    /// Distance of the plane in focus along the axis; `None` where all is sharp.
    pub focus_distance_m: Option<f64>,
    /// Width and height of a pixel on the sensor.
    pub pixel_pitch_um: [f64; 2],
}

impl Optics {
    /// Right and up of a picture position in pixels, at distance one along the axis.
    pub fn slope(&self, pixel: [f64; 2]) -> [f64; 2] {
        let across: [f64; 2] = std::array::from_fn(|axis| {
            let side = f64::from(self.resolution[axis]);
            2.0 * (pixel[axis] - self.principal_point_px[axis]) / side - 1.0
        });
        [across[0] * self.tan_half_extent[0], -across[1] * self.tan_half_extent[1]]
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.resolution[0] as usize * self.resolution[1] as usize
    }
}

/// What a camera sees of the light that is to be white.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct White {
    /// Share of its luminance that the lens passes; 1 without a stated transmission.
    pub luminous_transmission: f64,
    /// Tristimulus values behind the lens of 1 cd/m2 before it.
    pub behind_lens_xyz: Xyz,
    /// What each recorded channel holds for 1 cd/m2 of it.
    pub channels: Vec<f64>,
}

/// Responses of a sensor's recorded channels and of its lens at 1 nm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Responses {
    /// First wavelength.
    pub first_nm: f64,
    /// From one wavelength to the next.
    pub step_nm: f64,
    /// Transmission of the lens, where it is stated.
    pub lens_transmission: Option<Vec<f32>>,
    /// Weight of spectral radiance per nm of each recorded channel, lens included, in order.
    pub channels: Vec<Vec<f32>>,
}

impl Responses {
    /// The responses of a sensor.
    pub fn of(sensor: &Sensor) -> Self {
        Self {
            first_nm: FIRST_NM,
            step_nm: 1.0,
            lens_transmission: sensor.lens_transmission.as_ref().map(|lens| lens.values()),
            channels: sensor.recorded().map(|channel| channel.response.values()).collect(),
        }
    }

    /// What the camera sees of a light that is not black.
    pub fn white(&self, light: &LampSpectrum) -> White {
        let luminance = light.xyz()[1];
        let behind_lens_xyz = match &self.lens_transmission {
            None => light.xyz().map(|c| c / luminance),
            Some(lens) => {
                let lens: Vec<f64> = lens.iter().map(|t| f64::from(*t)).collect();
                self.under(light, |nm| between_grid_points(&lens, nm)).xyz
            }
        };
        White {
            luminous_transmission: behind_lens_xyz[1],
            behind_lens_xyz,
            channels: self.under(light, |_| 1.0).channels,
        }
    }

    /// What is seen of a surface with this reflectance from 360 to 830 nm, where a light has
    /// 1 cd/m2.
    pub fn under(&self, light: &LampSpectrum, reflectance: impl Fn(f64) -> f64) -> Seen {
        let luminance = light.xyz()[1];
        let reflected: Vec<f64> =
            grid_nm().map(|nm| light.continuum().at(nm) * reflectance(nm) / luminance).collect();
        let lines: Vec<(f64, f64)> = light
            .visible_lines()
            .map(|line| (line.nm, line.power * reflectance(line.nm) / luminance))
            .collect();
        let weighted = |response: &Vec<f32>| {
            let response: Vec<f64> = response.iter().map(|r| f64::from(*r)).collect();
            let of_lines = lines.iter().map(|(nm, power)| power * between_grid_points(&response, *nm));
            reflected.iter().zip(&response).map(|(c, r)| c * r).sum::<f64>() + of_lines.sum::<f64>()
        };
        let xyz = lines.iter().fold(xyz_of_grid(&reflected), |sum, (nm, power)| {
            let of_line = xyz_at(*nm);
            std::array::from_fn(|i| sum[i] + power * of_line[i])
        });
        Seen { xyz, channels: self.channels.iter().map(weighted).collect() }
    }
}

/// A surface as the observer and as a camera see it.
#[derive(Clone, Debug)]
pub struct Seen {
    /// Tristimulus values, before any lens.
    pub xyz: Xyz,
    /// What each recorded channel holds.
    pub channels: Vec<f64>,
}

impl CameraRecord {
    /// Exposure settings.
    pub const fn exposure(&self) -> Exposure {
        Exposure {
            iso: Iso(self.iso),
            shutter: Seconds(self.shutter_s),
            f_stop: FStop(self.f_stop),
            q: self.exposure_constant_q,
            anchor: self.anchor,
        }
    }

    /// Computes again what follows from the settings.
    #[must_use]
    pub fn settled(mut self) -> Self {
        self.exposure_constant_q = self.sensor_exposure_constant_q * self.white.luminous_transmission;
        let exposure = self.exposure();
        self.ev100 = exposure.ev100();
        self.saturation_luminance_cd_m2 = exposure.saturation_luminance().0;
        self.white_luminance_cd_m2 = exposure.white_luminance().0;
        self.stages = super::stages::stages(&self);
        self.warnings = super::stages::warnings(&self);
        self
    }

    /// Width and height in um of the area that a pixel gathers light on.
    pub fn light_sensitive_um(&self) -> [f64; 2] {
        let stated = self.electronics.as_ref().and_then(|electronics| electronics.pixel_pitch_um);
        stated.unwrap_or(self.optics.pixel_pitch_um)
    }

    /// Luminance of the white at which the first channel is full on the axis; `None` where none
    /// ever is, and without electronics. The dark current alone fills a pixel where it is not
    /// positive.
    pub fn full_luminance_cd_m2(&self) -> Option<f64> {
        let brightest = self.white.channels.iter().fold(0.0, |a: f64, b| a.max(*b));
        Some(self.counter()?.full_value()? / brightest)
    }

    /// What counts electrons at these settings; `None` without electronics.
    ///
    /// Electrons = A (t q / N^2) v x photons per joule x quantum efficiency x what the channel
    /// holds, with A in m^2.
    pub fn counter(&self) -> Option<Counter<'_>> {
        let electronics = self.electronics.as_ref()?;
        let [width, height] = self.light_sensitive_um().map(|um| um * 1e-6);
        let exposure_per_value =
            self.sensor_exposure_constant_q * self.shutter_s / (self.f_stop * self.f_stop);
        Some(Counter {
            electronics,
            electrons_per_value: width
                * height
                * exposure_per_value
                * self.electrons_per_weighted_joule
                * electronics.quantum_efficiency,
            dark_electrons: electronics.dark_current_electrons_per_s * self.shutter_s,
            iso: self.iso,
            noise: self.noise,
        })
    }
}
