//! EXIF: the settings of a camera where other programs look for them.
//!
//! An EXIF block is a TIFF without a picture (CIPA DC-008, EXIF 2.32), so the library that
//! writes TIFF files writes both.

use crate::camera::{CameraRecord, Tone};
use std::io::{Cursor, Seek, Write};
use tiff::encoder::{DirectoryEncoder, Rational, TiffEncoder, TiffKind, TiffValue};
use tiff::tags::{Tag, Type};
use tiff::{Directory, TiffError};

/// What a developed picture says about itself.
#[derive(Clone, Copy, Debug)]
pub struct Label<'a> {
    /// Name of the scene.
    pub scene: &'a str,
    /// The camera.
    pub camera: &'a CameraRecord,
    /// How values are encoded.
    pub tone: Tone,
}

/// Tags of the EXIF directory, by their numbers in CIPA DC-008.
mod tag {
    pub const EXPOSURE_TIME: u16 = 0x829A;
    pub const F_NUMBER: u16 = 0x829D;
    pub const PHOTOGRAPHIC_SENSITIVITY: u16 = 0x8827;
    pub const SENSITIVITY_TYPE: u16 = 0x8830;
    pub const ISO_SPEED: u16 = 0x8833;
    pub const EXIF_VERSION: u16 = 0x9000;
    pub const FOCAL_LENGTH: u16 = 0x920A;
    pub const COLOR_SPACE: u16 = 0xA001;
    pub const WHITE_BALANCE: u16 = 0xA403;
}

impl Label<'_> {
    /// The program that made the picture.
    pub fn software() -> String {
        format!("etalon {}", env!("CARGO_PKG_VERSION"))
    }

    /// The scene's name in the characters that EXIF has.
    pub fn description(&self) -> String {
        self.scene.chars().map(|c| if matches!(c, ' '..='~') { c } else { '?' }).collect()
    }

    /// The whole block, for formats that carry one.
    pub fn block(&self) -> Result<Vec<u8>, TiffError> {
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut bytes)?;
        let exif = self.write_exif(&mut encoder)?;
        let mut main = encoder.image_directory()?;
        self.write_main(&mut main, exif)?;
        main.finish()?;
        Ok(bytes.into_inner())
    }

    /// Writes the EXIF directory; where it begins comes back.
    pub fn write_exif<W: Write + Seek, K: TiffKind>(
        &self,
        encoder: &mut TiffEncoder<W, K>,
    ) -> Result<K::OffsetType, TiffError> {
        let mut exif = encoder.extra_directory()?;
        let camera = self.camera;
        exif.write_tag(Tag::Unknown(tag::EXPOSURE_TIME), rational(camera.shutter_s))?;
        exif.write_tag(Tag::Unknown(tag::F_NUMBER), rational(camera.f_stop))?;
        exif.write_tag(Tag::Unknown(tag::FOCAL_LENGTH), rational(camera.focal_length_mm))?;
        // A short number holds no more; the long ISOSpeed beside it says the rest.
        let iso = camera.iso.round().clamp(1.0, f64::from(u32::MAX));
        exif.write_tag(Tag::Unknown(tag::PHOTOGRAPHIC_SENSITIVITY), iso.min(f64::from(u16::MAX)) as u16)?;
        const ISO_SPEED_TYPE: u16 = 3;
        exif.write_tag(Tag::Unknown(tag::SENSITIVITY_TYPE), ISO_SPEED_TYPE)?;
        exif.write_tag(Tag::Unknown(tag::ISO_SPEED), iso as u32)?;
        const SRGB: u16 = 1;
        const UNCALIBRATED: u16 = 0xFFFF;
        let space = if self.tone == Tone::Srgb { SRGB } else { UNCALIBRATED };
        exif.write_tag(Tag::Unknown(tag::COLOR_SPACE), space)?;
        const MANUAL: u16 = 1;
        exif.write_tag(Tag::Unknown(tag::WHITE_BALANCE), MANUAL)?;
        let version = exif.write_entry_bytes(Type::UNDEFINED, b"0232")?;
        let mut more = Directory::empty();
        more.extend([(Tag::from_u16_exhaustive(tag::EXIF_VERSION), version)]);
        exif.extend_from(&more);
        Ok(exif.finish_with_offsets()?.offset)
    }

    /// Writes the tags that stand beside a picture.
    pub fn write_main<W: Write + Seek, K: TiffKind>(
        &self,
        directory: &mut DirectoryEncoder<'_, W, K>,
        exif: K::OffsetType,
    ) -> Result<(), TiffError>
    where
        K::OffsetType: TiffValue,
    {
        directory.write_tag(Tag::ImageDescription, self.description().as_str())?;
        directory.write_tag(Tag::Software, Self::software().as_str())?;
        directory.write_tag(Tag::ExifDirectory, exif)
    }
}

/// A positive number as a fraction, by its continued fraction: 1/90 s stays 1/90.
fn rational(value: f64) -> Rational {
    /// Nearer than settings are ever given.
    const NEAR: f64 = 1e-9;
    let limit = f64::from(u32::MAX);
    let value = value.clamp(1.0 / limit, limit);
    let ([mut n, mut d], [mut before_n, mut before_d]) = ([value.floor(), 1.0], [1.0, 0.0]);
    let mut rest = value - value.floor();
    while (n / d - value).abs() > NEAR * value && rest > 0.0 {
        let whole = (1.0 / rest).floor();
        let next = [whole * n + before_n, whole * d + before_d];
        if next[0] > limit || next[1] > limit {
            break;
        }
        rest = 1.0 / rest - whole;
        [before_n, before_d] = [n, d];
        [n, d] = next;
    }
    Rational { n: n as u32, d: d as u32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_fractions_that_photographers_write() {
        for (value, n, d) in [
            (1.0 / 90.0, 1, 90),
            (0.011_111_111_111, 1, 90),
            (5.6, 28, 5),
            (30.0, 30, 1),
            (0.5, 1, 2),
            (2e-10, 1, u32::MAX),
        ] {
            let Rational { n: above, d: below } = rational(value);
            assert_eq!((above, below), (n, d), "{value}");
        }
    }
}
