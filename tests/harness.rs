//! The Python harness, and `etalon validate` from a scene to its report.

use etalon::python::{Environment, VALIDATION};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// Keys of every report.
const KEYS: [&str; 10] = [
    "scene",
    "reference",
    "levels",
    "samples_per_pixel",
    "seconds",
    "version",
    "calibration",
    "calibration_error",
    "findings",
    "picture",
];

/// Figures of every region at every level.
const FIGURES: [&str; 5] = ["duv", "luminance_ratio", "delta_e_2000", "delta_e_itp", "pixels"];

/// The ladder of fits.
const LEVELS: [&str; 5] = ["L0", "L1", "L2", "L3", "L4"];

fn environment() -> Environment {
    Environment::prepare(&VALIDATION).expect("the Python environment can be made")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("the program writes UTF-8")
}

fn etalon(words: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_etalon"));
    command.current_dir(ROOT).args(words).output().expect("the program starts")
}

/// The folder of a `validate cornell` with a seed, and what it printed.
fn validate(test: &str, seed: &str) -> (PathBuf, String) {
    environment();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("harness-{test}-{seed}"));
    let _ = std::fs::remove_dir_all(&folder);
    let place = folder.to_str().expect("the folder's name is UTF-8");
    let output = etalon(&["validate", "cornell", "--spp", "2", "--seed", seed, "-o", place]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    (folder, text(&output.stdout).to_owned())
}

/// A JSON file; `serde_json` takes no NaN and no infinity.
fn read_json(file: &Path) -> Value {
    let content = std::fs::read_to_string(file).expect("the file is there");
    serde_json::from_str(&content).expect("the file is JSON")
}

fn regions<'a>(report: &'a Value, level: &str) -> &'a Vec<Value> {
    report["levels"][level]["regions"].as_array().expect("a level lists its regions")
}

#[test]
fn the_unit_tests_of_the_harness_pass() {
    let mut python = environment().harness();
    python.current_dir(ROOT).stdin(Stdio::null());
    python.args(["-m", "unittest", "discover", "-s", "validation/tests", "-t", "validation"]);
    let output = python.output().expect("Python starts");
    assert!(output.status.success(), "{}", text(&output.stderr));
}

#[test]
fn a_validation_reports_finite_figures_for_every_level() {
    let (folder, printed) = validate("figures", "0");
    for level in LEVELS {
        assert_eq!(printed.lines().filter(|line| line.starts_with(level)).count(), 1, "{printed}");
    }
    let report = read_json(&folder.join("report.json"));
    for key in KEYS {
        assert!(!report[key].is_null(), "{key}");
    }
    assert_eq!(report["samples_per_pixel"], 2);
    assert!(report["calibration_error"]["exposure_stops"].is_number());
    assert_eq!(report["picture"]["available"], false, "the photograph is not at hand");
    let table = read_json(&Path::new(ROOT).join("reference/cornell-photo/regions.json"));
    assert_eq!(report["reference"]["kind"], "region_table");
    assert_eq!(report["reference"]["sha256"], table["photo"]["sha256"]);
    let measured = table["regions"].as_array().expect("the table lists regions").len();
    for level in LEVELS {
        let scored = regions(&report, level);
        let undefined = report["levels"][level]["undefined"].as_array().expect("a list").len();
        assert_eq!(scored.len() + undefined, measured, "{level}");
        assert!(undefined < 3, "{level}: {undefined} regions without figures");
        for region in scored {
            for figure in FIGURES {
                assert!(
                    region[figure].is_number(),
                    "{level} {} {figure}: {}",
                    region["name"],
                    region[figure]
                );
            }
        }
        assert!(report["levels"][level]["fitted"].is_object(), "{level}");
        assert!(report["levels"][level]["verdict"]["verdict"].is_string(), "{level}");
        let budget = report["levels"][level]["budget"].as_array().expect("a level has a budget");
        let names: Vec<_> = budget.iter().filter_map(|row| row["component"].as_str()).collect();
        for component in ["render noise", "photograph noise", "registration", "lamp level", "all together"] {
            assert!(names.contains(&component), "{level}: {component} is not among {names:?}");
        }
        for figure in ["mean_duv", "rms_stops", "mean_delta_e_2000", "nrmse"] {
            assert!(report["levels"][level]["overall"][figure].is_number(), "{level} {figure}");
        }
    }
}

#[test]
fn another_render_has_other_figures() {
    let [first, again, other] = [("other", "0"), ("again", "0"), ("other", "1")]
        .map(|(test, seed)| read_json(&validate(test, seed).0.join("report.json")));
    assert_eq!(regions(&first, "L1"), regions(&again, "L1"), "the same seed gives the same figures");
    let changed =
        regions(&first, "L1").iter().zip(regions(&other, "L1")).filter(|(a, b)| a["duv"] != b["duv"]).count();
    assert!(changed > 40, "{changed} regions changed");
}

#[test]
fn the_page_stands_alone() {
    let (folder, _) = validate("page", "0");
    let page = std::fs::read_to_string(folder.join("report.html")).expect("the page is there");
    for request in ["src=\"http", "href=\"http", "http://", "https://", "@import", "url("] {
        assert!(!page.contains(request), "the page asks for {request}");
    }
    assert!(page.contains("data:image/png;base64,"), "the page shows the render");
}

#[test]
fn a_missing_photograph_is_one_line() {
    let output = etalon(&["validate", "cornell", "--photo", "no-such.png"]);
    let said = text(&output.stderr);
    assert_eq!((output.status.code(), said.lines().count()), (Some(2), 1), "{said}");
    assert!(said.contains("no-such.png"), "{said}");
}

#[test]
fn spectra_are_drawn_and_other_kinds_of_file_refused() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("harness-plot");
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    let place = |name: &str| folder.join(name).to_str().expect("UTF-8").to_owned();
    for name in ["d65", "n-bk7", "gold"] {
        let file = place(&format!("{name}.svg"));
        let output = etalon(&["spectra", name, "--plot", &file]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        assert!(std::fs::read_to_string(&file).expect("the drawing is there").contains("</svg>"));
    }
    for name in ["d65.jpg", "nowhere/d65.svg"] {
        let output = etalon(&["spectra", "d65", "--plot", &place(name)]);
        let said = text(&output.stderr);
        assert_eq!((output.status.code(), said.lines().count()), (Some(2), 1), "{said}");
    }
}
