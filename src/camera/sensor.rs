//! What a pixel records: its channels' responses over wavelength.
//!
//! X, Y, Z are what the scene shows, before any lens. Channels `sensor.*` are responses of the
//! sensor behind its lens and filters, as far as they depend on wavelength: only while
//! wavelengths are there can they be weighted.

use super::electrons::electrons_per_weighted_joule;
use crate::error::{Error, Result};
use crate::spectrum::colour::CIE_1931;
use crate::spectrum::library::{self, Purpose};
use crate::spectrum::{CsvTable, Curve, Dense, GRID_POINTS, Spectrum, Wavelengths, grid_nm};
use crate::units::constants::LUMINOUS_EFFICACY_LM_W;

/// Name of the sensor that records CIE 1931 tristimulus values alone.
pub const CIE_SENSOR: &str = "cie-1931";
/// What the names of a sensor's own channels begin with.
const PREFIX: &str = "sensor.";
/// Where the response of a detector with the same quantum efficiency everywhere is set to its
/// quantum efficiency, in nm: at the peak of the photopic curve.
const REFERENCE_NM: f64 = 555.0;

/// One channel of the film.
#[derive(Clone, Debug)]
pub struct Channel {
    /// Name in the EXR file: `X`, `sensor.R`, `S0.550,000000nm` …
    pub name: String,
    /// Weight of spectral radiance per nm.
    pub response: Dense,
    /// Unit of what it holds.
    pub unit: &'static str,
}

/// Unit of tristimulus values.
const TRISTIMULUS: &str = "cd/m2";
/// Unit of a table's channels: sensitivities are relative.
const RELATIVE: &str = "W sr^-1 m^-2 weighted with the relative sensitivity";
/// Unit of a channel behind a filter.
const FILTERED: &str = "W sr^-1 m^-2 weighted with filter transmission and detector response";

