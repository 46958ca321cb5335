//! Sums, threads, stopping and resuming.

mod faults;
mod program;
mod resuming;
mod stopping;
mod sums;
mod threads;
mod writing;

use crate::case::Case;
use crate::cases;
use faults::*;
use resuming::{
    a_damaged_checkpoint_is_refused, a_killed_run_goes_on_to_the_same_bits,
    another_run_s_checkpoint_is_refused,
};
use stopping::ending_at_an_error_does_not_bend_the_mean;
use sums::a_billion_samples_keep_their_digits;
use threads::any_number_of_threads_gives_the_same_bits;
use writing::{a_full_disk_costs_nothing_that_was_saved, a_picture_that_cannot_be_written_is_not_lost};

pub const CASES: &[Case] = cases![
    fixed 73 => a_billion_samples_keep_their_digits,
    fixed 74 => any_number_of_threads_gives_the_same_bits,
    fixed 75 => a_killed_run_goes_on_to_the_same_bits,
    fixed 75 => a_damaged_checkpoint_is_refused,
    fixed 75 => another_run_s_checkpoint_is_refused,
    fixed 75 => a_full_disk_costs_nothing_that_was_saved,
    fixed 75 => a_picture_that_cannot_be_written_is_not_lost,
    statistical 76 => ending_at_an_error_does_not_bend_the_mean,
    fixed 77 => samples_that_are_not_finite_are_counted_and_named,
    fixed 77 => the_same_name_gives_the_same_sample_bit_by_bit,
    fixed 77 => a_sum_that_overflows_fails_under_strict_and_is_replayed,
];
