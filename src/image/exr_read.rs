//! A render read back, with all that is needed to develop it.

use super::exr_file::{FACTS_ATTRIBUTE, RESPONSES_ATTRIBUTE};
use crate::camera::{CameraRecord, FLAT_FIELD_CHANNEL, Planes, Responses, Sensor};
use crate::error::{Error, Result};
use crate::input;
use exr::meta::MetaData;
use exr::prelude::*;
use serde::Deserialize;
use std::io::Cursor;
use std::path::Path;

/// What developing needs of a render.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// Name of the scene.
    pub scene: String,
    /// The camera.
    pub camera: CameraRecord,
    /// Responses of the channels that the camera records.
    pub responses: Responses,
    /// The channels that a picture is developed from.
    pub planes: Planes,
}

/// The part of the facts that is read again.
#[derive(Deserialize)]
struct KnownFacts {
    scene: String,
    camera: CameraRecord,
}

const REMEDY: &str = "give an EXR written by `etalon render`";

/// Larger files are refused before they are read.
pub(super) const MOST_BYTES: u64 = 16 << 30;

/// Bytes of pixels that one byte of a file can stand for at most: what deflate reaches, with
/// room for other methods. A header that announces more is wrong, whatever follows it.
pub(super) const MOST_INFLATION: u64 = 1100;

/// Reads a render; an error names the file and what it lacks.
pub fn read_exr(path: &Path) -> Result<Rendered> {
    let bytes = input::read_bytes(path, MOST_BYTES).map_err(|e| Error::io(path, "read the render", &e))?;
    parse_exr(&bytes).map_err(|e| e.in_file(path))
}

/// Reads a render's bytes. What is held is at most a few times 1100 times as much: what deflate
/// makes of a byte.
pub fn parse_exr(bytes: &[u8]) -> Result<Rendered> {
    let undecodable = |e: &exr::error::Error| {
        let what = e.to_string().to_lowercase();
        Error::new(format!("cannot be decoded ({what})")).hint(REMEDY)
    };
    check_size(bytes, &undecodable)?;
    let reader = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let image = reader.all_attributes().from_buffered(Cursor::new(bytes)).map_err(|e| undecodable(&e))?;
    let layer = &image.layer_data;
    let text = |name: &str| match layer.attributes.other.get(&Text::from(name)) {
        Some(AttributeValue::Text(text)) => Some(text.to_string()),
        _ => None,
    };
    let Some(facts) = text(FACTS_ATTRIBUTE) else {
        return Err(Error::new("it has no attribute \"etalon\"").hint(REMEDY));
    };
    let KnownFacts { scene, camera } = of_json(&facts, FACTS_ATTRIBUTE)?;
    let responses = match text(RESPONSES_ATTRIBUTE) {
        Some(responses) => of_json(&responses, RESPONSES_ATTRIBUTE)?,
        None => Responses::of(&Sensor::cie()),
    };
    let mut planes = Planes::new();
    let wanted = |name: &str| {
        ["X", "Y", "Z", FLAT_FIELD_CHANNEL].contains(&name)
            || camera.channels.iter().any(|channel| channel.name == name)
    };
    for channel in &layer.channel_data.list {
        if let (name, FlatSamples::F32(samples)) = (channel.name.to_string(), &channel.sample_data)
            && wanted(&name)
        {
            if samples.iter().any(|sample| !sample.is_finite()) {
                return Err(Error::new(format!("the channel {name} holds values that are not finite"))
                    .hint("render the scene again"));
            }
            planes.insert(name, samples.clone());
        }
    }
    let size = [layer.size.width(), layer.size.height()].map(|side| side as u64);
    check(&camera, &responses, size)?;
    Ok(Rendered { scene, camera: camera.settled(), responses, planes })
}

