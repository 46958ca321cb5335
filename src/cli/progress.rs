//! The progress bar: samples, elapsed, estimated error, time left; silent off a terminal.

use etalon::camera::Film;
use etalon::integrator::{Budget, Progress, share_done};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::borrow::Cow;
use std::sync::Mutex;
use std::time::Duration;

/// Steps of the bar over the whole render.
const STEPS: u64 = 10_000;

/// A bar on standard error.
pub struct Bar {
    bar: ProgressBar,
    /// Estimated relative error after the last block.
    error: Mutex<Option<f64>>,
}

impl Bar {
    /// A bar that shows itself only on a terminal.
    pub fn new() -> Self {
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template("{bar:30} {percent:>3}%  {msg}")
            .expect("the template is well formed");
        bar.set_style(style);
        Self { bar, error: Mutex::new(None) }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn show(&self, budget: &Budget, elapsed: Duration, samples: f64, error: Option<f64>) {
        let by_time = budget.time.map(|limit| elapsed.as_secs_f64() / limit.as_secs_f64());
        let by_error = budget.error.zip(error).map(|(target, error)| share_done(target, error));
        let by_samples = samples / budget.samples_per_pixel as f64;
        let done = [by_time, by_error].into_iter().flatten().fold(by_samples, f64::max);
        /// Before this share is done, the time left is a guess.
        const ENOUGH: f64 = 1e-3;
        let left =
            if done < ENOUGH { "?".to_owned() } else { clock(elapsed.mul_f64((1.0 - done).max(0.0) / done)) };
        let error = error.map_or_else(|| "?".to_owned(), |e| format!("{:.2} %", 100.0 * e));
        self.bar.set_message(format!(
            "{samples:.0} samples  elapsed {}  left {left}  error {error}",
            clock(elapsed)
        ));
        self.bar.set_position((done.min(1.0) * STEPS as f64) as u64);
    }
}

impl Progress for Bar {
    fn block<'f>(&self, budget: &Budget, elapsed: Duration, picture: &dyn Fn() -> Cow<'f, Film>) {
        if self.bar.is_hidden() {
            return; // the error estimate reads the whole film
        }
        let film = picture();
        let error = film.relative_error();
        if let Ok(mut latest) = self.error.lock() {
            *latest = error;
        }
        self.show(budget, elapsed, film.samples_per_pixel() as f64, error);
    }

    fn within_block(&self, budget: &Budget, elapsed: Duration, samples: f64) {
        // Threads that find another one at it have nothing to add.
        if let Ok(error) = self.error.try_lock() {
            self.show(budget, elapsed, samples, *error);
        }
    }
}

fn clock(time: Duration) -> String {
    let seconds = time.as_secs();
    format!("{}:{:02}", seconds / 60, seconds % 60)
}
