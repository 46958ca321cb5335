//! Large, small, far, flat and coincident.

use crate::case::Case;
use crate::cases;

pub const CASES: &[Case] = cases![];
