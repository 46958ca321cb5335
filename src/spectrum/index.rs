//! Refractive index over wavelength: dispersion formulas and tables.

use super::curve::Table;
use crate::error::{Error, Result};

/// Fraunhofer F line (hydrogen), nm.
pub const F_NM: f64 = 486.1327;
/// Helium d line, nm.
pub const D_NM: f64 = 587.5618;
/// Fraunhofer C line (hydrogen), nm.
pub const C_NM: f64 = 656.2725;

/// Nearer than this to a pole, in nm, Sellmeier's formula says nothing about a glass.
const POLE_CLEARANCE_NM: f64 = 1.0;
/// The square of an index below which a formula has left its range.
const LEAST_SQUARE: f64 = 1e-6;
/// Where Cauchy's two terms describe glass, in nm: between its absorption in the ultraviolet and
/// that in the infrared, neither of which the formula knows of.
const CAUCHY_RANGE_NM: (f64, f64) = (300.0, 2500.0);

/// Index of refraction as a function of vacuum wavelength.
#[derive(Clone, Debug)]
pub enum RefractiveIndex {
    /// The same at every wavelength.
    Constant(f64),
    /// n = a + b / lambda^2, lambda in micrometres.
    Cauchy {
        /// Constant term.
        a: f64,
        /// Dispersion term in um^2.
        b_um2: f64,
    },
    /// n^2 = 1 + sum of b lambda^2 / (lambda^2 - c), lambda in micrometres.
    Sellmeier {
        /// Pairs (b, c in um^2).
        terms: Vec<[f64; 2]>,
        /// Wavelengths for which the coefficients were fitted; beyond them the formula is
        /// followed as long as it gives an index at all.
        range_nm: (f64, f64),
    },
    /// Measured points; an error outside them.
    Table(Table),
}

impl RefractiveIndex {
    /// The Cauchy curve with index `nd` at the d line and Abbe number `vd` =
    /// (nd - 1) / (nF - nC); infinite `vd` means no dispersion.
    pub fn from_abbe(nd: f64, vd: f64) -> Result<Self> {
        if !(nd >= 1.0 && nd.is_finite()) {
            return Err(Error::new(format!("the index nd = {nd} is not a number from 1 up"))
                .hint("for example 1.5168"));
        }
        if vd.is_nan() || vd <= 0.0 {
            return Err(Error::new(format!("the Abbe number {vd} is not positive"))
                .hint("leave vd out, or use a constant index, where there is no dispersion"));
        }
        if vd.is_infinite() {
            return Ok(Self::Constant(nd));
        }
        let per_um2 = |nm: f64| 1e6 / (nm * nm);
        let b_um2 = (nd - 1.0) / vd / (per_um2(F_NM) - per_um2(C_NM));
        Ok(Self::Cauchy { a: nd - b_um2 * per_um2(D_NM), b_um2 })
    }

    /// Index at a wavelength in nm; an error where the description does not hold: outside a
    /// table, next to a pole of a formula, where the square of the index vanishes or is
    /// negative, and beyond any transparent solid.
    pub fn at(&self, nm: f64) -> Result<f64> {
        /// Above any transparent solid; a fit that gives more has left its range.
        const LARGEST: f64 = 10.0;
        let um2 = nm * nm * 1e-6;
        let n = match self {
            Self::Constant(n) => *n,
            Self::Cauchy { a, b_um2 } => a + b_um2 / um2,
            Self::Sellmeier { terms, .. } => {
                check_poles(nm, terms)?;
                let squared: f64 = 1.0 + terms.iter().map(|[b, c]| b * um2 / (um2 - c)).sum::<f64>();
                if squared < LEAST_SQUARE {
                    return Err(Error::new(format!("Sellmeier's formula gives n^2 = {squared} at {nm} nm"))
                        .hint("the square of an index is positive; check the coefficients and their units"));
                }
                squared.sqrt()
            }
            Self::Table(table) => {
                check_range(nm, table.range_nm())?;
                table.at(nm)
            }
        };
        if n > 0.0 && n <= LARGEST {
            return Ok(n);
        }
        Err(Error::new(format!("the refractive index at {nm} nm is {n}")).hint(format!(
            "an index lies above 0 and up to {LARGEST}; check the coefficients and their units"
        )))
    }

    /// The wavelengths for which a formula's coefficients were fitted, or for which it describes
    /// glass at all; `None` where nothing bounds the description but its own numbers.
    pub const fn fitted_range_nm(&self) -> Option<(f64, f64)> {
        match self {
            Self::Sellmeier { range_nm, .. } => Some(*range_nm),
            Self::Cauchy { .. } => Some(CAUCHY_RANGE_NM),
            Self::Constant(_) | Self::Table(_) => None,
        }
    }

    /// Abbe number (nd - 1) / (nF - nC); infinite without dispersion.
    pub fn abbe_number(&self) -> Result<f64> {
        Ok((self.at(D_NM)? - 1.0) / (self.at(F_NM)? - self.at(C_NM)?))
    }
}

fn check_poles(nm: f64, terms: &[[f64; 2]]) -> Result<()> {
    let poles = terms.iter().filter(|[b, _]| *b != 0.0).map(|[_, c_um2]| 1000.0 * c_um2.max(0.0).sqrt());
    match poles.into_iter().find(|pole| (nm - pole).abs() <= POLE_CLEARANCE_NM) {
        None => Ok(()),
        Some(pole) => Err(Error::new(format!("Sellmeier's formula has a pole at {pole:.2} nm")).hint(
            "coefficients c_um2 are squares of wavelengths in um, outside 360 to 830 nm; check the unit",
        )),
    }
}

fn check_range(nm: f64, (first, last): (f64, f64)) -> Result<()> {
    if (first..=last).contains(&nm) {
        return Ok(());
    }
    Err(Error::new(format!("the refractive index is known from {first} to {last} nm, not at {nm} nm"))
        .hint("an index cannot be continued; use a table or formula that covers 360 to 830 nm"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn abbe_numbers_come_back() {
        let glass = RefractiveIndex::from_abbe(1.5168, 64.167).expect("a real glass");
        assert!((glass.at(D_NM).expect("in range") - 1.5168).abs() < 1e-12);
        assert!((glass.abbe_number().expect("in range") - 64.167).abs() < 1e-9);
        assert!(RefractiveIndex::from_abbe(1.5, 0.0).is_err());
        assert!(RefractiveIndex::from_abbe(1.5, f64::NAN).is_err());
    }
}
