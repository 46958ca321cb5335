//! From photons to digital values: what a pixel of a photoelectric sensor counts.
//!
//! The linear model of EMVA 1288: photons of the exposure through a pixel's area, the share of
//! them that free an electron, electrons of the dark current, the full well; then an amplifier
//! with its noise, a black level, and a converter of so many bits. Every channel is counted at
//! every pixel, as by a camera with a filter wheel: there is no mosaic of filters.

use super::noise::Numbers;
use crate::spectrum::colour::xyz_of_grid;
use crate::spectrum::{Curve, grid_nm};
use crate::units::constants::{LIGHT_SPEED_M_S, PLANCK_J_S};
use serde::{Deserialize, Serialize};

/// The electronics of a sensor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Electronics {
    /// Width and height of a pixel's light-sensitive area in um; `None` takes the spacing of
    /// the picture's pixels on the sensor.
    pub pixel_pitch_um: Option<[f64; 2]>,
    /// Electrons per photon where the sensor is most efficient; the sensitivities give the
    /// shape.
    pub quantum_efficiency: f64,
    /// Electrons that a pixel holds; `None` does not clip.
    pub full_well_electrons: Option<f64>,
    /// Standard deviation of the amplifier's noise in electrons.
    pub read_noise_electrons: f64,
    /// Electrons per second that come without light.
    pub dark_current_electrons_per_s: f64,
    /// The converter; `None` leaves electrons.
    pub digital: Option<Digital>,
}

/// The amplifier and converter of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Digital {
    /// Electrons for one digital number at the base ISO; it falls as the ISO setting rises.
    pub electrons_per_dn: f64,
    /// The ISO setting of that gain.
    pub base_iso: f64,
    /// Digital value of no electrons.
    pub black_level_dn: f64,
    /// Bits of a digital value.
    pub bit_depth: u8,
}

impl Electronics {
    /// Whether its numbers are of a sensor: a scene's always are, those of a file may not be.
    pub fn is_sound(&self) -> bool {
        let positive = |value: f64| value > 0.0 && value.is_finite();
        let counts = |value: f64| value >= 0.0 && value.is_finite();
        self.pixel_pitch_um.iter().flatten().all(|um| positive(*um))
            && positive(self.quantum_efficiency)
            && self.full_well_electrons.is_none_or(positive)
            && counts(self.read_noise_electrons)
            && counts(self.dark_current_electrons_per_s)
            && self.digital.is_none_or(|digital| {
                (1..=16).contains(&digital.bit_depth)
                    && positive(digital.electrons_per_dn)
                    && positive(digital.base_iso)
                    && counts(digital.black_level_dn)
            })
    }
}

impl Digital {
    /// Electrons for one digital number at an ISO setting.
    pub fn electrons_per_dn_at(&self, iso: f64) -> f64 {
        self.electrons_per_dn * self.base_iso / iso
    }

    /// Largest digital value.
    pub fn white_level_dn(&self) -> f64 {
        f64::from((1_u32 << self.bit_depth) - 1)
    }
}

/// Which noise there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Noise {
    /// Seed of the random numbers.
    pub seed: u64,
    /// Photons and dark electrons arrive at random.
    pub shot: bool,
    /// The amplifier adds its noise.
    pub read: bool,
}

/// What a pixel counts in one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Count {
    /// Digital value; electrons where there is no converter.
    pub level: f64,
    /// Whether the well was full or the converter at its end.
    pub saturated: bool,
}

/// Electronics at one exposure: everything per unit of what the film holds.
#[derive(Clone, Debug)]
pub struct Counter<'a> {
    /// The electronics.
    pub electronics: &'a Electronics,
    /// Electrons on the axis for one unit of the film.
    pub electrons_per_value: f64,
    /// Electrons of the dark current.
    pub dark_electrons: f64,
    /// ISO setting.
    pub iso: f64,
    /// Noise, if any.
    pub noise: Option<Noise>,
}

