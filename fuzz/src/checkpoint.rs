//! Checkpoints: as a file, and as its content alone, which no checksum protects from the fuzzer.

use etalon::image::checkpoint::{self, Checkpoint};
use etalon::integrator::Budget;

/// A checkpoint's bytes, with what is read of them gone through as a run would before it goes on.
pub fn read(bytes: &[u8]) {
    for read in [checkpoint::read(bytes), checkpoint::decode(bytes)] {
        match read {
            Err(error) => super::expect_one_line(&error.to_string()),
            Ok(checkpoint) => go_on_from(checkpoint),
        }
    }
}

fn go_on_from(checkpoint: Checkpoint<'_>) {
    let identity = checkpoint.identity.clone();
    let budget = Budget {
        samples_per_pixel: identity.samples_per_pixel.unwrap_or(u64::MAX),
        error: identity.error,
        time: None,
        seed: identity.seed,
    };
    match checkpoint.state_of(&identity, &budget) {
        Err(error) => super::expect_one_line(&error.to_string()),
        Ok(state) => {
            let _ = state.samples_per_pixel();
        }
    }
}
