//! Numbers that a format cannot hold, and files that are wrong.

use crate::case::Case;
use crate::cases;

pub const CASES: &[Case] = cases![];
