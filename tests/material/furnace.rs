//! Rough surfaces in a white furnace, against an independent quadrature over facets.

use etalon::material::{Bsdf, Interface, Quantity};
use etalon::spectrum::Spectrum;

use crate::common::facets::{albedo, drawn, textbook_fresnel, white};

/// Draws of each mean, and the seed of their numbers.
const SAMPLES: u64 = 400_000;
const SEED: u64 = 77;

#[test]
fn rough_glass_keeps_what_quadrature_says() {
    for (alpha, mu, eta) in [
        (0.1, 0.8, 1.5),
        (0.5, 1.0, 1.5),
        (0.5, 0.3, 1.5),
        (1.0, 0.6, 1.5),
        (0.5, 0.6, 1.0 / 1.5),
        (1.0, 0.9, 1.0 / 1.5),
        (0.3, 0.2, 1.05),
    ] {
        let expected = albedo(alpha, mu, eta, |c| textbook_fresnel(c, eta));
        // From the outside of a medium of index eta, and from the inside of one of 1 / eta.
        for (side, index) in [(1.0, eta), (-1.0, 1.0 / eta)] {
            let bsdf = Bsdf::dielectric(Interface::new(Spectrum::splat(index as f32)), alpha as f32);
            let importance = drawn(&bsdf, side * mu, Quantity::Importance, SAMPLES, SEED);
            let radiance = drawn(&bsdf, side * mu, Quantity::Radiance, SAMPLES, SEED);
            let what = format!("alpha {alpha}, mu {mu}, eta {eta}, side {side}");
            importance[0].assert_is(expected[0], 2e-5, 2e-3, &format!("{what}, reflected"));
            importance[1].assert_is(expected[1], 2e-5, 2e-3, &format!("{what}, transmitted"));
            radiance[0].assert_is(expected[0], 2e-5, 2e-3, &format!("{what}, radiance back"));
            let compressed = expected[1] / (eta * eta);
            radiance[1].assert_is(compressed, 2e-5, 3e-3, &format!("{what}, radiance through"));
        }
    }
}

/// Roughness, cosine, and the percentages lost by white facets and by glass of index 1.5
/// seen from outside: the table in the documentation of `etalon::material::ggx`.
const LOSSES: [(f64, f64, f64, f64); 12] = [
    (0.1, 1.0, 1.2, 0.1),
    (0.1, 0.5, 3.1, 0.8),
    (0.1, 0.05, 8.8, 7.4),
    (0.2, 1.0, 5.2, 0.5),
    (0.2, 0.5, 10.5, 2.8),
    (0.2, 0.05, 6.8, 11.8),
    (0.5, 1.0, 31.2, 3.2),
    (0.5, 0.5, 30.1, 12.3),
    (0.5, 0.05, 8.7, 52.5),
    (1.0, 1.0, 69.3, 10.7),
    (1.0, 0.5, 54.9, 38.8),
    (1.0, 0.05, 15.2, 87.9),
];

#[test]
fn losses_are_those_of_the_documented_table() {
    for (alpha, mu, white_loss, glass_loss) in LOSSES {
        let mirror = albedo(alpha, mu, 1.5, |_| (1.0, 0.0))[0];
        let [drawn_mirror, _] = drawn(&white(alpha as f32), mu, Quantity::Importance, SAMPLES, SEED);
        let glass: f64 = albedo(alpha, mu, 1.5, |c| textbook_fresnel(c, 1.5)).iter().sum();
        let what = format!("alpha {alpha}, mu {mu}");
        // The horizon cuts through the quadrature's cells: four digits are all it has.
        drawn_mirror.assert_is(mirror, 5e-4, 2e-3, &what);
        for (share, loss) in [(mirror, white_loss), (glass, glass_loss)] {
            let got = 100.0 * (1.0 - share);
            assert!((got - loss).abs() < 0.1, "{what}: {got} %, table {loss} %");
        }
    }
}
