//! A function of wavelength as a user or a table describes it, in f64.
//!
//! Curves exist while a scene is built. Transport reads them through [`super::Dense`],
//! resampled once onto the grid that all scenes share.

use super::blackbody::{ln_planck, peak_nm, planck_w_m2_sr_m};
use crate::error::{Error, Result};
use crate::units::constants::STEFAN_BOLTZMANN_W_M2_K4;
use crate::units::{Kelvin, Nanometers};

/// What a table means outside the wavelengths it covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outside {
    /// The end values go on: reflectance, transmission.
    Hold,
    /// Nothing: emission and sensitivity.
    Zero,
}

/// A curve over wavelength.
#[derive(Clone, Debug)]
pub enum Curve {
    /// The same value everywhere.
    Constant(f64),
    /// Measured points, joined linearly.
    Table(Table),
    /// A black body's spectral radiance in W m^-2 sr^-1 nm^-1.
    Blackbody(Kelvin),
    /// Another curve times a factor.
    Scaled(Box<Self>, f64),
}

/// Measured points in order of wavelength.
#[derive(Clone, Debug)]
pub struct Table {
    /// Rising wavelengths in nm.
    pub wavelengths_nm: Vec<f64>,
    /// Value at each wavelength.
    pub values: Vec<f64>,
    /// What holds beyond the ends.
    pub outside: Outside,
}

impl Table {
    /// A table from points; the wavelengths must rise and both lists be equally long.
    pub fn new(wavelengths_nm: Vec<f64>, values: Vec<f64>, outside: Outside) -> Result<Self> {
        if wavelengths_nm.is_empty() || wavelengths_nm.len() != values.len() {
            return Err(Error::new(format!(
                "{} wavelengths but {} values",
                wavelengths_nm.len(),
                values.len()
            ))
            .hint("give one value per wavelength, and at least one"));
        }
        if wavelengths_nm.windows(2).any(|pair| pair[1] <= pair[0]) {
            return Err(Error::new("wavelengths do not rise").hint("sort the points by wavelength"));
        }
        if wavelengths_nm.iter().chain(&values).any(|v| !v.is_finite()) {
            return Err(Error::new("the table holds a value that is not finite"));
        }
        Ok(Self { wavelengths_nm, values, outside })
    }

    /// First and last wavelength in nm.
    pub fn range_nm(&self) -> (f64, f64) {
        (self.wavelengths_nm[0], self.wavelengths_nm[self.wavelengths_nm.len() - 1])
    }

    /// Whether any two neighbouring points are closer than a step in nm.
    pub fn is_finer_than(&self, step_nm: f64) -> bool {
        self.wavelengths_nm.windows(2).any(|pair| pair[1] - pair[0] < step_nm)
    }

    /// Value at a wavelength, linear between points.
    pub fn at(&self, nm: f64) -> f64 {
        let (first, last) = self.range_nm();
        if nm < first || nm > last {
            return match self.outside {
                Outside::Zero => 0.0,
                Outside::Hold if nm < first => self.values[0],
                Outside::Hold => self.values[self.values.len() - 1],
            };
        }
        let upper = self.wavelengths_nm.partition_point(|&w| w < nm);
        if upper == 0 {
            return self.values[0];
        }
        let (a, b) = (self.wavelengths_nm[upper - 1], self.wavelengths_nm[upper]);
        let fraction = (nm - a) / (b - a);
        self.values[upper - 1] * (1.0 - fraction) + self.values[upper] * fraction
    }
}

