//! The pages that `etalon validate all` writes, in a headless Chromium: sliders, tabs, a phone's
//! width, print, no errors and no requests. One run of all cases serves every test.
//!
//! Without a Chromium the pages are still written and looked at as text; `ETALON_REQUIRE_BROWSER`
//! makes its absence a failure.

use etalon::python::{BROWSER, Environment, VALIDATION};
use serde_json::Value;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// What a Chromium is called; `ETALON_CHROMIUM` names one that is called otherwise.
const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// The case whose folder cannot be made, for a file of its name is in the way.
const FAILING: &str = "yale-brown";

/// Cases of `validate all`, and how each ends where no band images are given.
const CASES: [(&str, &str); 9] = [
    ("cornell", "done"),
    ("yale-grey", "done"),
    (FAILING, "failed"),
    ("stanford", "done"),
    ("stanford-left", "done"),
    ("yale-cross", "done"),
    ("stanford-cross", "done"),
    ("schoedl", "done"),
    ("cornell-ccd", "skipped"),
];

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("the program writes UTF-8")
}

fn etalon<S: AsRef<std::ffi::OsStr>>(words: &[S]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_etalon"));
    command.current_dir(ROOT).args(words).output().expect("the program starts")
}

fn place(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// A folder with a synthetic photograph called as the case that it is of: a render whose exposure
/// and channel gains are changed, without a name that any table knows.
fn photographs() -> PathBuf {
    let folder = place("browser-photographs");
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    let exr = place("browser-photograph.exr");
    let render = [
        "render".as_ref(),
        "reference/cornell-photo/scene.json".as_ref(),
        "--spp".as_ref(),
        "16".as_ref(),
        "--seed".as_ref(),
        "5".as_ref(),
        "-o".as_ref(),
        exr.as_os_str(),
    ];
    let rendered = etalon(&render);
    assert!(rendered.status.success(), "{}", text(&rendered.stderr));
    make("browser_tests.synthetic", &[&exr, &folder.join("cornell.exr")]);
    folder
}

/// Lets a module of the harness make files.
fn make(module: &str, files: &[&Path]) {
    let mut python = Environment::prepare(&VALIDATION).expect("the Python environment can be made").harness();
    let made = python.args(["-m", module]).args(files).output().expect("Python starts");
    assert!(made.status.success(), "{}", text(&made.stderr));
}

/// The folder of one `validate all`, and what it printed; beside its reports stands one of seven
/// synthetic bands.
fn pages() -> &'static (PathBuf, String) {
    static PAGES: OnceLock<(PathBuf, String)> = OnceLock::new();
    PAGES.get_or_init(|| {
        let folder = place("browser-pages");
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).expect("the folder can be made");
        std::fs::write(folder.join(FAILING), "in the way").expect("the file can be written");
        let photos = photographs();
        let words = ["validate", "all", "--spp", "4", "--photos"].map(std::ffi::OsStr::new);
        let more = [photos.as_os_str(), "-o".as_ref(), folder.as_os_str()];
        let output = etalon(&[&words[..], &more[..]].concat());
        assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
        make("browser_tests.synthetic_bands", &[&folder.join("synthetic-bands")]);
        (folder, text(&output.stdout).to_owned())
    })
}

fn read_json(file: &Path) -> Value {
    let content = std::fs::read_to_string(file).expect("the file is there");
    serde_json::from_str(&content).expect("the file is JSON")
}

/// Chromium's path; `None` is a skipped test, and says so.
fn chromium() -> Option<PathBuf> {
    let named = std::env::var_os("ETALON_CHROMIUM").map(PathBuf::from);
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let found = named.filter(|path| path.is_file()).or_else(|| {
        let places = std::env::split_paths(&folders);
        places.flat_map(|folder| BROWSERS.map(|name| folder.join(name))).find(|path| path.is_file())
    });
    let is_required = std::env::var_os("ETALON_REQUIRE_BROWSER").is_some();
    assert!(found.is_some() || !is_required, "no Chromium is installed, and ETALON_REQUIRE_BROWSER is set");
    if found.is_none() {
        // Past the test harness, which keeps what a passing test prints.
        let reason =
            "SKIPPED: no Chromium on the path and none named by ETALON_CHROMIUM; pages were not opened";
        writeln!(std::io::stderr(), "{reason}").expect("standard error takes text");
    }
    found
}

