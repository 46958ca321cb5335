//! Mutations: how one path becomes another, and how likely each way is.
//!
//! Each proposes a path and gives the logarithm of
//! f(y) T(y -> x) / (f(x) T(x -> y)), the ratio that decides whether it is accepted
//! (Metropolis et al. 1953, Hastings 1970). T is computed exactly, from the vertices of both
//! paths alone. Where the path changes its kind on a way that keeps it, or nothing is met, the
//! proposal is void.

mod bidirectional;
mod fresh;
mod lens_subpath;
mod moved;
mod primary;
mod wavelength;

use super::grow::Draft;
use super::numbers::{Numbers, Steps};
use super::path::Path;
use super::world::World;
use crate::path::Kind;
use crate::replay::{ChainPath, Faults, SampleName, name_vertices};

/// The ways to change a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Mutation {
    /// A path that has nothing to do with the one before; what these find gives the level of
    /// the picture.
    Fresh,
    /// A stretch of the path is cut out and another put in (Veach and Guibas 1997).
    Bidirectional,
    /// The stretch from the eye to the first matte vertex is drawn anew.
    LensSubpath,
    /// The ray from the eye moves a little and follows its mirrors.
    Lens,
    /// A ray from a matte vertex or a light turns a little, and follows its mirrors to a vertex
    /// that the eye sees.
    Caustic,
    /// As `Lens`, through further chains of mirrors, with a little turn before each.
    MultiChain,
    /// Another wavelength on the same path, or on the one that it refracts to.
    Wavelength,
    /// The numbers that a strategy makes the path from move a little (Kelemen et al. 2002;
    /// Hachisuka et al. 2014).
    Primary,
}

impl Mutation {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Fresh,
        Self::Bidirectional,
        Self::LensSubpath,
        Self::Lens,
        Self::Caustic,
        Self::MultiChain,
        Self::Wavelength,
        Self::Primary,
    ];

    /// What reports call it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fresh => "fresh path",
            Self::Bidirectional => "bidirectional",
            Self::LensSubpath => "lens subpath",
            Self::Lens => "lens",
            Self::Caustic => "caustic",
            Self::MultiChain => "multi-chain",
            Self::Wavelength => "wavelength",
            Self::Primary => "primary sample",
        }
    }

    /// Whether a path is of the kind that this changes.
    pub fn applies(self, path: &Path) -> bool {
        let last = path.count() - 1;
        // The first vertex from the eye, and from there on, that is no mirror.
        let seen = (1..last).rev().find(|index| !path.is_delta(*index));
        let met = matches!(path.nodes[0].kind, Kind::Light { primitive: Some(_), .. });
        match self {
            Self::Fresh | Self::Bidirectional | Self::Primary | Self::Wavelength => true,
            // A fresh walk stops where something can be joined, also where this path did not.
            Self::LensSubpath => seen.is_some_and(|seen| {
                !path.is_delta(seen - 1) && (seen + 1..last).all(|index| path.nodes[index].is_mirror())
            }),
            Self::Lens => seen.is_some_and(|seen| !path.is_delta(seen - 1)),
            Self::MultiChain => seen.is_some_and(|seen| {
                path.is_delta(seen - 1) && (met || moved::joint_beyond(path, seen).is_some())
            }),
            Self::Caustic => last > 2 && !path.is_delta(last - 1) && path.is_delta(last - 2),
        }
    }
}

/// What mutations work with.
pub struct Mutator<'w, 'a> {
    /// What the paths are in.
    pub world: &'w World<'a>,
    /// Vertices while they are being found.
    pub draft: Draft,
    /// How far rays move in the picture, in pixels.
    pub in_picture: Steps,
    /// Which chain this is of how many, whose positions in the picture are stratified.
    pub place: Place,
    /// Paths whose worth was not a number; they count as void.
    pub faults: Faults,
    /// What made them, by the name that is kept with them.
    pub origin: Origin,
}

/// Where paths come from.
#[derive(Clone, Copy, Debug, Default)]
pub struct Origin {
    /// Seed of the run.
    pub seed: u64,
    /// Block of chains; `None` before the first one.
    pub block: Option<u64>,
    /// Chain in its block; `None` for a search.
    pub chain: Option<u32>,
    /// Paths made so far.
    pub number: u64,
}

/// A chain among others.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Names the run and the block of chains.
    pub key: u64,
    /// Number of the chain in its block.
    pub chain: u32,
    /// Bits of the number of chains in the block.
    pub bits: u32,
    /// Positions drawn so far.
    pub drawn: u64,
}

/// How far directions turn, in radians.
const TURNS: Steps = Steps { smallest: 1e-5, largest: 0.1 };
/// How far primary numbers and the number of the wavelengths move.
const PRIMARY_STEPS: Steps = Steps { smallest: 1.0 / 16_384.0, largest: 1.0 / 16.0 };
/// Smallest move in the picture, in pixels, and largest as a share of its diagonal.
const SMALLEST_MOVE_PX: f64 = 0.1;
const LARGEST_MOVE: f64 = 0.05;

impl<'w, 'a> Mutator<'w, 'a> {
    /// The mutations of one chain.
    pub fn new(world: &'w World<'a>, place: Place) -> Self {
        let [width, height] = world.resolution.map(f64::from);
        let largest = (LARGEST_MOVE * width.hypot(height)).max(2.0 * SMALLEST_MOVE_PX);
        let in_picture = Steps { smallest: SMALLEST_MOVE_PX, largest };
        Self {
            world,
            draft: Draft::default(),
            in_picture,
            place,
            faults: Faults::default(),
            origin: Origin::default(),
        }
    }

    /// Proposes a path from another one: the logarithm of the acceptance ratio; `None` where
    /// the proposal is void. The proposed path is judged.
    pub fn propose(
        &mut self,
        mutation: Mutation,
        x: &Path,
        y: &mut Path,
        numbers: &mut Numbers,
    ) -> Option<f64> {
        let ratio = match mutation {
            Mutation::Fresh => self.fresh(y, numbers).map(|()| y.ln_estimate() - x.ln_estimate()),
            Mutation::Bidirectional => self.bidirectional(x, y, numbers),
            Mutation::LensSubpath => self.lens_subpath(x, y, numbers),
            Mutation::Lens | Mutation::MultiChain => self.lens(x, y, numbers),
            Mutation::Caustic => self.caustic(x, y, numbers),
            Mutation::Wavelength => self.wavelength(x, y, numbers),
            Mutation::Primary => self.primary(x, y, numbers),
        };
        self.origin.number += 1;
        self.note_fault(mutation, y, ratio.is_some_and(f64::is_nan));
        ratio.filter(|ratio| !ratio.is_nan())
    }

    /// Names a path whose worth was not a number.
    pub fn note_fault(&mut self, mutation: Mutation, path: &mut Path, is_fault: bool) {
        if path.take_fault() || is_fault {
            let Origin { seed, block, chain, number } = self.origin;
            let is_somewhere = path.position.iter().all(|p| p.is_finite());
            self.faults.note(1, || {
                SampleName::Chain(ChainPath {
                    mutation: mutation.name().to_owned(),
                    seed,
                    block,
                    chain,
                    number,
                    pixel: is_somewhere.then(|| {
                        let pixel = self.world.pixel(path.position);
                        [pixel % self.world.resolution[0], pixel / self.world.resolution[0]]
                    }),
                    wavelength_bits: path.u_wavelength.to_bits(),
                    vertices: name_vertices(&path.nodes),
                })
            });
        }
    }
}
