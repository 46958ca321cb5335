//! Emission, observers and the range between them.

use crate::case::Case;
use crate::cases;

pub const CASES: &[Case] = cases![];
