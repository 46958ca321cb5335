//! A map of differences in standard errors: the sign by hue, the size by depth.
//!
//! White is no difference and full colour [`DEEPEST`] standard errors or more, so that what noise
//! alone makes stays pale.

use super::safely::write_whole;
use crate::error::Result;
use image::{ImageFormat, Rgb, RgbImage};
use std::path::Path;

/// Standard errors that get the full colour.
const DEEPEST: f64 = 5.0;
const BRIGHTER: [f64; 3] = [178.0, 24.0, 43.0];
const DARKER: [f64; 3] = [33.0, 102.0, 172.0];
/// Of pixels that nothing can be said of.
const UNKNOWN: Rgb<u8> = Rgb([128, 128, 128]);

/// Writes one pixel for each of `z`, in rows of `size[0]`, as PNG; NaN is grey.
pub fn write_z_map(path: &Path, size: [usize; 2], z: &[f64]) -> Result<()> {
    let [width, height] = size.map(|side| side as u32);
    let colour = |z: f64| {
        if z.is_nan() {
            return UNKNOWN;
        }
        let depth = (z.abs() / DEEPEST).min(1.0);
        let full = if z > 0.0 { BRIGHTER } else { DARKER };
        Rgb(full.map(|channel| (255.0 + depth * (channel - 255.0)).round() as u8))
    };
    let map = RgbImage::from_fn(width, height, |x, y| colour(z[y as usize * size[0] + x as usize]));
    write_whole(path, "map", |to| map.write_to(to, ImageFormat::Png).map_err(|e| e.to_string()))
}
