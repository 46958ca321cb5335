//! Pictures beyond what their encoding holds, and settings beyond the camera model.
//!
//! The render itself is in absolute 32-bit floats and loses nothing; what is developed from it
//! lies between the white and the last steps of the encoding.

use super::probe::Probe;
use super::{ALL, Condition, Kind, percent, short};
use crate::scene::{Scene, View};

/// sRGB is linear near black, with this slope.
const SRGB_SLOPE_AT_BLACK: f64 = 12.92;
/// Largest number of an 8-bit picture, and of a 16-bit one.
const MOST_8_BITS: f64 = 255.0;
const MOST_16_BITS: f64 = 65_535.0;
/// Number of an 8-bit picture below which rounding by half a step is more than 10 %.
const COARSE_NUMBER: f64 = 5.0;
/// Largest 16-bit float.
const LARGEST_HALF: f64 = 65_504.0;

pub(super) fn conditions(scene: &Scene, view: &View, probe: &Probe) -> Vec<Condition> {
    let record = view.record();
    let mut found: Vec<Condition> = record.warnings.iter().map(|warning| camera_model(warning)).collect();
    found.extend(exposure_range(record.white_luminance_cd_m2, probe));
    found.extend(beyond_half_float(scene));
    found
}

fn camera_model(warning: &str) -> Condition {
    Condition::new("camera_model", "camera", "a setting at which the camera model leaves something out")
        .effect(Kind::Bias, ALL, warning)
}

/// A picture more than half of which is clipped, or more than half of which is coarse.
fn exposure_range(white_cd_m2: f64, probe: &Probe) -> Option<Condition> {
    let median = probe.median_luminance().filter(|median| *median > 0.0)?;
    let level = median / white_cd_m2;
    let number = |most: f64| most * SRGB_SLOPE_AT_BLACK * level;
    let stops = level.log2();
    let condition = |limit: &str| {
        Condition::new("exposure_range", "camera", limit)
            .figure("median_luminance_cd_m2", median)
            .figure("white_luminance_cd_m2", white_cd_m2)
            .figure("stops_above_white", stops)
    };
    let remedy = |stops: f64| {
        format!("about {} stops of exposure, now or with `etalon develop` (--iso, --shutter)", short(stops))
    };
    if level > 1.0 {
        let what = format!(
            "more than half of the developed picture is clipped, the median by {} stops; the EXR is not",
            short(stops)
        );
        return Some(
            condition("more than half of the picture is brighter than what is developed white")
                .effect(Kind::Encoding, ALL, what)
                .remedy(remedy(-stops)),
        );
    }
    if number(MOST_8_BITS) >= COARSE_NUMBER {
        return None;
    }
    let what = format!(
        "the median is number {} of {MOST_8_BITS} in 8 bits, wrong by up to {} of itself by rounding ({} in 16 bits); the EXR is not",
        short(number(MOST_8_BITS)),
        percent(0.5 / number(MOST_8_BITS)),
        percent(0.5 / number(MOST_16_BITS))
    );
    Some(
        condition(
            "more than half of the picture lies where rounding to 8 bits is more than 10 % of the level",
        )
        .effect(Kind::Encoding, ALL, what)
        .remedy(remedy(-stops)),
    )
}

/// Lamps too bright for 16-bit floats.
fn beyond_half_float(scene: &Scene) -> Option<Condition> {
    let luminance = |emitter: &crate::light::EmitterFacts| emitter.luminance.map_or(0.0, |l| l.0);
    let brightest = scene.emitters.iter().max_by(|a, b| luminance(a).total_cmp(&luminance(b)))?;
    let (name, luminance) = (&brightest.name, luminance(brightest));
    (luminance > LARGEST_HALF).then(|| {
        let what = format!(
            "pixels that show it hold up to {} cd/m2: kept in the EXR, which has 32 bits, and infinite in a file of 16-bit floats",
            short(luminance)
        );
        Condition::new("beyond_half_float", name, format!("{LARGEST_HALF} is the largest 16-bit float"))
            .figure("luminance_cd_m2", luminance)
            .effect(Kind::Encoding, ALL, what)
            .remedy(format!("convert to 16-bit floats after a division by {} or more", short((luminance / LARGEST_HALF).ceil())))
    })
}
