//! A picture from a camera's record and the channels of a file.

use super::develop::{Development, Matrix};
use super::electrons::{Count, Counter};
use super::vignetting::FLAT_FIELD_CHANNEL;
use super::{CIE_SENSOR, CameraRecord, Film, Sensor};
use crate::error::{Error, Result};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Channels of a picture by name, each in rows from the top left, in the 32 bits of a file.
pub type Planes = BTreeMap<String, Vec<f32>>;

/// The channels of a film that a picture can be developed from, as a file will hold them.
pub fn planes(film: &Film, sensor: &Sensor, flat_field: &[f32]) -> Planes {
    let recorded: Vec<&str> = sensor.recorded().map(|channel| channel.name.as_str()).collect();
    let mut planes: Planes = (0..)
        .zip(&sensor.channels)
        .filter(|(index, channel)| *index < 3 || recorded.contains(&channel.name.as_str()))
        .map(|(index, channel)| {
            let values = (0..film.pixels()).map(|pixel| film.mean(pixel, index) as f32).collect();
            (channel.name.clone(), values)
        })
        .collect();
    if !flat_field.is_empty() {
        planes.insert(FLAT_FIELD_CHANNEL.to_owned(), flat_field.to_vec());
    }
    planes
}

/// Develops the pixels of a file.
pub struct Darkroom<'a> {
    record: &'a CameraRecord,
    /// Planes that the picture is made of.
    shown: Vec<&'a [f32]>,
    /// Planes that the camera records.
    recorded: Vec<&'a [f32]>,
    /// Whether the two are the same.
    shows_recorded: bool,
    falloff: Option<Vec<f64>>,
    counter: Option<Counter<'a>>,
    /// What each channel is cut off at: where the first of them is full for the white, so that
    /// what is too bright is white and not the colour of the channels that have room left.
    highlights: Option<Vec<f64>>,
    way: Way<'a>,
}

/// How linear sRGB is made of a pixel's values.
enum Way<'a> {
    Tristimulus(Development),
    Matrix { matrix: &'a Matrix, white: &'a [f64], white_luminance_cd_m2: f64 },
}

impl<'a> Darkroom<'a> {
    /// Sets up for a camera's record; an error names a channel that is missing.
    pub fn new(record: &'a CameraRecord, planes: &'a Planes) -> Result<Self> {
        let plane = |name: &str| -> Result<&'a [f32]> {
            let plane = planes.get(name).filter(|plane| plane.len() == record.optics.pixels());
            plane.map(Vec::as_slice).ok_or_else(|| {
                Error::new(format!("the channel {name} is missing")).hint("render the scene again")
            })
        };
        let recorded =
            record.channels.iter().map(|channel| plane(&channel.name)).collect::<Result<Vec<_>>>()?;
        let (shown, shows_recorded) = if shows_recorded(record) {
            (recorded.clone(), true)
        } else {
            (["X", "Y", "Z"].into_iter().map(plane).collect::<Result<Vec<_>>>()?, false)
        };
        let flat_field = match &record.vignetting {
            super::Vignetting::FlatField { channel, .. } => plane(channel)?,
            _ => &[],
        };
        let exposure = record.exposure();
        let white_luminance_cd_m2 = exposure.white_luminance().0;
        let way = match &record.matrix {
            Some(matrix) => Way::Matrix { matrix, white: &record.white.channels, white_luminance_cd_m2 },
            // Behind the lens everything is darker by its transmission, the white as well.
            None if shows_recorded && record.has_lens_transmission => Way::Tristimulus(Development {
                white_luminance_cd_m2: white_luminance_cd_m2 * record.white.luminous_transmission,
                white: record.white_xyz.map(|_| record.white.behind_lens_xyz),
                tone: record.tone,
            }),
            None => Way::Tristimulus(Development {
                white_luminance_cd_m2,
                white: record.white_xyz,
                tone: record.tone,
            }),
        };
        let counter = record.counter();
        let highlights = record
            .full_luminance_cd_m2()
            .map(|full| record.white.channels.iter().map(|held| full * held).collect());
        Ok(Self {
            highlights,
            shown,
            recorded,
            shows_recorded,
            falloff: record.vignetting.over_picture(&record.optics, flat_field),
            counter,
            way,
            record,
        })
    }

    /// Width and height in pixels.
    pub const fn resolution(&self) -> [u32; 2] {
        self.record.optics.resolution
    }

    /// Linear sRGB of a pixel with 1 at display white, not clipped.
    pub fn linear(&self, pixel: usize) -> [f64; 3] {
        let values = self.shown.iter().enumerate().map(|(channel, plane)| {
            let value = f64::from(plane[pixel]);
            match &self.counter {
                Some(counter) if self.shows_recorded => {
                    let value = counter.value_of(&self.count(counter, pixel, channel));
                    self.highlights.as_ref().map_or(value, |highest| value.min(highest[channel]))
                }
                _ => self.falloff.as_ref().map_or(value, |falloff| value * falloff[pixel]),
            }
        });
        match &self.way {
            Way::Tristimulus(development) => {
                let mut xyz = [0.0; 3];
                xyz.iter_mut().zip(values).for_each(|(to, value)| *to = value);
                development.linear(xyz)
            }
            Way::Matrix { matrix, white, white_luminance_cd_m2 } => {
                let balanced: Vec<f64> = values.zip(*white).map(|(value, white)| value / white).collect();
                matrix.apply(&balanced).map(|c| c / white_luminance_cd_m2)
            }
        }
    }

    /// Encoded values of a pixel in 0..1.
    pub fn display(&self, pixel: usize) -> [f64; 3] {
        self.linear(pixel).map(|c| self.record.tone.encode(c))
    }

    fn count(&self, counter: &Counter<'_>, pixel: usize, channel: usize) -> Count {
        let falloff = self.falloff.as_ref().map_or(1.0, |falloff| falloff[pixel]);
        counter.count(f64::from(self.recorded[channel][pixel]), falloff, pixel as u64, channel as u64)
    }

    /// What the camera counts of a recorded channel, pixel by pixel; `None` without electronics.
    pub fn counts(&self, channel: usize) -> Option<Vec<Count>> {
        let counter = self.counter.as_ref()?;
        let pixels = 0..self.recorded[channel].len();
        Some(pixels.into_par_iter().map(|pixel| self.count(counter, pixel, channel)).collect())
    }

    /// Pixels in which a channel saturates; `None` without electronics.
    pub fn saturated_pixels(&self) -> Option<u64> {
        let counter = self.counter.as_ref()?;
        let saturates = |pixel: usize| {
            (0..self.recorded.len()).any(|channel| self.count(counter, pixel, channel).saturated)
        };
        Some((0..self.record.optics.pixels()).into_par_iter().filter(|pixel| saturates(*pixel)).count() as u64)
    }
}

/// Whether a picture is made of what the camera records: where a matrix leads from there to
/// colours, or where it records tristimulus values. Otherwise it is made of X, Y, Z.
pub fn shows_recorded(record: &CameraRecord) -> bool {
    record.matrix.is_some() || record.sensor == CIE_SENSOR
}
