//! What leaving an item out saves, as it was measured.
//!
//! The table is data, not code: `savings.csv` is written, with the page `validation/plan.md`, by
//! `python -m etalon_validation plan-savings`. A saving is stated for the scene that it was
//! measured on, since no two scenes save the same.

use serde::Serialize;
use std::fmt;

/// Columns of the table: item, scene, integrator, instructions per sample with the item kept and
/// with it left out, and efficiency left out over kept with its 95 % interval.
const TABLE: &str = include_str!("savings.csv");

/// Shares of the instructions below which no number is given.
const TELLING_SHARE: f64 = 0.001;

/// A measured saving.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Saving {
    /// Which of [`super::ITEMS`].
    pub item: String,
    /// Name of the scene.
    pub scene: String,
    /// Algorithm.
    pub integrator: String,
    /// Instructions per sample with the item kept.
    pub instructions_kept: f64,
    /// Instructions per sample with the item left out.
    pub instructions_left_out: f64,
    /// Efficiency, 1 / (relative mean squared error times instructions), with the item left out
    /// over that with it kept; `None` where both give the same error.
    pub efficiency_ratio: Option<f64>,
    /// The ratio's 95 % interval.
    pub efficiency_ratio_ci95: Option<[f64; 2]>,
}

impl Saving {
    /// Share of the instructions that is saved; negative where it costs some.
    pub fn share(&self) -> f64 {
        1.0 - self.instructions_left_out / self.instructions_kept
    }

    fn from_row(row: &str) -> Option<Self> {
        let mut cells = row.split(',').map(str::trim);
        let mut text = || cells.next().map(str::to_owned);
        let (item, scene, integrator) = (text()?, text()?, text()?);
        let mut number = || text().map(|cell| cell.parse::<f64>().ok());
        let (kept, left_out) = (number()??, number()??);
        let (ratio, low, high) = (number()?, number()?, number()?);
        Some(Self {
            item,
            scene,
            integrator,
            instructions_kept: kept,
            instructions_left_out: left_out,
            efficiency_ratio: ratio,
            efficiency_ratio_ci95: low.zip(high).map(|(low, high)| [low, high]),
        })
    }
}

impl fmt::Display for Saving {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scene, integrator, efficiency_ratio, .. } = self;
        match self.share() {
            share if share.abs() < TELLING_SHARE => f.write_str("the same instructions within 0.1 %")?,
            share if share < 0.0 => write!(f, "{:.1} % more instructions", -100.0 * share)?,
            share => write!(f, "{:.1} % fewer instructions", 100.0 * share)?,
        }
        if let Some(ratio) = efficiency_ratio {
            write!(f, ", {ratio:.2} times as efficient")?;
        }
        write!(f, ": measured on {scene} by {integrator}")
    }
}

/// All savings that were measured, in the order of the table.
pub fn savings() -> impl Iterator<Item = Saving> {
    TABLE.lines().filter(|line| !line.starts_with('#')).skip(1).filter_map(Saving::from_row)
}

/// What leaving an item out saves: the first that was measured, of a render that follows light
/// as well if that is asked for and there is one.
pub(super) fn saving_of(item: &str, both_ends: bool) -> Option<Saving> {
    let of_item = || savings().filter(|saving| saving.item == item);
    of_item().find(|saving| (saving.integrator != "path") == both_ends).or_else(|| of_item().next())
}
