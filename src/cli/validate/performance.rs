//! `etalon validate peers --performance`: the harness runs this program and every peer that is there
//! in turns, scene by scene, and writes what each needs for the same error.
//!
//! Which peers there are is the harness' business; here the scenes are found and the environments
//! that a peer may be started from are made.

use super::all::command_line;
use super::idle::refuse_idle;
use super::{Arguments, peers};
use crate::cli::print;
use etalon::error::{Error, Result};
use etalon::python::{Environment, PEERS, VALIDATION, project_root};
use etalon::scene::Leaving;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Folders in `reference/` that are compared where none are named: all diffuse, glass, light through a slit.
const SCENES: [&str; 3] = ["cornell", "schoedl-2007", "slit-room"];

/// Every folder in `reference/` with a scene that all peers can be given.
const KNOWN: [&str; 6] = ["cornell", "schoedl-2007", "slit-room", "cornell-photo", "yale-grey", "stanford"];

/// The peer whose environment this program makes; others are made by their drivers.
const MITSUBA: &str = "mitsuba";

/// What a reader opens.
const REPORT: &str = "performance.html";

pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    check(arguments)?;
    let root = project_root()?;
    let cases = cases(&arguments.scenes, &root)?;
    arguments.effort.start_threads()?;
    // One that cannot be made leaves Mitsuba out and nobody else.
    let is_wanted = arguments.peers.is_empty() || arguments.peers.iter().any(|name| name == MITSUBA);
    if is_wanted && let Err(error) = Environment::prepare(&PEERS) {
        eprintln!("note: {error}");
    }
    let output = folder(arguments);
    let mut words: Vec<OsString> = vec!["--cases".into()];
    words.extend(cases.into_iter().map(OsString::from));
    words.extend(["--folder".into(), output.clone().into()]);
    words.extend(["--program".into(), std::env::current_exe()?.into()]);
    words.extend(["--program-version".into(), env!("CARGO_PKG_VERSION").into()]);
    words.extend(["--target".into(), root.join("target").into()]);
    words.extend(["--spectra".into(), root.join("spectra").into()]);
    words.extend(["--threads".into(), rayon::current_num_threads().to_string().into()]);
    words.extend(["--said".into(), command_line().into()]);
    words.extend(optional("--budget", arguments.budget.map(|seconds| seconds.to_string())));
    words.extend(optional("--resolution", arguments.effort.resolution.map(|[x, y]| format!("{x}x{y}"))));
    words.extend(optional("--peers", (!arguments.peers.is_empty()).then(|| arguments.peers.join(","))));
    Environment::prepare(&VALIDATION)?.run_module("peers-performance", &words, None)?;
    print(&format!("report: {}", output.join(REPORT).display()));
    Ok(ExitCode::SUCCESS)
}

/// Refuses what a session of many series cannot take.
fn check(arguments: &Arguments) -> Result<()> {
    if arguments.case != peers::NAME {
        return Err(
            Error::new("--performance goes with peers").hint("give it as in: validate peers --performance")
        );
    }
    let effort = &arguments.effort;
    let is_open = effort.time.is_some() || effort.error.is_some() || effort.max_bounces.is_some();
    let is_told = effort.spp.is_some() || effort.integrator.is_some() || effort.groups.is_some();
    if is_open || is_told || effort.seed != 0 || effort.leaving != Leaving::all() {
        return Err(Error::new("a session against peers sets samples, seeds, algorithms and plans itself")
            .hint("give --budget, --scenes, --peers, --threads and --resolution alone"));
    }
    let taken = ["--performance", "--budget", "--scenes", "--peers", "--threads", "--resolution"];
    refuse_idle(arguments, "a session against peers", &taken)
}

/// The folders of scenes by their names.
fn cases(names: &[String], root: &Path) -> Result<Vec<PathBuf>> {
    let names = if names.is_empty() { SCENES.map(str::to_owned).to_vec() } else { names.to_vec() };
    let folder = |name: &String| {
        if KNOWN.contains(&name.as_str()) {
            Ok(root.join("reference").join(name))
        } else {
            Err(Error::unknown_name("scene", name, KNOWN))
        }
    };
    names.iter().map(folder).collect()
}

/// Where everything goes: apart from the folder of `validate peers`.
fn folder(arguments: &Arguments) -> PathBuf {
    arguments.output.clone().unwrap_or_else(|| PathBuf::from("out/validate-peers-performance"))
}

fn optional(option: &str, value: Option<String>) -> Vec<OsString> {
    value.map_or_else(Vec::new, |value| vec![option.into(), value.into()])
}
