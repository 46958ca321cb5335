//! What a render will hold, before it is begun: a picture that does not fit ends in one line, not
//! hours later by the hand of the system.

use etalon::camera::batch_numbers;
use etalon::error::{Error, Result};
use etalon::integrator::{Budget, Integrator, Memory};
use etalon::scene::View;

/// Numbers of a channel of a pixel that independent samples are gathered in: sums, their squares
/// and the sum of the block.
const NUMBERS_OF_SAMPLES: u64 = 3;
/// The same of chains, with the direct light beside them.
const NUMBERS_OF_CHAINS: u64 = 11;
/// Numbers of a pixel, all channels together, that the error of a finished picture is told from:
/// luminance, standard error, weight and their product.
const NUMBERS_OF_ERROR: u64 = 4;
/// Channels of a file beyond those of the film: standard errors of X, Y and Z.
const WRITTEN_BESIDE: u64 = 3;
/// Bytes that a picture may take where the system does not say what is free.
const MOST_BYTES: u64 = 64 << 30;

/// What a render holds. Errors of squares of pixels, at most some 1400, are too few to count.
#[derive(Clone, Copy, Debug)]
pub struct Numbers {
    /// Of each channel of each pixel.
    per_value: u64,
    /// Times that batches of blocks are held at some pixels, which tell how sure the error is.
    batches: u64,
}

impl Numbers {
    /// Of a picture of one integrator.
    pub fn of(integrator: Integrator, budget: &Budget) -> Self {
        // Chains and the direct light beside them have batches of their own.
        let (per_value, films) = match integrator {
            Integrator::Mlt => (NUMBERS_OF_CHAINS, 2),
            _ => (NUMBERS_OF_SAMPLES, 1),
        };
        // Two halves, each of which may be kept as it ended while it goes on.
        let (halves, held) = if budget.is_open() { (2, 4) } else { (1, 1) };
        // When the picture is finished, what batches of a half scatter by stands beside them, as
        // they came and balanced.
        Self { per_value: held * per_value, batches: films * (held + 2 * halves) }
    }

    /// Of many films of independent samples, as strategies have them.
    pub const fn of_films(films: u64) -> Self {
        Self { per_value: films * NUMBERS_OF_SAMPLES, batches: films }
    }

    /// Bytes of a picture.
    fn bytes(self, pixels: u64, channels: u64) -> u64 {
        let values = pixels.saturating_mul(channels).saturating_mul(self.per_value);
        let batches = batch_numbers(pixels).saturating_mul(self.batches);
        let held = values.saturating_add(batches).saturating_mul(size_of::<f64>() as u64);
        // The error is told before anything is written; then channels stand beside the film twice, as
        // the file's and to develop from.
        let told = pixels.saturating_mul(NUMBERS_OF_ERROR * size_of::<f64>() as u64);
        let written = (2 * channels + WRITTEN_BESIDE) * size_of::<f32>() as u64;
        held.saturating_add(told.max(pixels.saturating_mul(written)))
    }
}

/// Refuses a picture that this machine cannot hold.
///
/// # Errors
/// Says how large it is, and how much is free.
pub fn check(view: &View, numbers: Numbers) -> Result<()> {
    let [width, height] = view.camera.resolution().map(u64::from);
    let channels = view.sensor.channels.len() as u64;
    let bytes = numbers.bytes(width.saturating_mul(height), channels);
    let free = free_bytes();
    if bytes <= free.unwrap_or(MOST_BYTES) {
        return Ok(());
    }
    let gib = |bytes: u64| bytes as f64 / f64::from(1 << 30);
    let there =
        free.map_or_else(String::new, |free| format!(", and {:.1} GiB of memory are free", gib(free)));
    let size = gib(bytes);
    Err(Error::new(format!(
        "a film of {width} x {height} pixels with {channels} channels takes {size:.1} GiB{there}"
    ))
    .hint("ask for fewer pixels or fewer spectral layers"))
}

/// What a run has held at most, after its seconds; empty where the system does not tell.
pub fn in_words(memory: Memory) -> String {
    /// Below it MiB are easier to read than GiB.
    const GIB: u64 = 1 << 30;
    match memory.peak_resident_bytes {
        None => String::new(),
        Some(bytes) if bytes < GIB => format!(" and {} MiB", bytes.div_ceil(1 << 20)),
        Some(bytes) => format!(" and {:.1} GiB", bytes as f64 / GIB as f64),
    }
}

/// Memory that a process can have without others being moved out, where Linux says so.
fn free_bytes() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    kibibytes.checked_mul(1 << 10)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn memory_is_told_in_a_unit_that_suits_it() {
        let words = |bytes: u64| in_words(Memory { peak_resident_bytes: Some(bytes) });
        assert_eq!(words((17 << 20) - 5), " and 17 MiB");
        assert_eq!(words(5 << 29), " and 2.5 GiB");
        assert_eq!(in_words(Memory::default()), "");
    }

    /// By hand, of a large picture of three channels: 3 numbers of a value, 36 bytes of a pixel when
    /// it is written, and 33 batches at 32768 pixels, three times.
    #[test]
    fn all_that_a_render_holds_is_counted() {
        const PIXELS: u64 = 1 << 22;
        let told = Budget { samples_per_pixel: 16, time: None, error: None, seed: 0 };
        let path = Numbers::of(Integrator::Path, &told).bytes(PIXELS, 3);
        assert_eq!(path, 8 * (PIXELS * 3 * 3 + 3 * 33 * (1 << 15)) + 36 * PIXELS);
        let open = Budget { time: Some(Duration::from_secs(1)), ..told };
        let chains = Numbers::of(Integrator::Mlt, &open).bytes(PIXELS, 3);
        assert_eq!(chains, 8 * (PIXELS * 4 * 11 * 3 + 16 * 33 * (1 << 15)) + 36 * PIXELS);
    }
}