/// Refuses a file whose header announces more pixels than it can hold.
pub(super) fn check_size(bytes: &[u8], undecodable: &dyn Fn(&exr::error::Error) -> Error) -> Result<()> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|e| undecodable(&e))?;
    let room = (bytes.len() as u64).saturating_mul(MOST_INFLATION);
    for header in &meta.headers {
        let [width, height] = [header.layer_size.width(), header.layer_size.height()].map(|side| side as u64);
        let bytes_per_pixel: u64 =
            header.channels.list.iter().map(|channel| channel.sample_type.bytes_per_sample() as u64).sum();
        if width.saturating_mul(height).saturating_mul(bytes_per_pixel) > room {
            return Err(Error::new(format!(
                "its header announces {width} x {height} pixels, more than its {} bytes can hold",
                bytes.len()
            ))
            .hint("the file is cut short or its header wrong; write it anew"));
        }
    }
    Ok(())
}

fn of_json<'de, T: Deserialize<'de>>(json: &'de str, attribute: &str) -> Result<T> {
    serde_json::from_str(json).map_err(|e| {
        let what = e.to_string();
        let what = what.split(" at line").next().unwrap_or_default();
        Error::new(format!("its attribute \"{attribute}\" cannot be read ({what})"))
            .hint("render the scene again with this version")
    })
}

/// Whether a record can be developed from: only files that were changed by hand cannot.
fn check(camera: &CameraRecord, responses: &Responses, size: [u64; 2]) -> Result<()> {
    let wrong = |what: String| Err(Error::new(what).hint("render the scene again"));
    if camera.optics.resolution.map(u64::from) != size {
        let [width, height] = camera.optics.resolution;
        return wrong(format!(
            "it has {} x {} pixels, but its facts say {width} x {height}",
            size[0], size[1]
        ));
    }
    let positive = [
        (camera.iso, "iso"),
        (camera.shutter_s, "shutter_s"),
        (camera.f_stop, "f_stop"),
        (camera.sensor_exposure_constant_q, "sensor_exposure_constant_q"),
        (camera.electrons_per_weighted_joule, "electrons_per_weighted_joule"),
        (camera.white.luminous_transmission, "white.luminous_transmission"),
        (camera.optics.tan_half_extent[0], "tan_half_extent"),
        (camera.optics.tan_half_extent[1], "tan_half_extent"),
        (camera.optics.image_distance_mm, "image_distance_mm"),
    ];
    if let Some((value, key)) = positive.into_iter().find(|(value, _)| !(*value > 0.0 && value.is_finite())) {
        return wrong(format!("its camera's {key} of {value} is not a positive number"));
    }
    if camera.electronics.as_ref().is_some_and(|electronics| !electronics.is_sound()) {
        return wrong("its camera's electronics are those of no sensor".to_owned());
    }
    if !camera.vignetting.is_sound() {
        return wrong("its camera's vignetting is no profile".to_owned());
    }
    camera.tone.check()?;
    let channels = camera.channels.len();
    let points = crate::spectrum::GRID_POINTS;
    let fits = |response: &Vec<f32>| response.len() == points;
    if channels == 0
        || camera.white.channels.len() != channels
        || responses.channels.len() != channels
        || !responses.channels.iter().chain(&responses.lens_transmission).all(fits)
    {
        return wrong("its channels and their responses do not fit together".to_owned());
    }
    match &camera.matrix {
        Some(matrix) => matrix.check(channels),
        None => Ok(()),
    }
}

/// The facts of a render as their JSON text; an error names the file and what it lacks.
pub fn read_facts(path: &Path) -> Result<String> {
    std::fs::File::open(path).map_err(|e| Error::io(path, "read the render", &e))?;
    let undecodable = |e: &exr::error::Error| {
        Error::new(format!("cannot be decoded ({})", e.to_string().to_lowercase())).hint(REMEDY).in_file(path)
    };
    let data = MetaData::read_from_file(path, false).map_err(|e| undecodable(&e))?;
    let attribute = |header: &exr::meta::header::Header| match header
        .own_attributes
        .other
        .get(&Text::from(FACTS_ATTRIBUTE))
    {
        Some(AttributeValue::Text(text)) => Some(text.to_string()),
        _ => None,
    };
    data.headers
        .iter()
        .find_map(attribute)
        .ok_or_else(|| Error::new("it has no attribute \"etalon\"").hint(REMEDY).in_file(path))
}
