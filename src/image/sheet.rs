//! A contact sheet of small pictures with captions.

use super::safely::write_whole;
use crate::camera::{Development, Film};
use crate::error::Result;
use font8x8::{BASIC_FONTS, UnicodeFonts as _};
use image::imageops::{FilterType, resize};
use image::{ImageFormat, Rgb, RgbImage};
use std::path::Path;

/// Widest picture on a sheet, in pixels.
const WIDEST: u32 = 160;
/// Side of a character, in pixels.
const CHARACTER: u32 = 8;
/// Free space around pictures and captions.
const MARGIN: u32 = 4;
const PAPER: Rgb<u8> = Rgb([32, 32, 32]);
const INK: Rgb<u8> = Rgb([224, 224, 224]);

/// A picture on a sheet.
#[derive(Clone, Copy, Debug)]
pub struct Tile<'f> {
    /// Column and row.
    pub place: [u32; 2],
    /// What stands under it.
    pub caption: &'f str,
    /// The picture.
    pub film: &'f Film,
    /// How it is developed.
    pub development: Development,
}

/// Writes a sheet of tiles of equal size as PNG.
pub fn write_sheet(path: &Path, tiles: &[Tile<'_>]) -> Result<()> {
    let [width, height] = tiles.first().map_or([1, 1], |tile| tile.film.resolution());
    let scale = (f64::from(WIDEST) / f64::from(width)).min(1.0);
    let size = [width, height].map(|side| ((f64::from(side) * scale).round() as u32).max(1));
    let cell = [size[0] + 2 * MARGIN, size[1] + CHARACTER + 3 * MARGIN];
    let count = |axis: usize| 1 + tiles.iter().map(|tile| tile.place[axis]).max().unwrap_or(0);
    let mut sheet = RgbImage::from_pixel(count(0) * cell[0], count(1) * cell[1], PAPER);
    for tile in tiles {
        let [left, top] = [0, 1].map(|axis| tile.place[axis] * cell[axis] + MARGIN);
        let small = resize(&developed(tile), size[0], size[1], FilterType::Triangle);
        image::imageops::replace(&mut sheet, &small, i64::from(left), i64::from(top));
        write_text(&mut sheet, tile.caption, [left, top + size[1] + MARGIN]);
    }
    write_whole(path, "contact sheet", |to| sheet.write_to(to, ImageFormat::Png).map_err(|e| e.to_string()))
}

fn developed(tile: &Tile<'_>) -> RgbImage {
    let [width, height] = tile.film.resolution();
    RgbImage::from_fn(width, height, |column, row| {
        let pixel = (row * width + column) as usize;
        let display = tile.development.display([0, 1, 2].map(|channel| tile.film.mean(pixel, channel)));
        Rgb(display.map(|c| (c * 255.0).round() as u8))
    })
}

fn write_text(sheet: &mut RgbImage, text: &str, [left, top]: [u32; 2]) {
    for (index, character) in (0..).zip(text.chars()) {
        let Some(rows) = BASIC_FONTS.get(character) else { continue };
        for (y, bits) in (0..).zip(rows) {
            for x in (0..CHARACTER).filter(|x| bits >> x & 1 == 1) {
                let [x, y] = [left + index * CHARACTER + x, top + y];
                if x < sheet.width() && y < sheet.height() {
                    sheet.put_pixel(x, y, INK);
                }
            }
        }
    }
}
