//! The chain from light to picture in words, and what it leaves out at the extremes.

use super::darkroom::shows_recorded;
use super::{CameraRecord, Digital, Tone};
use crate::scene::file::Anchor;
use serde::Serialize;

/// A stage of the chain.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Stage {
    /// Name.
    pub name: &'static str,
    /// Whether it changes anything.
    pub on: bool,
    /// What it does, with figures.
    pub what: String,
}

/// Names of the stages that can be switched off after a render.
pub const SWITCHES: [&str; 9] = [
    "vignetting",
    "electrons",
    "full_well",
    "dark_current",
    "shot_noise",
    "read_noise",
    "digital_values",
    "white_balance",
    "matrix",
];

impl CameraRecord {
    /// The same camera without a stage of [`SWITCHES`]; `None` for any other name.
    #[must_use]
    pub fn without(mut self, stage: &str) -> Option<Self> {
        match stage {
            "vignetting" => self.vignetting = super::Vignetting::None,
            "electrons" => (self.electronics, self.noise) = (None, None),
            "white_balance" => self.white_xyz = None,
            "matrix" => (self.matrix, self.has_fitted_matrix) = (None, false),
            "shot_noise" => self.noise = self.noise.map(|n| super::Noise { shot: false, ..n }),
            "read_noise" => self.noise = self.noise.map(|n| super::Noise { read: false, ..n }),
            "full_well" | "dark_current" | "digital_values" => {
                if let Some(electronics) = &mut self.electronics {
                    match stage {
                        "full_well" => electronics.full_well_electrons = None,
                        "dark_current" => electronics.dark_current_electrons_per_s = 0.0,
                        _ => electronics.digital = None,
                    }
                }
            }
            _ => return None,
        }
        Some(self)
    }
}

pub(super) fn stages(record: &CameraRecord) -> Vec<Stage> {
    let stage = |name, on, what: String| Stage { name, on, what };
    let mut stages = vec![lens_transmission(record)];
    let vignetting = &record.vignetting;
    stages.push(stage("vignetting", *vignetting != super::Vignetting::None, vignetting.in_words()));
    stages.push(stage("exposure", true, exposure(record)));
    let names: Vec<&str> = record.channels.iter().map(|channel| channel.name.as_str()).collect();
    stages.push(stage("sensitivity", true, format!("{}: {}", record.sensor, names.join(", "))));
    stages.extend(electronics(record));
    let balance = match (&record.white_xyz, &record.matrix) {
        (Some([x, y, z]), None) => {
            let sum = x + y + z;
            format!("light of xy ({:.4}, {:.4}) is adapted to D65 (Bradford)", x / sum, y / sum)
        }
        (Some(_), Some(_)) => balanced(record, "the white"),
        (None, Some(_)) => balanced(record, "equal energy"),
        (None, None) => "nothing is adapted".to_owned(),
    };
    stages.push(stage("white_balance", record.white_xyz.is_some(), balance));
    let matrix = match &record.matrix {
        Some(matrix) => {
            let fitted =
                if record.has_fitted_matrix { ", fitted to the ColorChecker's reflectances" } else { "" };
            format!("3x{} to {}{fitted}", record.channels.len(), matrix.to.name())
        }
        None if shows_recorded(record) => "X, Y, Z to linear sRGB".to_owned(),
        None => "none is given for the sensor's channels: the picture is made of X, Y, Z".to_owned(),
    };
    stages.push(stage("matrix", shows_recorded(record), matrix));
    stages.push(stage("tone", record.tone != Tone::Linear, tone(record)));
    stages
}

fn lens_transmission(record: &CameraRecord) -> Stage {
    let transmission = record.white.luminous_transmission;
    let stated = record.has_lens_transmission;
    let what = if stated {
        format!("{:.2} % of the white's luminance, spectrally in the sensor's channels", 100.0 * transmission)
    } else {
        format!("not stated; its mean is in the lens constant q = {:.4}", record.exposure_constant_q)
    };
    Stage { name: "lens_transmission", on: stated, what }
}

