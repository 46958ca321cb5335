//! The camera of a scene: placement, lens, exposure and sensor from what the file says.

use super::View;
use super::file::{CameraFile, SensorDescription, SensorFile, SpectrumFile};
use super::objects::{Built, unit_vector};
use super::spectra::Spectra;
use crate::camera::{CIE_SENSOR, Camera, CameraPlacement, Exposure, LensAperture, Sensor};
use crate::error::{Error, Result};
use crate::spectrum::colour::Xyz;
use crate::spectrum::library;
use glam::DVec3;

/// A camera in numbers that photographers know it by.
#[derive(Clone, Copy, Debug)]
pub struct CameraFacts {
    /// Horizontal and vertical angle of view in degrees.
    pub field_of_view_deg: [f64; 2],
    /// Exposure value at ISO 100.
    pub ev100: f64,
    /// Luminance that saturates, cd/m2.
    pub saturation_luminance_cd_m2: f64,
    /// Luminance that is developed to display white, cd/m2.
    pub white_luminance_cd_m2: f64,
}

impl View {
    /// The camera in numbers.
    pub fn facts(&self) -> CameraFacts {
        CameraFacts {
            field_of_view_deg: self.camera.field_of_view_deg(),
            ev100: self.exposure.ev100(),
            saturation_luminance_cd_m2: self.exposure.saturation_luminance().0,
            white_luminance_cd_m2: self.exposure.white_luminance().0,
        }
    }
}

pub(super) fn build(file: &CameraFile, built: &Built, spectra: &mut Spectra<'_>) -> Result<View> {
    let exposure = exposure(file)?;
    let focal_length_mm = positive(file.focal_length_mm, "focal_length_mm", "50")?;
    for (side, length) in file.sensor_mm.iter().enumerate() {
        positive(*length, side, "[36, 24]").map_err(|e| e.under("sensor_mm"))?;
    }
    let pixels = file.resolution.map(u64::from);
    /// Beyond this the film alone takes tens of gigabytes.
    const MOST_PIXELS: u64 = 1 << 28;
    if pixels.contains(&0) || pixels[0] * pixels[1] > MOST_PIXELS {
        return Err(Error::new(format!("a picture of {} by {} pixels", pixels[0], pixels[1]))
            .hint("give width and height, each at least 1 and together at most 268 million pixels")
            .under("resolution"));
    }
    let aperture = aperture(file, built, focal_length_mm)?;
    // A lens focused at distance d has its image at v, 1/v = 1/f - 1/d, behind it.
    let image_distance_mm = match file.focus_distance {
        Some(distance) => {
            let distance_mm = built.length(distance) * built.geometry.metres_per_unit() * 1000.0;
            1.0 / (1.0 / focal_length_mm - 1.0 / distance_mm)
        }
        None => focal_length_mm,
    };
    let half_extent = file.sensor_mm.map(|side| 0.5 * side / image_distance_mm);
    if let Some(side) = half_extent.iter().position(|half| *half == 0.0 || !half.is_finite()) {
        return Err(Error::new(format!(
            "a sensor of {} mm at {image_distance_mm} mm has no angle of view",
            file.sensor_mm[side]
        ))
        .hint("check sensor_mm and focal_length_mm, for example [36, 24] and 50")
        .under(side)
        .under("sensor_mm"));
    }
    if file.principal_point_px.iter().any(|p| !p.is_finite()) {
        return Err(Error::new("the principal point must be finite")
            .hint("for example [0, 0]")
            .under("principal_point_px"));
    }
    let camera =
        Camera::new(placement(file, built)?, file.resolution, half_extent, file.principal_point_px, aperture);
    let sensor = sensor(&file.sensor, spectra).map_err(|e| e.under("sensor"))?;
    let white = match &file.white_balance {
        Some(spectrum) => Some(white_of(spectrum, spectra).map_err(|e| e.under("white_balance"))?),
        None => None,
    };
    Ok(View { camera, exposure, sensor, focal_length_mm, white })
}

