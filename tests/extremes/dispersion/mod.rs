//! Glass whose index depends on the wavelength: formulas at their ends, and what becomes of the
//! wavelengths of a path.

mod formulas;
mod prisms;
mod slopes;

use crate::case::Case;
use crate::cases;
use crate::record::Record;
use etalon::statistics::BatchMean;
use formulas::*;
use prisms::*;
use slopes::*;

/// The cases of this group.
pub const CASES: &[Case] = cases![
    statistical 16 => glass_without_dispersion_keeps_all_wavelengths,
    statistical 17 => a_trace_of_dispersion_changes_no_mean,
    fixed 18 => poles_of_a_formula_are_refused,
    fixed 19 => a_formula_beyond_its_range_is_refused,
    statistical 20 => a_prism_deviates_as_its_glass_demands,
    statistical 21 => dispersion_moves_light_and_takes_none,
    statistical 22 => wavelengths_are_dropped_once_on_both_sides_of_a_joint,
];

/// Two means of independent runs that are to be the same: |z| < 4, a false alarm once in 16 000,
/// at a noise below `most_noise` of the second.
pub fn same_within_four(record: &mut Record, what: &str, one: BatchMean, other: BatchMean, most_noise: f64) {
    let error = one.standard_error.hypot(other.standard_error);
    record.at_most(format!("{what}: |z|"), ((one.mean - other.mean) / error).abs(), 4.0);
    record.at_most(format!("{what}: noise of the difference"), error / other.mean.abs(), most_noise);
}
