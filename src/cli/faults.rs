//! What a render or a reading must not pass over: samples that were not finite, paths that were
//! cut off, and light of which none was found. Warnings, or under `--strict` errors that end in exit code 3.

use etalon::image::Facts;
use etalon::integrator::{Reading, Truncation};
use etalon::replay::SampleName;
use std::collections::BTreeSet;
use std::path::Path;

/// Pixels and samples that are written out; the facts name more.
const SHOWN: usize = 8;

/// Tells what is wrong with a render; whether nothing is.
pub fn tell(facts: &Facts, scene: &Path, output: &Path, strict: bool) -> bool {
    let word = if strict { "error" } else { "warning" };
    if facts.non_finite_samples > 0 {
        let pixels: BTreeSet<[u32; 2]> = facts.non_finite.iter().filter_map(SampleName::pixel).collect();
        let all = facts.non_finite.len() as u64 >= facts.non_finite_samples;
        let mut listed: Vec<String> = pixels.iter().take(SHOWN).map(|[x, y]| format!("{x},{y}")).collect();
        if pixels.len() > SHOWN || !all {
            listed.push("…".to_owned());
        }
        eprintln!(
            "{word}: {} contributions were not finite and count as zero: the picture is biased by an unknown amount, at least in the pixels {}",
            facts.non_finite_samples,
            listed.join(" ")
        );
        name(&facts.non_finite, scene, &output.display().to_string());
    }
    // Where light cannot be found, that was said before.
    if facts.no_light_found && facts.missing.is_empty() {
        eprintln!(
            "{word}: the picture is black: lamps shine, and {} samples per pixel found none of their light; use --integrator mlt, or larger lamps",
            facts.samples_per_pixel
        );
    }
    let is_finite = tell_truncation(facts.truncation.as_ref(), word, "");
    let is_sound = is_finite && facts.non_finite_samples == 0 && !facts.no_light_found;
    if strict && !is_sound {
        eprintln!("error: {} was written all the same, and says so", output.display());
    }
    is_sound
}

/// Tells what is wrong with a reading; whether nothing is.
pub fn tell_reading(reading: &Reading, scene: &Path, strict: bool) -> bool {
    let word = if strict { "error" } else { "warning" };
    let faults = &reading.faults;
    if faults.count > 0 {
        eprintln!(
            "{word}: meter {}: {} samples were not finite and count as zero: the reading is biased by an unknown amount",
            reading.name, faults.count
        );
        name(&faults.named, scene, "READINGS.json");
    }
    let sound = tell_truncation(Some(&reading.truncation), word, &format!("meter {}: ", reading.name));
    sound && faults.count == 0
}

/// Names samples, and how they are looked at.
fn name(samples: &[SampleName], scene: &Path, from: &str) {
    samples.iter().take(SHOWN).for_each(|sample| eprintln!("  {sample}"));
    eprintln!("  look at them with: etalon replay {} --from {from} --sample 0", scene.display());
}

/// Tells where paths were cut off and light was trapped; whether radiance has a finite value. A
/// limit that was asked for is no fault.
fn tell_truncation(truncation: Option<&Truncation>, word: &str, of: &str) -> bool {
    let Some(truncation) = truncation else { return true };
    let diverges = truncation.divergence.is_some();
    let word = if diverges { word } else { "note" };
    for message in truncation.message().into_iter().chain(truncation.trapped_message()) {
        eprintln!("{word}: {of}{message}");
    }
    !diverges
}
