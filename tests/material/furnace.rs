//! Rough surfaces in a white furnace, against an independent quadrature over facets.
//!
//! The reference integrates over facet normals, in `f64`, with Fresnel's equations as they
//! stand in textbooks and with the visibility of facets as an integral over their heights
//! (Heitz et al. 2016): at height share t, Smith's visibility is t^Lambda upwards and
//! (1 - t)^Lambda downwards. It shares no formula with the renderer beyond GGX itself.

use std::f64::consts::PI;

use etalon::material::{Bsdf, Interface, Quantity};
use etalon::spectrum::Spectrum;

use super::support::{Mean, Random, direction, gauss, integral};

type Vector = [f64; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Textbook reflectance from both cosines.
fn textbook_fresnel(cos_i: f64, eta: f64) -> (f64, f64) {
    let sin_t_squared = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin_t_squared >= 1.0 {
        return (1.0, 0.0);
    }
    let cos_t = (1.0 - sin_t_squared).sqrt();
    let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    (0.5 * (s * s + p * p), cos_t)
}

fn lambda(alpha: f64, w: Vector) -> f64 {
    let tan_squared = (1.0 - w[2] * w[2]) / (w[2] * w[2]);
    0.5 * ((1.0 + alpha * alpha * tan_squared).sqrt() - 1.0)
}

/// Share of facets seen from both directions, both above.
fn both_above(a: f64, b: f64) -> f64 {
    integral(0.0, 1.0, |t| t.powf(a + b))
}

/// Share of facets seen from above and from below.
fn through(a: f64, b: f64) -> f64 {
    integral(0.0, 0.5, |t| t.powf(a) * (1.0 - t).powf(b))
        + integral(0.0, 0.5, |t| t.powf(b) * (1.0 - t).powf(a))
}

/// Reflected and transmitted share for light at cosine `mu`, scattered once. `reflectance`
/// gives the reflected share and the refracted cosine, which 0 forbids.
fn albedo(alpha: f64, mu: f64, eta: f64, reflectance: impl Fn(f64) -> (f64, f64)) -> [f64; 2] {
    let wo = [(1.0 - mu * mu).sqrt(), 0.0, mu];
    let (thetas, phis) = (gauss(120), gauss(96));
    let mut shares = [0.0; 2];
    for &(t, w_t) in &thetas {
        // tan(theta) = alpha sqrt(u / (1 - u)) makes D cos dh uniform in u; u = t^2 (3 - 2t)
        // flattens both ends.
        let (u, du) = (t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t));
        let tan_squared = alpha * alpha * u / (1.0 - u);
        let z = 1.0 / (1.0 + tan_squared).sqrt();
        let sine = (1.0 - z * z).sqrt();
        for &(s, w_s) in &phis {
            let phi = PI * s;
            let h = [sine * phi.cos(), sine * phi.sin(), z];
            let c = dot(wo, h);
            if c <= 0.0 {
                continue;
            }
            let weight = w_t * w_s * du * c / (mu * z);
            let (reflected, cos_t) = reflectance(c);
            let mirrored: Vector = std::array::from_fn(|i| 2.0 * c * h[i] - wo[i]);
            if mirrored[2] > 0.0 {
                let seen = both_above(lambda(alpha, wo), lambda(alpha, mirrored));
                shares[0] += weight * reflected * seen;
            }
            let refracted: Vector = std::array::from_fn(|i| (c / eta - cos_t) * h[i] - wo[i] / eta);
            if cos_t > 0.0 && refracted[2] < 0.0 {
                let seen = through(lambda(alpha, wo), lambda(alpha, refracted));
                shares[1] += weight * (1.0 - reflected) * seen;
            }
        }
    }
    shares
}

/// Mean weight of the draws, reflected and transmitted.
fn drawn(bsdf: &Bsdf, mu: f64, quantity: Quantity) -> [Mean; 2] {
    let mut random = Random(77);
    let mut means = [Mean::default(); 2];
    let wo = direction(mu, 0.7);
    for _ in 0..400_000 {
        let (u_lobe, u) = (random.uniform(), random.pair());
        let mut weights = [0.0; 2];
        if let Some(s) = bsdf.sample(wo, u_lobe, u, quantity) {
            weights[usize::from(s.is_transmission)] = f64::from(s.value.hero() / s.pdf.hero());
        }
        means.iter_mut().zip(weights).for_each(|(mean, weight)| mean.add(weight));
    }
    means
}

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
            let importance = drawn(&bsdf, side * mu, Quantity::Importance);
            let radiance = drawn(&bsdf, side * mu, Quantity::Radiance);
            let what = format!("alpha {alpha}, mu {mu}, eta {eta}, side {side}");
            importance[0].assert_is(expected[0], 2e-5, 2e-3, &format!("{what}, reflected"));
            importance[1].assert_is(expected[1], 2e-5, 2e-3, &format!("{what}, transmitted"));
            radiance[0].assert_is(expected[0], 2e-5, 2e-3, &format!("{what}, radiance back"));
            let compressed = expected[1] / (eta * eta);
            radiance[1].assert_is(compressed, 2e-5, 3e-3, &format!("{what}, radiance through"));
        }
    }
}

/// A surface whose facets reflect everything.
fn white(alpha: f32) -> Bsdf {
    Bsdf::conductor(Spectrum::splat(0.0), Spectrum::splat(1.0), alpha, false)
}

#[test]
fn white_facets_lose_what_quadrature_says() {
    // Alpha, cosine, albedo; the first is 1 - ln 2.
    for (alpha, mu, albedo) in
        [(1.0, 1.0, 0.306_853), (0.5, 1.0, 0.688), (0.5, 0.5, 0.698), (0.5, 0.05, 0.913)]
    {
        let tolerance = if alpha == 1.0 { 1e-5 } else { 1e-3 };
        let [reflected, none] = drawn(&white(alpha), mu, Quantity::Radiance);
        reflected.assert_is(albedo, tolerance, 1e-3, &format!("alpha {alpha}, mu {mu}"));
        assert_eq!(none.value(), 0.0);
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
        let [drawn_mirror, _] = drawn(&white(alpha as f32), mu, Quantity::Importance);
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
