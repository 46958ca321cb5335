//! `--integrator auto`: settles the algorithm before a render.

use super::arguments::Effort;
use super::checkpoint::Keeping;
use etalon::error::Result;
use etalon::pilot::{Report, choose};
use etalon::scene::{Scene, View};

/// The effort with an algorithm, and what picked it where nobody named one. A run that is gone on
/// with keeps what it has been rendered with so far.
///
/// # Errors
/// Where groups are given without their algorithm, or the checkpoint cannot be read.
pub fn settle(
    scene: &Scene,
    view: &View,
    effort: &Effort,
    default_spp: u64,
    keeping: Option<&Keeping>,
) -> Result<(Effort, Option<Report>)> {
    if let Some(selection) = effort.selection()? {
        return Ok((effort.with(selection), None));
    }
    if let Some(selection) = keeping.map(|keeping| keeping.selection(view)).transpose()?.flatten() {
        return Ok((effort.with(selection), None));
    }
    let choice = choose(scene, view, &effort.budget(default_spp), effort.max_bounces, &effort.leaving);
    super::print(&choice.report.to_string());
    Ok((effort.with(choice.selection), Some(choice.report)))
}
