//! A lamp's spectrum as a user or a table describes it, in f64: a continuum and lines.
//!
//! A line has a wavelength and a power, and no width: those of low-pressure lamps are some
//! 0.01 nm wide, and nothing else in a scene changes over that. The power is the integral over
//! wavelength, in the continuum's unit times nm.

use super::colour::{Xyz, xyz_at, xyz_of_grid};
use super::curve::Curve;
use super::wavelengths::{FIRST_NM, LAST_NM, grid_nm};
use crate::error::{Error, Result};

/// More lines than any lamp's table has; what is rendered picks one of them for each path.
const MOST_LINES: usize = 10_000;

/// A spectral line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Wavelength in nm.
    pub nm: f64,
    /// Integral over wavelength, in the continuum's unit times nm.
    pub power: f64,
}

/// A continuum and the lines on it.
#[derive(Clone, Debug)]
pub struct LampSpectrum {
    continuum: Curve,
    /// In order of wavelength, each wavelength once.
    lines: Vec<Line>,
}

impl From<Curve> for LampSpectrum {
    fn from(continuum: Curve) -> Self {
        Self { continuum, lines: Vec::new() }
    }
}

impl LampSpectrum {
    /// A spectrum with at least one line, in any order; an error carries the line's place in
    /// the list and the key at fault.
    pub fn new(continuum: Curve, mut lines: Vec<Line>) -> Result<Self> {
        if lines.is_empty() {
            return Err(
                Error::new("the list holds no line").hint("give at least one, or name the continuum alone")
            );
        }
        if lines.len() > MOST_LINES {
            return Err(Error::new(format!("{} lines, more than {MOST_LINES}", lines.len()))
                .hint("leave out the faint ones, or write a continuum"));
        }
        let mut seen = std::collections::HashSet::new();
        for (index, line) in lines.iter().enumerate() {
            line.check().map_err(|e| e.under(index))?;
            if !seen.insert(line.nm.to_bits()) {
                return Err(Error::new(format!("the line at {} nm stands twice", line.nm))
                    .hint("write it once, with the sum of its powers")
                    .under("wavelength_nm")
                    .under(index));
            }
        }
        lines.sort_by(|a, b| a.nm.total_cmp(&b.nm));
        Ok(Self { continuum, lines })
    }

    /// What lies beneath the lines.
    pub const fn continuum(&self) -> &Curve {
        &self.continuum
    }

    /// The lines, in order of wavelength.
    pub fn lines(&self) -> &[Line] {
        &self.lines
    }

    /// The lines that transport carries, from 360 to 830 nm.
    pub fn visible_lines(&self) -> impl Iterator<Item = &Line> {
        self.lines.iter().filter(|line| line.lies_within(FIRST_NM, LAST_NM))
    }

    /// The continuum of a spectrum that has no lines; `None` where it has.
    pub fn into_continuum(self) -> Option<Curve> {
        self.lines.is_empty().then_some(self.continuum)
    }

    /// The spectrum times a factor.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        let lines = self.lines.iter().map(|line| Line { power: line.power * factor, ..*line });
        Self { lines: lines.collect(), continuum: Curve::Scaled(Box::new(self.continuum), factor) }
    }

    /// The continuum at the grid points.
    pub fn on_grid(&self) -> Vec<f64> {
        grid_nm().map(|nm| self.continuum.on_grid(nm)).collect()
    }

    /// The continuum at the grid points, times one positive factor where there are no lines
    /// beside which its scale would matter ([`Curve::shape`]).
    pub fn shape(&self) -> Vec<f64> {
        if self.lines.is_empty() { self.continuum.shape(grid_nm()) } else { self.on_grid() }
    }

    /// Tristimulus values in absolute units.
    pub fn xyz(&self) -> Xyz {
        self.xyz_above(&grid_nm().map(|nm| self.continuum.at(nm)).collect::<Vec<_>>())
    }

    /// Tristimulus values on the scale of [`Self::shape`].
    pub fn xyz_of_shape(&self) -> Xyz {
        self.xyz_above(&self.shape())
    }

    /// Tristimulus values of a continuum at the grid points and of the lines.
    fn xyz_above(&self, continuum: &[f64]) -> Xyz {
        self.lines.iter().fold(xyz_of_grid(continuum), |sum, line| {
            let of_line = xyz_at(line.nm);
            std::array::from_fn(|i| sum[i] + line.power * of_line[i])
        })
    }

    /// Luminous efficacy of radiation over the grid, lm per radiant watt within it, the watts
    /// of the continuum by the trapezoid rule; `None` for black.
    pub fn efficacy_lm_per_w(&self) -> Option<f64> {
        let shape = self.shape();
        let ends = 0.5 * (shape[0] + shape[shape.len() - 1]);
        let lines: f64 = self.visible_lines().map(|line| line.power).sum();
        let watts = shape.iter().sum::<f64>() - ends + lines;
        (watts > 0.0).then(|| self.xyz_of_shape()[1] / watts)
    }

    /// Integral over a band in nm; a line counts if it lies within the band or on its end.
    pub fn integral(&self, from_nm: f64, to_nm: f64) -> f64 {
        let lines = self.lines.iter().filter(|line| line.lies_within(from_nm, to_nm));
        self.continuum.integral(from_nm, to_nm) + lines.map(|line| line.power).sum::<f64>()
    }

    /// Integral over all wavelengths; `None` where that of the continuum diverges.
    pub fn integral_over_all(&self) -> Option<f64> {
        let lines: f64 = self.lines.iter().map(|line| line.power).sum();
        Some(self.continuum.integral_over_all()? + lines)
    }
}