impl Curve {
    /// Value at a wavelength.
    pub fn at(&self, nm: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Table(table) => table.at(nm),
            Self::Blackbody(temperature) => planck_w_m2_sr_m(Nanometers(nm), *temperature) * 1e-9,
            Self::Scaled(curve, factor) => curve.at(nm) * factor,
        }
    }

    /// Value that stands for the nanometre around a grid point: the value there, or the mean
    /// over the nanometre where points lie closer, so that no narrow line is missed or
    /// counted twice.
    pub fn on_grid(&self, nm: f64) -> f64 {
        match self {
            Self::Table(table) if table.is_finer_than(1.0) => self.integral(nm - 0.5, nm + 0.5),
            Self::Scaled(curve, factor) => curve.on_grid(nm) * factor,
            _ => self.at(nm),
        }
    }

    /// The curve at 1 nm steps over a range, times one positive factor that the caller does
    /// not need to know: what matters is the shape. A black body too cold for f64 keeps its
    /// shape.
    pub fn shape(&self, wavelengths_nm: impl Iterator<Item = f64> + Clone) -> Vec<f64> {
        match self {
            Self::Blackbody(temperature) => {
                let logarithms: Vec<f64> =
                    wavelengths_nm.map(|nm| ln_planck(Nanometers(nm), *temperature)).collect();
                let largest = logarithms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                logarithms.iter().map(|ln| (ln - largest).exp()).collect()
            }
            Self::Scaled(curve, factor) => curve.shape(wavelengths_nm).iter().map(|v| v * factor).collect(),
            Self::Constant(_) | Self::Table(_) => wavelengths_nm.map(|nm| self.on_grid(nm)).collect(),
        }
    }

    /// Smallest and largest value; over all wavelengths for a table.
    pub fn extremes(&self) -> (f64, f64) {
        match self {
            Self::Constant(value) => (*value, *value),
            Self::Table(table) => table
                .values
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v))),
            Self::Blackbody(temperature) => (0.0, self.at(peak_nm(*temperature))),
            Self::Scaled(curve, factor) => {
                let (low, high) = curve.extremes();
                ((low * factor).min(high * factor), (low * factor).max(high * factor))
            }
        }
    }

    /// First and last wavelength of the measured points; `None` for a curve that is known
    /// everywhere.
    pub fn range_nm(&self) -> Option<(f64, f64)> {
        match self {
            Self::Constant(_) | Self::Blackbody(_) => None,
            Self::Table(table) => Some(table.range_nm()),
            Self::Scaled(curve, _) => curve.range_nm(),
        }
    }

    /// Integral over a band in nm.
    ///
    /// Exact for constants and tables; for a black body Simpson's rule on a grid of ln
    /// wavelength, good to 1e-9.
    pub fn integral(&self, from_nm: f64, to_nm: f64) -> f64 {
        match self {
            Self::Constant(value) => value * (to_nm - from_nm),
            Self::Table(table) => {
                let mut knots = vec![from_nm];
                knots.extend(table.wavelengths_nm.iter().copied().filter(|w| *w > from_nm && *w < to_nm));
                knots.push(to_nm);
                // The mean of a linear piece is its middle value, also next to a jump to zero.
                knots.windows(2).map(|k| table.at(0.5 * (k[0] + k[1])) * (k[1] - k[0])).sum()
            }
            Self::Scaled(curve, factor) => curve.integral(from_nm, to_nm) * factor,
            Self::Blackbody(_) => {
                const STEPS: usize = 4096;
                let (low, high) = (from_nm.ln(), to_nm.ln());
                let step = (high - low) / STEPS as f64;
                let term = |i: usize| {
                    let nm = (low + step * i as f64).exp();
                    let weight = if i == 0 || i == STEPS { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
                    weight * self.at(nm) * nm
                };
                (0..=STEPS).map(term).sum::<f64>() * step / 3.0
            }
        }
    }

    /// Integral over all wavelengths; `None` for a constant other than zero, whose integral
    /// diverges.
    pub fn integral_over_all(&self) -> Option<f64> {
        match self {
            Self::Constant(value) => (*value == 0.0).then_some(0.0),
            Self::Scaled(curve, factor) => Some(curve.integral_over_all()? * factor),
            Self::Table(table) => {
                let (first, last) = table.range_nm();
                Some(self.integral(first, last))
            }
            // Radiance of a black body over all wavelengths: sigma T^4 / pi.
            Self::Blackbody(t) => Some(STEFAN_BOLTZMANN_W_M2_K4 * t.0.powi(4) / std::f64::consts::PI),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_hold_or_vanish_outside() {
        let table = |outside| Table::new(vec![400.0, 500.0], vec![1.0, 3.0], outside).expect("valid");
        assert_eq!(table(Outside::Hold).at(300.0), 1.0);
        assert_eq!(table(Outside::Hold).at(900.0), 3.0);
        assert_eq!(table(Outside::Zero).at(399.9), 0.0);
        assert_eq!(table(Outside::Zero).at(400.0), 1.0);
        assert_eq!(table(Outside::Zero).at(450.0), 2.0);
        let emission = Curve::Table(table(Outside::Zero));
        assert!((emission.integral(300.0, 900.0) - 200.0).abs() < 1e-9);
    }
}
