//! Metropolis light transport: chains of paths, each a mutation of the one before, that spend
//! their time where the light is (Veach and Guibas 1997).
//!
//! The state of a chain is a complete path with its wavelengths ([`Path`]). Mutations of both
//! families work on it side by side: those of path space, whose transition probabilities follow
//! from the vertices, and the multiplexed primary-sample kind, which finds the numbers that a
//! strategy makes the path from by inverting its samplers ([`Mutation`]).
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

pub use mutation::{Mutation, Mutator, Place};
pub use node::Node;
pub use normalisation::Estimates;
pub use numbers::{Numbers, Steps};
pub use path::Path;
pub use render::{Outcome, render};
pub use report::{MutationRow, Report};
pub use world::World;