impl Counter<'_> {
    /// Counts a channel in a pixel; `falloff` is the vignetting there.
    pub fn count(&self, value: f64, falloff: f64, pixel: u64, channel: u64) -> Count {
        let mean = value * falloff * self.electrons_per_value + self.dark_electrons;
        let mut numbers = self.noise.map(|noise| (noise, Numbers::new(noise.seed, pixel, channel)));
        let mut electrons = match &mut numbers {
            Some((Noise { shot: true, .. }, numbers)) => numbers.poisson(mean),
            _ => mean,
        };
        let mut saturated = false;
        if let Some(well) = self.electronics.full_well_electrons.filter(|well| electrons >= *well) {
            (electrons, saturated) = (well, true);
        }
        if let Some((Noise { read: true, .. }, numbers)) = &mut numbers {
            electrons += self.electronics.read_noise_electrons * numbers.normal();
        }
        let Some(digital) = &self.electronics.digital else { return Count { level: electrons, saturated } };
        let white = digital.white_level_dn();
        let level = (digital.black_level_dn + electrons / digital.electrons_per_dn_at(self.iso)).round();
        Count { level: level.clamp(0.0, white), saturated: saturated || level >= white }
    }

    /// What the film holds on the axis where a count ends; `None` where it never does.
    pub fn full_value(&self) -> Option<f64> {
        let digital = self.electronics.digital.as_ref();
        let converter =
            digital.map(|d| (d.white_level_dn() - d.black_level_dn) * d.electrons_per_dn_at(self.iso));
        let well = self.electronics.full_well_electrons;
        let electrons = well.into_iter().chain(converter).reduce(f64::min)?;
        Some((electrons - self.dark_electrons) / self.electrons_per_value)
    }

    /// What a count says that the film held on the axis: black level and mean dark signal are
    /// subtracted, gain and exposure undone.
    pub fn value_of(&self, count: &Count) -> f64 {
        let electrons = match &self.electronics.digital {
            Some(digital) => (count.level - digital.black_level_dn) * digital.electrons_per_dn_at(self.iso),
            None => count.level,
        };
        (electrons - self.dark_electrons) / self.electrons_per_value
    }
}

/// Electrons per joule of a channel whose responses are relative, at a quantum efficiency of 1
/// where the largest of all is reached.
///
/// A response r per watt is r = eta lambda / (h c) up to a factor, so that eta is largest
/// where r / lambda is: electrons are 1 / (h c max(r / lambda)) times the joules weighted with
/// r. `responses` are pairs of wavelength in nm and response.
pub fn electrons_per_weighted_joule(responses: impl Iterator<Item = (f64, f64)>) -> f64 {
    let largest = responses.map(|(nm, response)| response / (nm * 1e-9)).fold(0.0, f64::max);
    1.0 / (PLANCK_J_S * LIGHT_SPEED_M_S * largest)
}

