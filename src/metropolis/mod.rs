//! Metropolis light transport: chains of paths, each a mutation of the one before, that spend
//! their time where the light is (Veach and Guibas 1997).
//!
//! The state of a chain is a complete path with its wavelengths ([`Path`]). Mutations of both
//! families work on it side by side: those of path space, whose transition probabilities follow
//! from the vertices, and the multiplexed primary-sample kind, which finds the numbers that a
//! strategy makes the path from by inverting its samplers ([`Mutation`]).
//!
//! Neither family is best everywhere, and which one is cannot be told from the scene. Relative mean
//! squared error times processor seconds, over that of the mix (`reference/`, 48 x 36 pixels,
//! 700 mutations per pixel, 8 seeds, 2026-11-22; one measurement, the pool's figures uncertain by half):
//!
//! | mutations | door ajar | bulb in glass | pool |
//! |---|---|---|---|
//! | of path space alone | 0.86 | 1.3 | 1.8 |
//! | of primary samples alone | 5.9 | 0.89 | 2.6 |
//!
//! Fresh paths are among all three. So chains mix both: within a fifth of the better one where
//! they differ most, and ahead of either where both have a part.
//!
//! What is right about the picture does not rest on the chains alone. Its level is the mean of
//! what independent fresh paths estimate, kept over the whole run with a 95 % interval
//! ([`Estimates`]); direct light is left to standard sampling; chains start from many
//! fresh paths in proportion to what these count, run in blocks that share nothing,
//! and the scatter of the blocks is the error of each pixel.

mod chain;
mod film;
mod grow;
mod judge;
mod lengths;
mod mutation;
mod node;
mod normalisation;
mod numbers;
mod path;
mod render;
mod report;
mod start;
mod world;

pub use chain::acceptance_of;
pub use mutation::{Mutation, Mutator, Origin, Place};
pub use node::Node;
pub use normalisation::Estimates;
pub use numbers::{Numbers, Steps};
pub use path::Path;
pub(crate) use render::{AtPixel, Chains, Learned, go_on, short_run};
pub use render::{Outcome, render};
pub use report::{MutationRow, Report};
pub use world::World;