/// The unit of a channel that is also weighted with the transmission of a lens.
fn behind_lens(unit: &'static str) -> &'static str {
    match unit {
        RELATIVE => "W sr^-1 m^-2 weighted with the relative sensitivity and lens transmission",
        FILTERED => "W sr^-1 m^-2 weighted with filter transmission, detector response and lens transmission",
        _ => "cd/m2 weighted with lens transmission",
    }
}

/// How a detector behind filters answers to light.
#[derive(Clone, Debug)]
pub enum Detector {
    /// Electrons per photon, relative.
    QuantumEfficiency(Curve),
    /// Response per watt, relative.
    Responsivity(Curve),
}

impl Detector {
    /// Response per watt.
    pub fn at(&self, nm: f64) -> f64 {
        match self {
            Self::QuantumEfficiency(efficiency) => efficiency.at(nm) * nm / REFERENCE_NM,
            Self::Responsivity(response) => response.at(nm),
        }
    }
}

/// The channels that a film records; X, Y, Z in cd/m2 are always the first three.
#[derive(Clone, Debug)]
pub struct Sensor {
    /// The scene's name for it.
    pub name: String,
    /// Its channels.
    pub channels: Vec<Channel>,
    /// Share of the tabulated sensitivity's own range that lies within the transport's, for
    /// each channel of a table.
    pub coverage: Vec<f64>,
    /// Transmission of the lens that the sensor's own channels are behind, where it is stated.
    pub lens_transmission: Option<Dense>,
    /// Electrons for a joule weighted as the recorded channels weight it, at a largest quantum
    /// efficiency of 1.
    pub electrons_per_weighted_joule: f64,
}

impl Sensor {
    /// CIE 1931 XYZ alone.
    pub fn cie() -> Self {
        let channels = xyz_channels();
        Self {
            name: CIE_SENSOR.to_owned(),
            coverage: Vec::new(),
            lens_transmission: None,
            electrons_per_weighted_joule: electrons_per_weighted_joule(channels.iter().flat_map(on_grid)),
            channels,
        }
    }

    /// CIE 1931 XYZ, and the channels of a built-in sensitivity where `name` is one.
    pub fn named(name: &str) -> Result<Self> {
        if name == CIE_SENSOR { Ok(Self::cie()) } else { Self::of_table(name, &library::table(name)?) }
    }

    /// CIE 1931 XYZ, and a channel for every column of a table of sensitivities.
    pub fn of_table(name: &str, table: &CsvTable) -> Result<Self> {
        let mut sensor = Self { name: name.to_owned(), ..Self::cie() };
        for column in table.columns.iter().skip(1) {
            if !names_channel(column) {
                return Err(Error::new(format!("the column \"{column}\" cannot name a channel"))
                    .hint("use letters and digits, such as wavelength_nm,r,g,b")
                    .at(table.header_line(), Some(1)));
            }
            let curve = library::curve(table, Some(column), Purpose::Emission)?;
            let response = Dense::from_fn(|nm| curve.at(nm));
            let all = curve.integral_over_all().expect("a table has a range");
            let inside = curve.integral(crate::spectrum::FIRST_NM, crate::spectrum::LAST_NM);
            sensor.coverage.push(if all > 0.0 { inside / all } else { 1.0 });
            let name = format!("{PREFIX}{}", column.to_uppercase());
            sensor.channels.push(Channel { name, response, unit: RELATIVE });
        }
        sensor.electrons_per_weighted_joule =
            electrons_per_weighted_joule(sensor.recorded().flat_map(on_grid));
        Ok(sensor)
    }

    /// CIE 1931 XYZ, and a channel for every filter before a detector: `filters` are pairs of
    /// a channel's name and a transmission.
    pub fn of_filters(name: &str, filters: &[(String, Curve)], detector: &Detector) -> Result<Self> {
        let mut sensor = Self { name: name.to_owned(), ..Self::cie() };
        for (filter, transmission) in filters {
            if !names_channel(filter) {
                return Err(Error::new(format!("the filter \"{filter}\" cannot name a channel"))
                    .hint("use letters and digits, such as B550"));
            }
            let name = format!("{PREFIX}{}", filter.to_uppercase());
            if sensor.channels.iter().any(|channel| channel.name == name) {
                return Err(Error::new(format!("two filters are called {}", filter.to_uppercase()))
                    .hint("rename one of them; capitals make no difference"));
            }
            let response = Dense::from_fn(|nm| transmission.at(nm) * detector.at(nm));
            if response.is_zero() {
                return Err(Error::new(format!("nothing is seen behind the filter \"{filter}\""))
                    .hint("check its transmission and the detector within 360 to 830 nm"));
            }
            sensor.channels.push(Channel { name, response, unit: FILTERED });
        }
        sensor.electrons_per_weighted_joule =
            electrons_per_weighted_joule(grid_nm().map(|nm| (nm, detector.at(nm))));
        Ok(sensor)
    }

    /// The sensor behind a lens: its own channels are multiplied by the transmission; one that
    /// records X, Y, Z alone gets these as channels of its own.
    #[must_use]
    pub fn behind(mut self, transmission: Dense) -> Self {
        if self.name == CIE_SENSOR {
            let own = xyz_channels().into_iter();
            self.channels.extend(own.map(|c| Channel { name: format!("{PREFIX}{}", c.name), ..c }));
        }
        for channel in self.channels.iter_mut().filter(|channel| channel.name.starts_with(PREFIX)) {
            channel.response = channel.response.times(&transmission);
            channel.unit = behind_lens(channel.unit);
        }
        self.lens_transmission = Some(transmission);
        self
    }

    /// The channels that the camera records: the sensor's own, or X, Y, Z where it has none.
    pub fn recorded(&self) -> impl Iterator<Item = &Channel> {
        let own = self.channels.iter().any(|channel| channel.name.starts_with(PREFIX));
        self.channels.iter().enumerate().filter_map(move |(index, channel)| {
            let recorded = if own { channel.name.starts_with(PREFIX) } else { index < 3 };
            recorded.then_some(channel)
        })
    }

    /// Adds a channel that counts every wavelength of the grid alike, after all others:
    /// radiant quantities within 360 to 830 nm.
    #[must_use]
    pub fn with_radiant_channel(mut self) -> Self {
        self.channels.push(Channel {
            name: "radiant".to_owned(),
            response: Dense::Flat(1.0),
            unit: "W sr^-1 m^-2",
        });
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
            let response = Dense::from_fn(inside);
            self.channels.push(Channel {
                name: format!("S0.{centre}nm"),
                response,
                unit: "W sr^-1 m^-2 nm^-1",
            });
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

    /// The channel with the largest share of its response outside a range of wavelengths, and
    /// that share, counted over the 1 nm grid.
    pub fn uncovered_share(&self, range_nm: (f64, f64)) -> (&str, f64) {
        let share = |channel: &Channel| {
            let (mut outside, mut total) = (0.0, 0.0);
            for (nm, response) in on_grid(channel) {
                total += response;
                outside += if (range_nm.0..=range_nm.1).contains(&nm) { 0.0 } else { response };
            }
            if total > 0.0 { outside / total } else { 0.0 }
        };
        let shares = self.channels.iter().map(|channel| (channel.name.as_str(), share(channel)));
        shares.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or(("", 0.0))
    }
}

fn xyz_channels() -> Vec<Channel> {
    let matching = &CIE_1931.matching;
    ["X", "Y", "Z"]
        .iter()
        .zip(matching)
        .map(|(name, column)| {
            let values: Vec<f32> = column.iter().map(|m| (m * LUMINOUS_EFFICACY_LM_W) as f32).collect();
            Channel { name: (*name).to_owned(), response: Dense::from_values(&values), unit: TRISTIMULUS }
        })
        .collect()
}

/// A channel's response at the grid points, with their wavelengths in nm.
fn on_grid(channel: &Channel) -> impl Iterator<Item = (f64, f64)> + '_ {
    grid_nm().enumerate().map(|(index, nm)| (nm, f64::from(channel.response.at_grid_point(index))))
}

fn names_channel(name: &str) -> bool {
    !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric())
}
