//! What a picture file says about itself, as one JSON text beside the standard attributes.

use crate::camera::{CameraRecord, CellErrors, Crop, Film, PictureError};
use crate::integrator::{
    Budget, Cost, End, Integrator, Memory, Times, Truncation, USUAL_TARGETS, cpu_seconds,
};
use crate::metropolis::Outcome;
use crate::pilot::Report;
use crate::replay::SampleName;
use crate::scene::conditions::Condition;
use crate::scene::{Plan, PlanItem, Scene, View};
use serde::Serialize;

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
    /// Processor seconds of all processes of the run so far, loading included, where the system
    /// tells.
    pub cpu_seconds: Option<f64>,
    /// What the parts of the run took.
    pub times: Times,
    /// What the process has held at most until the facts were gathered; in a report the writing of
    /// the pictures is included.
    pub memory: Memory,
    /// Processes that the run has taken: one, and one more for every time it was resumed.
    pub parts: u32,
    /// When the run was to end.
    pub stopping: Stopping,
    /// Algorithm.
    pub integrator: &'static str,
    /// Groups of strategies, as `path,splats`; `None` where all that the algorithm stands for were
    /// used.
    pub groups: Option<String>,
    /// What picked the algorithm, where nobody named it.
    pub auto: Option<Report>,
    /// Units of the channels.
    pub units: &'static str,
    /// Exposure and optics.
    pub camera: CameraRecord,
    /// What was planned, in plain words.
    pub plan: Vec<String>,
    /// The same as data: each decision with its reason and what it saves.
    pub plan_items: Vec<PlanItem>,
    /// What the plan was to leave out: `lean`, `full` or `keep=` and names.
    pub plan_setting: String,
    /// Paths that carry light and that the integrator cannot make.
    pub missing: Vec<String>,
    /// Remarks on the scene's data.
    pub notes: Vec<String>,
    /// Extreme conditions of the scene, and what they do to the error to be expected.
    pub conditions: Vec<Condition>,
    /// Estimated relative error of the luminance picture; `None` from a single block, and of a
    /// black picture.
    pub relative_error: Option<f64>,
    /// How sure that is and what a smaller error would cost; `None` where it is.
    pub error: Option<ErrorFacts>,
    /// Standard errors of mean luminance over squares of pixels; `None` from a single block.
    pub luminance_cells: Option<CellErrors>,
    /// Whether lamps shine and none of their light was found.
    pub no_light_found: bool,
    /// Contributions that were not finite; they count as zero, which biases their pixels by an
    /// unknown amount.
    pub non_finite_samples: u64,
    /// The first samples that they belong to: what `etalon replay` takes them again by.
    pub non_finite: Vec<SampleName>,
    /// Bounces after which paths were to be cut off; `None`: nobody asked for a limit.
    pub max_bounces: Option<u32>,
    /// What a limit on bounces has cut off, and what was trapped.
    pub truncation: Option<Truncation>,
    /// Of which picture this one is a part; `None`: it is all of it.
    pub crop: Option<Crop>,
    /// Spectral layers among the channels: they have a say in the wavelengths of samples.
    pub spectral_layers: usize,
    /// What chains of paths say about themselves.
    pub metropolis: Option<Outcome>,
}

/// The error of a picture and the cost of smaller ones.
#[derive(Clone, Debug, Serialize)]
pub struct ErrorFacts {
    /// What is known of the error.
    #[serde(flatten)]
    pub picture: PictureError,
    /// What a run like this one takes from the start to usual errors, and to the one asked for.
    pub seconds_to: Vec<Projection>,
}

/// The cost of a relative error.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Projection {
    /// Relative error of the luminance picture: the root of its relMSE.
    pub relative_error: f64,
    /// Cost of the whole run.
    #[serde(flatten)]
    pub cost: Cost,
}

impl ErrorFacts {
    /// The error of a picture that took this time; `None` where nothing is known.
    /// `asked` is the relative error that was asked for.
    pub fn of(film: &Film, times: &Times, asked: Option<f64>) -> Option<Self> {
        let picture = film.error()?;
        let now = picture.relmse.sqrt();
        let unusual = asked.filter(|asked| !USUAL_TARGETS.contains(asked));
        let seconds_to = USUAL_TARGETS
            .into_iter()
            .chain(unusual)
            .map(|target| Projection { relative_error: target, cost: times.to_reach(target, now) })
            .collect();
        Some(Self { picture, seconds_to })
    }
}

/// When a run was to end, and what ended it.
#[derive(Clone, Debug, Serialize)]
pub struct Stopping {
    /// Samples per pixel at most; `None` without a limit.
    pub samples_per_pixel: Option<u64>,
    /// Relative error of the luminance picture to be reached.
    pub error: Option<f64>,
    /// Seconds.
    pub time_s: Option<f64>,
    /// What ended the picture: one entry where only its samples could, else one for each of two
    /// independent halves, of each of which the other one decides. Empty if it has not ended.
    pub ends: Vec<End>,
}

impl Stopping {
    /// A budget's rule.
    pub fn of(budget: &Budget) -> Self {
        Self {
            samples_per_pixel: Some(budget.samples_per_pixel).filter(|most| *most < u64::MAX),
            error: budget.error,
            time_s: budget.time.map(|time| time.as_secs_f64()),
            ends: Vec::new(),
        }
    }
}

impl Facts {
    /// Gathers the facts of a finished render and of what it took.
    pub fn of(
        scene: &Scene,
        view: &View,
        plan: &Plan,
        integrator: Integrator,
        budget: &Budget,
        film: &Film,
        times: Times,
    ) -> Self {
        let error = ErrorFacts::of(film, &times, budget.error);
        Self {
            version: env!("CARGO_PKG_VERSION"),
            git_hash: option_env!("ETALON_COMMIT"),
            scene: scene.name.clone(),
            scene_hash: scene.hash.clone(),
            seed: budget.seed,
            samples_per_pixel: film.samples_per_pixel(),
            seconds: times.render.wall_s + times.bootstrap.map_or(0.0, |cost| cost.wall_s),
            cpu_seconds: cpu_seconds(),
            times,
            memory: Memory::so_far(),
            parts: 1,
            stopping: Stopping::of(budget),
            integrator: integrator.name(),
            groups: None,
            auto: None,
            units: "X, Y, Z in cd/m2 (Y is luminance); stderr.* their standard errors; sensor.* as camera.channels says, before exposure and vignetting; S0.* in W sr^-1 m^-2 nm^-1; vignetting relative to the middle",
            camera: view.record(),
            plan: plan.reasons.clone(),
            plan_items: plan.items.clone(),
            plan_setting: plan.leaving.to_string(),
            missing: plan.unreachable.iter().map(|c| format!("{}: {}", c.word, c.meaning)).collect(),
            notes: scene.notes.clone(),
            conditions: Vec::new(),
            relative_error: error.as_ref().map(|error| error.picture.relmse.sqrt()),
            error,
            luminance_cells: film.cell_errors(),
            no_light_found: film.is_black() && scene.emitters.iter().any(|emitter| emitter.weight() > 0.0),
            non_finite_samples: film.faults.count,
            non_finite: film.faults.named.clone(),
            max_bounces: plan.most_bounces,
            truncation: None,
            crop: view.camera.crop(),
            spectral_layers: view.sensor.channels.iter().filter(|c| c.name.starts_with("S0.")).count(),
            metropolis: None,
        }
    }
}
