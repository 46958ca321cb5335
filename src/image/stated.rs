//! What a render's facts state of its error and of its cost, as another program reads them.
//!
//! Every key may be missing: files of earlier versions have fewer. What is there must fit the
//! picture.

use crate::error::{Error, Result};
use crate::integrator::block_size;
use crate::statistics::CellErrors;
use serde::Deserialize;

/// Blocks of chains of which a file does not state the number.
const BLOCKS_OF_CHAINS: u64 = 16;

/// The part of the facts that pictures are compared by.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Stated {
    /// Units of the channels.
    pub units: Option<String>,
    /// Hash of the scene.
    pub scene_hash: Option<String>,
    /// Seed of the random numbers.
    pub seed: Option<u64>,
    /// Samples in every pixel.
    pub samples_per_pixel: Option<u64>,
    /// Algorithm.
    pub integrator: Option<String>,
    /// Wall-clock seconds of rendering.
    pub seconds: Option<f64>,
    /// Processor seconds of the run.
    pub cpu_seconds: Option<f64>,
    /// Seconds by part of the run.
    pub times: Option<Times>,
    error: Option<StatedError>,
    luminance_cells: Option<StatedCells>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
struct StatedError {
    blocks: Option<f64>,
    correlated: Option<bool>,
}

#[derive(Clone, Debug, Deserialize)]
struct StatedCells {
    levels: Vec<StatedLevel>,
}

#[derive(Clone, Debug, Deserialize)]
struct StatedLevel {
    cell_px: usize,
    columns: usize,
    rows: usize,
    stderr: Vec<Option<f64>>,
}

/// What the parts of a run took.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Times {
    /// Reading and building the scene.
    pub load: Option<Spent>,
    /// Samples to choose an algorithm by.
    pub pilot: Option<Spent>,
    /// What chains need before their first block.
    pub bootstrap: Option<Spent>,
    /// The blocks.
    pub render: Option<Spent>,
}

/// Seconds of a part of a run.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Spent {
    /// By the clock.
    pub wall_s: Option<f64>,
    /// Of processors.
    pub cpu_s: Option<f64>,
}

impl Stated {
    /// From the JSON of the attribute.
    pub fn of_json(json: &str) -> Result<Self> {
        serde_json::from_str(json).map_err(|e| {
            let what = e.to_string();
            let what = what.split(" at line").next().unwrap_or_default();
            Error::new(format!("its attribute \"etalon\" cannot be read ({what})"))
                .hint("render the scene again with this version")
        })
    }

    /// Whether X, Y and Z are in cd/m2.
    pub fn is_in_cd_m2(&self) -> bool {
        self.units.as_ref().is_some_and(|units| units.starts_with("X, Y, Z in cd/m2"))
    }

    /// Whether pixels are known to be independent: those that only their own samples made.
    pub fn is_independent(&self) -> bool {
        let by_integrator = self.integrator.as_deref() == Some("path");
        self.error.as_ref().and_then(|error| error.correlated).map_or(by_integrator, |correlated| !correlated)
    }

    /// Blocks behind the standard errors, and whether they are stated; `None`: one alone, or
    /// nothing to tell by.
    pub fn blocks(&self) -> Option<(f64, bool)> {
        if let Some(blocks) = self.error.as_ref().and_then(|error| error.blocks) {
            return (blocks >= 2.0).then_some((blocks, true));
        }
        let spp = self.samples_per_pixel?;
        let blocks = match self.integrator.as_deref()? {
            "mlt" => BLOCKS_OF_CHAINS.min(spp),
            _ => spp.div_ceil(u64::from(block_size(spp))),
        };
        (blocks >= 2).then_some((blocks as f64, false))
    }

    /// Standard errors of cells of a picture of this size.
    ///
    /// # Errors
    /// Levels that do not fit the picture.
    pub fn cells(&self, size: [usize; 2]) -> Result<Vec<CellErrors>> {
        let Some(stated) = &self.luminance_cells else { return Ok(Vec::new()) };
        let level = |level: &StatedLevel| {
            let StatedLevel { cell_px, columns, rows, stderr } = level;
            let is_right = *cell_px > 0
                && [*columns, *rows] == size.map(|side| side.div_ceil((*cell_px).max(1)))
                && Some(stderr.len()) == columns.checked_mul(*rows);
            if !is_right {
                return Err(Error::new(format!(
                    "its luminance_cells of {cell_px} px do not fit {} x {} pixels",
                    size[0], size[1]
                ))
                .hint("render the scene again with this version"));
            }
            let standard_error = stderr.iter().map(|error| error.unwrap_or(f64::NAN)).collect();
            Ok(CellErrors { grid: [*columns, *rows], cell_px: *cell_px, standard_error })
        };
        stated.levels.iter().map(level).collect()
    }

    /// Seconds by the clock and of processors that `factor` times as many samples would take, where
    /// the run says: all parts but that of the blocks take what they took.
    pub fn seconds_of(&self, factor: f64) -> [Option<f64>; 2] {
        let part = |pick: fn(&Spent) -> Option<f64>| {
            let times = self.times.as_ref()?;
            let before = [times.load, times.pilot, times.bootstrap];
            let fixed: f64 = before.iter().flatten().filter_map(pick).sum();
            Some(fixed + factor * pick(times.render.as_ref()?)?)
        };
        [
            part(|spent| spent.wall_s).or(self.seconds.map(|seconds| factor * seconds)),
            part(|spent| spent.cpu_s).or(self.cpu_seconds.map(|seconds| factor * seconds)),
        ]
    }
}
