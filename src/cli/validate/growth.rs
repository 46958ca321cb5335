//! `etalon validate growth`: how cost grows with pixels, triangles, lamps, depth, channels and
//! threads. The harness writes the scenes and runs this program on them.

use super::Arguments;
use crate::cli::print;
use etalon::error::{Error, Result};
use etalon::integrator::Stopwatch;
use etalon::python::{Environment, VALIDATION};
use etalon::scene::Leaving;
use std::ffi::OsString;
use std::process::ExitCode;

/// Name of the case on the command line.
pub const NAME: &str = "growth";

pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    check(arguments)?;
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

/// Refuses what the study decides itself.
fn check(arguments: &Arguments) -> Result<()> {
    let effort = &arguments.effort;
    let is_decided = effort.spp.is_some()
        || effort.error.is_some()
        || effort.time.is_some()
        || effort.resolution.is_some()
        || effort.integrator.is_some()
        || effort.groups.is_some()
        || effort.max_bounces.is_some()
        || effort.seed != 0
        || effort.leaving != Leaving::all();
    let has_photos = !arguments.photo.is_empty() || arguments.photos.is_some() || arguments.bands.is_some();
    if is_decided || has_photos {
        return Err(Error::new("growth takes --budget, --threads, --full and -o alone")
            .hint("leave the other options out"));
    }
    Ok(())
}