/// Photons per um^2 within a band for an exposure of 1 lx s, by the shape of the light alone.
///
/// Sums over the 1 nm grid, as CIE 015 has them for luminance: each point of the grid stands for
/// its nanometre, the band's ends included.
pub fn photons_per_um2_lx_s(light: &Curve, from_nm: f64, to_nm: f64) -> f64 {
    /// Square micrometres in a square metre.
    const UM2_PER_M2: f64 = 1e12;
    let shape = light.shape(grid_nm());
    let luminous = xyz_of_grid(&shape)[1];
    let photons = |nm: f64, power: f64| power * nm * 1e-9 / (PLANCK_J_S * LIGHT_SPEED_M_S);
    let inside = grid_nm().zip(&shape).filter(|(nm, _)| (from_nm..=to_nm).contains(nm));
    inside.map(|(nm, power)| photons(nm, *power)).sum::<f64>() / luminous / UM2_PER_M2
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::{Outside, Table};
    use crate::units::Kelvin;

    fn electronics() -> Electronics {
        Electronics {
            pixel_pitch_um: Some([4.3; 2]),
            quantum_efficiency: 0.5,
            full_well_electrons: Some(1000.0),
            read_noise_electrons: 3.0,
            dark_current_electrons_per_s: 10.0,
            digital: Some(Digital {
                electrons_per_dn: 0.5,
                base_iso: 100.0,
                black_level_dn: 64.0,
                bit_depth: 12,
            }),
        }
    }

    /// 1 lx s at 555 nm is 4091 photons per um^2, of 6500 K within 400-700 nm 11 106.
    #[test]
    fn photons_of_a_lux_second() {
        let line =
            Table::new(vec![554.0, 555.0, 556.0], vec![0.0, 1.0, 0.0], Outside::Zero).expect("a table");
        let green = photons_per_um2_lx_s(&Curve::Table(line), 360.0, 830.0);
        assert!((green - 4091.0).abs() < 1.0, "{green}");
        let daylight = photons_per_um2_lx_s(&Curve::Blackbody(Kelvin(6500.0)), 400.0, 700.0);
        assert!((daylight - 11_106.0).abs() < 1.0, "{daylight}");
        // ISO 100 saturation, 78 lx s / 100, through a pixel of 4.3 um, quantum efficiency 0.5.
        let electrons = daylight * 0.78 * 4.3 * 4.3 * 0.5;
        assert!((electrons - 80_085.0).abs() < 10.0, "{electrons}");
    }

    #[test]
    fn counts_without_noise_go_there_and_back() {
        let electronics = electronics();
        let counter = Counter {
            electronics: &electronics,
            electrons_per_value: 2.0,
            dark_electrons: 5.0,
            iso: 100.0,
            noise: None,
        };
        // 100 * 0.5 * 2 + 5 electrons, 2 DN each, above 64.
        let count = counter.count(100.0, 0.5, 0, 0);
        assert_eq!(count, Count { level: 274.0, saturated: false });
        assert_eq!(counter.value_of(&count), 50.0);
        // Twice the ISO, twice the gain, the same answer.
        let faster = Counter { iso: 200.0, ..counter.clone() };
        assert_eq!(faster.count(100.0, 0.5, 0, 0).level, 64.0 + 420.0);
        assert_eq!(faster.value_of(&faster.count(100.0, 0.5, 0, 0)), 50.0);
        // The well holds 1000 electrons, the converter 4095 - 64 numbers.
        let full = counter.count(1e6, 1.0, 0, 0);
        assert_eq!(full, Count { level: 64.0 + 2000.0, saturated: true });
        assert_eq!(
            Counter { iso: 800.0, ..counter }.count(300.0, 1.0, 0, 0),
            Count { level: 4095.0, saturated: true }
        );
    }

    /// Variance of many pixels of the same light: signal and dark current by themselves,
    /// the amplifier's on top. |z| < 5 with z of standard error sqrt(2 / n): false alarm once
    /// in 1.7 million.
    #[test]
    fn variances_of_signal_dark_and_amplifier_add_up() {
        const PIXELS: u64 = 40_000;
        let electronics = Electronics { digital: None, full_well_electrons: None, ..electronics() };
        for (shot, read, variance) in [(true, false, 405.0), (false, true, 9.0), (true, true, 414.0)] {
            let noise = Some(Noise { seed: 3, shot, read });
            let counter = Counter {
                electronics: &electronics,
                electrons_per_value: 2.0,
                dark_electrons: 5.0,
                iso: 100.0,
                noise,
            };
            let levels: Vec<f64> = (0..PIXELS).map(|p| counter.count(200.0, 1.0, p, 1).level).collect();
            let mean = levels.iter().sum::<f64>() / PIXELS as f64;
            let scatter = levels.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / (PIXELS - 1) as f64;
            assert!((mean - 405.0).abs() < 5.0 * (variance / PIXELS as f64).sqrt(), "{mean}");
            let spread = ((2.0 + 1.0 / 405.0) / PIXELS as f64).sqrt();
            assert!((scatter / variance - 1.0).abs() < 5.0 * spread, "{scatter} for {variance}");
        }
    }
}