fn balanced(record: &CameraRecord, white: &str) -> String {
    let holds: Vec<String> = record.white.channels.iter().map(|held| format!("{held:.4e}")).collect();
    format!("channels divided by what they hold of 1 cd/m2 of {white}, {}", holds.join(", "))
}

fn exposure(record: &CameraRecord) -> String {
    let per_cd = record.exposure_constant_q * record.shutter_s / (record.f_stop * record.f_stop);
    format!(
        "{} s at f/{}: H = q L t / N^2 with q = {:.4} on the axis, {per_cd:.4e} lx s for 1 cd/m2; ISO {} saturates at {:.6} cd/m2",
        record.shutter_s,
        record.f_stop,
        record.exposure_constant_q,
        record.iso,
        record.saturation_luminance_cd_m2
    )
}

fn electronics(record: &CameraRecord) -> Vec<Stage> {
    const NAMES: [&str; 6] =
        ["electrons", "full_well", "dark_current", "shot_noise", "read_noise", "digital_values"];
    let (Some(electronics), Some(counter)) = (&record.electronics, record.counter()) else {
        let off = |name| Stage { name, on: false, what: "no electronics are stated".to_owned() };
        return NAMES.map(off).to_vec();
    };
    let [width, height] = record.light_sensitive_um();
    let noise = record.noise;
    let [shot, read] = [noise.is_some_and(|n| n.shot), noise.is_some_and(|n| n.read)];
    let seed = noise.map_or_else(String::new, |n| format!(", seed {}", n.seed));
    let whats = [
        (
            true,
            format!(
                "pixels of {width:.3} x {height:.3} um, quantum efficiency {}: {:.6} electrons for 1 unit of a channel",
                electronics.quantum_efficiency, counter.electrons_per_value
            ),
        ),
        match electronics.full_well_electrons {
            Some(well) => (
                true,
                format!("clips at {well} electrons; highlights are cut where the first channel is full"),
            ),
            None => (false, "not stated".to_owned()),
        },
        (
            counter.dark_electrons > 0.0,
            format!(
                "{:.4} electrons, {} per second",
                counter.dark_electrons, electronics.dark_current_electrons_per_s
            ),
        ),
        if shot {
            (true, format!("electrons arrive at random, with a variance equal to their mean{seed}"))
        } else {
            (false, "as many electrons as are expected".to_owned())
        },
        (
            read && electronics.read_noise_electrons > 0.0,
            format!("standard deviation {} electrons", electronics.read_noise_electrons),
        ),
        converter(electronics.digital.as_ref(), record.iso),
    ];
    let shown = shows_recorded(record);
    let stage = |(name, (on, what)): (_, (bool, String))| match (on, shown) {
        (true, false) => Stage { name, on: false, what: format!("raw values only: {what}") },
        _ => Stage { name, on, what },
    };
    NAMES.into_iter().zip(whats).map(stage).collect()
}

fn converter(digital: Option<&Digital>, iso: f64) -> (bool, String) {
    let Some(digital) = digital else { return (false, "electrons are developed as they are".to_owned()) };
    let what = format!(
        "{:.4} electrons per number at ISO {iso}, black at {}, {} bits",
        digital.electrons_per_dn_at(iso),
        digital.black_level_dn,
        digital.bit_depth
    );
    (true, what)
}

fn tone(record: &CameraRecord) -> String {
    let encoding = match record.tone {
        Tone::Srgb => "sRGB encoding".to_owned(),
        Tone::Linear => "linear".to_owned(),
        Tone::Gamma(gamma) => format!("gamma {gamma}"),
    };
    let anchor = match record.anchor {
        Anchor::Saturation => "saturation exposure",
        Anchor::Sos => "standard output sensitivity at 0.18",
        Anchor::Meter => "meter reading at 0.18",
    };
    format!("{encoding}, white at {:.6} cd/m2 ({anchor})", record.white_luminance_cd_m2)
}

