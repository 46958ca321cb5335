//! The luminance of an EXR of any renderer, with what the file says of units and of noise.
//!
//! Channels are X, Y, Z, or linear R, G, B with the file's primaries, or Y alone, by themselves or
//! in one layer. Units are what the facts of a render say; else the attribute `whiteLuminance`,
//! cd/m2 of the value one (of R = G = B = 1); else what the caller says. Nothing is guessed but the
//! primaries: those of ITU-R BT.709, as OpenEXR has it where a file states none, with a note.

use super::exr_file::FACTS_ATTRIBUTE;
use super::exr_read::{MOST_BYTES, check_size};
use super::stated::Stated;
use crate::error::{Error, Result};
use crate::input;
use exr::meta::MetaData;
use exr::meta::attribute::Chromaticities;
use exr::prelude::*;
use glam::{DMat3, DVec3};
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

/// What gives the values of a file their unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unit {
    /// Known: values are in cd/m2.
    CandelasPerSquareMetre,
    /// Not known: values are as in the file.
    Unknown,
}

/// The luminance of a picture.
#[derive(Clone, Debug)]
pub struct LuminancePicture {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// Upper left pixel of the picture in its frame.
    pub position: [i32; 2],
    /// X, Y and Z in rows, in cd/m2 where the unit is known; X and Z are empty where the file has Y
    /// alone.
    pub xyz: [Vec<f64>; 3],
    /// Standard error of every Y, in its unit.
    pub standard_error: Option<Vec<f64>>,
    /// The unit.
    pub unit: Unit,
    /// The channels that it is from, such as `R, G, B`.
    pub channels: String,
    /// What a render's facts say, where there are any.
    pub stated: Stated,
    /// What was assumed, in words.
    pub notes: Vec<String>,
}

/// Channels of one layer by their names within it.
type Named<'c> = BTreeMap<String, &'c FlatSamples>;

const BT_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.3, 0.6),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.329),
};

/// Reads a file; `layer` names the layer where there are several with a picture, and
/// `luminance_of_one` the cd/m2 of the value one, which goes before what the file says.
///
/// # Errors
/// Files that are no EXR, deep or subsampled ones, ones without a picture or with several.
pub fn read_luminance(
    path: &Path,
    layer: Option<&str>,
    luminance_of_one: Option<f64>,
) -> Result<LuminancePicture> {
    let bytes = input::read_bytes(path, MOST_BYTES).map_err(|e| Error::io(path, "read the picture", &e))?;
    parse(&bytes, layer, luminance_of_one).map_err(|e| e.in_file(path))
}

fn parse(bytes: &[u8], layer: Option<&str>, luminance_of_one: Option<f64>) -> Result<LuminancePicture> {
    let undecodable = |e: &exr::error::Error| {
        let what = e.to_string().to_lowercase();
        Error::new(format!("cannot be decoded ({what})")).hint("give an OpenEXR file with flat pixels")
    };
    check_size(bytes, &undecodable)?;
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|e| undecodable(&e))?;
    refuse_unsupported(&meta)?;
    let reader = read().no_deep_data().largest_resolution_level().all_channels().all_layers();
    let image = reader.all_attributes().from_buffered(Cursor::new(bytes)).map_err(|e| undecodable(&e))?;
    let found: Vec<_> = image.layer_data.iter().flat_map(pictures_of).collect();
    let (part, name, channels) = choose(&found, layer)?;
    let size = [part.size.width(), part.size.height()];
    let facts = part.attributes.other.get(&Text::from(FACTS_ATTRIBUTE));
    let stated = match facts {
        Some(AttributeValue::Text(json)) => Stated::of_json(&json.to_string())?,
        _ => Stated::default(),
    };
    let unit = luminance_of_one
        .or(stated.is_in_cd_m2().then_some(1.0))
        .or(part.attributes.white_luminance.map(f64::from))
        .filter(|unit| *unit > 0.0 && unit.is_finite());
    let mut notes = Vec::new();
    if luminance_of_one.is_some() && stated.is_in_cd_m2() {
        notes.push("its facts say cd/m2; the factor that was given goes before them".to_owned());
    }
    let (xyz, read) = tristimulus(channels, image.attributes.chromaticities, &mut notes)?;
    let factor = unit.unwrap_or(1.0);
    let scaled = |values: Vec<f64>| values.into_iter().map(|value| factor * value).collect::<Vec<f64>>();
    let standard_error = channels.get("stderr.Y").map(|samples| scaled(values(samples)));
    let prefix = if name.is_empty() { String::new() } else { format!(" of layer \"{name}\"") };
    Ok(LuminancePicture {
        size,
        position: [part.attributes.layer_position.x(), part.attributes.layer_position.y()],
        xyz: xyz.map(scaled),
        standard_error,
        unit: if unit.is_some() { Unit::CandelasPerSquareMetre } else { Unit::Unknown },
        channels: format!("{read}{prefix}"),
        stated,
        notes,
    })
}

