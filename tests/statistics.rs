//! How often two estimates of one picture are wrongly called different, and what faults in one
//! of them are found.

use etalon::sampler::mix;
use etalon::statistics::{Agreement, MARGIN, Verdict};
use rayon::prelude::*;
use std::f64::consts::TAU;

const SIDE: usize = 16;
const PIXELS: usize = SIDE * SIDE;
const BATCHES: usize = 16;

/// Noise of one batch: what it multiplies the truth with, of mean one.
#[derive(Clone, Copy, Debug)]
enum Noise {
    /// By its standard deviation.
    Normal(f64),
    /// By its standard deviation; the skewness is three times that and more.
    LogNormal(f64),
    /// Shared by neighbours, as where paths are splatted over a picture.
    Correlated(f64),
    /// Mostly nothing; something at this chance.
    Rare(f64),
    /// Little scatter, but three times as much light on top at this chance.
    Fireflies(f64),
}

impl Noise {
    fn batch(self, numbers: &mut Numbers) -> Vec<f64> {
        if let Self::Correlated(scatter) = self {
            return correlated(scatter, numbers);
        }
        (0..PIXELS).map(|_| self.factor(numbers)).collect()
    }

    fn factor(self, numbers: &mut Numbers) -> f64 {
        let happens = |chance: f64, u: f64| f64::from(u8::from(u < chance));
        match self {
            Self::Normal(scatter) | Self::Correlated(scatter) => 1.0 + scatter * numbers.normal(),
            Self::LogNormal(scatter) => {
                let variance = (1.0 + scatter * scatter).ln();
                (variance.sqrt() * numbers.normal() - 0.5 * variance).exp()
            }
            Self::Rare(chance) => happens(chance, numbers.uniform()) / chance,
            Self::Fireflies(chance) => {
                let light = 1.0 + 0.02 * numbers.normal() + 3.0 * happens(chance, numbers.uniform());
                light / (1.0 + 3.0 * chance)
            }
        }
    }
}

/// Blobs of two pixels' radius, going around at the edges so that all pixels scatter alike.
fn correlated(scatter: f64, numbers: &mut Numbers) -> Vec<f64> {
    let side = SIDE as f64;
    let around = |distance: f64| distance.abs().min(side - distance.abs());
    let mut picture = vec![1.0; PIXELS];
    for _ in 0..40 {
        let (x, y) = (side * numbers.uniform(), side * numbers.uniform());
        let height = scatter * numbers.normal();
        for (p, value) in picture.iter_mut().enumerate() {
            let (dx, dy) = (around((p % SIDE) as f64 - x), around((p / SIDE) as f64 - y));
            *value += height * (-(dx * dx + dy * dy) / 8.0).exp();
        }
    }
    picture
}

/// Random numbers for the simulated noise.
struct Numbers(u64);

