//! Rough boundaries from polished to fully rough.

use crate::case::Case;
use crate::cases;

pub const CASES: &[Case] = cases![];
