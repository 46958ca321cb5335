//! Boundaries that hardly are any, and boundaries beyond all bounds.

mod fresnel;
mod matched;
mod media;

use crate::case::Case;
use crate::cases;
use fresnel::*;
use matched::*;
use media::*;

/// The cases of this group.
pub const CASES: &[Case] = cases![
    statistical 23 => a_body_of_index_one_is_not_there,
    statistical 24 => a_rough_body_of_index_one_is_not_there,
    fixed 25 => media_that_nearly_match_reflect_what_they_should,
    fixed 26 => a_thinner_medium_reflects_totally,
    fixed 27 => glass_reflects_from_both_sides_as_one_boundary,
    fixed 28 => total_reflection_begins_where_it_should_and_never_dips,
    fixed 29 => grazing_light_still_enters,
    fixed 30 => brewsters_angle_is_where_it_should_be,
    fixed 31 => metals_of_any_extinction_reflect_what_they_should,
    fixed 32 => a_metal_without_real_index_reflects_all,
    statistical 33 => a_slab_passes_all_orders,
    statistical 34 => radiance_inside_glass_is_larger_by_the_square_of_its_index,
];
