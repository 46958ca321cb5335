//! Light lost towards the corners: none, the fourth power of the cosine, or as measured.
//!
//! Factors are relative to the optical axis and apply after the render: what the film holds is
//! the radiance of the scene.

use super::Optics;
use crate::error::{Error, Result};
use crate::spectrum::CsvTable;
use crate::spectrum::{Outside, Table};
use serde::{Deserialize, Serialize};

/// How illuminance at the sensor falls off from the axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(tag = "model", rename_all = "snake_case")]
pub enum Vignetting {
    /// Not at all.
    #[default]
    None,
    /// Natural vignetting of a thin lens: cos^4 of the angle from the axis.
    Cos4,
    /// A measured profile over the distance from the principal point, linear between its
    /// points, its end values held.
    RadialTable {
        /// The table's file, as the scene names it.
        file: String,
        /// What distance is counted in.
        coordinate: Coordinate,
        /// Rising distances.
        at: Vec<f64>,
        /// Illuminance there relative to the axis.
        relative_illuminance: Vec<f64>,
    },
    /// A measured picture of an even field; relative illuminance pixel by pixel stands in a
    /// channel of the EXR.
    FlatField {
        /// The picture's file, as the scene names it.
        file: String,
        /// Channel of the EXR with the relative illuminance.
        channel: String,
    },
}

/// The channel of an EXR that holds a flat field at the render's pixels.
pub const FLAT_FIELD_CHANNEL: &str = "vignetting";

/// What the distance from the principal point is counted in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Coordinate {
    /// Millimetres on the sensor.
    RadiusMm,
    /// Degrees from the axis.
    AngleDeg,
}

impl Vignetting {
    /// A radial profile from a table with columns `radius_mm` or `angle_deg`, and
    /// `relative_illuminance`.
    pub fn of_table(file: &str, table: &CsvTable) -> Result<Self> {
        let coordinate = match table.columns[0].as_str() {
            "radius_mm" => Coordinate::RadiusMm,
            "angle_deg" => Coordinate::AngleDeg,
            other => {
                return Err(Error::unknown_name("column", other, ["radius_mm", "angle_deg"])
                    .at(table.header_line(), Some(1)));
            }
        };
        let Some(relative_illuminance) = table.column("relative_illuminance") else {
            return Err(Error::new("the table has no column \"relative_illuminance\"")
                .hint("name the columns radius_mm,relative_illuminance")
                .at(table.header_line(), Some(1)));
        };
        let at: Vec<f64> = table.rows.iter().map(|row| row[0]).collect();
        let falls = |row: &usize| at[*row] < 0.0 || (*row > 0 && at[*row] <= at[*row - 1]);
        if let Some(row) = (0..at.len()).find(falls) {
            return Err(Error::new("distances from the axis must rise from 0 on")
                .hint("sort the rows")
                .at(table.line_of(row), Some(1)));
        }
        if let Some(row) = relative_illuminance.iter().position(|value| *value <= 0.0) {
            return Err(Error::new(format!(
                "a relative illuminance of {} is not positive",
                relative_illuminance[row]
            ))
            .hint("give the illuminance relative to the axis, such as 0.87")
            .at(table.line_of(row), Some(1)));
        }
        Ok(Self::RadialTable { file: file.to_owned(), coordinate, at, relative_illuminance })
    }

    /// Whether a profile has a value at every distance: a scene's always has, that of a file may
    /// not.
    pub fn is_sound(&self) -> bool {
        match self {
            Self::RadialTable { at, relative_illuminance, .. } => {
                Table::new(at.clone(), relative_illuminance.clone(), Outside::Hold).is_ok()
            }
            _ => true,
        }
    }

    /// Relative illuminance at the middle of every pixel, in rows from the top left; `None`
    /// where there is no vignetting.
    ///
    /// `flat_field` holds the values of [`Self::FlatField`].
    pub fn over_picture(&self, optics: &Optics, flat_field: &[f32]) -> Option<Vec<f64>> {
        let [width, height] = optics.resolution;
        let places = || (0..height).flat_map(move |y| (0..width).map(move |x| [x, y]));
        let tangent = |[x, y]: [u32; 2]| {
            let [x, y] = optics.slope([f64::from(x) + 0.5, f64::from(y) + 0.5]);
            x.hypot(y)
        };
        match self {
            Self::None => None,
            Self::Cos4 => Some(places().map(|place| cos4(tangent(place))).collect()),
            Self::FlatField { .. } => Some(flat_field.iter().map(|value| f64::from(*value)).collect()),
            Self::RadialTable { coordinate, at, relative_illuminance, .. } => {
                let profile = Table::new(at.clone(), relative_illuminance.clone(), Outside::Hold).ok()?;
                let distance = |tangent: f64| match coordinate {
                    Coordinate::RadiusMm => tangent * optics.image_distance_mm,
                    Coordinate::AngleDeg => tangent.atan().to_degrees(),
                };
                Some(places().map(|place| profile.at(distance(tangent(place)))).collect())
            }
        }
    }

