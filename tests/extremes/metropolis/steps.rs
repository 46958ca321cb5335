//! Steps on the unit interval, in the plane and on the sphere, without any scene.

use crate::record::Record;
use etalon::metropolis::{Numbers, Steps};
use glam::Vec3A;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f64::consts::TAU;

/// Smallest probability of a passing chi-squared test: a false alarm once in a thousand.
const LEAST_P: f64 = 1e-3;

const STEPS: Steps = Steps { smallest: 1e-3, largest: 0.3 };

fn p_value(chi2: f64, degrees: usize) -> f64 {
    1.0 - ChiSquared::new(degrees as f64).expect("some degrees").cdf(chi2)
}

// Case 72.
pub fn steps_round_the_ends_of_the_interval_keep_known_densities(record: &mut Record) {
    const CELLS: usize = 32;
    /// Turns between two looks: farther apart than the chain remembers.
    const APART: usize = 400;
    let looks = record.samples(20_000);
    let even = |_: f64| 1.0;
    let ramp = |u: f64| u + 0.02;
    let peak = |u: f64| (-40.0 * u.min(1.0 - u)).exp() + 0.01;
    let densities: [(&str, &dyn Fn(f64) -> f64); 3] =
        [("even", &even), ("with a jump at the end", &ramp), ("with a peak across the end", &peak)];
    for (name, density) in densities {
        let mut numbers = Numbers::of(&[record.seed(), 11]);
        let mut at = 0.5_f32;
        let mut counts = [0.0; CELLS];
        for _ in 0..looks {
            for _ in 0..APART {
                let to = STEPS.along_unit(at, &mut numbers);
                if numbers.fine() < density(f64::from(to)) / density(f64::from(at)) {
                    at = to;
                }
            }
            counts[(at * CELLS as f32) as usize] += 1.0;
        }
        let mass = |cell: usize| -> f64 {
            (0..1000).map(|i| density((cell as f64 + (f64::from(i) + 0.5) / 1000.0) / CELLS as f64)).sum()
        };
        let all: f64 = (0..CELLS).map(mass).sum();
        let term = |(cell, count): (usize, &f64)| {
            let expected = looks as f64 * mass(cell) / all;
            (count - expected).powi(2) / expected
        };
        let p = p_value(counts.iter().enumerate().map(term).sum(), CELLS - 1);
        record.at_least(format!("a density {name}: p of chi-squared over {CELLS} cells"), p, LEAST_P);
    }
}

// Case 72.
pub fn steps_lead_there_as_often_as_back(record: &mut Record) {
    let uniform = |n: &mut Numbers| {
        let z = 2.0 * n.fine() - 1.0;
        let (sin, cos) = (TAU * n.fine()).sin_cos();
        let across = (1.0 - z * z).sqrt();
        glam::DVec3::new(across * cos, across * sin, z).as_vec3a()
    };
    let octant = |w: Vec3A| {
        let third = |v: f32| ((v + 1.0) * 1.499) as usize;
        third(w.x) * 9 + third(w.y) * 3 + third(w.z)
    };
    let plane =
        |[x, y]: [f64; 2]| ((x * 4.0).rem_euclid(4.0) as usize) * 4 + (y * 4.0).rem_euclid(4.0) as usize;
    symmetric(record, "circle", |n| n.single(), |u, n| STEPS.along_unit(u, n), |u| (u * 16.0) as usize);
    symmetric(record, "plane", |n| [n.fine(), n.fine()], |p, n| STEPS.in_plane(p, n), plane);
    symmetric(record, "sphere", uniform, |w, n| STEPS.on_sphere(w, n), octant);
}

/// As many steps lead from one cell to another as back, from evenly spread starts.
fn symmetric<T: Copy>(
    record: &mut Record,
    name: &str,
    start: impl Fn(&mut Numbers) -> T,
    step: impl Fn(T, &mut Numbers) -> T,
    cell: impl Fn(T) -> usize,
) {
    let mut numbers = Numbers::of(&[record.seed(), 12]);
    let mut pairs = std::collections::BTreeMap::new();
    for _ in 0..record.samples(400_000) {
        let from = start(&mut numbers);
        let to = step(from, &mut numbers);
        *pairs.entry((cell(from), cell(to))).or_insert(0.0) += 1.0;
    }
    let (mut chi2, mut degrees) = (0.0, 0);
    for (&(a, b), &there) in pairs.iter().filter(|((a, b), _)| a < b) {
        let back: f64 = pairs.get(&(b, a)).copied().unwrap_or(0.0);
        if there + back >= 20.0 {
            chi2 += (there - back).powi(2) / (there + back);
            degrees += 1;
        }
    }
    record.at_least(
        format!("{name}: p of chi-squared over {degrees} pairs of cells"),
        p_value(chi2, degrees),
        LEAST_P,
    );
}