impl Line {
    fn lies_within(&self, from_nm: f64, to_nm: f64) -> bool {
        (from_nm..=to_nm).contains(&self.nm)
    }

    fn check(&self) -> Result<()> {
        let Self { nm, power } = self;
        if !(*nm > 0.0 && nm.is_finite()) {
            return Err(Error::new(format!("a line at {nm} nm"))
                .hint("give a wavelength above 0, in nm")
                .under("wavelength_nm"));
        }
        if !(*power >= 0.0 && power.is_finite()) {
            return Err(Error::new(format!("the line at {nm} nm has a power of {power}"))
                .hint("give a number from 0 up")
                .under("power"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(nm: f64, power: f64) -> Line {
        Line { nm, power }
    }

    #[test]
    fn lines_add_to_bands_that_hold_them() {
        let lines = vec![line(546.0, 3.0), line(253.65, 5.0), line(830.0, 1.0)];
        let lamp = LampSpectrum::new(Curve::Constant(0.0), lines).expect("sound");
        assert_eq!((lamp.integral(360.0, 830.0), lamp.integral(500.0, 540.0)), (4.0, 0.0));
        assert_eq!(lamp.integral_over_all(), Some(9.0));
        assert_eq!(lamp.visible_lines().count(), 2);
        let doubled = lamp.scaled(2.0);
        assert_eq!((doubled.integral(200.0, 600.0), doubled.lines()[0].nm), (16.0, 253.65));
        let on_grey = LampSpectrum::new(Curve::Constant(0.5), vec![line(546.0, 3.0)]).expect("sound");
        assert_eq!((on_grey.integral(500.0, 600.0), on_grey.integral_over_all()), (53.0, None));
    }

    #[test]
    fn faulty_lines_are_refused_where_they_stand() {
        for (lines, place) in [
            (vec![], None),
            (vec![line(589.0, 1.0), line(589.0, 2.0)], Some("/1/wavelength_nm")),
            (vec![line(-1.0, 1.0)], Some("/0/wavelength_nm")),
            (vec![line(589.0, -1.0)], Some("/0/power")),
            (vec![line(589.0, f64::NAN)], Some("/0/power")),
        ] {
            let error = LampSpectrum::new(Curve::Constant(0.0), lines).expect_err("a fault");
            assert_eq!(error.pointer.as_deref(), place, "{error}");
        }
    }

    /// One watt at 555 nm is 683 lm, and the matching functions are linear between grid points.
    #[test]
    fn a_line_has_the_colour_of_its_wavelength() {
        let lamp = |nm| LampSpectrum::new(Curve::Constant(0.0), vec![line(nm, 1.0)]).expect("sound");
        assert!((lamp(555.0).xyz()[1] - 683.0).abs() < 1e-9);
        assert_eq!(lamp(555.0).efficacy_lm_per_w(), Some(lamp(555.0).xyz()[1]));
        let middle = 0.25 * lamp(588.0).xyz()[0] + 0.75 * lamp(589.0).xyz()[0];
        assert!((lamp(588.75).xyz()[0] - middle).abs() < 1e-9);
        assert_eq!(lamp(253.65).xyz(), [0.0; 3]);
    }
}
