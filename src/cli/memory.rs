//! What a render will hold, before it is begun: a picture that does not fit ends in one line, not
//! hours later by the hand of the system.

use etalon::error::{Error, Result};
use etalon::integrator::{Budget, Integrator};
use etalon::scene::View;

/// Numbers of a channel of a pixel that independent samples are gathered in: sums, their squares
/// and the sum of the block.
pub const NUMBERS_OF_SAMPLES: u64 = 3;
/// The same of chains, with the direct light beside them.
const NUMBERS_OF_CHAINS: u64 = 11;
/// Bytes that a picture may take where the system does not say what is free.
const MOST_BYTES: u64 = 64 << 30;

/// Numbers of a channel of a pixel that a render holds.
pub fn numbers_per_value(integrator: Integrator, budget: &Budget) -> u64 {
    let of_one = if integrator == Integrator::Mlt { NUMBERS_OF_CHAINS } else { NUMBERS_OF_SAMPLES };
    // Two halves, each of which may be kept as it ended while it goes on.
    if budget.is_open() { 4 * of_one } else { of_one }
}

/// Refuses a picture that this machine cannot hold.
///
/// # Errors
/// Says how large it is, and how much is free.
pub fn check(view: &View, numbers_per_value: u64) -> Result<()> {
    let [width, height] = view.camera.resolution().map(u64::from);
    let channels = view.sensor.channels.len() as u64;
    let values = width.saturating_mul(height).saturating_mul(channels);
    let bytes = values.saturating_mul(numbers_per_value).saturating_mul(size_of::<f64>() as u64);
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

/// Memory that a process can have without others being moved out, where Linux says so.
fn free_bytes() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    kibibytes.checked_mul(1 << 10)
}
