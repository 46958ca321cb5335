//! Numbers that a format cannot hold, and files that are wrong.

use crate::case::Case;
use crate::cases;
use crate::record::Record;
use exr::prelude::{FlatSamples, ReadChannels, ReadLayers};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Instant;

pub const CASES: &[Case] = cases![
    statistical 78 => luminances_beyond_the_range_of_half_precision_survive_the_file,
    fixed 80 => a_mistake_in_a_file_is_named_with_its_line_within_a_second,
    fixed 80 => every_fixture_of_a_mistake_is_refused_in_one_line,
    fixed 80 => normals_that_are_not_of_unit_length_count_by_their_direction,
];

/// Largest number of half precision.
const LARGEST_HALF: f64 = 65504.0;

// Case 78.
fn luminances_beyond_the_range_of_half_precision_survive_the_file(record: &mut Record) {
    // 27 W at 62.963 lm/W from a sphere: flux over pi times its surface.
    let flux_lm = 27.0 * 62.963;
    let lamp = flux_lm / (std::f64::consts::PI * 4.0 * std::f64::consts::PI * 0.025_f64.powi(2));
    let bulb = json!({"electrical_power": {"power_w": 27, "efficacy_lm_per_w": 62.963}});
    let [bulb, error] = luminance_in_file(record, "bulb", "d65".into(), bulb);
    record.mean("lamp of 27 W, radius 2.5 cm, in the file, cd/m2", bulb, error, lamp, 1e-3);
    record.at_least("that over the largest number of half precision", bulb / LARGEST_HALF, 1.0);
    let million = json!({"luminance_cd_m2": 1e6});
    let [mean, error] = luminance_in_file(record, "million", "d65".into(), million);
    record.mean("a lamp of 1e6 cd/m2 in the file, cd/m2", mean, error, 1e6, 1e-3);
    let body = json!({"blackbody": {"temperature_k": 6500}});
    let factor = json!({"spectral_radiance_factor": 1.0});
    let [mean, error] = luminance_in_file(record, "body", body, factor);
    // Half of the last of the catalogue's three digits, and the picture's noise.
    record.absolute("black body of 6500 K in the file, cd/m2", mean, 3.07e9, 0.005e9 + 5.0 * error);
    record.note(
        "Files have 32-bit floats throughout; there is no option for half precision, so that nothing need be scaled or refused.",
    );
}

