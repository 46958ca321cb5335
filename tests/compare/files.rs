//! The program on its own renders and on files with facts.

use crate::common::program::{Ran, etalon, folder, render};
use crate::common::scenes;
use crate::written::{Numbers, Written};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// The JSON of a comparison that ends well.
pub fn compared(a: &Path, b: &Path, options: &str) -> Value {
    let ran = compare(a, b, &format!("--json {options}"));
    assert_eq!(ran.code, 0, "{}", ran.err);
    serde_json::from_str(&ran.out).unwrap_or_else(|e| panic!("{e}\n{}", ran.out))
}

pub fn compare(a: &Path, b: &Path, options: &str) -> Ran {
    let files = ["compare".as_ref(), a.as_os_str(), b.as_os_str()];
    etalon(files.into_iter().chain(options.split_whitespace().map(AsRef::as_ref)))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn rendered(test: &str, name: &str, options: &str) -> PathBuf {
    let folder = folder(&format!("{test}-{name}"));
    let ran = render(&scenes::large_panel(), &folder, options);
    assert_eq!(ran.code, 0, "{}", ran.err);
    folder.join("out.exr")
}

#[test]
fn two_renders_of_one_scene() {
    let test = "compare-renders";
    let [a, b] = [1, 2].map(|seed| {
        rendered(
            test,
            &format!("{seed}"),
            &format!("--integrator path --spp 64 --seed {seed} --resolution 24x18"),
        )
    });
    let found = compared(&a, &b, "");
    for key in ["mse", "relmse", "relmse_trimmed", "smape", "mean_ratio"] {
        assert!(number(&found[key]) > 0.0, "{key}: {found:#}");
    }
    let [low, high] = [0, 1].map(|end| number(&found["mean_ratio_ci95"][end]));
    assert!(low < number(&found["mean_ratio"]) && number(&found["mean_ratio"]) < high, "{found:#}");
    assert!(number(&found["relmse_trimmed"]) <= number(&found["relmse"]));
    assert_eq!(found["pixels_rejected"], 0, "{found:#}");
    assert_eq!(found["verdict"], "undecided", "{found:#}");
    assert!(number(&found["samples_factor"]) >= 2.0);
    assert!(number(&found["seconds_to_settle"]["wall"]) > 0.0);
    // A wide margin is met, and a script is told so.
    assert_eq!(compared(&a, &b, "--margin 20% --require equal")["verdict"], "equal");
    let strict = compare(&a, &b, "--require equal");
    assert_eq!((strict.code, strict.err.lines().count()), (3, 1), "{}", strict.err);
    assert_eq!(compare(&a, &b, "--require not-different").code, 0);
    let text = compare(&a, &b, "");
    assert!(text.out.contains("undecided: the 95 % interval"), "{}", text.out);
    assert!(text.out.contains("cell px"), "{}", text.out);
    assert!(compare(&a, &a, "").out.contains("share random numbers"));
}

/// Paths from the camera are the same ones: noise of both is not what sets them apart.
#[test]
fn integrators_of_one_seed_are_not_independent() {
    let of = |integrator: &str, seed: u64| {
        let options = format!("--integrator {integrator} --spp 64 --seed {seed} --resolution 24x18");
        rendered("compare-one-seed", &format!("{integrator}-{seed}"), &options)
    };
    let [path, bdpt, other] = [of("path", 1), of("bdpt", 1), of("bdpt", 2)];
    let keys = ["mse_corrected", "relmse_corrected", "mse_corrected_ci95", "relmse_corrected_ci95"];
    let found = compared(&path, &bdpt, "");
    assert!(found["notes"].to_string().contains("share random numbers"), "{found:#}");
    assert!(keys.iter().all(|key| found[key].is_null()), "{found:#}");
    assert!(compare(&path, &bdpt, "").out.contains("share random numbers"));
    let found = compared(&path, &other, "");
    assert!(!found["notes"].to_string().contains("share random numbers"), "{found:#}");
    assert!(keys[..2].iter().all(|key| found[key].is_number()), "{found:#}");
}

#[test]
fn a_map_has_a_pixel_for_each_of_the_picture() {
    let a = rendered("compare-map", "a", "--integrator path --spp 64 --seed 1 --resolution 24x18");
    let b = rendered("compare-map", "b", "--integrator path --spp 64 --seed 2 --resolution 24x18");
    let map = a.with_file_name("map.png");
    assert_eq!(compare(&a, &b, &format!("--map {}", map.display())).code, 0);
    let picture = image::open(&map).expect("a picture");
    assert_eq!([picture.width(), picture.height()], [24, 18]);
    let wrong = compare(&a, &b, "--map map.jpg");
    assert_eq!(wrong.code, 2, "{}", wrong.err);
}

#[test]
fn one_block_of_samples_settles_nothing() {
    let a = rendered("compare-block", "a", "--integrator path --spp 1 --seed 1 --resolution 24x18");
    let b = rendered("compare-block", "b", "--integrator path --spp 64 --seed 2 --resolution 24x18");
    let found = compared(&a, &b, "");
    assert_eq!(found["verdict"], "undecided", "{found:#}");
    assert!(found["reason"].as_str().is_some_and(|reason| reason.contains("no noise figures")), "{found:#}");
    assert!(found["samples_factor"].is_null() && found["pixels_rejected"].is_null());
    assert!(number(&found["mse"]) > 0.0);
}

const SIDE: usize = 32;
const PIXELS: usize = SIDE * SIDE;
/// Of all pixels alike, relative: what a level that is drawn once for a picture adds.
const COMMON: f64 = 0.02;
/// Of single pixels, relative.
const OWN: f64 = 0.01;

/// A picture whose pixels share an error; with the errors of cells that follow from it, or none.
fn correlated(folder: &Path, name: &str, seed: u64, has_cells: bool, factor: f64) -> PathBuf {
    broken(folder, name, seed, has_cells, factor, 0)
}

/// The same with as many pixels that are not finite, from the first one on.
fn broken(folder: &Path, name: &str, seed: u64, has_cells: bool, factor: f64, pixels: usize) -> PathBuf {
    let mut numbers = Numbers(etalon::sampler::mix(seed));
    let common = 1.0 + COMMON * numbers.normal();
    let truth = |pixel: usize| 10.0 + (pixel % SIDE) as f64;
    let mut mean: Vec<f32> =
        (0..PIXELS).map(|p| (factor * truth(p) * (common + OWN * numbers.normal())) as f32).collect();
    mean[..pixels].fill(f32::NAN);
    let error = |pixel: usize| truth(pixel) * COMMON.hypot(OWN);
    let level = |cell_px: usize| {
        let side = SIDE / cell_px;
        let stderr: Vec<f64> = (0..side * side)
            .map(|cell| {
                let inside =
                    (0..cell_px).map(|x| truth(cell % side * cell_px + x)).sum::<f64>() / cell_px as f64;
                inside * COMMON.hypot(OWN / cell_px as f64)
            })
            .collect();
        json!({ "cell_px": cell_px, "columns": side, "rows": side, "stderr": stderr })
    };
    let levels = [2, 4, 8, 16, 32].map(level);
    let cells = json!({ "levels": levels });
    let facts = json!({
        "units": "X, Y, Z in cd/m2 (Y is luminance)", "integrator": "bdpt", "seed": seed, "scene_hash": "s",
        "samples_per_pixel": 512, "error": { "blocks": 32, "correlated": true },
        "luminance_cells": if has_cells { cells } else { Value::Null },
        "times": { "load": { "wall_s": 1.0, "cpu_s": 1.0 }, "pilot": null, "bootstrap": null,
                   "render": { "wall_s": 10.0, "cpu_s": 20.0 } },
    });
    let written = Written {
        channels: vec![("Y", mean), ("stderr.Y", (0..PIXELS).map(|p| error(p) as f32).collect())],
        facts: Some(facts.to_string()),
        ..Written::default()
    };
    written.write(folder, name, [SIDE, SIDE])
}

/// Taken for independent, pixels that share an error make pictures differ by hundreds of standard
/// errors; the errors of cells say that they do not. All 40 pairs together are called different
/// once in 25 times at the stated rate, and twice or more once in 1000 times.
#[test]
fn errors_of_cells_are_believed() {
    let folder = folder("compare-cells");
    let verdict = |pair: u64| {
        let a = correlated(&folder, "a.exr", 2 * pair, true, 1.0);
        let b = correlated(&folder, "b.exr", 2 * pair + 1, true, 1.0);
        let found = compared(&a, &b, "");
        let judged = found["levels"].as_array().expect("levels").iter().all(|level| level["judged"] != 0);
        assert!(judged, "{found:#}");
        found["verdict"].as_str().expect("a verdict").to_owned()
    };
    let different = (0..40).filter(|pair| verdict(*pair) == "different").count();
    assert!(different <= 1, "{different} of 40");
    let a = correlated(&folder, "a.exr", 100, true, 1.5);
    let b = correlated(&folder, "b.exr", 101, true, 1.0);
    assert_eq!(compared(&a, &b, "")["verdict"], "different");
}

/// Of 1024 pixels one may be missing for the stated errors to be believed, and 64 may not.
#[test]
fn few_pixels_left_out_do_not_hide_the_errors_of_cells() {
    let folder = folder("compare-left-out");
    let b = correlated(&folder, "b.exr", 1, true, 1.0);
    let whole = compared(&correlated(&folder, "a.exr", 2, true, 1.0), &b, "");
    let found = compared(&broken(&folder, "a.exr", 2, true, 1.0, 1), &b, "");
    assert_eq!(found["verdict"], "undecided", "{found:#}");
    assert!(found["reason"].as_str().is_some_and(|reason| reason.contains("95 % interval")), "{found:#}");
    for end in [0, 1] {
        let [one, all] = [&found, &whole].map(|it| number(&it["mean_ratio_ci95"][end]));
        assert!((one / all - 1.0).abs() < 1e-3, "{one}, with all pixels {all}");
    }
    let bright = correlated(&folder, "bright.exr", 3, true, 1.5);
    assert_eq!(compared(&broken(&folder, "a.exr", 2, true, 1.0, 1), &bright, "")["verdict"], "different");
    let found = compared(&broken(&folder, "a.exr", 2, true, 1.0, 64), &b, "");
    assert!(found["reason"].as_str().is_some_and(|reason| reason.contains("left out")), "{found:#}");
    assert!(found["mean_ratio_ci95"].is_null(), "{found:#}");
}

#[test]
fn time_to_settle_counts_what_does_not_grow() {
    let folder = folder("compare-times");
    let a = correlated(&folder, "a.exr", 1, true, 1.0);
    let b = correlated(&folder, "b.exr", 2, true, 1.0);
    let found = compared(&a, &b, "");
    let factor = number(&found["samples_factor"]);
    let seconds = &found["seconds_to_settle"];
    for (kind, truth) in [("wall", 2.0 + 20.0 * factor), ("cpu", 2.0 + 40.0 * factor)] {
        assert!((number(&seconds[kind]) / truth - 1.0).abs() < 1e-9, "{kind}: {found:#}");
    }
}

#[test]
fn dependent_pixels_without_errors_of_cells_are_judged_one_by_one() {
    let folder = folder("compare-no-cells");
    let a = correlated(&folder, "a.exr", 1, false, 1.0);
    let b = correlated(&folder, "b.exr", 2, false, 1.0);
    let found = compared(&a, &b, "");
    let judged: Vec<_> =
        found["levels"].as_array().expect("levels").iter().map(|l| l["judged"] != 0).collect();
    assert_eq!(judged, [true, false, false, false, false, false], "{found:#}");
    assert_eq!(found["verdict"], "undecided", "{found:#}");
    assert!(found["mean_ratio_ci95"].is_null());
    assert!(found["notes"].to_string().contains("only single pixels are judged"), "{found:#}");
}

#[test]
fn cells_that_do_not_fit_are_refused() {
    let folder = folder("compare-wrong-cells");
    let file = |stderr: Value, columns: usize| {
        let levels = json!([{ "cell_px": 2, "columns": columns, "rows": 1, "stderr": stderr }]);
        let facts = json!({
            "units": "X, Y, Z in cd/m2", "integrator": "bdpt", "error": { "blocks": 8 },
            "luminance_cells": { "levels": levels },
        });
        let channels = vec![("Y", vec![1.0; 8]), ("stderr.Y", vec![0.1; 8])];
        Written { channels, facts: Some(facts.to_string()), ..Written::default() }.write(
            &folder,
            "a.exr",
            [4, 2],
        )
    };
    for (stderr, columns) in [(json!([0.1]), 2), (json!([0.1, 0.1, 0.1]), 3)] {
        let file = file(stderr, columns);
        let ran = compare(&file, &file, "");
        assert_eq!((ran.code, ran.err.lines().count()), (2, 1), "{}", ran.err);
        assert!(
            ran.err.contains("a.exr: its luminance_cells of 2 px do not fit 4 x 2 pixels"),
            "{}",
            ran.err
        );
    }
    let sound = file(json!([0.1, null]), 2);
    assert_eq!(compare(&sound, &sound, "").code, 0, "a cell of which nothing is known");
}
