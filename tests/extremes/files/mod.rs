//! Numbers that a format cannot hold, and files that are wrong.

mod exposure;
mod metadata;
mod mistakes;

use crate::case::Case;
use crate::cases;
use exposure::{
    exposure_follows_its_closed_form_at_every_setting, what_is_exposed_beyond_the_model_is_warned_of,
};
use metadata::{
    a_picture_carries_all_that_it_was_made_with, a_picture_of_chains_carries_their_normalisation,
    a_picture_with_rgb_declares_the_primaries_of_srgb,
};
use mistakes::{
    a_mistake_in_a_file_is_named_with_its_line_within_a_second,
    every_fixture_of_a_mistake_is_refused_in_one_line,
    luminances_beyond_the_range_of_half_precision_survive_the_file,
    normals_that_are_not_of_unit_length_count_by_their_direction,
};

pub const CASES: &[Case] = cases![
    statistical 78 => luminances_beyond_the_range_of_half_precision_survive_the_file,
    fixed 79 => exposure_follows_its_closed_form_at_every_setting,
    fixed 79 => what_is_exposed_beyond_the_model_is_warned_of,
    fixed 80 => a_mistake_in_a_file_is_named_with_its_line_within_a_second,
    fixed 80 => every_fixture_of_a_mistake_is_refused_in_one_line,
    fixed 80 => normals_that_are_not_of_unit_length_count_by_their_direction,
    fixed 81 => a_picture_carries_all_that_it_was_made_with,
    fixed 81 => a_picture_with_rgb_declares_the_primaries_of_srgb,
    fixed 81 => a_picture_of_chains_carries_their_normalisation,
];
