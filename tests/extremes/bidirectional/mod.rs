//! Strategies of two subpaths: what none of them finds, what they share, where they spike.

mod found;
mod pictures;
mod shared;

use crate::case::Case;
use crate::cases;
use found::*;
use pictures::*;
use shared::*;

pub const CASES: &[Case] = cases![
    fixed 57 => light_that_no_strategy_finds_is_named_and_refused,
    statistical 57 => a_lamp_of_one_millimetre_in_a_mirror_lights_as_its_image_does,
    statistical 58 => weights_of_all_strategies_of_a_path_add_up_to_one,
    fixed 58 => ratios_of_ten_thousand_thirty_times_over_and_deltas_leave_weights_sound,
    statistical 59 => joints_in_a_corner_are_bounded,
    statistical 60 => a_lamp_beside_one_a_million_times_as_strong_is_not_lost,
    statistical 61 => the_border_of_the_picture_is_as_bright_as_its_middle,
    statistical 61 => a_crop_shows_what_the_picture_shows_there,
    statistical 62 => luminance_does_not_depend_on_distance,
    statistical 63 => every_two_strategies_for_paths_of_one_length_agree,
];
