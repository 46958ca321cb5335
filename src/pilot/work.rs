//! What a sample costs, from counted work: measured seconds would make the choice, and with it the
//! picture, depend on what else the machine does.

use crate::path::{Groups, Subpaths};
use serde::Serialize;

/// Light vertices that a vertex from the eye is joined to at most.
const JOINED: usize = 9;

/// What samples under all strategies took, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Samples.
    pub samples: u64,
    /// Vertices of subpaths from the eye, the eye included.
    pub eye_vertices: u64,
    /// Those that ask a light.
    pub asking: u64,
    /// Vertices of subpaths from lights.
    pub light_vertices: u64,
    /// Those that ask the eye.
    pub splatting: u64,
    /// Pairs of vertices that are joined.
    pub pairs: u64,
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
        self.pairs += (eye * light.min(JOINED)) as u64;
    }

    /// Adds those of other samples.
    pub const fn add(&mut self, other: &Self) {
        self.samples += other.samples;
        self.eye_vertices += other.eye_vertices;
        self.asking += other.asking;
        self.light_vertices += other.light_vertices;
        self.splatting += other.splatting;
        self.pairs += other.pairs;
    }
}

/// Processor microseconds of a sample: a base, then for each vertex or pair of a kind. Least
/// squares over the reference scenes on the developer's machine (`tools/auto.py --calibrate`).
/// Only their ratios decide between lists of strategies.
mod us {
    /// A sample whatever it does.
    pub const SAMPLE: f64 = 0.25;
    /// A vertex from the eye in path tracing.
    pub const EYE: f64 = 0.25;
    /// A vertex that asks a light.
    pub const ASKING: f64 = 0.25;
    /// More for each vertex from the eye where densities from both ends are kept.
    pub const BOTH: f64 = 0.10;
    /// A vertex from a light.
    pub const LIGHT: f64 = 0.25;
    /// A vertex that asks the eye.
    pub const SPLATTING: f64 = 0.25;
    /// A pair of vertices.
    pub const PAIR: f64 = 0.10;
    /// Looking along one of the pairs.
    pub const JOINING: f64 = 0.15;
    /// What a sample takes more where every path is weighed for every list.
    pub const JUDGED: f64 = 2.0;
    /// A mutation, over a sample of all strategies.
    pub const MUTATION: f64 = 0.7;
}

impl Counts {
    /// Processor seconds of a sample of the groups.
    pub fn seconds_per_sample(&self, groups: Groups) -> f64 {
        let per_sample = |count: u64| count as f64 / self.samples as f64;
        let [eye, asking, light, splatting, pairs] =
            [self.eye_vertices, self.asking, self.light_vertices, self.splatting, self.pairs].map(per_sample);
        let follows_eye = groups.path || groups.joins;
        let follows_light = groups.joins || groups.splats;
        let term = |on: bool, value: f64| if on { value } else { 0.0 };
        let microseconds = us::SAMPLE
            + term(follows_eye, us::EYE * eye)
            + term(groups.path, us::ASKING * asking)
            + term(follows_eye && follows_light, us::BOTH * eye)
            + term(follows_light, us::LIGHT * light)
            + term(groups.splats, us::SPLATTING * splatting)
            + term(groups.joins, us::PAIR * pairs + us::JOINING * asking);
        1e-6 * microseconds
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
