//! Rough surfaces in a white furnace, against an independent quadrature over facets.
//!
//! The reference integrates over facet normals, in `f64`, with Fresnel's equations as they
//! stand in textbooks and with the visibility of facets as an integral over their heights
//! (Heitz et al. 2016): at height share t, Smith's visibility is t^Lambda upwards and
//! (1 - t)^Lambda downwards. It shares no formula with the renderer beyond GGX itself.

use std::f64::consts::PI;

use etalon::material::{Bsdf, Quantity};
use etalon::spectrum::Spectrum;

use super::hemisphere::{Mean, Random, direction, gauss, integral};

type Vector = [f64; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Textbook reflectance from both cosines.
pub fn textbook_fresnel(cos_i: f64, eta: f64) -> (f64, f64) {
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
pub fn albedo(alpha: f64, mu: f64, eta: f64, reflectance: impl Fn(f64) -> (f64, f64)) -> [f64; 2] {
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
pub fn drawn(bsdf: &Bsdf, mu: f64, quantity: Quantity, samples: u64, seed: u64) -> [Mean; 2] {
    let mut random = Random(seed);
    let mut means = [Mean::default(); 2];
    let wo = direction(mu, 0.7);
    for _ in 0..samples {
        let (u_lobe, u) = (random.uniform(), random.pair());
        let mut weights = [0.0; 2];
        if let Some(s) = bsdf.sample(wo, u_lobe, u, quantity) {
            weights[usize::from(s.is_transmission)] = f64::from(s.value.hero() / s.pdf.hero());
        }
        means.iter_mut().zip(weights).for_each(|(mean, weight)| mean.add(weight));
    }
    means
}

/// A surface whose facets reflect everything.
pub fn white(alpha: f32) -> Bsdf {
    Bsdf::conductor(Spectrum::splat(0.0), Spectrum::splat(1.0), alpha, false)
}
