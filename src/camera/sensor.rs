//! What a pixel records: its channels' responses over wavelength.

use crate::error::{Error, Result};
use crate::spectrum::colour::CIE_1931;
use crate::spectrum::library::{self, Purpose};
use crate::spectrum::{CsvTable, Dense, GRID_POINTS, Spectrum, Wavelengths, grid_nm};
use crate::units::constants::LUMINOUS_EFFICACY_LM_W;

/// Name of the sensor that records CIE 1931 tristimulus values alone.
pub const CIE_SENSOR: &str = "cie-1931";

/// One channel of the film.
#[derive(Clone, Debug)]
pub struct Channel {
    /// Name in the EXR file: `X`, `sensor.R`, `S0.550,000000nm` …
    pub name: String,
    /// Weight of spectral radiance per nm.
    pub response: Dense,
}

/// The channels that a film records; X, Y, Z in cd/m2 are always the first three.
#[derive(Clone, Debug)]
pub struct Sensor {
    /// The scene's name for it.
    pub name: String,
    /// Its channels.
    pub channels: Vec<Channel>,
    /// Share of the tabulated sensitivity's own range that lies within the transport's, for
    /// each channel beyond XYZ.
    pub coverage: Vec<f64>,
}

impl Sensor {
    /// CIE 1931 XYZ alone.
    pub fn cie() -> Self {
        Self { name: CIE_SENSOR.to_owned(), channels: xyz_channels(), coverage: Vec::new() }
    }

    /// CIE 1931 XYZ, and the channels of a built-in sensitivity where `name` is one.
    pub fn named(name: &str) -> Result<Self> {
        if name == CIE_SENSOR { Ok(Self::cie()) } else { Self::of_table(name, &library::table(name)?) }
    }

    /// CIE 1931 XYZ, and a channel for every column of a table of sensitivities.
    pub fn of_table(name: &str, table: &CsvTable) -> Result<Self> {
        let mut sensor = Self { name: name.to_owned(), ..Self::cie() };
        for column in table.columns.iter().skip(1) {
            if !column.chars().all(|c| c.is_ascii_alphanumeric()) || column.is_empty() {
                return Err(Error::new(format!("the column \"{column}\" cannot name a channel"))
                    .hint("use letters and digits, such as wavelength_nm,r,g,b"));
            }
            let curve = library::curve(table, Some(column), Purpose::Emission)?;
            let response = Dense::from_fn(|nm| curve.at(nm));
            let all = curve.integral_over_all().expect("a table has a range");
            let inside = curve.integral(crate::spectrum::FIRST_NM, crate::spectrum::LAST_NM);
            sensor.coverage.push(if all > 0.0 { inside / all } else { 1.0 });
            sensor.channels.push(Channel { name: format!("sensor.{}", column.to_uppercase()), response });
        }
        Ok(sensor)
    }

    /// Adds a channel that counts every wavelength of the grid alike, after all others:
    /// radiant quantities within 360 to 830 nm.
    #[must_use]
    pub fn with_radiant_channel(mut self) -> Self {
        self.channels.push(Channel { name: "radiant".to_owned(), response: Dense::Flat(1.0) });
        self
    }

    /// Adds spectral layers: `count` equal bands over the grid, each the mean spectral
    /// radiance of its band, named after Fichet, Pacanowski and Wilkie 2021.
    #[must_use]
    pub fn with_spectral_layers(mut self, count: usize) -> Self {
        let span = (GRID_POINTS - 1) as f64 / count as f64;
        for band in 0..count {
            let (from, to) = (band as f64 * span, (band + 1) as f64 * span);
            let centre = format!("{:.6}", crate::spectrum::FIRST_NM + 0.5 * (from + to)).replace('.', ",");
            let inside = |nm: f64| {
                let x = nm - crate::spectrum::FIRST_NM;
                // Half weights where two bands share a grid point.
                if x < from || x > to {
                    0.0
                } else if x == from || x == to {
                    0.5 / span
                } else {
                    1.0 / span
                }
            };
            self.channels.push(Channel { name: format!("S0.{centre}nm"), response: Dense::from_fn(inside) });
        }
        self
    }

    /// Sum of all responses at each grid point, every channel scaled to the same integral:
    /// wherever a channel sees something, this is positive.
    pub fn attention(&self) -> Vec<f64> {
        let mut sum = vec![0.0; GRID_POINTS];
        for channel in &self.channels {
            let values = (0..GRID_POINTS).map(|i| f64::from(channel.response.at_grid_point(i)).abs());
            let total: f64 = values.clone().sum();
            if total > 0.0 {
                sum.iter_mut().zip(values).for_each(|(s, v)| *s += v / total);
            }
        }
        sum
    }

    /// What each channel records of a path's radiance: the mean over its lanes of radiance
    /// times response over density, or over probability for a lane on a line.
    #[inline]
    pub fn record(&self, radiance: Spectrum, wavelengths: &Wavelengths, mut put: impl FnMut(usize, f64)) {
        let per_density = radiance / wavelengths.density;
        for (index, channel) in self.channels.iter().enumerate() {
            put(index, f64::from((per_density * channel.response.at(wavelengths)).mean()));
        }
    }
}

fn xyz_channels() -> Vec<Channel> {
    let matching = &CIE_1931.matching;
    ["X", "Y", "Z"]
        .iter()
        .zip(matching)
        .map(|(name, column)| {
            let values: Vec<f32> = column.iter().map(|m| (m * LUMINOUS_EFFICACY_LM_W) as f32).collect();
            Channel { name: (*name).to_owned(), response: Dense::from_values(&values) }
        })
        .collect()
}

/// Share of the luminous response of the grid that a table's range does not cover.
pub fn uncovered_share(range_nm: (f64, f64)) -> f64 {
    let y_bar = &CIE_1931.matching[1];
    let covered = |nm: f64| (range_nm.0..=range_nm.1).contains(&nm);
    let (mut outside, mut total) = (0.0, 0.0);
    for (nm, weight) in grid_nm().zip(y_bar) {
        total += weight;
        outside += if covered(nm) { 0.0 } else { *weight };
    }
    outside / total
}
