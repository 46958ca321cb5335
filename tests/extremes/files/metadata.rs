//! What a picture says about itself, read back from the file as any reader of EXR would.

use crate::record::Record;
use exr::prelude::*;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder of this test alone, empty.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("extremes-metadata").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("the folder for tests can be written");
    folder
}

/// Attributes of a render and the facts in it, and the run's own report.
struct Written {
    image: ImageAttributes,
    layer: LayerAttributes,
    facts: Value,
    report: Value,
}

fn render(integrator: &str, options: &str) -> Written {
    let folder = folder(&format!("{integrator}{}", options.len()));
    let (picture, report) = (folder.join("out.exr"), folder.join("out.json"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_etalon"));
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(["render", "reference/door-ajar/scene.json", "-o"]);
    command.arg(&picture).arg("--report").arg(&report);
    command.args(["--resolution", "16x12", "--seed", "7", "--integrator", integrator]);
    let output = command.args(options.split(' ')).output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let image = read_all_data_from_file(&picture).expect("an EXR");
    let layer = image.layer_data[0].attributes.clone();
    let Some(AttributeValue::Text(text)) = layer.other.get(&Text::from("etalon")) else {
        panic!("the facts are missing");
    };
    let facts = serde_json::from_str(&text.to_string()).expect("the facts are JSON");
    let report = serde_json::from_str(&std::fs::read_to_string(report).expect("a report")).expect("JSON");
    Written { image: image.attributes, layer, facts, report }
}

fn number(facts: &Value, pointer: &str) -> f64 {
    facts.pointer(pointer).and_then(Value::as_f64).unwrap_or(f64::NAN)
}

// Case 81.
pub fn a_picture_carries_all_that_it_was_made_with(record: &mut Record) {
    let Written { image, layer, mut facts, mut report } = render("path", "--spp 4");
    // The writing of pictures is in the peak of the report alone.
    let peaks = [&mut facts, &mut report].map(|told| number(&told["memory"].take(), "/peak_resident_bytes"));
    record.exactly("the peak of memory grows while pictures are written", peaks[0] > peaks[1], false);
    record.exactly("the report holds the facts of the EXR", report == facts, true);
    record.says("units", facts["units"].as_str().unwrap_or_default(), "X, Y, Z in cd/m2");
    record.exactly(
        "sensor",
        facts.pointer("/camera/sensor").and_then(Value::as_str).unwrap_or("none"),
        "cie-1931",
    );
    for (what, pointer, truth) in [
        ("ISO", "/camera/iso", 1600.0),
        ("t, s", "/camera/shutter_s", 30.0),
        ("N", "/camera/f_stop", 2.8),
        ("samples per pixel", "/samples_per_pixel", 4.0),
        ("seed", "/seed", 7.0),
        ("samples that were not finite", "/non_finite_samples", 0.0),
        ("share of the energy truncated", "/truncation/energy_truncated", 0.0),
        ("walks that this is known from", "/truncation/walks", 16.0 * 12.0 * 4.0),
    ] {
        record.exactly(what, number(&facts, pointer), truth);
    }
    let ev = (2.8_f64 * 2.8 / 30.0).log2() - 16_f64.log2();
    record.absolute("EV100", number(&facts, "/camera/ev100"), ev, 1e-12);
    record.exactly("integrator", facts["integrator"].as_str().unwrap_or("none"), "path");
    let plan = facts["plan"].to_string();
    record.says("plan", &plan, "pinhole: no lens sampling");
    let commit = facts["git_hash"].as_str().map(|hash| hash.trim_end_matches("-changed").to_owned());
    match head() {
        Some(head) => record.holds("the commit that is checked out", commit == Some(head)),
        // A published copy knows the commit that it was made from, any other copy none.
        None => record.holds("no commit, or a whole one", commit.is_none_or(|commit| commit.len() == 40)),
    }
    record.holds("wall-clock time above 0 s", number(&facts, "/seconds") > 0.0);
    record.holds("processor time above 0 s", number(&facts, "/cpu_seconds") > 0.0);
    let conditions = facts["conditions"].as_array().map_or(0, Vec::len);
    record.exactly("extreme conditions of the scene", conditions, 4);
    record.exactly("whiteLuminance, cd/m2 for 1", layer.white_luminance.unwrap_or(f32::NAN), 1.0);
    let of_xyz = [[1.0_f32, 0.0], [0.0, 1.0], [0.0, 0.0], [1.0 / 3.0, 1.0 / 3.0]];
    record.exactly("chromaticities", primaries(&image), format!("{of_xyz:?}"));
    record.exactly("expTime, s", layer.exposure.unwrap_or(f32::NAN), 30.0);
    record.exactly("aperture", layer.aperture.unwrap_or(f32::NAN), 2.8);
    record.exactly("isoSpeed", layer.iso_speed.unwrap_or(f32::NAN), 1600.0);
}

// Case 81.
pub fn a_picture_with_rgb_declares_the_primaries_of_srgb(record: &mut Record) {
    let Written { image, layer, .. } = render("path", "--spp 1 --linear-srgb");
    let of_srgb = [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3127, 0.329]];
    record.exactly(
        "chromaticities",
        primaries(&image),
        format!("{:?}", of_srgb.map(|xy| xy.map(|c| c as f32))),
    );
    record.exactly("whiteLuminance, cd/m2 for 1", layer.white_luminance.unwrap_or(f32::NAN), 1.0);
}

// Case 81.
pub fn a_picture_of_chains_carries_their_normalisation(record: &mut Record) {
    let Written { facts, .. } = render("mlt", "--spp 64");
    let b = number(&facts, "/metropolis/report/normalisation");
    let [low, high] =
        [0, 1].map(|end| number(&facts, &format!("/metropolis/report/normalisation_ci95/{end}")));
    record.note(format!("b = {b:.4e}, 95 % from {low:.4e} to {high:.4e}"));
    let [paths, found] =
        ["fresh_paths", "fresh_paths_found"].map(|key| number(&facts, &format!("/metropolis/report/{key}")));
    // Were all finds alike, their number would be binomial: fresh paths that differ in what they
    // find can but scatter more.
    let least = 1.96 * ((1.0 - found / paths) / found).sqrt();
    record.at_least(
        "half the width of the interval over b, of at least that of the finds",
        0.5 * (high - low) / b,
        least,
    );
    record.at_most("and of at most five times that", 0.5 * (high - low) / b, 5.0 * least);
    record.relative("b, middle of its interval, within half its width", b, 0.5 * (low + high), least);
    // One mutation in five is a fresh path, beside those of the search for the chains' starts.
    let mutations = number(&facts, "/metropolis/report/mutations");
    record.at_least("fresh paths over a fifth of all mutations", paths / (0.2 * mutations), 0.9);
}

/// The commit that is checked out; `None` outside the project's own repository.
fn head() -> Option<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let git = |arguments: [&str; 2]| {
        let output = Command::new("git").args(arguments).current_dir(root).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let top = std::fs::canonicalize(git(["rev-parse", "--show-toplevel"])?).ok()?;
    (top == std::fs::canonicalize(root).ok()?).then(|| git(["rev-parse", "HEAD"]))?
}

/// Red, green, blue and white of an image.
fn primaries(image: &ImageAttributes) -> String {
    image.chromaticities.map_or("none".to_owned(), |c| {
        format!("{:?}", [c.red, c.green, c.blue, c.white].map(|v| [v.x(), v.y()]))
    })
}
