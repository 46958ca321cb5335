//! What a lamp gives off, as transport reads it: a continuum on the grid, and lines.

use super::colour::{Xyz, xyz_at, xyz_of_grid};
use super::dense::Dense;
use super::lanes::Spectrum;
use super::wavelengths::{GRID_POINTS, Wavelengths};

/// A lamp's radiance or intensity.
///
/// Lines are named by their place in the scene's list ([`crate::scene::Scene::lines_nm`]), so
/// that lamps with the same line share it.
#[derive(Clone, Debug, PartialEq)]
pub struct Emission {
    /// Radiance in W sr^-1 m^-2 nm^-1, or intensity in W sr^-1 nm^-1.
    continuum: Dense,
    /// Place of each line and its radiance in W sr^-1 m^-2, or its intensity in W sr^-1.
    lines: Vec<(u32, f32)>,
}

impl Emission {
    /// An emission from its continuum (per nm) and its lines (place in the scene's list, and
    /// the line's whole radiance or intensity).
    pub const fn new(continuum: Dense, lines: Vec<(u32, f32)>) -> Self {
        Self { continuum, lines }
    }

    /// The emission at the wavelengths of a path: per nm for a lane in the continuum, the
    /// line's coefficient for a lane on a line, zero if the lamp lacks that line.
    #[inline]
    pub fn at(&self, wavelengths: &Wavelengths) -> Spectrum {
        let continuum = self.continuum.at(wavelengths);
        if !wavelengths.meet_lines() {
            return continuum;
        }
        Spectrum::from_fn(|lane| match wavelengths.line(lane) {
            Some(line) => self.of_line(line),
            None => continuum[lane],
        })
    }

    fn of_line(&self, line: u32) -> f32 {
        self.lines.iter().find(|(place, _)| *place == line).map_or(0.0, |(_, coefficient)| *coefficient)
    }

    /// The continuum at each grid point, per nm.
    pub fn at_grid_points(&self) -> impl Iterator<Item = f64> + '_ {
        (0..GRID_POINTS).map(|index| f64::from(self.continuum.at_grid_point(index)))
    }

    /// Each line: its place in the scene's list, and its radiance or intensity.
    pub fn lines(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.lines.iter().map(|(line, coefficient)| (*line, f64::from(*coefficient)))
    }

    /// Tristimulus values, given the wavelengths of the scene's lines.
    pub fn xyz(&self, lines_nm: &[f64]) -> Xyz {
        let values: Vec<f64> = self.at_grid_points().collect();
        self.lines().fold(xyz_of_grid(&values), |sum, (line, coefficient)| {
            let of_line = xyz_at(lines_nm[line as usize]);
            std::array::from_fn(|i| sum[i] + coefficient * of_line[i])
        })
    }

    /// Integral over 360 to 830 nm, of the continuum by the trapezoid rule.
    pub fn integral(&self) -> f64 {
        let ends = self.continuum.at_grid_point(0) + self.continuum.at_grid_point(GRID_POINTS - 1);
        let continuum = self.at_grid_points().sum::<f64>() - 0.5 * f64::from(ends);
        continuum + self.lines().map(|(_, coefficient)| coefficient).sum::<f64>()
    }

    /// The emission times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let times = |&(line, coefficient): &(u32, f32)| (line, (f64::from(coefficient) * factor) as f32);
        Self { continuum: self.continuum.scaled(factor), lines: self.lines.iter().map(times).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::{LANES, WavelengthSampler};

    #[test]
    fn lanes_on_lines_see_the_lines_of_this_lamp_alone() {
        let lines = [(450.0, 1.0), (550.0, 1.0)];
        let sampler = WavelengthSampler::mixture(&[1.0 / 470.0; GRID_POINTS], &lines).expect("positive");
        let lamp = Emission::new(Dense::Flat(0.25), vec![(1, 7.0)]).scaled(2.0);
        let mut met = [false; 3];
        for i in 0..64 {
            let drawn = sampler.sample(i as f32 / 64.0);
            let values = lamp.at(&drawn);
            for lane in 0..LANES {
                let (case, truth) = match drawn.line(lane) {
                    None => (0, 0.5),
                    Some(0) => (1, 0.0),
                    Some(_) => (2, 14.0),
                };
                met[case] = true;
                assert_eq!(values[lane], truth);
            }
        }
        assert_eq!(met, [true; 3]);
        assert!((lamp.integral() - (470.0 * 0.5 + 14.0)).abs() < 1e-9);
    }
}
