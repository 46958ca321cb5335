//! From the level that a user states to absolute spectral radiance or intensity.
//!
//! Every level is one equation between the spectrum's shape S, the emitter's constant G
//! (flux = G times radiance or intensity) and the number given. Lumens count 683 lm/W
//! weighted with the photopic curve; watts count within the band that stands beside them.
//! A line counts in full wherever its wavelength does.

use crate::error::{Error, Result};
use crate::scene::file::{BandFile, LevelFile};
use crate::spectrum::colour::{self, ColourTemperature, Xyz};
use crate::spectrum::{Dense, Emission, LampSpectrum};
use crate::units::{Candelas, CandelasPerSquareMeter, Lumens, Watts};
use std::f64::consts::PI;

/// The shape of an emitter, as far as its power depends on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EmitterShape {
    /// A Lambertian surface.
    Surface {
        /// Area that shines, both sides counted where both do.
        area_m2: f64,
        /// Area as seen along the axis, where there is an axis: a flat lamp, a sphere.
        seen_area_m2: Option<f64>,
    },
    /// A point; flux over largest intensity.
    Point {
        /// 4 pi for an isotropic light, pi for a cosine.
        solid_angle_sr: f64,
    },
}

/// A resolved emitter in numbers that people know lamps by.
#[derive(Clone, Debug)]
pub struct EmitterFacts {
    /// Name of the object or light.
    pub name: String,
    /// Its shape.
    pub shape: EmitterShape,
    /// Radiant flux within 360 to 830 nm.
    pub radiant_flux: Watts,
    /// Luminous flux.
    pub luminous_flux: Lumens,
    /// Luminance, for a surface.
    pub luminance: Option<CandelasPerSquareMeter>,
    /// Largest intensity, for a point or a lamp with an axis.
    pub intensity: Option<Candelas>,
    /// Tristimulus values of the radiance or intensity.
    pub xyz: Xyz,
    /// CIE 1931 chromaticity; `None` for black.
    pub chromaticity: Option<[f64; 2]>,
}

/// Radiance (surface) or largest intensity (point): per nm at the grid points, and of each line.
///
/// The lines' wavelengths join the scene's list where they are new to it; those outside 360 to
/// 830 nm are counted in the level and left out here.
pub fn resolve(
    spectrum: &LampSpectrum,
    level: &LevelFile,
    shape: EmitterShape,
    lines_nm: &mut Vec<f64>,
) -> Result<Emission> {
    let factor = factor_of(spectrum, level, shape)?;
    let values = match level {
        // Photometric levels fix the level by shape alone, however cold the body.
        LevelFile::FluxLm(_)
        | LevelFile::ElectricalPower { .. }
        | LevelFile::IntensityCd(_)
        | LevelFile::LuminanceCdM2(_) => spectrum.shape(),
        _ => spectrum.on_grid(),
    };
    let held = |value: f64| {
        let value = (value * factor) as f32;
        value.is_finite().then_some(value).ok_or_else(|| {
            Error::new("this emitter is too bright for 32-bit numbers").hint("check the unit of the level")
        })
    };
    let radiance: Vec<f32> = values.into_iter().map(held).collect::<Result<_>>()?;
    let lines = spectrum.visible_lines().map(|line| Ok((place_of(line.nm, lines_nm), held(line.power)?)));
    Ok(Emission::new(Dense::from_values(&radiance), lines.collect::<Result<_>>()?))
}

/// The place of a wavelength in the scene's list of lines, at its end if it is new.
fn place_of(nm: f64, lines_nm: &mut Vec<f64>) -> u32 {
    let place = lines_nm.iter().position(|known| *known == nm).unwrap_or_else(|| {
        lines_nm.push(nm);
        lines_nm.len() - 1
    });
    place as u32
}

fn factor_of(spectrum: &LampSpectrum, level: &LevelFile, shape: EmitterShape) -> Result<f64> {
    let needs_surface = |key: &str| {
        Error::new(format!("{key} describes a surface, and a point light has none"))
            .hint("give flux_lm, intensity_cd or a power")
    };
    let area = match shape {
        EmitterShape::Surface { area_m2, .. } => Some(area_m2),
        EmitterShape::Point { .. } => None,
    };
    let flux_per_unit = flux_constant(shape);
    match level {
        LevelFile::FluxLm(Lumens(flux_lm)) => Ok(flux_lm / (flux_per_unit * luminance_of_shape(spectrum)?)),
        LevelFile::ElectricalPower { power_w: Watts(power_w), efficacy_lm_per_w } => {
            Ok(power_w * efficacy_lm_per_w / (flux_per_unit * luminance_of_shape(spectrum)?))
        }
        LevelFile::RadiantPower { power_w: Watts(power_w), band_nm } => {
            Ok(power_w / (flux_per_unit * in_band(spectrum, *band_nm)?))
        }
        LevelFile::IntensityCd(Candelas(intensity)) => {
            let seen = match shape {
                EmitterShape::Point { .. } => 1.0,
                EmitterShape::Surface { seen_area_m2, .. } => seen_area_m2.ok_or_else(|| {
                    Error::new("the intensity of this shape depends on the direction")
                        .hint("give flux_lm, luminance_cd_m2 or a power")
                })?,
            };
            Ok(intensity / (seen * luminance_of_shape(spectrum)?))
        }
        LevelFile::LuminanceCdM2(CandelasPerSquareMeter(luminance)) => {
            area.ok_or_else(|| needs_surface("luminance_cd_m2"))?;
            Ok(luminance / luminance_of_shape(spectrum)?)
        }
        LevelFile::Radiance { radiance_w_sr_m2, band_nm } => {
            area.ok_or_else(|| needs_surface("radiance"))?;
            Ok(radiance_w_sr_m2 / in_band(spectrum, *band_nm)?)
        }
        LevelFile::SpectralRadianceFactor(factor) => {
            area.ok_or_else(|| needs_surface("spectral_radiance_factor"))?;
            Ok(*factor)
        }
    }
}

