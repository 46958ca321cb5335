//! Glass whose index is almost constant, or anything but.

use crate::case::Case;
use crate::cases;

pub const CASES: &[Case] = cases![];
