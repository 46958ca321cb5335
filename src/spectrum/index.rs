//! Refractive index over wavelength: dispersion formulas and tables.

use super::curve::Table;
use crate::error::{Error, Result};

/// Fraunhofer F line (hydrogen), nm.
pub const F_NM: f64 = 486.1327;
/// Helium d line, nm.
pub const D_NM: f64 = 587.5618;
/// Fraunhofer C line (hydrogen), nm.
pub const C_NM: f64 = 656.2725;

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

    /// Index at a wavelength in nm; an error where the description does not hold.
    pub fn at(&self, nm: f64) -> Result<f64> {
        /// Above any transparent solid; a fit that gives more has left its range.
        const LARGEST: f64 = 10.0;
        let um2 = nm * nm * 1e-6;
        let n = match self {
            Self::Constant(n) => *n,
            Self::Cauchy { a, b_um2 } => a + b_um2 / um2,
            Self::Sellmeier { terms, .. } => {
                let squared: f64 = 1.0 + terms.iter().map(|[b, c]| b * um2 / (um2 - c)).sum::<f64>();
                // Next to a pole the square is huge, infinite or negative.
                if squared > 0.0 { squared.sqrt() } else { f64::NAN }
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

    /// The wavelengths for which a formula's coefficients were fitted, where they are known.
    pub const fn fitted_range_nm(&self) -> Option<(f64, f64)> {
        match self {
            Self::Sellmeier { range_nm, .. } => Some(*range_nm),
            _ => None,
        }
    }

    /// Abbe number (nd - 1) / (nF - nC); infinite without dispersion.
    pub fn abbe_number(&self) -> Result<f64> {
        Ok((self.at(D_NM)? - 1.0) / (self.at(F_NM)? - self.at(C_NM)?))
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

    #[test]
    fn poles_are_errors_and_never_nan() {
        // BK7's coefficients; poles at 77.46 and 141.48 nm, n^2 < 0 below each.
        let terms = vec![[1.03961212, 0.00600069867], [0.231792344, 0.0200179144], [1.01046945, 103.560653]];
        let glass = RefractiveIndex::Sellmeier { terms, range_nm: (50.0, 2500.0) };
        for nm in [77.463, 141.485, 141.0, 76.0] {
            assert!(glass.at(nm).is_err(), "{nm} nm: {:?}", glass.at(nm));
        }
        for (nm, n) in [(F_NM, 1.522_376), (D_NM, 1.516_800), (C_NM, 1.514_322)] {
            assert!((glass.at(nm).expect("in range") - n).abs() < 1e-6);
        }
    }
}
