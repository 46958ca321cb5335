//! What becomes of a long sum.

use crate::record::Record;
use etalon::camera::Film;
use etalon::metropolis::Numbers;

const SAMPLES: u64 = 1_000_000_000;
/// Samples of a block of a film.
const BLOCK: u32 = 16;

/// The same samples added up in several ways.
#[derive(Default)]
struct Sums {
    /// Without rounding, in units of 2^-24: what the samples are multiples of.
    exact: u64,
    single: f32,
    /// With compensation (Kahan 1965).
    compensated: f32,
    lost: f32,
    /// Blocks of 1024 in single precision, these in double.
    block: f32,
    blocks: f64,
}

impl Sums {
    fn add(&mut self, number: u64, value: f32) {
        self.exact += (value * 16_777_216.0) as u64;
        self.single += value;
        let with_lost = value - self.lost;
        let sum = self.compensated + with_lost;
        self.lost = (sum - self.compensated) - with_lost;
        self.compensated = sum;
        self.block += value;
        if number % 1024 == 1023 {
            self.blocks += f64::from(std::mem::take(&mut self.block));
        }
    }
}

// Case 73.
pub fn a_billion_samples_keep_their_digits(record: &mut Record) {
    let mut numbers = Numbers::of(&[record.seed()]);
    let mut sums = Sums::default();
    let mut film = Film::new([1, 1], 1, false);
    let mut splats = Film::new([1, 1], 1, true);
    for block in 0..SAMPLES / u64::from(BLOCK) {
        let mut own = 0.0;
        for index in 0..u64::from(BLOCK) {
            let value = numbers.single();
            sums.add(block * u64::from(BLOCK) + index, value);
            own += f64::from(value);
        }
        film.add_row(0, &[own], BLOCK);
        film.finish_block(BLOCK);
        splats.add_splats(&[0], &[own]);
        splats.finish_block(BLOCK);
    }
    let truth = sums.exact as f64 / 16_777_216.0 / SAMPLES as f64;
    record.relative("mean on the film", film.mean(0, 0), truth, 1e-12);
    record.relative("mean on a film that receives splats", splats.mean(0, 0), truth, 1e-12);
    // The variance of a uniform number is 1/12; that of its estimate from 6e7 blocks is 2e-4 of it.
    let error = (SAMPLES as f64 / 12.0).sqrt() / SAMPLES as f64;
    record.relative("standard error of that mean", film.standard_error(0, 0), error, 1e-3);
    record.exactly("what single precision stalls at", sums.single, 16_777_216.0);
    let mean = |sum: f64| (sum / SAMPLES as f64 / truth - 1.0).abs();
    record.at_most("error of a compensated sum in single precision", mean(f64::from(sums.compensated)), 6e-8);
    let blocks = sums.blocks + f64::from(sums.block);
    record.at_most("error of blocks in single precision, added in double", mean(blocks), 1e-8);
}
