//! What a comparison has found, as one JSON object and as text.

use super::pictures::Pair;
use etalon::image::LuminancePicture;
use etalon::statistics::{ALPHA, Comparison, FLOOR_SHARE, LevelResult, Outcome, Subject, relative_mse};
use serde::Serialize;
use std::fmt::Write as _;

/// The JSON object. Figures that are not known are null.
#[derive(Debug, Serialize)]
pub struct Report<'p> {
    a: File<'p>,
    b: File<'p>,
    width: usize,
    height: usize,
    /// `cd/m2`, or `relative` where A was scaled to the mean of B.
    units: &'static str,
    pixels: usize,
    pixels_excluded: usize,
    mse: f64,
    mse_corrected: Option<f64>,
    mse_corrected_ci95: Option<[f64; 2]>,
    relmse: f64,
    relmse_trimmed: f64,
    relmse_corrected: Option<f64>,
    relmse_corrected_ci95: Option<[f64; 2]>,
    /// Of X, Y and Z, where both pictures have them.
    mse_xyz: Option<[f64; 3]>,
    relmse_xyz: Option<[f64; 3]>,
    smape: f64,
    mean_ratio: Option<f64>,
    mean_ratio_ci95: Option<[f64; 2]>,
    /// What A was multiplied by, where shapes are compared.
    scale_fitted: Option<f64>,
    margin: f64,
    alpha: f64,
    pixels_judged: Option<usize>,
    pixels_rejected: Option<usize>,
    pixels_suspicious: Option<usize>,
    levels: Vec<LevelJson>,
    chi_squared: Option<ChiSquared>,
    verdict: &'static str,
    reason: Option<&'static str>,
    samples_factor: Option<f64>,
    seconds_to_settle: Option<Seconds>,
    notes: &'p [String],
}

#[derive(Debug, Serialize)]
struct File<'p> {
    file: &'p str,
    channels: &'p str,
    integrator: Option<&'p str>,
    samples_per_pixel: Option<u64>,
    blocks: Option<f64>,
}

#[derive(Debug, Serialize)]
struct LevelJson {
    cell_px: usize,
    cells: usize,
    judged: usize,
    rejected: usize,
    suspicious: usize,
    worst: Option<Worst>,
}

#[derive(Debug, Serialize)]
struct Worst {
    pixel: [usize; 2],
    ratio: f64,
    z: f64,
    p: f64,
}

#[derive(Debug, Serialize)]
struct ChiSquared {
    reduced: f64,
    z: f64,
    p: f64,
    pixels: usize,
}

/// Seconds of both renders with as many samples as would settle the verdict.
#[derive(Clone, Copy, Debug, Serialize)]
struct Seconds {
    wall: Option<f64>,
    cpu: Option<f64>,
}

