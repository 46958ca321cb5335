//! One sample taken again, and looked at vertex by vertex.
//!
//! A sample that is not finite counts as zero, which biases its pixel by an amount that nobody
//! knows: it is never hidden, but counted, named ([`SampleName`]) and kept with the picture. By
//! its name the same sample is taken again, bit by bit, with every vertex and every strategy.

mod chain;
mod name;
mod sample;
mod text;

pub(crate) use chain::name_vertices;
pub use chain::{ReplayedPath, replay_path};
pub use name::{ChainPath, ChainVertex, Faults, MOST_NAMES, MeterSample, PixelSample, Place, SampleName};
pub use sample::{Replayed, replay_meter, replay_pixel};
pub use text::{explain, explain_path};
