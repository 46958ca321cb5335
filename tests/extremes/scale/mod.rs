//! Large, small, far, flat and coincident.

mod geometry;
mod glass;
mod invariance;
mod lamps;

use crate::case::Case;
use crate::cases;
use geometry::*;
use glass::*;
use invariance::*;
use lamps::*;

pub const CASES: &[Case] = cases![
    fixed 47 => a_tiny_lamp_far_away_lights_by_the_solid_angle_it_fills,
    fixed 48 => scaling_all_lengths_by_a_power_of_two_changes_no_bit,
    statistical 48 => any_scale_and_unit_shows_the_same_picture,
    fixed 49 => scaling_all_lamps_by_a_power_of_two_scales_the_picture_exactly,
    fixed 49 => twice_the_iso_at_half_the_time_develops_to_the_same_picture,
    statistical 50 => spheres_a_hair_apart_are_both_found,
    statistical 50 => shadow_rays_from_a_plane_never_meet_it,
    fixed 50 => a_scene_far_from_its_origin_says_what_it_loses,
    fixed 51 => emissive_triangles_without_area_are_dropped_and_counted,
    statistical 52 => a_closed_box_of_slivers_leaks_no_ray,
    fixed 53 => of_coincident_faces_the_first_is_met_whatever_the_tree,
    fixed 54 => a_mirrored_lamp_shines_from_the_same_side,
    fixed 55 => nested_glass_is_told_from_glass_that_overlaps,
    statistical 55 => a_lamp_and_a_camera_in_glass_know_what_they_are_in,
    statistical 56 => a_square_lamp_lights_by_its_form_factor,
];
