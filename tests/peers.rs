//! Other renderers beside the integrators: `etalon converge --peer` from tables to plot, and what
//! is refused. Mitsuba itself is not needed: this program stands in for the other renderer.

use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");
const SCENE: &str = "reference/cornell/scene.json";

fn etalon(words: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_etalon"));
    command.current_dir(ROOT).args(words).stdin(Stdio::null()).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("the program writes UTF-8")
}

/// An empty folder for a test.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("peers-{test}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    folder
}

fn render(file: &Path, spp: &str, seed: &str) {
    let place = file.to_str().expect("UTF-8");
    let output = etalon(&[
        "render",
        SCENE,
        "-o",
        place,
        "--spp",
        spp,
        "--seed",
        seed,
        "--resolution",
        "16x16",
        "--integrator",
        "path",
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
}

/// A table of two points of three repeats, and a reference of its own.
fn peer(folder: &Path) -> PathBuf {
    let mut table = "cpu_seconds,file,spp\n".to_owned();
    for (point, spp) in ["4", "8"].iter().enumerate() {
        for repeat in 0..3 {
            let (seed, name) = (100 + 3 * point + repeat, format!("{spp}-{repeat}.exr"));
            render(&folder.join(&name), spp, &seed.to_string());
            writeln!(table, "0.{}{repeat},{name},{spp}", point + 1).expect("text grows");
        }
    }
    render(&folder.join("own.exr"), "256", "99");
    table.push_str("reference,own.exr,\n");
    let file = folder.join("peer.csv");
    std::fs::write(&file, table).expect("the table can be written");
    file
}

#[test]
fn a_peer_is_judged_and_drawn_beside_the_integrators() {
    let folder = folder("beside");
    let option = format!("other={}", peer(&folder).display());
    let study = folder.join("study");
    let place = study.to_str().expect("UTF-8");
    let output = etalon(&[
        "converge",
        SCENE,
        "--integrators",
        "path",
        "--points",
        "2",
        "--repeats",
        "5",
        "--budget",
        "0.1",
        "--resolution",
        "16x16",
        "--peer",
        &option,
        "-o",
        place,
    ]);
    let printed = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{printed}{}", text(&output.stderr));
    assert!(printed.contains("judged against its own reference own.exr"), "{printed}");
    let report = std::fs::read_to_string(study.join("converge.json")).expect("the report is there");
    let report: Value = serde_json::from_str(&report).expect("the report is JSON");
    let told = &report["peers"]["other"];
    assert_eq!((&told["runs"], &told["is_fitted"]), (&Value::from(6), &Value::from(false)), "{told}");
    let ratio = told["against_common_reference"]["mean_ratio"]["value"].as_f64().expect("a ratio");
    // The same estimator, of 3 x 8 samples in each of 256 pixels.
    assert!((ratio - 1.0).abs() < 0.5, "{ratio}");
    assert_eq!(report["series"]["other"]["points"].as_array().map(Vec::len), Some(2));
    let csv = std::fs::read_to_string(study.join("converge.csv")).expect("the table is there");
    assert_eq!(csv.lines().filter(|line| line.starts_with("other,")).count(), 2, "{csv}");
    let plot = std::fs::read_to_string(study.join("converge.svg")).expect("the plot is there");
    assert!(plot.starts_with("<?xml") && plot.contains("<svg"));
}

#[test]
fn faults_of_a_peer_end_with_one_line_before_anything_is_run() {
    let folder = folder("faults");
    let table = folder.join("peer.csv");
    std::fs::write(&table, "cpu_seconds,file\n1.5,none.exr\n").expect("the table can be written");
    let (table, study) = (table.to_str().expect("UTF-8"), folder.join("study"));
    let study = study.to_str().expect("UTF-8");
    let missing = format!("{table}:2:5: there is no file");
    for (options, saying) in [
        (vec!["--peer", &*format!("other={table}")], &*missing),
        (vec!["--peer", "other=nowhere.csv"], "nowhere.csv: no such file"),
        (vec!["--peer", "peer.csv"], "is not NAME=FILE.csv"),
        (vec!["--peer-scale", "other=1"], "--peer"),
    ] {
        let output = etalon(&[&["converge", SCENE, "-o", study][..], &options].concat());
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(saying), "{said}\nsays nothing of\n{saying}");
        assert!(!Path::new(study).join("runs.csv").exists());
    }
}

#[test]
fn a_budget_belongs_to_the_peers() {
    for (words, saying) in [
        (["validate", "cornell", "--budget", "10"], "--budget goes with peers"),
        (["validate", "peers", "--budget", "0"], "give a positive number of seconds"),
    ] {
        let output = etalon(&words);
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains(saying), "{}", text(&output.stderr));
    }
}

#[test]
fn faults_of_a_session_against_peers_end_with_one_line_before_anything_is_run() {
    for (words, saying) in [
        (&["validate", "cornell", "--performance"][..], "--performance goes with peers"),
        (
            &["validate", "peers", "--performance", "--spp", "8"],
            "sets samples, seeds, algorithms and plans itself",
        ),
        (&["validate", "peers", "--performance", "--integrator", "path"], "sets samples, seeds"),
        (&["validate", "peers", "--performance", "--scenes", "cornel"], "did you mean \"cornell\"?"),
        (&["validate", "peers", "--performance", "--budget", "0"], "give a positive number of seconds"),
        (&["validate", "peers", "--scenes", "cornell"], "--performance"),
        (
            &["validate", "peers", "--performance", "--peers", "nobody"],
            "--peers: knows no nobody; name some of mitsuba",
        ),
    ] {
        let output = etalon(words);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(saying), "{said}\nsays nothing of\n{saying}");
    }
}
