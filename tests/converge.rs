//! `etalon converge` from a scene to its tables and plots, and against an earlier program.

#![cfg(unix)]

use etalon::python::{Environment, VALIDATION};
use serde_json::Value;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");
const PROGRAM: &str = env!("CARGO_BIN_EXE_etalon");
const SCENE: &str = "reference/cornell/scene.json";
const FILES: [&str; 5] = ["runs.csv", "converge.csv", "converge.json", "converge.svg", "converge.png"];

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("the program writes UTF-8")
}

/// An empty folder.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("converge-{name}"));
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

fn converge(folder: &Path, words: &[&str]) -> Output {
    let mut command = Command::new(PROGRAM);
    command.current_dir(ROOT).arg("converge").args(words).arg("-o").arg(folder);
    command.output().expect("the program starts")
}

fn read_json(file: &Path) -> Value {
    let content = std::fs::read_to_string(file).expect("the file is there");
    serde_json::from_str(&content).expect("the file is JSON")
}

#[test]
fn a_study_says_error_against_time_for_each_algorithm() {
    let folder = folder("study");
    let words = [SCENE, "--integrators", "path,bdpt", "--resolution", "24x24", "--threads", "1"];
    let effort = ["--budget", "0.5", "--points", "3", "--repeats", "5"];
    let output = converge(&folder, &[&words[..], &effort[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    for file in FILES {
        assert!(folder.join(file).is_file(), "{file}");
    }
    let report = read_json(&folder.join("converge.json"));
    for key in ["version", "git_hash", "scene_hash", "date", "machine", "reference", "definitions"] {
        assert!(!report[key].is_null() || key == "git_hash", "{key}");
    }
    for name in ["path", "bdpt"] {
        let series = &report["series"][name];
        assert_eq!(series["points"].as_array().map(Vec::len), Some(3), "{name}");
        assert_eq!(series["runs"].as_array().map(Vec::len), Some(15), "{name}");
        assert!(series["fit"]["relmse"]["value"].as_f64().is_some_and(|slope| slope < 0.0), "{series}");
        assert!(series["ratio_to_best"]["value"].as_f64().is_some_and(|ratio| ratio > 0.0), "{name}");
    }
    let runs = std::fs::read_to_string(folder.join("runs.csv")).expect("the runs are there");
    assert_eq!(runs.lines().count(), 1 + 2 * 3 * 5);
    assert!(!folder.join("pictures").exists(), "pictures are kept for a study that is broken off");
    assert!(text(&output.stdout).contains("efficiency over the best"), "{}", text(&output.stdout));
}

/// What both comparisons ask for: a processor second in all, and so few threads that the
/// machine's other work matters little.
const PAIRS: [&str; 10] = [
    "--integrators",
    "path",
    "--resolution",
    "24x24",
    "--budget",
    "0.25",
    "--repeats",
    "8",
    "--threads",
    "1",
];

#[test]
fn a_program_is_as_efficient_as_itself() {
    // A fall by half is asked for: the same program would seem to have one only if the eight
    // pairs' seconds were apart by that much, one way.
    let words = [SCENE, "--baseline", PROGRAM, "--factor", "2"];
    let output = converge(&folder("itself"), &[&words[..], &PAIRS[..]].concat());
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{said}{}", text(&output.stderr));
    assert!(said.contains("the same bits"), "{said}");
}

#[test]
fn a_program_that_wastes_time_fails_in_one_line() {
    let folder = folder("slow");
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    let slow = folder.join("slow");
    // As much again as the run takes, and more: the render is made four times.
    let script = format!(
        "#!/bin/sh\nset -e\n{PROGRAM} \"$@\"\n{PROGRAM} \"$@\"\n{PROGRAM} \"$@\"\nexec {PROGRAM} \"$@\"\n"
    );
    std::fs::write(&slow, script).expect("the script can be written");
    std::fs::set_permissions(&slow, std::fs::Permissions::from_mode(0o755))
        .expect("it can be made a program");
    let environment = Environment::prepare(&VALIDATION).expect("the Python environment can be made");
    let mut python = environment.harness();
    python.current_dir(ROOT).args(["-m", "etalon_validation", "converge", SCENE, "--program"]).arg(&slow);
    python.args(["--baseline", PROGRAM, "--factor", "2"]).args(PAIRS).arg("-o").arg(&folder);
    let output = python.output().expect("Python starts");
    let (said, complaint) = (text(&output.stdout), text(&output.stderr));
    assert_eq!((output.status.code(), complaint.lines().count()), (Some(1), 1), "{said}{complaint}");
    assert!(complaint.starts_with("error: cornell, path: efficiency is 0."), "{complaint}");
    assert!(said.contains("FELL"), "{said}");
}

#[test]
fn wrong_arguments_are_one_line() {
    let folder = folder("wrong");
    for (words, problem) in [
        (&[][..], "no scene is named"),
        (&["no-such.json"][..], "no such file"),
        (&[SCENE, "--baseline", SCENE][..], "is a report and no program"),
        (&[SCENE, "--baseline", "/bin/sh", "--allow-difference"][..], "version"),
        (&[SCENE, SCENE, "--reference", "no-such.exr"][..], "is a picture of one scene"),
        (&[SCENE, "--reference", "no-such.exr"][..], "no such picture"),
    ] {
        let output = converge(&folder, words);
        let said = text(&output.stderr);
        assert_eq!((output.status.code(), said.lines().count()), (Some(2), 1), "{said}");
        assert!(said.contains(problem), "{said}");
    }
    for (words, problem) in [
        (&[SCENE, "--integrators", "path,bdtp"][..], "did you mean \"bdpt\""),
        (&[SCENE, "--repeats", "4"][..], "5..=1000"),
        (&[SCENE, "--factor", "1.1"][..], "--baseline"),
        (&[SCENE, "--allow-difference"][..], "--baseline"),
        (&[SCENE, "--budget", "0"][..], "above zero"),
    ] {
        let output = converge(&folder, words);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(problem), "{said}");
    }
}
