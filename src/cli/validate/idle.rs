//! Options that a case has no use for are refused: who gives one expects something of it.

use super::Arguments;
use etalon::error::{Error, Result};
use etalon::scene::Leaving;

/// Refuses what is given and not in `taken`; `-o` always is.
///
/// # Errors
/// The first such option, said of `who`.
pub fn refuse_idle(arguments: &Arguments, who: &str, taken: &[&str]) -> Result<()> {
    let effort = &arguments.effort;
    let options = [
        (!arguments.photo.is_empty(), "--photo"),
        (arguments.photos.is_some(), "--photos"),
        (arguments.bands.is_some(), "--bands"),
        (arguments.points.is_some(), "--points"),
        (arguments.force_registration, "--force-registration"),
        (arguments.performance, "--performance"),
        (!arguments.scenes.is_empty(), "--scenes"),
        (!arguments.peers.is_empty(), "--peers"),
        (arguments.budget.is_some(), "--budget"),
        (arguments.full, "--full"),
        (effort.spp.is_some(), "--spp"),
        (effort.seed != 0, "--seed"),
        (effort.integrator.is_some(), "--integrator"),
        (effort.groups.is_some(), "--groups"),
        (effort.max_bounces.is_some(), "--max-bounces"),
        (effort.leaving != Leaving::all(), "--plan"),
        (effort.error.is_some(), "--error"),
        (effort.time.is_some(), "--time"),
        (effort.threads.is_some(), "--threads"),
        (effort.resolution.is_some(), "--resolution"),
    ];
    match options.into_iter().find(|(given, option)| *given && !taken.contains(option)) {
        Some((_, option)) => Err(Error::new(format!("{who} does not take {option}"))
            .hint(format!("leave it out; {} and -o are taken", taken.join(", ")))),
        None => Ok(()),
    }
}
