//! Means with error bars.

mod batches;

pub use batches::{BATCHES, BatchMean};