impl Numbers {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(1);
        ((mix(mix(self.0)) >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (TAU * self.uniform()).cos()
    }
}

/// A picture of a bright and a dark half with a slope across both.
fn truth() -> Vec<f64> {
    let half = |p: usize| if p / SIDE < SIDE / 2 { 1.0 } else { 0.1 };
    (0..PIXELS).map(|p| half(p) * (1.0 + (p % SIDE) as f64 / SIDE as f64)).collect()
}

fn batches(truth: &[f64], noise: Noise, seed: u64) -> Vec<Vec<f64>> {
    let mut numbers = Numbers(mix(seed));
    let batch = |_| truth.iter().zip(noise.batch(&mut numbers)).map(|(t, factor)| t * factor).collect();
    (0..BATCHES).map(batch).collect()
}

fn compared(truths: [&[f64]; 2], noises: [Noise; 2], seed: u64) -> Agreement {
    let [a, b] = [0, 1].map(|i| batches(truths[i], noises[i], 2 * seed + i as u64));
    Agreement::of(&a, &b, SIDE, SIDE, MARGIN)
}

/// How many of so many comparisons say that the pictures differ.
fn called_different(truths: [&[f64]; 2], noises: [Noise; 2], pairs: u64) -> usize {
    let differs = |seed: &u64| compared(truths, noises, *seed).verdict == Verdict::Different;
    (0..pairs).into_par_iter().filter(differs).count()
}

const PAIRS: u64 = 2000;

fn assert_hardly_ever_different(noises: [Noise; 2], most: usize) {
    let truth = truth();
    let wrong = called_different([&truth, &truth], noises, PAIRS);
    println!("{noises:?}: {wrong} of {PAIRS}");
    assert!(wrong <= most, "{noises:?}: {wrong} of {PAIRS}");
}

/// Once in a thousand times is meant; Student's distribution and the correction for skewness
/// are approximations, and up to five times is let pass. Of 2000 comparisons at that rate, more
/// than 22 are wrong once in 10 000 times.
#[test]
fn the_same_picture_is_hardly_ever_called_different() {
    for noises in [
        [Noise::Normal(0.1), Noise::Normal(0.1)],
        [Noise::Normal(0.2), Noise::Normal(0.02)],
        [Noise::LogNormal(0.2), Noise::Normal(0.02)],
        [Noise::LogNormal(0.4), Noise::Normal(0.02)],
        [Noise::LogNormal(0.3), Noise::LogNormal(0.3)],
        [Noise::LogNormal(1.0), Noise::Normal(0.02)],
        [Noise::Correlated(0.05), Noise::Correlated(0.05)],
        [Noise::Correlated(0.05), Noise::Normal(0.05)],
        [Noise::Fireflies(0.02), Noise::Normal(0.02)],
        [Noise::Fireflies(0.2), Noise::Normal(0.02)],
        [Noise::Rare(0.98), Noise::Normal(0.01)],
        [Noise::Rare(0.9), Noise::Normal(0.1)],
        [Noise::Rare(0.02), Noise::Normal(0.1)],
    ] {
        assert_hardly_ever_different(noises, 22);
    }
}

/// Light that all batches of a whole picture meet eight times, among noise of 2 %: the limit of
/// what any rule can know. Once in twenty times is let pass.
#[test]
fn light_that_is_hardly_ever_met_raises_few_alarms() {
    assert_hardly_ever_different([Noise::Fireflies(0.002), Noise::Normal(0.02)], 100);
}

/// Asserts that a planted fault is found in 99 of 100 comparisons, where a batch of a pixel
/// scatters by 2 %.
fn assert_found(what: &str, faulty: &[f64]) {
    const PAIRS: u64 = 400;
    for noises in [[Noise::Normal(0.02); 2], [Noise::LogNormal(0.02); 2]] {
        let found = called_different([faulty, &truth()], noises, PAIRS);
        println!("{what}, {noises:?}: {found} of {PAIRS}");
        assert!(found >= 396, "{what}, {noises:?}: {found} of {PAIRS}");
    }
}

#[test]
fn one_per_cent_in_one_block_is_found() {
    let mut faulty = truth();
    let in_block = |p: usize| (3..11).contains(&(p % SIDE)) && p / SIDE < 8;
    (0..PIXELS).filter(|&p| in_block(p)).for_each(|p| faulty[p] *= 1.01);
    assert_found("1 % in 8x8 pixels", &faulty);
}

#[test]
fn half_a_per_cent_overall_is_found() {
    let faulty: Vec<f64> = truth().iter().map(|t| 1.005 * t).collect();
    assert_found("0.5 % overall", &faulty);
}

/// The whole stays as bright: no test of means over the picture could tell.
#[test]
fn a_misplaced_highlight_is_found() {
    let mut faulty = truth();
    let [right, wrong] = [3 * SIDE + 4, 3 * SIDE + 10];
    for p in [0, 1, SIDE, SIDE + 1] {
        faulty[wrong + p] += 0.15 * faulty[right + p];
        faulty[right + p] *= 0.85;
    }
    assert_found("2x2 pixels of 15 % elsewhere", &faulty);
}

#[test]
fn a_fault_is_shown_where_it_is() {
    let mut faulty = truth();
    faulty[5 * SIDE + 9] *= 1.2;
    let agreement = compared([&faulty, &truth()], [Noise::Normal(0.03); 2], 1);
    assert_eq!(agreement.verdict, Verdict::Different);
    assert_eq!(agreement.levels[0].rejected, 1, "{agreement}");
    assert_eq!(agreement.levels[0].worst.map(|worst| worst.pixel), Some([9, 5]), "{agreement}");
    assert!(agreement.suspicious[5 * SIDE + 9]);
    assert!(agreement.suspicious.iter().filter(|s| **s).count() < 4, "{agreement}");
}

/// With little noise the pictures are equal; with much it is not known, and as many more
/// samples as are asked for tell nine times of ten.
#[test]
fn equality_needs_samples_enough() {
    let truth = truth();
    let verdict =
        |scatter: f64, seed: u64| compared([&truth, &truth], [Noise::Normal(scatter); 2], seed).verdict;
    let Verdict::Undecided { samples_factor } = verdict(0.1, 0) else { panic!("{:?}", verdict(0.1, 0)) };
    let enough = 0.1 / samples_factor.sqrt();
    let equal = (1..=100).filter(|&seed| verdict(enough, seed) == Verdict::Equal).count();
    assert!((75..=99).contains(&equal), "{equal} of 100 after {samples_factor} times as many samples");
    assert_eq!(verdict(0.005, 1), Verdict::Equal);
}

#[test]
fn a_black_picture_differs_from_a_lit_one_and_not_from_another() {
    let black = vec![vec![0.0; PIXELS]; BATCHES];
    let lit = batches(&truth(), Noise::Normal(0.05), 1);
    let verdict = |a: &[Vec<f64>], b: &[Vec<f64>]| Agreement::of(a, b, SIDE, SIDE, MARGIN).verdict;
    assert_eq!(verdict(&black, &black), Verdict::Equal);
    assert_eq!(verdict(&black, &lit), Verdict::Different);
    assert_eq!(verdict(&lit, &black), Verdict::Different);
}
