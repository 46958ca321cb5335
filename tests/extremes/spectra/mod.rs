//! Black bodies from cold to hot, lamps and their levels, lines, and where spectra end.

mod colour;
mod lamps;
mod lines;
mod planck;
mod range;

use crate::case::Case;
use crate::cases;
use colour::*;
use lamps::*;
use lines::*;
use planck::*;
use range::*;

/// The cases of this group.
pub const CASES: &[Case] = cases![
    fixed 1 => a_cold_black_body_is_dark_and_never_nan,
    fixed 2 => a_hot_black_body_holds_at_short_waves,
    fixed 3 => a_hot_black_body_follows_rayleigh_and_jeans_at_long_waves,
    fixed 4 => a_temperature_that_is_none_is_refused_where_it_stands,
    fixed 5 => a_black_body_radiates_what_stefan_and_boltzmann_say,
    fixed 6 => the_planckian_locus_holds_at_its_ends,
    fixed 7 => six_and_a_half_thousand_kelvin_is_not_d65,
    fixed 8 => the_observer_is_the_published_one,
    statistical 9 => a_white_surface_is_balanced_once,
    statistical 10 => lamps_of_every_shape_agree_on_their_lumens,
    statistical 11 => a_line_is_met_exactly,
    statistical 12 => lines_and_continuum_keep_their_shares,
    fixed 13 => gaps_of_a_table_are_told_with_what_fills_them,
    statistical 14 => every_wavelength_that_counts_is_drawn,
    fixed 15 => a_reflectance_is_a_spectrum_and_never_a_triple,
];