fn refuse_unsupported(meta: &MetaData) -> Result<()> {
    for header in &meta.headers {
        if header.deep {
            return Err(Error::new("it has deep pixels").hint("flatten it to one value per pixel"));
        }
        if let Some(channel) = header.channels.list.iter().find(|channel| channel.sampling != Vec2(1, 1)) {
            return Err(Error::new(format!("its channel {} is subsampled", channel.name))
                .hint("write all channels at full resolution"));
        }
    }
    Ok(())
}

/// A part of the file, the name of a layer in it, and that layer's channels.
type Found<'i> = (&'i Layer<AnyChannels<FlatSamples>>, String, Named<'i>);

/// The layers of a part of the file that hold a picture. A layer is what stands before the last
/// point of a channel's name, apart from `stderr.`, which goes with its picture.
fn pictures_of(part: &Layer<AnyChannels<FlatSamples>>) -> Vec<Found<'_>> {
    let part_name = part.attributes.layer_name.as_ref().map(ToString::to_string).unwrap_or_default();
    let mut layers: BTreeMap<String, Named<'_>> = BTreeMap::new();
    for channel in &part.channel_data.list {
        let full = channel.name.to_string();
        let (layer, name) = match full.strip_suffix(".Y").and_then(|it| it.strip_suffix("stderr")) {
            Some(layer) => (layer.trim_end_matches('.'), "stderr.Y".to_owned()),
            None => {
                full.rsplit_once('.').map_or(("", full.clone()), |(layer, name)| (layer, name.to_owned()))
            }
        };
        layers.entry(layer.to_owned()).or_default().insert(name, &channel.sample_data);
    }
    let named = |layer: String| match (part_name.is_empty(), layer.is_empty()) {
        (true, _) => layer,
        (false, true) => part_name.clone(),
        (false, false) => format!("{part_name}.{layer}"),
    };
    let holds =
        |channels: &Named<'_>| SETS.iter().any(|set| set.iter().all(|name| channels.contains_key(*name)));
    layers.into_iter().filter(|(_, c)| holds(c)).map(|(layer, c)| (part, named(layer), c)).collect()
}

/// What a picture is made of, in the order of preference.
const SETS: [&[&str]; 3] = [&["X", "Y", "Z"], &["R", "G", "B"], &["Y"]];

fn choose<'f, 'i>(
    found: &'f [Found<'i>],
    layer: Option<&str>,
) -> Result<(&'i Layer<AnyChannels<FlatSamples>>, &'f str, &'f Named<'i>)> {
    // Renderers call the picture itself so, beside layers of other quantities.
    const ROOTS: [&str; 2] = ["", "<root>"];
    let names: Vec<&str> = found.iter().map(|(_, name, _)| name.as_str()).collect();
    let by = |wanted: &dyn Fn(&str) -> bool| found.iter().find(|(_, name, _)| wanted(name));
    let chosen = match layer {
        Some(layer) if names.iter().all(|name| name.is_empty()) => {
            return Err(Error::new(format!("it has no layers, and none is called \"{layer}\""))
                .hint("leave out --layer-a or --layer-b: the file is one picture"));
        }
        Some(layer) => by(&|name| name == layer)
            .ok_or_else(|| Error::unknown_name("layer", layer, names.iter().copied()))?,
        None if found.len() == 1 => &found[0],
        None => by(&|name| ROOTS.contains(&name)).ok_or_else(|| match found {
            [] => Error::new("it has no channels X, Y, Z, nor R, G, B, nor Y")
                .hint("write the picture with one of these sets of channels"),
            _ => Error::new(format!("it has several layers with a picture: {}", names.join(", ")))
                .hint("choose one with --layer-a or --layer-b"),
        })?,
    };
    Ok((chosen.0, &chosen.1, &chosen.2))
}

