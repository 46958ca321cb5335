//! Developed pictures: PNG with 8 bits, TIFF with 16 bits, both sRGB-encoded.

use super::write_whole;
use crate::camera::{Development, Film};
use crate::error::{Error, Result};
use image::{ImageBuffer, ImageFormat, Rgb};
use std::path::Path;

/// Develops a film and writes it as PNG or TIFF, by the file's ending.
pub fn write_developed(path: &Path, film: &Film, development: &Development) -> Result<()> {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let colour = |column: u32, row: u32| {
        let pixel = row as usize * film.resolution()[0] as usize + column as usize;
        development.display([0, 1, 2].map(|channel| film.mean(pixel, channel)))
    };
    let [width, height] = film.resolution();
    match ending.as_str() {
        "png" => {
            let picture = ImageBuffer::from_fn(width, height, |x, y| {
                Rgb(colour(x, y).map(|c| (c * 255.0).round() as u8))
            });
            write_whole(path, |to| picture.save_with_format(to, ImageFormat::Png).map_err(|e| e.to_string()))
        }
        "tif" | "tiff" => {
            let picture = ImageBuffer::from_fn(width, height, |x, y| {
                Rgb(colour(x, y).map(|c| (c * 65_535.0).round() as u16))
            });
            write_whole(path, |to| picture.save_with_format(to, ImageFormat::Tiff).map_err(|e| e.to_string()))
        }
        _ => Err(Error::new("a developed picture is a PNG or a TIFF")
            .hint("end the file's name in .png or .tiff")
            .in_file(path)),
    }
}