impl<'p> Report<'p> {
    /// Gathers what was found.
    pub fn of(pair: &'p Pair, comparison: &Comparison, margin: f64, subject: Subject) -> Self {
        let Comparison { measures, whole, levels, excess, outcome, .. } = comparison;
        let file = |which: usize| File {
            file: &pair.files[which],
            channels: &pair.pictures[which].channels,
            integrator: pair.pictures[which].stated.integrator.as_deref(),
            samples_per_pixel: pair.pictures[which].stated.samples_per_pixel,
            blocks: pair.estimates[which].noise.as_ref().map(|noise| noise.blocks),
        };
        let is_shape = subject == Subject::Shape;
        let scale_fitted = is_shape.then_some(1.0 / whole.ratio);
        let xyz = of_xyz(pair, scale_fitted.unwrap_or(1.0));
        let (verdict, reason, samples_factor) = match outcome {
            Outcome::Equal => ("equal", None, None),
            Outcome::Different => ("different", None, None),
            Outcome::Undecided { samples_factor, reason } => ("undecided", Some(*reason), *samples_factor),
        };
        let finest = levels.first();
        let corrected = measures.corrected.filter(|_| !pair.shares_numbers);
        Self {
            a: file(0),
            b: file(1),
            width: pair.size[0],
            height: pair.size[1],
            units: if is_shape { "relative" } else { "cd/m2" },
            pixels: pair.counted.len() - pair.excluded(),
            pixels_excluded: pair.excluded(),
            mse: measures.mse,
            mse_corrected: corrected.map(|c| c.mse),
            mse_corrected_ci95: corrected.and_then(|c| c.intervals).map(|i| i[0]),
            relmse: measures.relative.plain,
            relmse_trimmed: measures.relative.trimmed,
            relmse_corrected: corrected.map(|c| c.relative_mse),
            relmse_corrected_ci95: corrected.and_then(|c| c.intervals).map(|i| i[1]),
            mse_xyz: xyz.map(|channels| channels.map(|c| c[0])),
            relmse_xyz: xyz.map(|channels| channels.map(|c| c[1])),
            smape: measures.smape,
            mean_ratio: (!is_shape).then_some(whole.ratio),
            mean_ratio_ci95: whole.interval.map(|i| i.interval),
            scale_fitted,
            margin,
            alpha: ALPHA,
            pixels_judged: finest.map(|level| level.judged),
            pixels_rejected: finest.map(|level| level.rejected),
            pixels_suspicious: finest.map(|level| level.suspicious),
            levels: levels.iter().map(LevelJson::of).collect(),
            chi_squared: excess.map(|e| ChiSquared {
                reduced: e.reduced_chi_squared,
                z: e.z,
                p: e.p_value,
                pixels: e.pixels,
            }),
            verdict,
            reason,
            samples_factor,
            seconds_to_settle: samples_factor.map(|factor| seconds(pair, factor)),
            notes: &pair.notes,
        }
    }

    /// The verdict in one word.
    pub fn verdict(&self) -> &'static str {
        self.verdict
    }

    /// One JSON object.
    pub fn json(&self) -> String {
        serde_json::to_string_pretty(self).expect("the report is plain data")
    }

    /// The same as text.
    pub fn text(&self, comparison: &Comparison) -> String {
        let mut text = String::new();
        // Writing to a string does not fail.
        let _ = self.write(&mut text, comparison);
        text.trim_end().to_owned()
    }

    fn write(&self, to: &mut String, comparison: &Comparison) -> std::fmt::Result {
        for (name, file) in [("A", &self.a), ("B", &self.b)] {
            writeln!(to, "{name}  {}: {}", file.file, file.description())?;
        }
        writeln!(
            to,
            "{} x {} pixels, {} left out; {}",
            self.width,
            self.height,
            self.pixels_excluded,
            self.scale()
        )?;
        let unit = if self.scale_fitted.is_some() { "B's unit squared" } else { "(cd/m2)^2" };
        writeln!(to, "\n{:<24}{:>12}   without noise [95 %]", "", "")?;
        let row = |name: &str, value: f64, corrected: Option<f64>, ci95: Option<[f64; 2]>, unit: &str| {
            let corrected = corrected.map_or(String::new(), |value| format!("{value:.3e}"));
            let interval = ci95.map_or(String::new(), |[low, high]| format!(" [{low:.2e}, {high:.2e}]"));
            format!("{name:<24}{value:>12.4e}   {corrected}{interval} {unit}").trim_end().to_owned()
        };
        writeln!(to, "{}", row("MSE", self.mse, self.mse_corrected, self.mse_corrected_ci95, unit))?;
        writeln!(
            to,
            "{}",
            row("relMSE", self.relmse, self.relmse_corrected, self.relmse_corrected_ci95, "")
        )?;
        writeln!(to, "{}", row("relMSE, 0.1 % trimmed", self.relmse_trimmed, None, None, ""))?;
        writeln!(to, "{}", row("SMAPE", self.smape, None, None, ""))?;
        if let Some(ratio) = self.mean_ratio {
            let interval =
                self.mean_ratio_ci95.map_or(String::new(), |[low, high]| format!("   [{low:.6}, {high:.6}]"));
            writeln!(to, "{:<24}{ratio:>12.6}{interval}", "mean of A / mean of B")?;
        }
        if !comparison.levels.is_empty() {
            writeln!(to, "\ncell px     cells    judged  rejected  suspicious   clearest difference")?;
        }
        comparison.levels.iter().try_for_each(|level| writeln!(to, "{level}"))?;
        if let Some(excess) = &comparison.excess {
            writeln!(to, "{excess}")?;
        }
        writeln!(to)?;
        self.notes.iter().try_for_each(|note| writeln!(to, "note: {note}"))?;
        writeln!(to, "{}", self.conclusion())
    }

    fn scale(&self) -> String {
        match self.scale_fitted {
            Some(factor) => format!("shapes: A is multiplied by {factor:.6e}"),
            None => "luminance in cd/m2".to_owned(),
        }
    }

    fn conclusion(&self) -> String {
        let margin = 100.0 * self.margin;
        let of = if self.scale_fitted.is_some() { "the quarters of the picture" } else { "the means" };
        match (self.verdict, self.reason) {
            ("equal", _) => format!("equal: nothing differs, and {of} are equal within {margin} %"),
            ("different", _) => format!(
                "different: equal pictures are meant to be called so once in {:.0} times, and are more often where samples are so few that bright ones were not met",
                1.0 / self.alpha
            ),
            (verdict, reason) => {
                let reason = reason.unwrap_or_default();
                let more = self.samples_factor.map_or(String::new(), |factor| {
                    let time = match self.seconds_to_settle.and_then(|s| s.wall) {
                        Some(wall) => format!("about {wall:.0} s for both renders together"),
                        None => "in a time that the files do not tell".to_owned(),
                    };
                    format!("; {factor:.1} times as many samples of both would settle it, {time}")
                });
                format!("{verdict}: {reason} (margin {margin} %){more}")
            }
        }
    }
}

