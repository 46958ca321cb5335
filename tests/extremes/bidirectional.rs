//! Strategies that must agree, and paths that none can make.

use crate::case::Case;
use crate::cases;

pub const CASES: &[Case] = cases![];
