//! `etalon validate self-test`: the harness takes a synthetic photograph apart, whose answer is known.

use super::Arguments;
use etalon::error::Error;
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
    let effort = &arguments.effort;
    let idle = [
        (!arguments.photo.is_empty(), "--photo"),
        (arguments.photos.is_some(), "--photos"),
        (arguments.bands.is_some(), "--bands"),
        (arguments.points.is_some(), "--points"),
        (arguments.force_registration, "--force-registration"),
        (effort.seed != 0, "--seed"),
        (effort.integrator.is_some(), "--integrator"),
        (effort.groups.is_some(), "--groups"),
        (effort.error.is_some(), "--error"),
        (effort.time.is_some(), "--time"),
        (effort.threads.is_some(), "--threads"),
        (effort.resolution.is_some(), "--resolution"),
    ];
    if let Some((_, option)) = idle.into_iter().find(|(given, _)| *given) {
        return Err(Error::new(format!("the self-test does not take {option}"))
            .hint("leave it out; --spp and -o are taken")
            .into());
    }
    let program = std::env::current_exe()?;
    let case = project_root()?.join("reference").join("cornell-photo");
    let output = arguments.folder();
    let spp = effort.spp.map(|spp| spp.to_string());
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
