//! Numbers that a format cannot hold, and files that are wrong.

mod exposure;
mod metadata;

use crate::case::Case;
use crate::cases;
use exposure::{
    exposure_follows_its_closed_form_at_every_setting, what_is_exposed_beyond_the_model_is_warned_of,
};
use metadata::{
    a_picture_carries_all_that_it_was_made_with, a_picture_of_chains_carries_their_normalisation,
    a_picture_with_rgb_declares_the_primaries_of_srgb,
};

pub const CASES: &[Case] = cases![
    fixed 79 => exposure_follows_its_closed_form_at_every_setting,
    fixed 79 => what_is_exposed_beyond_the_model_is_warned_of,
    fixed 81 => a_picture_carries_all_that_it_was_made_with,
    fixed 81 => a_picture_with_rgb_declares_the_primaries_of_srgb,
    fixed 81 => a_picture_of_chains_carries_their_normalisation,
];
