//! Smooth boundaries at the ends of their formulas.

use crate::case::Case;
use crate::cases;

pub const CASES: &[Case] = cases![];
