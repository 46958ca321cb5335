//! Long and short paths: walls that keep nearly everything or nothing, roulette, glass that
//! traps light.

mod closed;
mod furnace;
mod glass;
mod roulette;

use crate::case::Case;
use crate::cases;
use closed::*;
use furnace::*;
use glass::*;
use roulette::*;

pub const CASES: &[Case] = cases![
    fixed 40 => light_between_lossless_walls_is_cut_off_and_said,
    fixed 40 => a_little_loss_is_no_divergence,
    statistical 41 => high_albedo_multiplies_light_without_a_limit,
    statistical 41 => a_finite_depth_prints_what_it_truncates,
    fixed 42 => black_walls_give_exact_zeros,
    statistical 43 => roulette_changes_no_mean,
    fixed 43 => roulette_never_ends_what_is_heavy,
    statistical 44 => trapped_light_ends_and_is_reported,
    statistical 44 => absorbing_glass_keeps_its_closed_form_share,
    statistical 45 => glass_around_a_lamp_passes_all_its_light,
    statistical 46 => an_integrating_sphere_multiplies_its_lamp,
];
