//! `--checkpoint` and `--resume`: a render that survives the end of its process.
//!
//! Batch systems start the same command again and again until it has ended well. So `--resume`
//! without a checkpoint begins anew, and the checkpoint stays when the run has ended: asked once
//! more, the command writes its pictures again and renders nothing. A checkpoint is never
//! overwritten by a run that was not told to go on from it.

use super::progress::Bar;
use super::render::check_place;
use clap::Args;
use etalon::camera::Film;
use etalon::error::{Error, Result};
use etalon::image::checkpoint::{self, Identity};
use etalon::integrator::{Budget, Progress, State};
use etalon::pilot::Selection;
use etalon::scene::View;
use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Where a run is kept.
#[derive(Clone, Debug, Default, Args)]
pub struct Keeping {
    /// Write down what the run has gathered, from time to time and at its end; the file stays
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// Seconds between checkpoints; 0 writes one after every block
    #[arg(long, value_name = "SECONDS", requires = "checkpoint", default_value = "60", value_parser = interval)]
    checkpoint_interval: Duration,
    /// Go on from the checkpoint, to the same bits as without the interruption; begin where there
    /// is none yet
    #[arg(long, requires = "checkpoint")]
    resume: bool,
}

fn interval(text: &str) -> std::result::Result<Duration, String> {
    let seconds = text.parse().ok().and_then(|value| Duration::try_from_secs_f64(value).ok());
    seconds.ok_or_else(|| "give a number of seconds from 0 up, such as 60".to_owned())
}

/// Shows how a render goes, and keeps it.
pub struct Watch {
    bar: Bar,
    keeper: Option<Keeper>,
}

/// Writes checkpoints of one run.
struct Keeper {
    file: PathBuf,
    interval: Duration,
    identity: Identity,
    /// When the latest attempt was made.
    latest: Mutex<Instant>,
    /// Whether the file holds the run's end.
    has_end: AtomicBool,
}

impl Keeping {
    /// Refuses, before hours of work, what cannot be kept.
    ///
    /// # Errors
    /// Where the file cannot be written, or would be lost.
    pub fn check(&self) -> Result<()> {
        let Some(file) = &self.checkpoint else { return Ok(()) };
        if file.exists() && !self.resume {
            return Err(Error::new("there is a checkpoint already")
                .hint("add --resume to go on from it, or remove it to begin anew")
                .in_file(file));
        }
        check_place(file)
    }

    /// What a run that is gone on with was rendered with; `None` where it begins.
    ///
    /// # Errors
    /// Where the checkpoint is damaged.
    pub fn selection(&self, view: &View) -> Result<Option<Selection>> {
        let Some(file) = self.checkpoint.as_ref().filter(|_| self.resume) else { return Ok(None) };
        let found = checkpoint::read_file(file, most_bytes(view))?;
        let named = found.map(|found| Selection::named(&found.identity.integrator));
        named.transpose().map_err(|e| e.in_file(file))
    }

    /// The state to go on from, and what watches over the run.
    ///
    /// # Errors
    /// Where the checkpoint is damaged or of another run.
    pub fn begin(&self, identity: Identity, view: &View, budget: &Budget) -> Result<(Option<State>, Watch)> {
        let Some(file) = &self.checkpoint else {
            return Ok((None, Watch { bar: Bar::new(), keeper: None }));
        };
        let mut from = None;
        if self.resume {
            from = match checkpoint::read_file(file, most_bytes(view))? {
                Some(found) => Some(found.state_of(&identity, budget).map_err(|e| e.in_file(file))?),
                None => None,
            };
            let what = from.as_ref().map_or_else(
                || "no checkpoint yet, the run begins".to_owned(),
                |state| {
                    let samples_per_pixel = state.samples_per_pixel();
                    format!("going on from {samples_per_pixel} samples per pixel of {}", identity.integrator)
                },
            );
            super::notice(&format!("{}: {what}", file.display()));
        }
        let keeper = Keeper {
            file: file.clone(),
            interval: self.checkpoint_interval,
            identity,
            latest: Mutex::new(Instant::now()),
            has_end: AtomicBool::new(from.as_ref().is_some_and(State::has_ended)),
        };
        Ok((from, Watch { bar: Bar::new(), keeper: Some(keeper) }))
    }
}

/// Bytes that a checkpoint of a view has at most.
fn most_bytes(view: &View) -> u64 {
    /// Of each channel of a pixel: 11 numbers, of two halves, each of which may be held twice.
    const PER_VALUE: u64 = 11 * 8 * 4;
    /// What does not depend on the size of the picture: some four million chains.
    const BESIDE: u64 = 1 << 30;
    let [width, height] = view.camera.resolution().map(u64::from);
    width * height * view.sensor.channels.len() as u64 * PER_VALUE + BESIDE
}

impl Watch {
    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish();
    }

    /// Says of an error after the render that nothing is lost, if nothing is.
    pub fn reassure(&self, error: Error) -> Error {
        match &self.keeper {
            Some(keeper) if keeper.has_end.load(Ordering::Relaxed) => {
                let hint = error.hint.clone().unwrap_or_default();
                let kept = keeper.file.display();
                error.hint(format!("{hint}; the render is kept in {kept}: repeat the command with --resume"))
            }
            _ => error,
        }
    }
}

impl Progress for Watch {
    fn block<'f>(&self, budget: &Budget, elapsed: Duration, picture: &dyn Fn() -> Cow<'f, Film>) {
        self.bar.block(budget, elapsed, picture);
    }

    fn within_block(&self, budget: &Budget, elapsed: Duration, samples: f64) {
        self.bar.within_block(budget, elapsed, samples);
    }

    fn keep(&self, state: &State, has_ended: bool) {
        if let Some(keeper) = &self.keeper {
            keeper.keep(state, has_ended);
        }
    }
}

impl Keeper {
    /// A checkpoint that cannot be written is no reason to give a render up: the one before
    /// stays, and the next attempt may do better.
    fn keep(&self, state: &State, has_ended: bool) {
        let Ok(mut latest) = self.latest.lock() else { return };
        let is_due = has_ended || latest.elapsed() >= self.interval;
        if !is_due || self.has_end.load(Ordering::Relaxed) {
            return;
        }
        match checkpoint::write(&self.file, &self.identity, state) {
            Ok(()) => self.has_end.store(has_ended, Ordering::Relaxed),
            Err(error) => super::notice(&format!("warning: {error}; the render goes on")),
        }
        *latest = Instant::now();
    }
}
