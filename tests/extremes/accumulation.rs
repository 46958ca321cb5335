//! Sums, threads, stopping and resuming.

use crate::case::Case;
use crate::cases;

pub const CASES: &[Case] = cases![];
