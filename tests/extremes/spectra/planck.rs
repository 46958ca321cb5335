//! Planck's law where f32, or a careless f64, leaves its range.

use crate::common::refusals::{check, place};
use crate::record::Record;
use etalon::spectrum::{Curve, ln_planck, planck_w_m2_sr_m};
use etalon::units::{Kelvin, Nanometers};
use std::f64::consts::PI;

fn planck(nm: f64, kelvin: f64) -> f64 {
    planck_w_m2_sr_m(Nanometers(nm), Kelvin(kelvin))
}

// Case 1. Values with 40 digits by mpmath, and the constants of the SI.
pub fn a_cold_black_body_is_dark_and_never_nan(record: &mut Record) {
    record.exactly("B(555 nm, 1 K), W m^-2 sr^-1 m^-1", planck(555.0, 1.0), 0.0);
    for (nm, kelvin, ln) in [
        (555.0, 1.0, -25_888.552_746_274_83),
        (360.0, 1e-3, -39_965_986.855_832_36),
        (1e6, 1.0, -16.515_523_933_123_137),
        (555.0, 1000.0, 9.431_048_795_987_37),
    ] {
        let found = ln_planck(Nanometers(nm), Kelvin(kelvin));
        record.relative(format!("ln B({nm} nm, {kelvin} K)"), found, ln, 1e-10);
    }
    for (nm, kelvin, value) in [
        (1e6, 1.0, 6.720_461_386_135_17e-8),
        (555.0, 1000.0, 12_469.597_940_178_5),
        (555.0, 300.0, 6.695_180_650_699_26e-23),
    ] {
        record.relative(format!("B({nm} nm, {kelvin} K)"), planck(nm, kelvin), value, 1e-9);
    }
    let all = (0..=30).flat_map(|e| [1.0, 360.0, 830.0, 1e6].map(|nm| planck(nm, 10f64.powi(e - 20))));
    record.holds("no NaN from 1e-20 to 1e10 K", all.into_iter().all(f64::is_finite));
}

// Case 2.
pub fn a_hot_black_body_holds_at_short_waves(record: &mut Record) {
    record.relative("B(1 nm, 1e6 K)", planck(1.0, 1e6), 6.720_461_386_135_17e22, 1e-12);
}

// Case 3. The second order of Rayleigh and Jeans is x / 2 = 7e-10 at 1e-3 m and 1e10 K.
pub fn a_hot_black_body_follows_rayleigh_and_jeans_at_long_waves(record: &mut Record) {
    record.relative("B(1e6 nm, 1e7 K)", planck(1e6, 1e7), 82_781.571_916_914_1, 1e-12);
    const LIGHT_M_S: f64 = 299_792_458.0;
    const BOLTZMANN_J_K: f64 = 1.380_649e-23;
    let limit = 2.0 * LIGHT_M_S * BOLTZMANN_J_K * 1e10 / 1e-3_f64.powi(4);
    record.relative("B(1e6 nm, 1e10 K) against 2 c k T / lambda^4", planck(1e6, 1e10), limit, 1e-9);
}

// Case 4.
pub fn a_temperature_that_is_none_is_refused_where_it_stands(record: &mut Record) {
    record.note("What stands at fault is named by file, line, column and JSON pointer.");
    for (name, temperature, says) in [
        ("zero", "0", "a temperature of 0 K is not positive"),
        ("negative", "-273.15", "a temperature of -273.15 K is not positive"),
        ("infinite", "1e999", "too large"),
        ("absurd", "1e100", "too large"),
        ("nan", "NaN", "write a finite number"),
        ("null", "null", "null where a number belongs"),
    ] {
        let scene = format!(
            "{{\n\"name\": \"body\",\n\"length_unit\": \"m\",\n\"lights\": [{{\"point\": {{\n\"position\": [0, 0, 0],\n\
             \"emission\": {{\"level\": {{\"flux_lm\": 1}}, \"spectrum\": {{\n\"blackbody\": {{\"temperature_k\": {temperature}}}}}}}}}}}]}}\n"
        );
        let file = format!("temperature-{name}");
        let (code, _, error) = check(&file, &scene);
        record.exactly(format!("exit code for {temperature} K"), code.unwrap_or(-1), 2);
        record.says(format!("{temperature} K: what is said"), &error, says);
        // Numbers out of range of a spectrum are faults of the spectrum as a whole.
        let line = place(&file, &scene, "temperature_k").rsplit_once(':').map(|(line, _)| line.to_owned());
        let line = if name == "absurd" {
            place(&file, &scene, "\"emission\"").rsplit_once(':').map(|(l, _)| l.to_owned())
        } else {
            line
        };
        record.says(format!("{temperature} K: where"), &error, &line.expect("a line"));
    }
}

// Case 5.
pub fn a_black_body_radiates_what_stefan_and_boltzmann_say(record: &mut Record) {
    const STEFAN_BOLTZMANN: f64 = 5.670_374_419e-8;
    for kelvin in [1.0_f64, 300.0, 6500.0, 1e7] {
        // From a hundredth of the wavelength of the peak to a hundred thousand times it.
        let peak_nm = 2.897_771_955e6 / kelvin;
        let sum = Curve::Blackbody(Kelvin(kelvin)).integral(peak_nm * 1e-2, peak_nm * 1e5);
        let truth = STEFAN_BOLTZMANN * kelvin.powi(4) / PI;
        record.relative(format!("integral at {kelvin} K, W m^-2 sr^-1"), sum, truth, 1e-6);
    }
    record.note(
        "The catalogue's shares, 0.5528 and 0.1340, are sums over 471 samples, which count the ends \
         in full; both that sum and the integral are held to 40-digit values.",
    );
    for (kelvin, integral, sum) in
        [(6500.0, 0.551_794_088_048, 0.552_798_362_828), (2856.0, 0.133_745_650_124, 0.134_044_318_451)]
    {
        let body = Curve::Blackbody(Kelvin(kelvin));
        let all = body.integral_over_all().expect("finite");
        let share = body.integral(360.0, 830.0) / all;
        record.relative(format!("share from 360 to 830 nm at {kelvin} K"), share, integral, 1e-6);
        let summed = etalon::spectrum::grid_nm().map(|nm| body.at(nm)).sum::<f64>() / all;
        record.relative(format!("the same, summed at 1 nm, at {kelvin} K"), summed, sum, 1e-6);
    }
}