    /// What it is, in a few words.
    pub fn in_words(&self) -> String {
        match self {
            Self::None => "none: the picture is as bright at its corners as on the axis".to_owned(),
            Self::Cos4 => "cos^4 of the angle from the axis".to_owned(),
            Self::RadialTable { file, at, .. } => format!("{} radii measured in {file}", at.len()),
            Self::FlatField { file, .. } => format!("flat field {file}"),
        }
    }
}

/// cos^4 of the angle with this tangent.
pub fn cos4(tangent: f64) -> f64 {
    (1.0 + tangent * tangent).powi(-2)
}

/// A measured flat field, and where in the picture it lies.
#[derive(Clone, Debug)]
pub struct FlatField {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Level relative to the middle, in rows from the top left.
    pub values: Vec<f32>,
    /// Tangents of half its angles of view: those of the camera that took it.
    pub tan_half_extent: [f64; 2],
}

impl FlatField {
    /// A flat field from levels of any positive scale; its middle tenth becomes 1.
    pub fn new(size: [u32; 2], levels: Vec<f32>, tan_half_extent: [f64; 2]) -> Result<Self> {
        if let Some(level) = levels.iter().find(|level| !(level.is_finite() && **level > 0.0)) {
            return Err(Error::new(format!("the flat field holds a level of {level}"))
                .hint("give a picture of an even field, linear, with every level above 0"));
        }
        let [width, height] = size;
        let middle = |place: u32, side: u32| {
            (f64::from(place) + 0.5 - 0.5 * f64::from(side)).abs() <= (0.05 * f64::from(side)).max(0.5)
        };
        let inside: Vec<f64> = (0..)
            .zip(&levels)
            .filter(|(index, _)| middle(index % width, width) && middle(index / width, height))
            .map(|(_, level)| f64::from(*level))
            .collect();
        let mean = inside.iter().sum::<f64>() / inside.len() as f64;
        let values = levels.iter().map(|level| (f64::from(*level) / mean) as f32).collect();
        Ok(Self { size, values, tan_half_extent })
    }

    /// The field at the middle of every pixel of a picture, linear between its own pixels.
    pub fn over_picture(&self, optics: &Optics) -> Vec<f32> {
        let [width, height] = optics.resolution;
        let mut values = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            for x in 0..width {
                // From the middle of the picture, whatever the principal point.
                let place = [x, y].map(|p| f64::from(p) + 0.5);
                let at = std::array::from_fn(|axis| {
                    let side = f64::from(optics.resolution[axis]);
                    let scale = optics.tan_half_extent[axis] / self.tan_half_extent[axis];
                    ((2.0 * place[axis] / side - 1.0) * scale + 1.0) * 0.5 * f64::from(self.size[axis]) - 0.5
                });
                values.push(self.at(at));
            }
        }
        values
    }

    /// Bilinear between the middles of pixels, held beyond the outermost.
    fn at(&self, place: [f64; 2]) -> f32 {
        let [(x, fx), (y, fy)]: [(usize, f64); 2] = std::array::from_fn(|axis| {
            let last = f64::from(self.size[axis] - 1);
            let held = place[axis].clamp(0.0, last);
            let low = held.floor().min((last - 1.0).max(0.0));
            (low as usize, held - low)
        });
        let [width, height] = self.size.map(|side| side as usize);
        let value = |x: usize, y: usize| f64::from(self.values[y.min(height - 1) * width + x.min(width - 1)]);
        let row = |y: usize| value(x, y) * (1.0 - fx) + value(x + 1, y) * fx;
        (row(y) * (1.0 - fy) + row(y + 1) * fy) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0.941, 0.780, 0.563, 0.344 at 10, 20, 30, 40 degrees.
    #[test]
    fn natural_vignetting_has_its_textbook_values() {
        for (degrees, truth) in [(10.0_f64, 0.9406), (20.0, 0.7797), (30.0, 0.5625), (40.0, 0.3444)] {
            let value = cos4(degrees.to_radians().tan());
            assert!((value - truth).abs() < 5e-5, "{degrees}: {value}");
        }
    }

    #[test]
    fn a_flat_field_is_one_in_the_middle_and_follows_the_picture() {
        let levels = (0..9).map(|i| if i == 4 { 2.0 } else { 1.0 }).collect();
        let field = FlatField::new([3, 3], levels, [0.5, 0.5]).expect("sound");
        assert_eq!(field.values[4], 1.0);
        assert_eq!(field.values[0], 0.5);
        let optics = Optics { resolution: [3, 3], tan_half_extent: [0.5, 0.5], ..Optics::default() };
        assert_eq!(field.over_picture(&optics), field.values);
        // Half the angle of view upwards: half-way from the middle row to the next.
        let narrow = Optics { resolution: [1, 3], tan_half_extent: [0.5 / 3.0, 0.25], ..optics };
        assert_eq!(field.over_picture(&narrow), [0.75, 1.0, 0.75]);
    }
}