/// A sensor by name, where tables of other kinds are none, or from a table of the scene's own.
fn sensor(file: &SensorFile, spectra: &mut Spectra<'_>) -> Result<Sensor> {
    let name = match file {
        SensorFile::Described(SensorDescription::Csv { file }) => {
            let (path, table) = spectra.read_csv(file).map_err(|e| e.under("file").under("csv"))?;
            return Sensor::of_table(file, &table).map_err(|e| e.in_file(&path));
        }
        SensorFile::Name(name) => name.as_str(),
    };
    let cameras = library::entries().filter(|entry| entry.kind == "sensitivity").map(|entry| entry.name);
    let known: Vec<&str> = cameras.chain([CIE_SENSOR]).collect();
    if known.contains(&name) { Sensor::named(name) } else { Err(Error::unknown_name("sensor", name, known)) }
}

/// Tristimulus values of the light that is developed white.
fn white_of(spectrum: &SpectrumFile, spectra: &mut Spectra<'_>) -> Result<Xyz> {
    let white = spectra.emission(spectrum)?.xyz();
    if white.iter().all(|value| *value > 0.0 && value.is_finite()) {
        return Ok(white);
    }
    Err(Error::new("a white without visible light").hint("name an illuminant, such as \"d65\""))
}

fn positive(value: f64, key: impl std::fmt::Display, example: &str) -> Result<f64> {
    if value > 0.0 && value.is_finite() {
        return Ok(value);
    }
    Err(Error::new(format!("{value} is not a positive number"))
        .hint(format!("for example {example}"))
        .under(key))
}

fn exposure(file: &CameraFile) -> Result<Exposure> {
    positive(file.iso.0, "iso", "100")?;
    positive(file.shutter_s.0, "shutter_s", "0.0111 for 1/90 s")?;
    positive(file.f_stop.0, "f_stop", "8")?;
    positive(file.exposure_constant_q, "exposure_constant_q", "0.65")?;
    Ok(Exposure {
        iso: file.iso,
        shutter: file.shutter_s,
        f_stop: file.f_stop,
        q: file.exposure_constant_q,
        anchor: file.anchor,
    })
}

fn aperture(file: &CameraFile, built: &Built, focal_length_mm: f64) -> Result<Option<LensAperture>> {
    let Some(distance) = file.focus_distance else { return Ok(None) };
    let focus_distance = built.length(distance);
    let focal_length = built.length_of_metres(focal_length_mm / 1000.0);
    if !(focus_distance > focal_length && focus_distance.is_finite()) {
        return Err(Error::new(format!("a lens of {focal_length_mm} mm cannot focus at {distance}"))
            .hint("focus farther away than the focal length, in the scene's length unit")
            .under("focus_distance"));
    }
    let radius = 0.5 * focal_length / file.f_stop.0;
    if !(radius as f32).is_finite() {
        return Err(Error::new(format!("an aperture of f/{:e} is too wide to be held", file.f_stop.0))
            .hint("for example 8")
            .under("f_stop"));
    }
    Ok(Some(LensAperture { radius, focus_distance }))
}

fn placement(file: &CameraFile, built: &Built) -> Result<CameraPlacement> {
    let position = built.position(file.position, "position")?;
    let forward = match (file.look_at, file.direction) {
        (Some(target), None) => {
            let span = built.position(target, "look_at")? - position;
            unit_vector(span.to_array(), "look_at").map_err(|_| {
                Error::new("the camera looks at its own position").hint("move look_at away").under("look_at")
            })?
        }
        (None, Some(direction)) => unit_vector(direction, "direction")?,
        (Some(_), Some(_)) => {
            return Err(Error::new("both look_at and direction are given")
                .hint("keep one")
                .under("direction"));
        }
        (None, None) => {
            return Err(Error::new("the camera looks nowhere").hint("add look_at or direction"));
        }
    };
    let right = forward.cross(unit_vector(file.up, "up")?);
    if right.length() < 1e-9 {
        return Err(Error::new("up is along the line of sight")
            .hint("give a direction across it, such as [0, 1, 0]")
            .under("up"));
    }
    let right = right.normalize();
    Ok(CameraPlacement { position, forward, right, up: DVec3::cross(right, forward) })
}
