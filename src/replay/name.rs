//! The name of a sample: all that is needed to take it again, in numbers that every format keeps.
//!
//! Random numbers are named by what they decide, not by their place in a queue, so a sample is
//! made again from its seed, its pixel or meter, its block and its index, whatever came before.
//! The state of a chain is not: of its paths the vertices are kept, bit by bit.

use serde::{Deserialize, Serialize};

/// Samples of a render that are kept by name; of further ones only the number is.
pub const MOST_NAMES: usize = 64;

/// What a sample can be taken again by.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SampleName {
    /// An independent sample of a pixel.
    Pixel(PixelSample),
    /// A sample of a meter.
    Meter(MeterSample),
    /// A path that a chain proposed, or that was found in search of where chains start.
    Chain(ChainPath),
}

/// An independent sample of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PixelSample {
    /// Column and row from the top left.
    pub pixel: [u32; 2],
    /// Seed of the random numbers; of direct light beside chains another one than the run's.
    pub seed: u64,
    /// Number of the block.
    pub block: u32,
    /// Samples in the block.
    pub block_size: u32,
    /// Number of the sample in its block.
    pub index: u32,
    /// Whether it is of the direct light beside chains of paths.
    #[serde(default)]
    pub direct_light: bool,
}

/// A sample of a meter.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MeterSample {
    /// Name of the meter.
    pub meter: String,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Number of the batch.
    pub block: u32,
    /// Samples in the batch.
    pub block_size: u32,
    /// Number of the sample in its batch.
    pub index: u32,
}

/// A path of a chain or of a search, by its vertices.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChainPath {
    /// How it was made.
    pub mutation: String,
    /// Seed of the run.
    pub seed: u64,
    /// Block of chains; `None` where it was made before the first one.
    pub block: Option<u64>,
    /// Chain in its block; `None` for a search.
    pub chain: Option<u32>,
    /// Mutation in the chain, or path of the search.
    pub number: u64,
    /// Where in the picture it ends, if that is known.
    pub pixel: Option<[u32; 2]>,
    /// The number that its wavelengths were drawn with, as bits.
    pub wavelength_bits: u32,
    /// The vertices from the light to the eye.
    pub vertices: Vec<ChainVertex>,
}

/// A vertex of a chain's path.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChainVertex {
    /// What is there.
    pub at: Place,
    /// Whether the path goes on from here by a Dirac delta.
    pub is_delta: bool,
    /// Position, its error and the normal in scene units, and for a surface tangent, bitangent
    /// and normal of its shading frame: 9 or 18 numbers, as bits.
    pub bits: Vec<u32>,
}

/// What a vertex is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// The eye.
    Eye {
        /// Whether light can meet it.
        has_area: bool,
    },
    /// A point of a light.
    Light {
        /// Number of the light.
        light: u32,
        /// Primitive in the geometry; `None` for a point light.
        primitive: Option<u32>,
    },
    /// A surface.
    Surface {
        /// Number of the object.
        object: u32,
        /// Primitive in the geometry.
        primitive: u32,
    },
}

impl SampleName {
    /// Where in the picture the sample was drawn, if that is known.
    pub fn pixel(&self) -> Option<[u32; 2]> {
        match self {
            Self::Pixel(sample) => Some(sample.pixel),
            Self::Meter(_) => None,
            Self::Chain(path) => path.pixel,
        }
    }
}

impl std::fmt::Display for SampleName {
    /// On one line.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Pixel(PixelSample { pixel: [x, y], seed, block, block_size, index, direct_light }) => {
                write!(
                    f,
                    "pixel {x},{y}, seed {seed}, block {block} of {block_size} samples, index {index}"
                )?;
                if *direct_light { write!(f, ", direct light") } else { Ok(()) }
            }
            Self::Meter(MeterSample { meter, seed, block, block_size, index }) => {
                write!(f, "meter {meter}, seed {seed}, block {block} of {block_size} samples, index {index}")
            }
            Self::Chain(ChainPath { mutation, seed, block, chain, number, pixel, vertices, .. }) => {
                write!(f, "{mutation} {number}")?;
                if let Some(chain) = chain {
                    write!(f, " of chain {chain}")?;
                }
                if let Some(block) = block {
                    write!(f, " in block {block}")?;
                }
                if let Some([x, y]) = pixel {
                    write!(f, ", pixel {x},{y}")?;
                }
                write!(f, ", seed {seed}, {} vertices", vertices.len())
            }
        }
    }
}

/// Samples that were not finite: how many, and the first of them by name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Faults {
    /// Contributions and sums that were not finite; each counts as zero.
    pub count: u64,
    /// The first samples that they belong to, at most [`MOST_NAMES`].
    pub named: Vec<SampleName>,
}

impl Faults {
    /// Adds those of another part of the render, in order.
    pub fn merge(&mut self, other: Self) {
        self.count += other.count;
        let left = MOST_NAMES - self.named.len().min(MOST_NAMES);
        self.named.extend(other.named.into_iter().take(left));
    }

    /// Notes so many faults of one sample.
    pub fn note(&mut self, count: u64, name: impl FnOnce() -> SampleName) {
        self.count += count;
        if count > 0 && self.named.len() < MOST_NAMES {
            self.named.push(name());
        }
    }
}
