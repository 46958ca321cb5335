//! `etalon validate growth`: how cost grows with pixels, triangles, lamps, depth, channels and
//! threads. The harness writes the scenes and runs this program on them.

use super::Arguments;
use super::idle::refuse_idle;
use crate::cli::print;
use etalon::integrator::Stopwatch;
use etalon::python::{Environment, VALIDATION};
use std::ffi::OsString;
use std::process::ExitCode;

/// Name of the case on the command line.
pub const NAME: &str = "growth";

pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    refuse_idle(arguments, "growth", &["--budget", "--threads", "--full"])?;
    let since = Stopwatch::start();
    let mut words: Vec<OsString> = vec!["--program".into(), std::env::current_exe()?.into()];
    words.extend(arguments.budget.iter().flat_map(|s| ["--budget".into(), s.to_string().into()]));
    words.extend(arguments.effort.threads.iter().flat_map(|n| ["--threads".into(), n.to_string().into()]));
    words.extend(arguments.full.then(|| "--full".into()));
    words.extend(["-o".into(), arguments.folder().into()]);
    Environment::prepare(&VALIDATION)?.run_module("growth", &words, None)?;
    print(&format!("measured in {:.0} s", since.cost().wall_s));
    Ok(ExitCode::SUCCESS)
}
