//! Every model of a surface is held to the contract of `etalon::material` and to closed
//! forms.
//!
//! Statistical tests use fixed seeds. With seeds drawn anew, all chi-squared tests together
//! would raise a false alarm once in a thousand runs, and the few dozen comparisons of means
//! (|z| < 5) once in some ten thousand.

mod chi_squared;
mod closed_forms;
#[path = "../common/mod.rs"]
mod common;
mod conservation;
mod edges;
mod furnace;
mod support;
