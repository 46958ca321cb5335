//! The camera of a scene: placement, lens and exposure from what the file says, and the record
//! that a picture carries of it.

use super::file::CameraFile;
use super::objects::{Built, unit_vector};
use super::spectra::Spectra;
use super::{View, chain};
use crate::camera::{
    Camera, CameraPlacement, CameraRecord, ChannelRecord, Exposure, LensAperture, Optics, STANDARD_Q,
    STANDARD_Q_ON_AXIS, clear_lens_q,
};
use crate::error::{Error, Result};
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

    /// Everything that a picture must carry to be developed again.
    pub fn record(&self) -> CameraRecord {
        let Exposure { iso, shutter, f_stop, q, anchor } = self.exposure;
        let channels = self.sensor.recorded();
        let channels =
            channels.map(|c| ChannelRecord { name: c.name.clone(), unit: c.unit.to_owned() }).collect();
        let chain = self.chain.clone();
        CameraRecord {
            iso: iso.0,
            shutter_s: shutter.0,
            f_stop: f_stop.0,
            exposure_constant_q: q,
            sensor_exposure_constant_q: chain.sensor_q,
            saturation_luminance_cd_m2: 0.0,
            white_luminance_cd_m2: 0.0,
            anchor,
            ev100: 0.0,
            focal_length_mm: self.focal_length_mm,
            has_aperture: self.camera.has_aperture(),
            has_lens_transmission: self.sensor.lens_transmission.is_some(),
            sensor: self.sensor.name.clone(),
            channels,
            electrons_per_weighted_joule: self.sensor.electrons_per_weighted_joule,
            white_xyz: self.white,
            white: chain.white,
            optics: self.optics(),
            vignetting: chain.vignetting,
            electronics: chain.electronics,
            noise: chain.noise,
            matrix: chain.matrix,
            has_fitted_matrix: chain.has_fitted_matrix,
            tone: chain.tone,
            saturated_pixels: None,
            stages: Vec::new(),
            warnings: Vec::new(),
        }
        .settled()
    }

    fn optics(&self) -> Optics {
        let placement = self.camera.placement();
        let resolution = self.camera.resolution();
        let tan_half_extent = self.camera.half_extent();
        Optics {
            position_m: (placement.position * self.metres_per_unit).to_array(),
            look: placement.forward.to_array(),
            up: placement.up.to_array(),
            right: placement.right.to_array(),
            resolution,
            tan_half_extent,
            principal_point_px: self.camera.principal_point_px(),
            image_distance_mm: self.image_distance_mm,
            focus_distance_m: self.camera.focus_distance().map(|distance| distance * self.metres_per_unit),
            pixel_pitch_um: std::array::from_fn(|axis| {
                2000.0 * tan_half_extent[axis] * self.image_distance_mm / f64::from(resolution[axis])
            }),
        }
    }

    /// Relative illuminance of a measured flat field at the picture's pixels; empty without one.
    pub fn flat_field(&self) -> Vec<f32> {
        self.chain.flat_field.as_ref().map_or_else(Vec::new, |field| field.over_picture(&self.optics()))
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
    let sensor_q = sensor_q(file, focal_length_mm, image_distance_mm)?;
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
    let sensor = chain::sensor(file, spectra)?;
    let light = chain::white(file, &sensor, spectra)?;
    let white = light.xyz;
    let exposure = Exposure { q: sensor_q * light.seen.luminous_transmission, ..exposure };
    let chain = chain::build(file, &sensor, light, sensor_q, half_extent, spectra)?;
    let metres_per_unit = built.geometry.metres_per_unit();
    Ok(View { camera, exposure, sensor, focal_length_mm, image_distance_mm, metres_per_unit, white, chain })
}

pub(super) fn positive(value: f64, key: impl std::fmt::Display, example: &str) -> Result<f64> {
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
    Ok(Exposure {
        iso: file.iso,
        shutter: file.shutter_s,
        f_stop: file.f_stop,
        q: STANDARD_Q,
        anchor: file.anchor,
    })
}

/// Lens constant on the axis of what the sensor's channels hold, in which a stated transmission
/// is already.
fn sensor_q(file: &CameraFile, focal_length_mm: f64, image_distance_mm: f64) -> Result<f64> {
    match (file.exposure_constant_q, &file.lens_transmission) {
        (Some(q), None) => positive(q, "exposure_constant_q", "0.65"),
        (Some(_), Some(_)) => Err(Error::new("both exposure_constant_q and lens_transmission are given")
            .hint("keep one: with a lens transmission the constant is (pi/4) (f/i)^2")
            .under("exposure_constant_q")),
        (None, Some(_)) => Ok(clear_lens_q(focal_length_mm, image_distance_mm)),
        (None, None) if chain::falls_off(file) => Ok(STANDARD_Q_ON_AXIS),
        (None, None) => Ok(STANDARD_Q),
    }
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
