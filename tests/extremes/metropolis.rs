//! Chains that start badly, stick or wrap around.

use crate::case::Case;
use crate::cases;

pub const CASES: &[Case] = cases![];
