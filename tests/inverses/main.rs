//! Every map from random numbers gives its numbers back.
//!
//! Two claims, each with a tolerance that follows from the resolution of `f32`:
//!
//! * What is drawn from the numbers that an inverse gives lies where it should: within the
//!   rounding of what was asked for, and a few distances to what the neighbouring numbers
//!   (2^-24 away) draw. No inverse can do better, because numbers are rounded.
//! * The numbers of something drawn come back within its rounding over the least stretch of
//!   the map; where that is more than [`support::TELLING`], as at poles, the map does not tell
//!   numbers apart and nothing is claimed.
//!
//! Each test also fails when the claim is empty in too many places.

mod geometry;
mod lens;
mod light;
mod material;
mod support;
