//! What a picture file says about itself, as one JSON text beside the standard attributes.

use crate::camera::{CameraRecord, Film};
use crate::integrator::{Budget, Integrator};
use crate::metropolis::Outcome;
use crate::scene::conditions::Condition;
use crate::scene::{Plan, Scene, View};
use serde::Serialize;
use std::time::Duration;

/// The facts of a render.
#[derive(Clone, Debug, Serialize)]
pub struct Facts {
    /// Version of the program.
    pub version: &'static str,
    /// Commit that the program was built from, with `-changed` where its sources differ; `None`
    /// where it was built without a repository.
    pub git_hash: Option<&'static str>,
    /// Name of the scene.
    pub scene: String,
    /// Hash of the scene and of the files that it names.
    pub scene_hash: String,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Samples in every pixel.
    pub samples_per_pixel: u64,
    /// Wall-clock seconds of rendering.
    pub seconds: f64,
    /// Processor seconds of the whole process so far, where the system tells.
    pub cpu_seconds: Option<f64>,
    /// Algorithm.
    pub integrator: &'static str,
    /// Units of the channels.
    pub units: &'static str,
    /// Exposure and optics.
    pub camera: CameraRecord,
    /// What was planned, in plain words.
    pub plan: Vec<String>,
    /// Paths that carry light and that the integrator cannot make.
    pub missing: Vec<String>,
    /// Remarks on the scene's data.
    pub notes: Vec<String>,
    /// Extreme conditions of the scene, and what they do to the error to be expected.
    pub conditions: Vec<Condition>,
    /// Estimated relative error of the luminance picture; `None` from a single block.
    pub relative_error: Option<f64>,
    /// Samples that were not finite; they count as zero.
    pub non_finite_samples: u64,
    /// What chains of paths say about themselves.
    pub metropolis: Option<Outcome>,
}

impl Facts {
    /// Gathers the facts of a finished render.
    pub fn of(
        scene: &Scene,
        view: &View,
        plan: &Plan,
        integrator: Integrator,
        budget: &Budget,
        film: &Film,
        elapsed: Duration,
    ) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            git_hash: option_env!("ETALON_COMMIT"),
            scene: scene.name.clone(),
            scene_hash: scene.hash.clone(),
            seed: budget.seed,
            samples_per_pixel: film.samples_per_pixel(),
            seconds: elapsed.as_secs_f64(),
            cpu_seconds: cpu_seconds(),
            integrator: integrator.name(),
            units: "X, Y, Z in cd/m2 (Y is luminance); stderr.* their standard errors; sensor.* as camera.channels says, before exposure and vignetting; S0.* in W sr^-1 m^-2 nm^-1; vignetting relative to the middle",
            camera: view.record(),
            plan: plan.reasons.clone(),
            missing: plan.unreachable.iter().map(|c| format!("{}: {}", c.word, c.meaning)).collect(),
            notes: scene.notes.clone(),
            conditions: Vec::new(),
            relative_error: film.relative_error(),
            non_finite_samples: film.non_finite_samples,
            metropolis: None,
        }
    }
}

/// Processor time of this process in seconds, user and system, from Linux's `/proc`.
fn cpu_seconds() -> Option<f64> {
    /// Clock ticks per second that Linux reports to programs on every architecture.
    const TICKS_PER_SECOND: f64 = 100.0;
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The command name in parentheses may hold spaces; fields are counted after it.
    let fields: Vec<&str> = text.rsplit(')').next()?.split_whitespace().collect();
    let ticks = |index: usize| fields.get(index)?.parse::<f64>().ok();
    Some((ticks(11)? + ticks(12)?) / TICKS_PER_SECOND)
}
