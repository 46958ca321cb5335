//! Paths that never end, and paths that end at once.

use crate::case::Case;
use crate::cases;

pub const CASES: &[Case] = cases![];