impl File<'_> {
    fn description(&self) -> String {
        let mut parts = vec![self.channels.to_owned()];
        parts.extend(self.integrator.map(ToOwned::to_owned));
        parts.extend(self.samples_per_pixel.map(|spp| format!("{spp} samples per pixel")));
        parts.extend(self.blocks.map(|blocks| format!("{blocks} blocks")));
        parts.join("; ")
    }
}

impl LevelJson {
    fn of(level: &LevelResult) -> Self {
        let LevelResult { cell_px, cells, judged, rejected, suspicious, worst, .. } = *level;
        let worst = worst.map(|w| Worst { pixel: w.pixel, ratio: w.ratio, z: w.t, p: w.p_value });
        Self { cell_px, cells, judged, rejected, suspicious, worst }
    }
}

/// MSE and relative MSE of X, Y and Z, where both pictures have all of them.
fn of_xyz(pair: &Pair, factor: f64) -> Option<[[f64; 2]; 3]> {
    let kept = |picture: &LuminancePicture, channel: usize, factor: f64| -> Vec<f64> {
        let values = picture.xyz[channel].iter().zip(&pair.counted);
        values.filter(|(_, counted)| **counted).map(|(value, _)| factor * value).collect()
    };
    let [a, b] = &pair.pictures;
    if a.xyz.iter().chain(&b.xyz).any(Vec::is_empty) {
        return None;
    }
    Some([0, 1, 2].map(|channel| {
        let (image, reference) = (kept(a, channel, factor), kept(b, channel, 1.0));
        let squares: f64 = image.iter().zip(&reference).map(|(i, r)| (i - r).powi(2)).sum();
        [squares / image.len() as f64, relative_mse(&image, &reference, FLOOR_SHARE).plain]
    }))
}

/// What both renders together would take.
fn seconds(pair: &Pair, factor: f64) -> Seconds {
    let [a, b] = pair.pictures.each_ref().map(|picture| picture.stated.seconds_of(factor));
    let both = |kind: usize| Some(a[kind]? + b[kind]?);
    Seconds { wall: both(0), cpu: both(1) }
}
