//! Sums, threads, stopping and resuming.

#[path = "faults.rs"]
mod faults;

use crate::case::Case;
use crate::cases;
use faults::*;

pub const CASES: &[Case] = cases![
    fixed 77 => samples_that_are_not_finite_are_counted_and_named,
    fixed 77 => the_same_name_gives_the_same_sample_bit_by_bit,
    fixed 77 => a_sum_that_overflows_fails_under_strict_and_is_replayed,
];
