//! `etalon validate peers`: a picture held against Mitsuba's block by block, then error against
//! run time of both in one paired session, against the two pictures that were just compared.

use etalon::error::Result;
use etalon::python::{Environment, PEERS, VALIDATION, project_root};
use std::ffi::OsString;
use std::path::Path;

/// The name among the cases.
pub const NAME: &str = "peers";

/// Size of the picture that is compared with a peer: 8x8 blocks are averaged.
pub const RESOLUTION: [u32; 2] = [128, 128];

/// What the block comparison is told besides case, render and folder.
pub fn words(samples_per_pixel: u64) -> Result<Vec<OsString>> {
    let spectra = project_root()?.join("spectra");
    Ok(vec![
        "--spp".into(),
        samples_per_pixel.to_string().into(),
        "--spectra".into(),
        spectra.into(),
        "--threads".into(),
        threads(),
    ])
}

/// Lets the harness run both renderers in turns and write tables, plot and page into `output`.
///
/// The harness has no Mitsuba and Mitsuba's environment has no plots: the one starts the other.
///
/// # Errors
/// Where an environment cannot be made, a run fails, or the budget has no room.
pub fn converge(case: &Path, output: &Path, budget_s: Option<f64>) -> anyhow::Result<()> {
    let python = Environment::prepare(&PEERS)?.harness().get_program().to_owned();
    let mut words: Vec<OsString> = vec!["--case".into(), case.into(), "--folder".into(), output.into()];
    words.extend(["--program".into(), std::env::current_exe()?.into(), "--peer-python".into(), python]);
    words.extend(["--spectra".into(), project_root()?.join("spectra").into()]);
    words.extend(["--threads".into(), threads()]);
    if let Some(seconds) = budget_s {
        words.extend(["--budget".into(), seconds.to_string().into()]);
    }
    Environment::prepare(&VALIDATION)?.run_module("peers-converge", &words, None)
}

/// Threads of both sides: those that this program renders on.
fn threads() -> OsString {
    rayon::current_num_threads().to_string().into()
}
