//! Planck's law in f64, and its logarithm where the law itself leaves the range of f64.

use crate::units::constants::{BOLTZMANN_J_K, LIGHT_SPEED_M_S, PLANCK_J_S};
use crate::units::{Kelvin, Nanometers};

/// First radiation constant for radiance, 2 h c^2 in W m^2 sr^-1.
const C1_RADIANCE: f64 = 2.0 * PLANCK_J_S * LIGHT_SPEED_M_S * LIGHT_SPEED_M_S;
/// Second radiation constant, h c / k in m K.
const C2: f64 = PLANCK_J_S * LIGHT_SPEED_M_S / BOLTZMANN_J_K;

/// Spectral radiance of a black body in W m^-2 sr^-1 m^-1 (per metre of wavelength).
///
/// Zero where the value is below the range of f64, never NaN for positive arguments.
pub fn planck_w_m2_sr_m(wavelength: Nanometers, temperature: Kelvin) -> f64 {
    let metres = wavelength.0 * 1e-9;
    // exp_m1 keeps the Rayleigh-Jeans end, where exp(x) - 1 would cancel.
    C1_RADIANCE / (metres.powi(5) * (C2 / (metres * temperature.0)).exp_m1())
}

/// Natural logarithm of [`planck_w_m2_sr_m`], finite for every positive wavelength and
/// temperature.
pub fn ln_planck(wavelength: Nanometers, temperature: Kelvin) -> f64 {
    let metres = wavelength.0 * 1e-9;
    let x = C2 / (metres * temperature.0);
    // ln(exp(x) - 1) = x + ln(1 - exp(-x)): no overflow at the cold end.
    let ln_exp_m1 = if x > 1.0 { x + (-(-x).exp()).ln_1p() } else { x.exp_m1().ln() };
    C1_RADIANCE.ln() - 5.0 * metres.ln() - ln_exp_m1
}

/// Wavelength at which a black body's radiance per nanometre is largest (Wien).
pub fn peak_nm(temperature: Kelvin) -> f64 {
    /// Root of x = 5 (1 - exp(-x)).
    const WIEN: f64 = 4.965_114_231_744_276;
    C2 / (WIEN * temperature.0) * 1e9
}
