//! Levels of an even field, from whatever file a camera's maker or a user has them in.
//!
//! The one picture that a scene reads. A library that is built without pictures says so instead
//! of not knowing the key.

use crate::error::{Error, Result};
#[cfg(feature = "pictures")]
use exr::prelude::*;
use std::path::Path;

/// Levels of a picture of an even field: an EXR's channel Y or G, or the grey of a PNG or TIFF
/// taken as linear; size and values in rows from the top left.
///
/// # Errors
/// What cannot be decoded, or lacks the channel; every file, without the feature `pictures`.
#[cfg(feature = "pictures")]
pub fn read_levels(path: &Path, bytes: &[u8]) -> Result<([u32; 2], Vec<f32>)> {
    let undecodable = |e: &dyn std::fmt::Display| {
        let what = e.to_string().to_lowercase();
        Error::new(format!("cannot be decoded ({what})")).hint("give an EXR, PNG or TIFF, linear in light")
    };
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr")) {
        levels_of_exr(bytes, &undecodable)
    } else {
        grey_levels(bytes, &undecodable)
    }
}

/// The same.
///
/// # Errors
/// Always: this build reads no pictures.
#[cfg(not(feature = "pictures"))]
pub fn read_levels(_: &Path, _: &[u8]) -> Result<([u32; 2], Vec<f32>)> {
    Err(Error::not_built("flat fields from files", "pictures"))
}

#[cfg(feature = "pictures")]
fn grey_levels(
    bytes: &[u8],
    undecodable: &dyn Fn(&dyn std::fmt::Display) -> Error,
) -> Result<([u32; 2], Vec<f32>)> {
    let reader = image::ImageReader::new(std::io::Cursor::new(bytes)).with_guessed_format();
    let mut reader = reader.map_err(|e| undecodable(&e))?;
    let mut limits = image::Limits::default();
    limits.max_alloc = Some((bytes.len() as u64).saturating_mul(super::exr_read::MOST_INFLATION));
    reader.limits(limits);
    let picture = reader.decode().map_err(|e| undecodable(&e))?.into_luma16();
    let values = picture.as_raw().iter().map(|level| f32::from(*level)).collect();
    Ok(([picture.width(), picture.height()], values))
}

#[cfg(feature = "pictures")]
fn levels_of_exr(
    bytes: &[u8],
    undecodable: &dyn Fn(&dyn std::fmt::Display) -> Error,
) -> Result<([u32; 2], Vec<f32>)> {
    super::exr_read::check_size(bytes, &|e| undecodable(e))?;
    let reader = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let picture = reader.all_attributes().from_buffered(std::io::Cursor::new(bytes));
    let picture = picture.map_err(|e| undecodable(&e))?;
    let channels = &picture.layer_data.channel_data.list;
    let named = |name: &str| channels.iter().find(|channel| channel.name == *name);
    let Some(channel) = named("Y").or_else(|| named("G")) else {
        return Err(Error::new("the flat field has neither a channel Y nor G").hint("rename its channel"));
    };
    let size = [picture.layer_data.size.width(), picture.layer_data.size.height()].map(|side| side as u32);
    Ok((size, channel.sample_data.values_as_f32().collect()))
}
