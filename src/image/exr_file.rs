//! OpenEXR with 32-bit floats: absolute tristimulus values, their errors, further channels.

use super::facts::Facts;
use super::safely::write_whole;
use crate::camera::{FLAT_FIELD_CHANNEL, Film, Responses, Sensor};
use crate::error::Result;
use crate::scene::View;
use crate::spectrum::colour::xyz_to_linear_srgb;
use exr::prelude::*;
use std::path::Path;

/// Which channels a file gets beside the film's own.
#[derive(Clone, Copy, Debug, Default)]
pub struct Layers {
    /// Linear sRGB in cd/m2 (`R`, `G`, `B`), for viewers that know nothing else.
    pub linear_srgb: bool,
}

/// The facts stand in an attribute of this name, as JSON.
pub const FACTS_ATTRIBUTE: &str = "etalon";
/// The responses of the `sensor.*` channels stand in an attribute of this name, as JSON.
pub const RESPONSES_ATTRIBUTE: &str = "etalon_sensor";

/// Writes a film: `X`, `Y`, `Z` in cd/m2 and `stderr.*` with their standard errors, then the
/// sensor's further channels, and the view's flat field where it has one.
pub fn write_exr(path: &Path, film: &Film, view: &View, facts: &Facts, layers: Layers) -> Result<()> {
    let sensor = &view.sensor;
    let resolution = film.resolution().map(|side| side as usize);
    let mut channels: Vec<AnyChannel<FlatSamples>> = Vec::new();
    let mut add = |name: String, value_of_pixel: &dyn Fn(usize) -> f64| {
        let values: Vec<f32> = (0..film.pixels()).map(|pixel| value_of_pixel(pixel) as f32).collect();
        channels.push(AnyChannel::new(Text::new_or_panic(&name), FlatSamples::F32(values)));
    };
    for (index, channel) in sensor.channels.iter().enumerate() {
        add(channel.name.clone(), &|pixel| film.mean(pixel, index));
        if index < XYZ.len() {
            add(format!("stderr.{}", XYZ[index]), &|pixel| film.standard_error(pixel, index));
        }
    }
    if layers.linear_srgb {
        for (index, name) in ["R", "G", "B"].iter().enumerate() {
            let value = |pixel| xyz_to_linear_srgb([0, 1, 2].map(|c| film.mean(pixel, c)))[index];
            add((*name).to_owned(), &value);
        }
    }
    let flat_field = view.flat_field();
    if !flat_field.is_empty() {
        add(FLAT_FIELD_CHANNEL.to_owned(), &|pixel| f64::from(flat_field[pixel]));
    }
    let mut layer = Layer::new(
        (resolution[0], resolution[1]),
        attributes(facts, sensor),
        Encoding { compression: Compression::ZIP16, ..Encoding::default() },
        AnyChannels::sort(channels.into_iter().collect()),
    );
    layer.attributes.exposure = Some(facts.camera.shutter_s as f32);
    let mut image = Image::from_layer(layer);
    image.attributes.chromaticities =
        Some(if layers.linear_srgb { SRGB_CHROMATICITIES } else { XYZ_CHROMATICITIES });
    write_whole(path, "picture", |to| image.write().to_buffered(to).map_err(|e| e.to_string()))
}

const XYZ: [&str; 3] = ["X", "Y", "Z"];

/// X, Y, Z are their own primaries, with equal energy white (OpenEXR's advice for CIE XYZ).
const XYZ_CHROMATICITIES: attribute::Chromaticities = attribute::Chromaticities {
    red: Vec2(1.0, 0.0),
    green: Vec2(0.0, 1.0),
    blue: Vec2(0.0, 0.0),
    white: Vec2(1.0 / 3.0, 1.0 / 3.0),
};
/// Of the channels R, G, B where there are any (IEC 61966-2-1).
const SRGB_CHROMATICITIES: attribute::Chromaticities = attribute::Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.3, 0.6),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.329),
};

fn attributes(facts: &Facts, sensor: &Sensor) -> LayerAttributes {
    let text = |value: &str| Text::new_or_none(value);
    let mut attributes = LayerAttributes {
        software_name: text(&format!("etalon {}", facts.version)),
        comments: text(&facts.scene),
        // One unit of a channel is one cd/m2.
        white_luminance: Some(1.0),
        aperture: Some(facts.camera.f_stop as f32),
        iso_speed: Some(facts.camera.iso as f32),
        ..LayerAttributes::default()
    };
    let json = ascii_only(&serde_json::to_string(facts).expect("the facts are plain data"));
    let mut other = |name: &str, value: AttributeValue| {
        attributes.other.insert(Text::new_or_panic(name), value);
    };
    other(FACTS_ATTRIBUTE, AttributeValue::Text(Text::from(json.as_str())));
    if sensor.recorded().any(|channel| channel.name.starts_with("sensor.")) {
        let json = serde_json::to_string(&Responses::of(sensor)).expect("responses are plain data");
        other(RESPONSES_ATTRIBUTE, AttributeValue::Text(Text::from(json.as_str())));
    }
    // A standard attribute by name, in mm, that the library keeps among the others.
    other("focalLength", AttributeValue::F32(facts.camera.focal_length_mm as f32));
    if sensor.channels.iter().any(|channel| channel.name.starts_with("S0.")) {
        other("spectralLayoutVersion", AttributeValue::Text(Text::from("1.0")));
        other("emissiveUnits", AttributeValue::Text(Text::from("W.m^-2.sr^-1.nm^-1")));
    }
    attributes
}

/// JSON with everything beyond ASCII escaped: EXR text has one byte per character.
pub(super) fn ascii_only(json: &str) -> String {
    let escape = |unit: &u16| format!("\\u{unit:04x}");
    json.chars()
        .map(|c| match c {
            ' '..='~' => c.to_string(),
            _ => c.encode_utf16(&mut [0; 2]).iter().map(escape).collect(),
        })
        .collect()
}
