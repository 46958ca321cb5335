//! Developed pictures: PNG and JPEG with 8 bits, TIFF with 16 bits, EXR linear; raw values.

use super::exif::Label;
use super::exr_file::ascii_only;
use super::safely::{Writer, write_whole};
use crate::camera::{Count, Darkroom};
use crate::error::{Error, Result};
use exr::prelude::{AttributeValue, SpecificChannels, Text, WritableImage as _, attribute};
use image::codecs::{jpeg::JpegEncoder, png::PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use rayon::prelude::*;
use std::path::Path;
use tiff::encoder::{TiffEncoder, colortype};
use tiff::tags::Tag;

/// Endings of the files that a developed picture may be.
pub const DEVELOPED_ENDINGS: [&str; 5] = ["png", "tif", "tiff", "jpg", "jpeg"];

/// A developed EXR says what it is in an attribute of this name.
const DEVELOPED_ATTRIBUTE: &str = "etalon_developed";
/// Quality of JPEG files, of 100: losses below the steps of 8 bits nearly everywhere.
const JPEG_QUALITY: u8 = 95;

type Written = std::result::Result<(), String>;

/// Develops a picture and writes it as PNG, TIFF, JPEG or EXR, by the file's ending.
pub fn write_developed(path: &Path, darkroom: &Darkroom<'_>, label: &Label<'_>) -> Result<()> {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    match ending.as_str() {
        "png" | "jpg" | "jpeg" => {
            write_whole(path, "picture", |to| write_8_bits(to, darkroom, label, ending == "png"))
        }
        "tif" | "tiff" => write_whole(path, "picture", |to| write_tiff(to, darkroom, label)),
        "exr" => write_whole(path, "picture", |to| write_linear(to, darkroom, label)),
        _ => Err(Error::new("a developed picture is a PNG, a TIFF, a JPEG or an EXR")
            .hint("end the file's name in .png, .tiff, .jpg or .exr")
            .in_file(path)),
    }
}

/// Encoded values of all pixels, each times `scale` and rounded.
fn encoded(darkroom: &Darkroom<'_>, scale: f64) -> Vec<f64> {
    let [width, height] = darkroom.resolution().map(|side| side as usize);
    let pixels = (0..width * height).into_par_iter();
    pixels.flat_map_iter(|pixel| darkroom.display(pixel).map(|c| (c * scale).round())).collect()
}

fn write_8_bits(to: &mut Writer, darkroom: &Darkroom<'_>, label: &Label<'_>, as_png: bool) -> Written {
    let [width, height] = darkroom.resolution();
    let bytes: Vec<u8> = encoded(darkroom, 255.0).iter().map(|c| *c as u8).collect();
    let exif = label.block().map_err(|e| e.to_string())?;
    let written = if as_png {
        write_with(PngEncoder::new(to), exif, &bytes, [width, height])
    } else {
        write_with(JpegEncoder::new_with_quality(to, JPEG_QUALITY), exif, &bytes, [width, height])
    };
    written.map_err(|e| e.to_string())
}

fn write_with(
    mut encoder: impl ImageEncoder,
    exif: Vec<u8>,
    bytes: &[u8],
    [width, height]: [u32; 2],
) -> image::ImageResult<()> {
    encoder.set_exif_metadata(exif).map_err(image::ImageError::Unsupported)?;
    encoder.write_image(bytes, width, height, ExtendedColorType::Rgb8)
}

fn write_tiff(to: &mut Writer, darkroom: &Darkroom<'_>, label: &Label<'_>) -> Written {
    let values: Vec<u16> = encoded(darkroom, 65_535.0).iter().map(|c| *c as u16).collect();
    write_page::<colortype::RGB16>(
        &mut TiffEncoder::new(to).map_err(|e| e.to_string())?,
        darkroom.resolution(),
        &values,
        label,
        None,
    )
    .map_err(|e| e.to_string())
}

/// Writes a picture of 16 bits into a TIFF, with its EXIF and, where given, a name of its own.
fn write_page<C: colortype::ColorType<Inner = u16>>(
    encoder: &mut TiffEncoder<&mut Writer>,
    [width, height]: [u32; 2],
    values: &[u16],
    label: &Label<'_>,
    page: Option<&str>,
) -> std::result::Result<(), tiff::TiffError> {
    /// Tag PageName of TIFF 6.0.
    const PAGE_NAME: u16 = 285;
    let exif = label.write_exif(encoder)?;
    let mut picture = encoder.new_image::<C>(width, height)?;
    label.write_main(picture.encoder(), exif)?;
    if let Some(page) = page {
        picture.encoder().write_tag(Tag::Unknown(PAGE_NAME), page)?;
    }
    picture.write_data(values)
}

/// Writes digital values as they are in a TIFF of 16 bits: three channels as red, green and
/// blue of one picture, any other number as a page for each, called like the channel.
pub fn write_raw(path: &Path, darkroom: &Darkroom<'_>, label: &Label<'_>) -> Result<()> {
    let camera = label.camera;
    if camera.electronics.as_ref().is_none_or(|electronics| electronics.digital.is_none()) {
        return Err(Error::new("the render's camera has no digital values")
            .hint("add electronics with a bit_depth to the scene and render again"));
    }
    let channels: Vec<Vec<Count>> =
        (0..camera.channels.len()).filter_map(|channel| darkroom.counts(channel)).collect();
    write_whole(path, "picture", |to| {
        let mut encoder = TiffEncoder::new(to).map_err(|e| e.to_string())?;
        let size = darkroom.resolution();
        let written = if let [red, green, blue] = channels.as_slice() {
            let pixels = red.iter().zip(green).zip(blue);
            let values: Vec<u16> =
                pixels.flat_map(|((r, g), b)| [r, g, b].map(|count| count.level as u16)).collect();
            write_page::<colortype::RGB16>(&mut encoder, size, &values, label, None)
        } else {
            channels.iter().zip(&camera.channels).try_for_each(|(counts, channel)| {
                let values: Vec<u16> = counts.iter().map(|count| count.level as u16).collect();
                write_page::<colortype::Gray16>(&mut encoder, size, &values, label, Some(&channel.name))
            })
        };
        written.map_err(|e| e.to_string())
    })
}

/// Linear sRGB with 1 at display white, not clipped, and the luminance that 1 stands for.
fn write_linear(to: &mut Writer, darkroom: &Darkroom<'_>, label: &Label<'_>) -> Written {
    let [width, height] = darkroom.resolution().map(|side| side as usize);
    let pixel = |position: exr::math::Vec2<usize>| {
        let [r, g, b] = darkroom.linear(position.y() * width + position.x()).map(|c| c as f32);
        (r, g, b)
    };
    let channels = SpecificChannels::rgb(pixel);
    let mut picture = exr::image::Image::from_channels((width, height), channels);
    let camera = label.camera;
    let attributes = &mut picture.layer_data.attributes;
    attributes.software_name = Text::new_or_none(Label::software());
    attributes.comments = Text::new_or_none(label.description());
    attributes.white_luminance = Some(camera.white_luminance_cd_m2 as f32);
    attributes.exposure = Some(camera.shutter_s as f32);
    attributes.aperture = Some(camera.f_stop as f32);
    attributes.iso_speed = Some(camera.iso as f32);
    let json = ascii_only(&serde_json::to_string(camera).expect("a record is plain data"));
    let mut other = |name: &str, value| attributes.other.insert(Text::new_or_panic(name), value);
    other("focalLength", AttributeValue::F32(camera.focal_length_mm as f32));
    other(DEVELOPED_ATTRIBUTE, AttributeValue::Text(Text::from(json.as_str())));
    // ITU-R BT.709, with the white of D65.
    picture.attributes.chromaticities = Some(attribute::Chromaticities {
        red: exr::math::Vec2(0.64, 0.33),
        green: exr::math::Vec2(0.30, 0.60),
        blue: exr::math::Vec2(0.15, 0.06),
        white: exr::math::Vec2(0.3127, 0.3290),
    });
    picture.write().to_buffered(to).map_err(|e| e.to_string())
}