pub(super) fn warnings(record: &CameraRecord) -> Vec<String> {
    /// Below this f-number the paraxial H = q L t / N^2 overstates what any lens can gather:
    /// the sine of the largest angle behind a lens in air, 1 / (2 N), stays below 1 at 0.5, and
    /// at 0.7 the angle is 45 degrees.
    const PARAXIAL_F_STOP: f64 = 0.7;
    /// Wavelength of the Airy disc that is named, um.
    const GREEN_UM: f64 = 0.55;
    /// Rayleigh's distance in pixels from which a picture is softer than the finest line pair
    /// that its pixels hold.
    const LINE_PAIR_PX: f64 = 2.0;
    /// Exposure time from which film loses speed and dark current counts.
    const LONG_S: f64 = 1.0;
    let mut warnings = Vec::new();
    if record.f_stop < PARAXIAL_F_STOP {
        warnings.push(format!(
            "f/{} is beyond paraxial optics: a real lens gathers less than H = q L t / N^2",
            record.f_stop
        ));
    }
    let airy_um = 2.44 * GREEN_UM * record.f_stop;
    let pitch_um = record.optics.pixel_pitch_um[0].max(record.optics.pixel_pitch_um[1]);
    if 0.5 * airy_um > LINE_PAIR_PX * pitch_um {
        warnings.push(format!(
            "at f/{} the Airy disc is {:.4} mm wide at 550 nm, {:.1} pixels: diffraction is not modelled, a photograph is softer",
            record.f_stop,
            airy_um / 1000.0,
            airy_um / pitch_um
        ));
    }
    if record.shutter_s > LONG_S {
        let dark = record.electronics.as_ref().is_some_and(|e| e.dark_current_electrons_per_s > 0.0);
        let what =
            if dark { "reciprocity failure of film is" } else { "reciprocity failure and dark current are" };
        warnings.push(format!("an exposure of {} s: {what} not modelled", record.shutter_s));
    }
    warnings.extend(sensor_warnings(record));
    warnings
}

/// What of the electronics is not in the picture, or spoils it.
fn sensor_warnings(record: &CameraRecord) -> impl Iterator<Item = String> {
    let unseen_noise = (record.noise.is_some() && !shows_recorded(record)).then(|| {
        "noise is in the raw values only: without a matrix the picture is made of X, Y, Z".to_owned()
    });
    [unseen_noise, derived_pitch(record), full_too_early(record)].into_iter().flatten()
}

fn derived_pitch(record: &CameraRecord) -> Option<String> {
    record.electronics.as_ref().filter(|electronics| electronics.pixel_pitch_um.is_none())?;
    let [width, height] = record.light_sensitive_um();
    Some(format!(
        "no pixel_pitch_um is stated: pixels of {width:.3} x {height:.3} um follow from sensor_mm and resolution, and electrons change with the resolution"
    ))
}

fn full_too_early(record: &CameraRecord) -> Option<String> {
    /// What one decimal of a stop does not show.
    const UNSEEN_STOPS: f64 = 0.05;
    let full_cd_m2 = record.full_luminance_cd_m2().filter(|_| shows_recorded(record))?;
    let white_cd_m2 = record.white_luminance_cd_m2;
    if full_cd_m2 <= 0.0 {
        return Some("the dark current alone fills a pixel: the picture is black".to_owned());
    }
    let stops = (white_cd_m2 / full_cd_m2).log2();
    (stops > UNSEEN_STOPS).then(|| {
        format!(
            "a pixel is full at {full_cd_m2:.6} cd/m2, {stops:.1} stops below the white of {white_cd_m2:.6} cd/m2: nothing in the picture is brighter than that"
        )
    })
}