/// Mean luminance, and its standard error, of a picture that a spherical lamp of 2.5 cm radius
/// fills, as the file that the program wrote has it.
fn luminance_in_file(record: &mut Record, name: &str, spectrum: Value, level: Value) -> [f64; 2] {
    let folder = folder("half");
    let (scene, file) = (folder.join(format!("{name}.json")), folder.join(format!("{name}.exr")));
    let described = json!({
        "name": name, "length_unit": "m",
        "materials": {"black": {"lambertian": {"reflectance": 0}}},
        "objects": [{
            "shape": {"sphere": {"center": [0, 0, 0], "radius": 0.025}}, "material": "black",
            "emission": {"spectrum": spectrum, "level": level},
        }],
        "camera": {
            "position": [0, 0, -0.1], "look_at": [0, 0, 0], "up": [0, 1, 0], "focal_length_mm": 200,
            "sensor_mm": [24, 24], "resolution": [8, 8], "f_stop": 8, "shutter_s": 0.01, "iso": 100,
        },
    });
    std::fs::write(&scene, described.to_string()).expect("the folder can be written to");
    let samples = record.samples(1024).to_string();
    let seed = record.seed().to_string();
    let output = etalon(&[
        "render".as_ref(),
        scene.as_os_str(),
        "-o".as_ref(),
        file.as_os_str(),
        "--spp".as_ref(),
        samples.as_ref(),
        "--seed".as_ref(),
        seed.as_ref(),
    ]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
    let image = reader.first_valid_layer().all_attributes().from_file(&file).expect("the program wrote it");
    let channels = image.layer_data.channel_data.list;
    let is_single = channels.iter().all(|channel| matches!(channel.sample_data, FlatSamples::F32(_)));
    record.holds(format!("{name}: every channel has 32-bit floats"), is_single);
    let values = |wanted: &str| -> Vec<f64> {
        let channel = channels.iter().find(|channel| channel.name == *wanted).expect("every file has it");
        channel.sample_data.values_as_f32().map(f64::from).collect()
    };
    let (luminances, errors) = (values("Y"), values("stderr.Y"));
    let pixels = luminances.len() as f64;
    [luminances.iter().sum::<f64>() / pixels, errors.iter().map(|e| e * e).sum::<f64>().sqrt() / pixels]
}

/// The kinds of mistake that the catalogue names: fixture, place, and what is said.
const MISTAKES: [(&str, &str, &str, &str); 13] = [
    ("NaN in a scene", "number-nan", "number-nan.json:13:59", "write a finite number"),
    ("infinity in a scene", "number-infinite", "number-infinite.json:13:60", "write a finite number"),
    ("NaN in a table", "csv-nan", "nan.csv:4:5", "not a finite number"),
    ("infinity in a table", "csv-infinite", "infinite.csv:3:5", "not a finite number"),
    ("NaN in a mesh", "ply-not-a-number", "not-a-number.ply:11:3", "not a finite number"),
    ("a length of 1e39", "radius-1e39", "radius-1e39.json:13:49", "too large"),
    ("a reflectance of 1e39", "reflectance-1e39", "reflectance-1e39.json:8:30", "above 1"),
    ("a negative reflectance", "reflectance-negative", "reflectance-negative.json:8:30", "is negative"),
    ("a reflectance above 1", "reflectance-above-1", "reflectance-above-1.json:8:30", "is above 1"),
    ("a normal without length", "ply-normal-0", "normal-0.ply:14:7", "points nowhere"),
    ("an empty mesh", "ply-empty", "empty.ply:7:1", "holds no face"),
    ("spectra in a circle", "spectra-in-a-circle", "spectra-in-a-circle.json:7:22", "in a circle"),
    ("a missing file", "mesh-missing", "mesh-missing.json:13:25", "No such file"),
];

// Case 80.
fn a_mistake_in_a_file_is_named_with_its_line_within_a_second(record: &mut Record) {
    for (what, fixture, place, said) in MISTAKES {
        let (seconds, output) = check(&files().join(format!("{fixture}.json")));
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        record.exactly(format!("{what}: exit code"), output.status.code().unwrap_or(-1), 2);
        record.says(format!("{what}: file, line and column"), &message, &format!("/{place} "));
        record.says(format!("{what}: what is wrong or to be done"), &message, said);
        record.at_most(format!("{what}: seconds"), seconds, 1.0);
    }
}

// Case 80.
fn every_fixture_of_a_mistake_is_refused_in_one_line(record: &mut Record) {
    let entries = std::fs::read_dir(files()).expect("the fixtures are there");
    let scenes = entries.map(|entry| entry.expect("readable").path());
    let mut scenes: Vec<PathBuf> =
        scenes.filter(|file| file.extension().is_some_and(|e| e == "json")).collect();
    scenes.retain(|file| !file.ends_with("sound.json"));
    let mut slowest = 0.0_f64;
    let refused = scenes.iter().filter(|scene| {
        let (seconds, output) = check(scene);
        slowest = slowest.max(seconds);
        let message = String::from_utf8_lossy(&output.stderr);
        let is_one_line = message.strip_suffix('\n').is_some_and(|line| !line.contains('\n'));
        let has_remedy = message.contains("; ");
        output.status.code() == Some(2)
            && output.stdout.is_empty()
            && is_one_line
            && has_remedy
            && has_place(&message)
    });
    let refused = refused.count();
    record.exactly("refused with file, line, column and remedy, of all fixtures", refused, scenes.len());
    record.at_least("fixtures", scenes.len() as f64, 100.0);
    record.at_most("seconds for the slowest", slowest, 1.0);
}

/// Whether a message begins `error: file:line:column `.
fn has_place(message: &str) -> bool {
    let place = message.strip_prefix("error: ").and_then(|rest| rest.split(' ').next()).unwrap_or_default();
    let numbers: Vec<&str> = place.trim_end_matches(':').rsplit(':').take(2).collect();
    numbers.len() == 2 && numbers.iter().all(|number| number.parse::<u32>().is_ok_and(|n| n > 0))
}

// Case 80.
fn normals_that_are_not_of_unit_length_count_by_their_direction(record: &mut Record) {
    let mesh = |length: f64| {
        let normals = [[0.0, length, 0.0], [0.0, 0.0, length], [length, 0.0, 0.0]];
        json!({"mesh": {
            "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "normals": normals, "triangles": [[0, 1, 2]],
        }})
    };
    let scene = |length: f64| {
        crate::common::metered(
            json!({"white": {"lambertian": {"reflectance": 0.5}}}),
            json!([{"shape": mesh(length), "material": "white"}]),
            json!([]),
            json!([]),
        )
    };
    let normals = |length: f64| {
        let geometry = scene(length).geometry;
        let ray = etalon::geometry::Ray::new(glam::Vec3A::new(0.25, 0.25, 1.0), glam::Vec3A::NEG_Z);
        geometry.intersect(&ray).expect("the triangle is there").shading.normal
    };
    for length in [1e-300, 1e-3, 2.0, 1e300] {
        let deviation = normals(length).distance(normals(1.0));
        record.absolute(
            format!(
                "normals of length {length:e}: distance of the unit shading normal from that of unit normals"
            ),
            deviation.into(),
            0.0,
            1e-6,
        );
        let notes = scene(length).notes.join("\n");
        record.says(
            format!("length {length:e}: note"),
            &notes,
            "3 of 3 normals of object 0 are not of unit length",
        );
    }
    record.exactly("notes on normals of unit length", scene(1.0).notes.len(), 0);
    record.note("Normals of any length are directions, and a note says how many were not of unit length; one of zero length is refused.");
}

fn check(scene: &Path) -> (f64, Output) {
    let started = Instant::now();
    let output = etalon(&["check".as_ref(), scene.as_os_str()]);
    (started.elapsed().as_secs_f64(), output)
}

fn etalon(arguments: &[&std::ffi::OsStr]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_etalon")).args(arguments).output().expect("the program starts")
}

fn files() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files")
}

/// A folder for what a case writes.
fn folder(case: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("extremes-{case}"));
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    folder
}
