//! What a sample costs, from counted work: measured seconds would make the choice, and with it the
//! picture, depend on what else the machine does.

use crate::path::{Groups, Subpaths};
use serde::Serialize;

/// What samples under all strategies took, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Samples.
    pub samples: u64,
    /// Vertices of subpaths from the eye, the eye included.
    pub eye_vertices: u64,
    /// Those that ask a light and are joined.
    pub asking: u64,
    /// Vertices of subpaths from lights.
    pub light_vertices: u64,
    /// Those that ask the eye.
    pub splatting: u64,
}

impl Counts {
    /// Notes the subpaths of a sample.
    pub fn note(&mut self, paths: &Subpaths) {
        let open = |walk: &[crate::path::Vertex]| walk.iter().skip(1).filter(|v| !v.is_mirror()).count();
        let (eye, light) = (open(&paths.eye), open(&paths.light));
        self.samples += 1;
        self.eye_vertices += paths.eye.len() as u64;
        self.asking += eye as u64;
        self.light_vertices += paths.light.len() as u64;
        self.splatting += light as u64;
    }

    /// Adds those of other samples.
    pub const fn add(&mut self, other: &Self) {
        self.samples += other.samples;
        self.eye_vertices += other.eye_vertices;
        self.asking += other.asking;
        self.light_vertices += other.light_vertices;
        self.splatting += other.splatting;
    }
}

/// Processor microseconds of a sample: a base, then for each vertex of a kind. Least squares of
/// relative residuals, by the counts of a pilot, of processor seconds per sample without loading:
/// medians of four renders on one thread, 64 pixels wide, 64 samples per pixel, of the five lists of
/// strategies on nine reference scenes (2026-11-23; off by 10 % on average, by 28 % at most: path
/// tracing of the pool, whose vertices are smooth). Whatever asking a light and weighing a pair cost was not told apart from the walks.
/// Only the ratios decide between lists of strategies.
mod us {
    /// A sample whatever it does.
    pub const SAMPLE: f64 = 0.79;
    /// A vertex of a walk, what it asks included.
    pub const VERTEX: f64 = 0.43;
    /// Part of that which path tracing by itself takes, since it keeps no vertices and weighs nothing
    /// (medians over ten reference scenes of three renders, relative to all strategies, 2026-11-23).
    pub const ALONE: f64 = 0.85;
    /// A sample whose walks from both ends are weighed against each other.
    pub const BOTH: f64 = 0.32;
    /// A vertex that asks the eye.
    pub const SPLATTING: f64 = 0.09;
    /// A vertex that is joined to those from a light.
    pub const JOINING: f64 = 0.27;
    /// A sample of which every path is weighed for every list, over one that is not.
    pub const JUDGED: f64 = 1.5;
    /// A mutation of a chain, what is learned, searched and sampled beside it included, over a
    /// sample of all strategies.
    pub const MUTATION: f64 = 0.65;
}

impl Counts {
    /// Processor seconds of a sample of the groups.
    pub fn seconds_per_sample(&self, groups: Groups) -> f64 {
        let per_sample = |is_taken: bool, us: f64, count: u64| {
            if is_taken { us * count as f64 / self.samples as f64 } else { 0.0 }
        };
        let follows_eye = groups.path || groups.joins;
        let follows_light = groups.joins || groups.splats;
        let microseconds = us::SAMPLE
            + per_sample(follows_eye, us::VERTEX, self.eye_vertices)
            + per_sample(follows_light, us::VERTEX, self.light_vertices)
            + per_sample(follows_eye && follows_light, us::BOTH, self.samples)
            + per_sample(groups.splats, us::SPLATTING, self.splatting)
            + per_sample(groups.joins, us::JOINING, self.asking);
        let part = if follows_light { 1.0 } else { us::ALONE };
        1e-6 * part * microseconds
    }

    /// Processor seconds of a sample of the pilot.
    pub fn seconds_per_pilot_sample(&self) -> f64 {
        us::JUDGED * self.seconds_per_sample(Groups::ALL)
    }

    /// Processor seconds of a mutation of a chain, what belongs to it included.
    pub fn seconds_per_mutation(&self) -> f64 {
        us::MUTATION * self.seconds_per_sample(Groups::ALL)
    }
}