fn values(samples: &FlatSamples) -> Vec<f64> {
    samples.values_as_f32().map(f64::from).collect()
}

/// X, Y, Z of the channels as they stand, and which channels those are.
fn tristimulus(
    channels: &Named<'_>,
    primaries: Option<Chromaticities>,
    notes: &mut Vec<String>,
) -> Result<([Vec<f64>; 3], &'static str)> {
    let get = |name: &str| channels.get(name).map(|samples| values(samples));
    let all = |names: [&str; 3]| Some([get(names[0])?, get(names[1])?, get(names[2])?]);
    if let Some(xyz) = all(["X", "Y", "Z"]) {
        return Ok((xyz, "X, Y, Z"));
    }
    if let Some([red, green, blue]) = all(["R", "G", "B"]) {
        if primaries.is_none() {
            notes.push(
                "it states no chromaticities: R, G, B are taken for linear ITU-R BT.709 (sRGB)".to_owned(),
            );
        }
        let matrix = to_xyz(primaries.unwrap_or(BT_709))?;
        let row = |row: usize| {
            let weights = matrix.row(row);
            let mixed = |((r, g), b): ((&f64, &f64), &f64)| weights.dot(DVec3::new(*r, *g, *b));
            red.iter().zip(&green).zip(&blue).map(mixed).collect()
        };
        return Ok(([row(0), row(1), row(2)], "R, G, B"));
    }
    Ok(([Vec::new(), get("Y").unwrap_or_default(), Vec::new()], "Y"))
}

/// From linear R, G, B to X, Y, Z, with Y = 1 for R = G = B = 1.
///
/// SMPTE RP 177, "Derivation of basic television color equations".
fn to_xyz(primaries: Chromaticities) -> Result<DMat3> {
    let place =
        |Vec2(x, y): Vec2<f32>| DVec3::new(f64::from(x), f64::from(y), 1.0 - f64::from(x) - f64::from(y));
    let Chromaticities { red, green, blue, white } = primaries;
    let columns = DMat3::from_cols(place(red), place(green), place(blue));
    let white = place(white);
    let matrix = columns * DMat3::from_diagonal(columns.inverse() * (white / white.y));
    /// Far beyond what any primaries give: three that lie on a line, or a white without luminance.
    const LARGEST: f64 = 1e3;
    let is_sound = matrix.to_cols_array().iter().all(|value| value.abs() < LARGEST);
    is_sound.then_some(matrix).ok_or_else(|| {
        Error::new("its chromaticities are those of no primaries")
            .hint("correct the attribute, or leave it out")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// IEC 61966-2-1 has Y = 0.2126 R + 0.7152 G + 0.0722 B, to four digits.
    #[test]
    fn luminance_of_bt_709() {
        let matrix = to_xyz(BT_709).expect("primaries");
        for (weight, truth) in matrix.row(1).to_array().into_iter().zip([0.2126, 0.7152, 0.0722]) {
            assert!((weight - truth).abs() < 1e-4, "{weight}, truth {truth}");
        }
    }

    #[test]
    fn primaries_on_a_line_are_refused() {
        let line = Chromaticities { green: Vec2(0.4, 0.2), ..BT_709 };
        let line = Chromaticities { red: Vec2(0.5, 0.3), blue: Vec2(0.3, 0.1), ..line };
        assert!(to_xyz(line).is_err());
    }
}
