//! What a path contributes, and the subpaths that it came from.

use super::fate::BothFates;
use super::groups::Shares;
use super::vertex::Vertex;
use super::weights::Known;
use crate::geometry::SurfacePoint;
use crate::spectrum::Spectrum;

/// A complete path's estimate of what the eye records.
#[derive(Clone, Copy, Debug)]
pub struct Contribution {
    /// Vertices from the light.
    pub s: usize,
    /// Vertices from the eye.
    pub t: usize,
    /// Estimate by this strategy alone: radiance in W sr^-1 m^-2 nm^-1 times the eye's response.
    pub estimate: Spectrum,
    /// The strategy's share among those that find the path.
    pub weight: f32,
    /// Where in the picture, unless where the subpath from the eye began.
    pub position: Option<[f64; 2]>,
    /// The vertex that belongs to no subpath: of the light for s = 1, of the eye for t < 2.
    pub end: Option<End>,
    /// Probability with which the contribution was kept; the estimate is larger by its inverse.
    pub kept: f32,
    /// Which of [`Subpaths::shares`] is of this path, where they are kept.
    pub number: u32,
}

impl Contribution {
    /// What a strategy found by itself, where the subpath from the eye began.
    pub(super) const fn of_path(s: usize, t: usize, estimate: Spectrum) -> Self {
        Self { s, t, estimate, weight: 1.0, position: None, end: None, kept: 1.0, number: u32::MAX }
    }

    /// What a walk would have brought that has come upon something that is no number: it is not
    /// known, and the sample must not pass for black.
    pub(super) const fn lost(s: usize, t: usize) -> Self {
        Self::of_path(s, t, Spectrum::splat(f32::NAN))
    }
}

/// An end of a path that was found from its neighbour.
#[derive(Clone, Copy, Debug)]
pub struct End {
    /// Where it is.
    pub point: SurfacePoint,
    /// Light in the scene and primitive in the geometry, for a light.
    pub light: Option<(u32, Option<u32>)>,
}

impl End {
    pub(super) const fn of_eye(point: SurfacePoint) -> Self {
        Self { point, light: None }
    }
}
/// The two subpaths of a sample; kept between samples for its memory.
#[derive(Debug, Default)]
pub struct Subpaths {
    /// From a light on.
    pub light: Vec<Vertex>,
    /// From the eye on.
    pub eye: Vec<Vertex>,
    /// Light emitted along the first.
    pub emitted: Spectrum,
    /// Density with which the second vertex of the first would ask for its first.
    pub asked: f64,
    /// What became of all walks since this was last taken.
    pub fates: BothFates,
    /// Whether nobody looks at the subpaths after a sample: then they may stay empty, which takes
    /// less time.
    pub forgetful: bool,
    /// What other lists of strategies would make of the paths of the sample, where that is asked
    /// for: it takes time.
    pub shares: Option<Vec<Shares>>,
    pub(super) known: Vec<Known>,
    pub(super) proposals: Vec<Proposal>,
}

/// A contribution that an obstacle may still take away.
#[derive(Clone, Copy, Debug)]
pub(super) struct Proposal {
    pub(super) contribution: Contribution,
    /// What it would add to the picture, in any unit.
    pub(super) size: f32,
}

impl Subpaths {
    /// Those of samples whose contributions are all that is asked for.
    pub fn forgetful() -> Self {
        Self { forgetful: true, ..Self::default() }
    }

    /// Forgets both subpaths, but not what became of them.
    pub fn clear(&mut self) {
        self.light.clear();
        self.eye.clear();
        if let Some(shares) = &mut self.shares {
            shares.clear();
        }
    }
}
