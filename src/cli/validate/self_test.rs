//! `etalon validate self-test`: the harness takes a synthetic photograph apart, whose answer is known.

use super::Arguments;
use super::idle::refuse_idle;
use etalon::python::{Environment, VALIDATION, project_root};
use std::ffi::OsStr;
use std::process::ExitCode;

/// The name among the cases.
pub const NAME: &str = "self-test";

/// Runs the self-test into `output`; the harness renders with this program.
///
/// # Errors
/// Where an option has no meaning here, and where the self-test fails.
pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    refuse_idle(arguments, "the self-test", &["--spp"])?;
    let program = std::env::current_exe()?;
    let case = project_root()?.join("reference").join("cornell-photo");
    let output = arguments.folder();
    let spp = arguments.effort.spp.map(|spp| spp.to_string());
    let mut words: Vec<&OsStr> = vec![
        "--program".as_ref(),
        program.as_os_str(),
        "--case".as_ref(),
        case.as_os_str(),
        "-o".as_ref(),
        output.as_os_str(),
    ];
    if let Some(spp) = &spp {
        words.extend([OsStr::new("--spp"), OsStr::new(spp)]);
    }
    Environment::prepare(&VALIDATION)?.run_module("self-test", &words, None)?;
    Ok(ExitCode::SUCCESS)
}
