//! Samples of every specimen fall as densely as its pdf says.

use etalon::material::{Bsdf, Quantity, specimens};
use etalon::spectrum::LANES;
use glam::Vec3A;

use super::support::{viewpoints, with_hero};
use crate::common::chi_squared::{SAMPLES, Verdict, examine, tail_probability};

/// Probability of a false alarm over all cases together, were the seeds drawn anew.
const FALSE_ALARM: f64 = 1e-3;

/// Every specimen with a lobe, from every side that is not black, with two of its lanes as
/// the hero where lanes are refracted differently.
fn cases() -> Vec<(String, Bsdf, Vec3A)> {
    let mut cases = vec![];
    for (name, specimen) in specimens() {
        let dispersive = super::support::interface_of(&specimen).is_some_and(|i| !i.excess().is_flat());
        for lane in if dispersive { vec![0, LANES - 1] } else { vec![0] } {
            let bsdf = with_hero(&specimen, lane);
            for wo in viewpoints() {
                let drawn = bsdf.sample(wo, 0.5, [0.4, 0.3], Quantity::Radiance);
                if !bsdf.is_delta() && drawn.is_some_and(|s| !s.is_delta) {
                    cases.push((format!("{name}, hero {lane}, wo {wo}"), bsdf, wo));
                }
            }
        }
    }
    cases
}

#[test]
fn samples_fall_as_densely_as_the_pdf_says() {
    let cases = cases();
    assert!(cases.len() > 60, "only {} cases", cases.len());
    let level = 1.0 - (1.0 - FALSE_ALARM).powf(1.0 / cases.len() as f64);
    let mut faults = vec![];
    for (i, (name, bsdf, wo)) in cases.iter().enumerate() {
        let verdict = examine(bsdf, *wo, 1_000 + i as u64);
        let Verdict { p, chi_squared, degrees, integral, drawn } = verdict;
        // Draws of nothing are binomial; quadrature adds a rounding of its own.
        let deviation = (drawn * (1.0 - drawn) / SAMPLES as f64).sqrt();
        let normalised = (integral - drawn).abs() < 5.0 * deviation + 1e-3;
        if p.is_nan() || p < level || !normalised {
            faults.push(format!(
                "{name}: p = {p:e} (chi2 {chi_squared:.1} of {degrees}), \
                 pdf integrates to {integral:.5}, drawn {drawn:.5}"
            ));
        }
    }
    assert!(faults.is_empty(), "level {level:e}, {} cases:\n{}", cases.len(), faults.join("\n"));
}

#[test]
fn the_test_itself_knows_chi_squared() {
    // Abramowitz and Stegun, table 26.8.
    for (x, degrees, p) in [(10.827_6, 1, 0.001), (29.588_3, 10, 0.001), (124.342, 100, 0.05)] {
        let got = tail_probability(x, degrees);
        assert!((got / p - 1.0).abs() < 1e-4, "Q({x} | {degrees}) = {got}, {p}");
    }
}
