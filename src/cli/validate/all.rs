//! Every case, one after the other, and an index page over their reports.
//!
//! Each case is a process of its own: one that fails leaves a row with its reason, and
//! processor seconds are the case's own.

use super::Arguments;
use super::cases::{Against, CASES, Case};
use super::photographs::{self, Photographs};
use crate::cli::arguments::Effort;
use crate::cli::print;
use etalon::error::{Error, Result};
use etalon::python::{Environment, VALIDATION};
use serde::Serialize;
use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};

/// How a case ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Status {
    Done,
    Failed,
    Skipped,
}

/// A row of the index.
#[derive(Debug, Serialize)]
struct Row {
    case: &'static str,
    status: Status,
    /// Why it failed or was left out.
    reason: Option<String>,
}

/// What the index is made of.
#[derive(Debug, Serialize)]
struct Index {
    version: &'static str,
    command: String,
    cases: Vec<Row>,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    if arguments.effort.resolution.is_some() {
        return Err(Error::new("the cases differ in shape, one --resolution does not fit them")
            .hint("leave it out, or validate one case")
            .into());
    }
    let named = photographs::named(&arguments.photo)?;
    let environment = Environment::prepare(&VALIDATION)?;
    let mut photos = match &arguments.photos {
        Some(folder) => photographs::in_folder(folder, &environment)?,
        None => Photographs::new(),
    };
    photos.extend(named);
    let folder = arguments.folder();
    std::fs::create_dir_all(&folder).map_err(|e| Error::io(&folder, "make the folder", &e))?;

    let cases = CASES.iter().filter(|case| case.is_in_all());
    let rows =
        cases.map(|case| row(case, arguments, &photos, &folder)).collect::<anyhow::Result<Vec<Row>>>()?;
    let failed = rows.iter().filter(|row| row.status == Status::Failed).count();
    let index = Index { version: env!("CARGO_PKG_VERSION"), command: command_line(), cases: rows };
    let words: [OsString; 2] = ["-o".into(), folder.clone().into()];
    environment.run_module("index", &words, Some(&serde_json::to_string(&index)?))?;
    print(&format!("index: {}", folder.join("index.html").display()));
    if failed > 0 {
        eprintln!("error: {failed} of the cases failed; the index says why");
        return Ok(ExitCode::FAILURE);
    }
    Ok(ExitCode::SUCCESS)
}

/// Runs a case, unless what it is held against is not at hand.
fn row(
    case: &'static Case,
    arguments: &Arguments,
    photos: &Photographs,
    folder: &Path,
) -> anyhow::Result<Row> {
    if case.against == Against::Bands && arguments.bands.is_none() {
        let reason = "the band images are not part of this project; give them as --bands".to_owned();
        return Ok(Row { case: case.name, status: Status::Skipped, reason: Some(reason) });
    }
    print(&format!("{}:", case.name));
    let place = folder.join(case.name);
    forget(&place)?;
    let mut words: Vec<OsString> = vec!["validate".into(), case.name.into(), "-o".into(), place.into()];
    words.extend(effort(case, arguments).words().into_iter().map(OsString::from));
    words.extend(photographs::words(case, photos));
    if case.against == Against::Photograph && arguments.force_registration {
        words.push("--force-registration".into());
    }
    if case.against == Against::Bands {
        for (option, value) in [("--bands", &arguments.bands), ("--points", &arguments.points)] {
            words.extend(value.iter().flat_map(|value| [option.into(), value.into()]));
        }
    }
    let reason = run_apart(&words)?;
    let status = if reason.is_some() { Status::Failed } else { Status::Done };
    Ok(Row { case: case.name, status, reason })
}

/// The effort that a case is given: predictions set their own seeds and algorithm.
fn effort(case: &Case, arguments: &Arguments) -> Effort {
    let mut effort = arguments.effort.clone();
    if matches!(case.against, Against::Another(_)) {
        effort = Effort { integrator: None, error: None, time: None, seed: 0, ..effort };
    }
    effort
}

/// Removes an earlier report, which would stand for a case that now fails.
fn forget(place: &Path) -> Result<()> {
    for name in ["report.json", "report.html"] {
        let file = place.join(name);
        if file.exists() {
            std::fs::remove_file(&file).map_err(|e| Error::io(&file, "remove the earlier report", &e))?;
        }
    }
    Ok(())
}

/// Runs this program with other arguments; why it failed, or `None` where it did not.
fn run_apart(words: &[OsString]) -> anyhow::Result<Option<String>> {
    let mut command = Command::new(std::env::current_exe()?);
    let output = command.args(words).stdin(Stdio::null()).stdout(Stdio::inherit()).output()?;
    let said = String::from_utf8_lossy(&output.stderr);
    eprint!("{said}");
    if output.status.success() {
        return Ok(None);
    }
    let last = said.lines().rev().find(|line| !line.trim().is_empty());
    let reason =
        last.map_or_else(|| output.status.to_string(), |line| line.trim_start_matches("error: ").to_owned());
    Ok(Some(reason))
}

/// The command as it was given, quoted where a shell needs it.
pub(super) fn command_line() -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,".contains(c);
    let quoted = |word: OsString| match word.to_string_lossy().into_owned() {
        word if !word.is_empty() && word.chars().all(plain) => word,
        word => format!("'{}'", word.replace('\'', r"'\''")),
    };
    let words = std::env::args_os().skip(1).map(quoted);
    std::iter::once("etalon".to_owned()).chain(words).collect::<Vec<String>>().join(" ")
}
