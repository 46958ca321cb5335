//! The progress bar: samples, elapsed, estimated error, time left; silent off a terminal.

use etalon::camera::Film;
use etalon::integrator::{Budget, Progress};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Steps of the bar over the whole render.
const STEPS: u64 = 10_000;

/// A bar on standard error.
pub struct Bar {
    bar: ProgressBar,
    state: Mutex<State>,
}

struct State {
    started: Instant,
    /// Share of the budget that finished blocks have used.
    done: f64,
    /// Share of the budget that one block takes, as far as known.
    per_block: f64,
}

impl Bar {
    /// A bar that shows itself only on a terminal.
    pub fn new() -> Self {
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template("{bar:30} {percent:>3}%  {msg}")
            .expect("the template is well formed");
        bar.set_style(style);
        let state = State { started: Instant::now(), done: 0.0, per_block: 0.0 };
        Self { bar, state: Mutex::new(state) }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Bar {
    fn block(&self, budget: &Budget, started: Instant, film: &Film) {
        let samples = film.samples_per_pixel();
        let elapsed = started.elapsed();
        let done = match budget.time {
            Some(limit) => elapsed.as_secs_f64() / limit.as_secs_f64(),
            None => samples as f64 / budget.samples_per_pixel as f64,
        };
        let left = elapsed.mul_f64(((1.0 - done).max(0.0) / done).min(1e6));
        let error = film.relative_error().map_or_else(|| "?".to_owned(), |e| format!("{:.2} %", 100.0 * e));
        self.bar.set_message(format!(
            "{samples} samples  elapsed {}  left {}  error {error}",
            clock(elapsed),
            clock(left)
        ));
        self.bar.set_position((done.min(1.0) * STEPS as f64) as u64);
        if let Ok(mut state) = self.state.lock() {
            *state = State { started, per_block: done - state.done, done };
        }
    }

    fn within_block(&self, share: f64) {
        if let Ok(state) = self.state.try_lock() {
            let done = state.done + share * state.per_block;
            self.bar.set_position((done.min(1.0) * STEPS as f64) as u64);
            if state.done == 0.0 {
                self.bar.set_message(format!("first samples  elapsed {}", clock(state.started.elapsed())));
            }
        }
    }
}

fn clock(time: Duration) -> String {
    let seconds = time.as_secs();
    format!("{}:{:02}", seconds / 60, seconds % 60)
}
