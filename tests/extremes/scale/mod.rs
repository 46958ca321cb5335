//! Large, small, far, flat and coincident.

mod invariance;

use crate::case::Case;
use crate::cases;

pub const CASES: &[Case] = cases![
    fixed 48 => scaling_all_lengths_by_a_power_of_two_changes_no_bit,
    fixed 49 => scaling_all_lamps_by_a_power_of_two_scales_the_picture_exactly,
    fixed 49 => twice_the_iso_at_half_the_time_develops_to_the_same_picture,
    statistical 48 => any_scale_and_unit_shows_the_same_picture,
];

use invariance::*;