/// Flux over radiance (pi A, in m2 sr) or over intensity (sr).
fn flux_constant(shape: EmitterShape) -> f64 {
    match shape {
        EmitterShape::Surface { area_m2, .. } => PI * area_m2,
        EmitterShape::Point { solid_angle_sr } => solid_angle_sr,
    }
}

fn luminance_of_shape(spectrum: &LampSpectrum) -> Result<f64> {
    let luminance = spectrum.xyz_of_shape()[1];
    if luminance > 0.0 {
        return Ok(luminance);
    }
    Err(Error::new("the spectrum holds no visible light, so a photometric level cannot be met")
        .hint("give radiant_power or radiance with its band"))
}

fn in_band(spectrum: &LampSpectrum, band: BandFile) -> Result<f64> {
    let integral = match band {
        BandFile::Range([from, to]) if from > 0.0 && to > from && to.is_finite() => {
            spectrum.integral(from, to)
        }
        BandFile::Range([from, to]) => {
            return Err(Error::new(format!("the band from {from} to {to} nm is empty"))
                .hint("give two rising wavelengths, such as [360, 830]"));
        }
        BandFile::All => spectrum.integral_over_all().ok_or_else(|| {
            Error::new("a constant spectrum has no end, so power over \"all\" wavelengths does not fix it")
                .hint("name a band, such as [360, 830]")
        })?,
    };
    if integral > 0.0 {
        return Ok(integral);
    }
    Err(Error::new("the spectrum is dark within the band").hint("widen band_nm"))
}

impl EmitterFacts {
    /// The numbers of an emitter with this radiance or intensity (per metre and metre
    /// squared, before any change of the length unit); `lines_nm` is the scene's list of lines.
    pub fn new(name: String, shape: EmitterShape, emission: &Emission, lines_nm: &[f64]) -> Self {
        let xyz = emission.xyz(lines_nm);
        let band = emission.integral();
        let chromaticity = colour::xy_of(xyz);
        let (luminance, intensity) = match shape {
            EmitterShape::Surface { seen_area_m2, .. } => (Some(xyz[1]), seen_area_m2.map(|a| a * xyz[1])),
            EmitterShape::Point { .. } => (None, Some(xyz[1])),
        };
        Self {
            name,
            shape,
            radiant_flux: Watts(flux_constant(shape) * band),
            luminous_flux: Lumens(flux_constant(shape) * xyz[1]),
            luminance: luminance.map(CandelasPerSquareMeter),
            intensity: intensity.map(Candelas),
            xyz,
            chromaticity,
        }
    }

    /// Correlated colour temperature; `None` where there is none. It is searched for when it is asked
    /// for: of a hall of 10^4 lamps that search would take most of the time to load.
    pub fn colour_temperature(&self) -> Option<ColourTemperature> {
        self.chromaticity.and_then(colour::colour_temperature)
    }

    /// Power as the sensors see it, by which lights are chosen: X + Y + Z of the flux.
    pub fn weight(&self) -> f64 {
        flux_constant(self.shape) * self.xyz.iter().sum::<f64>()
    }
}

/// Checks that a level is a finite number from 0 up.
pub fn check_level(level: &LevelFile) -> Result<()> {
    let values = match level {
        LevelFile::FluxLm(Lumens(v)) => vec![("flux_lm", *v)],
        LevelFile::RadiantPower { power_w, .. } => vec![("power_w", power_w.0)],
        LevelFile::ElectricalPower { power_w, efficacy_lm_per_w } => {
            vec![("power_w", power_w.0), ("efficacy_lm_per_w", *efficacy_lm_per_w)]
        }
        LevelFile::IntensityCd(Candelas(v)) => vec![("intensity_cd", *v)],
        LevelFile::LuminanceCdM2(CandelasPerSquareMeter(v)) => vec![("luminance_cd_m2", *v)],
        LevelFile::Radiance { radiance_w_sr_m2, .. } => vec![("radiance_w_sr_m2", *radiance_w_sr_m2)],
        LevelFile::SpectralRadianceFactor(v) => vec![("spectral_radiance_factor", *v)],
    };
    match values.iter().find(|(_, v)| !(*v >= 0.0 && v.is_finite())) {
        None => Ok(()),
        Some((key, value)) => Err(Error::new(format!("{key} = {value} is not a finite number from 0 up"))),
    }
}
