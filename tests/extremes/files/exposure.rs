//! Exposures of every camera, and of none.

use crate::common::scene;
use crate::record::Record;
use etalon::scene::View;
use serde_json::{Value, json};

/// A camera alone, with these settings.
fn camera(iso: f64, shutter_s: f64, f_stop: f64) -> View {
    let json: Value = json!({
        "name": "exposure", "length_unit": "m",
        "camera": {
            "position": [0, 0, 0], "direction": [0, 0, 1], "up": [0, 1, 0], "focal_length_mm": 35, "sensor_mm": [36, 24],
            "resolution": [360, 240], "iso": iso, "shutter_s": shutter_s, "f_stop": f_stop,
        },
    });
    scene(&json).view.expect("it has a camera")
}

/// ISO 12232: H = q L t / N^2 with q = 0.65 saturates at 78 / S lx s; EV100 = log2(N^2 / t) -
/// log2(S / 100).
const Q: f64 = 0.65;
const SATURATION_LX_S: f64 = 78.0;
/// As many digits as the catalogue asks for.
const DIGITS: f64 = 1e-12;

// Case 79.
pub fn exposure_follows_its_closed_form_at_every_setting(record: &mut Record) {
    let (mut worst_luminance, mut worst_ev) = (0.0_f64, 0.0_f64);
    let (mut least, mut most) = (f64::MAX, 0.0_f64);
    let mut exposures = 0_u32;
    for iso in [1.0, 50.0, 100.0, 3200.0, 4e6] {
        for shutter_s in [1.0 / 8000.0, 1.0 / 125.0, 1.0, 30.0, 3600.0] {
            for f_stop in [0.5, 1.4, 8.0, 22.0, 1e3] {
                let facts = camera(iso, shutter_s, f_stop).facts();
                let truth = SATURATION_LX_S * f_stop * f_stop / (Q * iso * shutter_s);
                let ev = (f_stop * f_stop / shutter_s).log2() - (iso / 100.0).log2();
                let luminance = facts.saturation_luminance_cd_m2;
                worst_luminance = worst_luminance.max((luminance / truth - 1.0).abs());
                worst_ev = worst_ev.max((facts.ev100 - ev).abs());
                (least, most) = (least.min(luminance), most.max(luminance));
                exposures += 1;
            }
        }
    }
    record.at_most(format!("L_sat of {exposures} exposures, relative deviation"), worst_luminance, DIGITS);
    record.at_most(format!("EV100 of {exposures} exposures, deviation"), worst_ev, 1e-12 * 39.5);
    // The ends as the catalogue has them, to the digits that it gives.
    record.relative(
        "least L_sat (ISO 4e6, 3600 s, f/0.5), cd/m2",
        least,
        78.0 * 0.25 / (0.65 * 4e6 * 3600.0),
        DIGITS,
    );
    record.relative("least L_sat, as the catalogue has it", least, 2.083e-9, 2e-4);
    record.relative("most L_sat (ISO 1, 1/8000 s, f/1000), cd/m2", most, 9.6e11, DIGITS);
    for (what, settings, ev) in
        [("least", (4e6, 3600.0, 0.5), -29.1), ("most", (1.0, 1.0 / 8000.0, 1e3), 39.5)]
    {
        let (iso, shutter_s, f_stop) = settings;
        let ev100 = camera(iso, shutter_s, f_stop).facts().ev100;
        record.absolute(format!("{what} EV100, as the catalogue has it"), ev100, ev, 0.05);
    }
}

// Case 79.
pub fn what_is_exposed_beyond_the_model_is_warned_of(record: &mut Record) {
    let warnings = |iso, shutter_s, f_stop| camera(iso, shutter_s, f_stop).record().warnings;
    record.exactly("warnings at ISO 100, 1/125 s, f/8", warnings(100.0, 0.008, 8.0).len(), 0);
    let one =
        |warnings: Vec<String>| if let [one] = &warnings[..] { one.clone() } else { warnings.join("; ") };
    let wide = one(warnings(100.0, 0.008, 0.5));
    record.says("f/0.5", &wide, "f/0.5 is beyond paraxial optics");
    record.exactly("warnings at f/0.7", warnings(100.0, 0.008, 0.7).len(), 0);
    let narrow = one(warnings(100.0, 0.008, 1e3));
    // Airy: 2.44 lambda N = 2.44 * 0.00055 mm * 1000.
    record.says("f/1000", &narrow, &format!("{:.4} mm wide at 550 nm", 2.44 * 550e-6 * 1e3));
    record.says("f/1000", &narrow, "diffraction is not modelled");
    let long = one(warnings(100.0, 3600.0, 8.0));
    record.says("3600 s", &long, "reciprocity failure and dark current are not modelled");
    record.exactly("warnings at 1 s", warnings(100.0, 1.0, 8.0).len(), 0);
}