#[test]
fn pages_work_in_a_browser() {
    let Some(chromium) = chromium() else { return };
    let (folder, _) = pages();
    let environment = Environment::prepare(&BROWSER).expect("the Python environment can be made");
    let mut python = environment.harness();
    python.current_dir(ROOT).stdin(Stdio::null());
    python.env("ETALON_PAGES", folder).env("ETALON_CHROMIUM", chromium);
    python.args(["-m", "unittest", "discover", "-s", "validation/browser_tests", "-t", "validation"]);
    let output = python.output().expect("Python starts");
    assert!(output.status.success(), "{}", text(&output.stderr));
}

#[test]
fn every_case_has_a_row_with_its_figures() {
    let (folder, printed) = pages();
    assert!(printed.contains("index.html"), "{printed}");
    let index = read_json(&folder.join("index.json"));
    let rows = index["cases"].as_array().expect("a list of cases");
    let found: Vec<(&str, &str)> =
        rows.iter().filter_map(|row| Some((row["case"].as_str()?, row["status"].as_str()?))).collect();
    assert_eq!(found, CASES);
    let command = index["command"].as_str().expect("the command");
    assert!(command.starts_with("etalon validate all --spp 4"), "{command}");
    let processor: f64 = rows.iter().filter_map(|row| row["cpu_seconds"].as_f64()).sum();
    assert!((processor - index["cpu_seconds"].as_f64().expect("a number")).abs() < 1e-9);
    for row in rows.iter().filter(|row| row["status"] == "done") {
        assert_eq!(row["samples_per_pixel"], 4, "{}", row["case"]);
        let report = row["report"].as_str().expect("a link");
        assert!(!report.starts_with('/') && folder.join(report).is_file(), "{report}");
    }
}

#[test]
fn a_photograph_is_found_by_its_name_and_told_from_the_published_one() {
    let (folder, _) = pages();
    let report = read_json(&folder.join("cornell/report.json"));
    assert_eq!(report["reference"]["kind"], "photograph");
    assert_eq!(report["reference"]["regions_measured_again"], true);
    assert_eq!(read_json(&folder.join("yale-grey/report.json"))["reference"]["kind"], "region_table");
}

#[test]
fn the_picture_of_a_case_without_photograph_is_judged_by_its_exposure() {
    let (folder, _) = pages();
    let report = read_json(&folder.join("schoedl/report.json"));
    assert_eq!(report["integrator"], "bdpt");
    let conditions = report["exposure"]["conditions"].as_array().expect("a list of conditions");
    let all_hold = conditions.iter().all(|condition| condition["holds"] == true);
    assert_eq!(report["exposure"]["well_exposed"], all_hold);
    assert_eq!(conditions.len(), 3);
}

#[test]
fn a_case_that_fails_is_a_row_and_the_others_are_scored() {
    let (folder, _) = pages();
    let index = read_json(&folder.join("index.json"));
    let rows = index["cases"].as_array().expect("a list");
    let failed = rows.iter().find(|row| row["case"] == FAILING).expect("its row");
    assert!(
        failed["reason"].as_str().is_some_and(|reason| reason.contains("cannot make the folder")),
        "{failed}"
    );
    assert_eq!(index["counts"], serde_json::json!({ "done": 7, "failed": 1, "skipped": 1 }));
    let page = std::fs::read_to_string(folder.join("index.html")).expect("the index is there");
    assert!(page.contains("1 failed"), "the page says so");
}

#[test]
fn wrong_words_are_one_line() {
    for (words, saying) in [
        (&["all", "--photo", "cornell=no-such.png"][..], "no-such.png"),
        (&["all", "--photo", "Cargo.toml"], "CASE=FILE"),
        (&["all", "--photo", "schoedl=Cargo.toml"], "schoedl"),
        (&["all", "--photos", "no-such-folder"], "no-such-folder"),
        (&["all", "--photos", "spectra"], "photograph of no case"),
        (&["all", "--resolution", "8x8"], "--resolution"),
        (&["cornell", "--photos", "spectra"], "--photos"),
        (&["cornell", "--photo", "stanford=Cargo.toml"], "stanford"),
        (&["schoedl", "--photo", "Cargo.toml"], "schoedl"),
        (&["cornell", "--bands", "spectra"], "--bands"),
        (&["cornell-ccd"], "box_exr.zip"),
        (&["cornell-ccd", "--bands", "no-such.zip"], "no-such.zip"),
    ] {
        let output = etalon(&[&["validate"], words].concat());
        let said = text(&output.stderr);
        assert_eq!((output.status.code(), said.lines().count()), (Some(2), 1), "{words:?}: {said}");
        assert!(said.contains(saying), "{words:?}: {said}");
    }
}
