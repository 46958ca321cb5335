//! Fresnel's equations and the facet distribution against closed forms.

use std::f64::consts::PI;

use etalon::material::fresnel::{Shares, conductor, dielectric};
use etalon::material::{Bsdf, Ggx, Interface, Quantity};
use etalon::spectrum::Spectrum;
use glam::Vec3A;

use super::support::{direction, integral};

fn assert_close(got: f64, expected: f64, relative: f64, what: &str) {
    let error = (got / expected - 1.0).abs();
    assert!(error <= relative, "{what}: {got:e}, expected {expected:e}, off by {error:e}");
}

/// Reflectance averaged over a diffuse field, seen from the side of index one.
fn diffuse_reflectance(eta: f64) -> f64 {
    let f = |c: f64| 2.0 * c * dielectric(c, eta - 1.0).reflected;
    if eta >= 1.0 {
        return integral(0.0, 1.0, f);
    }
    let critical = (1.0 - eta * eta).sqrt();
    critical * critical + integral(critical, 1.0, f)
}

#[test]
fn diffuse_reflectance_of_glass_from_both_sides() {
    let (outside, inside) = (diffuse_reflectance(1.5), diffuse_reflectance(1.0 / 1.5));
    assert!((outside - 0.091_778_0).abs() < 1e-6, "{outside}");
    assert!((inside - 0.596_345_8).abs() < 1e-6, "{inside}");
    assert_close(1.0 - inside, (1.0 - outside) / 2.25, 1e-9, "n^2 identity");
}

#[test]
fn diffuse_reflectance_of_a_thinner_medium() {
    let got = diffuse_reflectance(0.9);
    assert!((got - 0.212_244).abs() < 1e-5, "{got}");
}

#[test]
fn total_reflection_begins_where_it_should_and_never_dips() {
    let excess = 1.0 / 1.5 - 1.0;
    let critical = (1.0_f64 / 1.5).asin();
    let at = |theta: f64| dielectric(theta.cos(), excess).reflected;
    assert!((at(critical - 1e-6) - 0.991_350).abs() < 1e-6);
    assert!((at(critical - 1e-8) - 0.999_131).abs() < 1e-6);
    for step in 0..=1000 {
        assert_eq!(at(critical + 1e-12 + f64::from(step) * 1e-4), 1.0);
    }
    let mut last = 0.0;
    for step in (0..4000).rev() {
        let now = at(critical - f64::from(step) * 1e-9);
        assert!(now >= last && now <= 1.0, "{now} after {last}");
        last = now;
    }
}

#[test]
fn grazing_light_still_enters() {
    for (cosine, share) in [(1e-4, 5.81e-4), (1e-5, 5.8136e-5), (1e-7, 5.813_8e-7)] {
        // 4 c q (1 / (c + q)^2 + eta^2 / (eta^2 c + q)^2) / 2 to the second order in c.
        let eta2: f64 = 2.25;
        let m: f64 = eta2 - 1.0;
        let series = 2.0 * cosine * (1.0 + eta2) / m.sqrt() - 4.0 * cosine * cosine * (1.0 + eta2 * eta2) / m;
        let got = dielectric(cosine, 0.5).crossing;
        assert_close(got, series, 1e-6, "series");
        assert_close(got, share, 1e-3, "table");
    }
}

#[test]
fn brewsters_angle() {
    let theta = 1.5_f64.atan();
    assert!((theta.to_degrees() - 56.309_93).abs() < 1e-5);
    let got = dielectric(theta.cos(), 0.5).reflected;
    assert!((got - 0.073_964_5).abs() < 1e-7, "{got}");
}

#[test]
fn media_that_nearly_match() {
    for excess in [1e-6, -1e-6, 1e-9, 1e-12] {
        let expected = (excess / (2.0 + excess)) * (excess / (2.0 + excess));
        assert_close(dielectric(1.0, excess).reflected, expected, 1e-6, "normal incidence");
        // Through the lanes of an interface, given as indices.
        let interface = Interface::between([1.5 * (1.0 + excess); 8], [1.5; 8]);
        let through_lanes = f64::from(interface.excess().hero());
        assert_close(through_lanes, excess, if excess.abs() < 1e-7 { 1e-3 } else { 1e-6 }, "lanes");
        let glass = Bsdf::dielectric(interface, 0.0);
        let sample = glass.sample(Vec3A::Z, 0.0, [0.5; 2], Quantity::Radiance);
        let sample = sample.expect("light meets a polished surface");
        if sample.is_transmission {
            continue;
        }
        assert_close(sample.pdf.hero().into(), expected, 1e-2, "sample");
    }
    assert_eq!(dielectric(0.3, 0.0), Shares { reflected: 0.0, crossing: 1.0 });
    assert_eq!(dielectric(0.0, 0.0), Shares { reflected: 0.0, crossing: 1.0 });
}

#[test]
fn shares_add_up_to_one() {
    for step in 1..=1000 {
        let c = f64::from(step) / 1000.0;
        for excess in [-0.9, -0.3, -1e-3, 1e-9, 0.1, 0.5, 3.0, 1e6] {
            let Shares { reflected, crossing } = dielectric(c, excess);
            assert!((reflected + crossing - 1.0).abs() < 1e-12, "{c} {excess}");
        }
        for (n, k) in [(0.0, 0.0), (0.0, 2.0), (1.0, 0.0), (0.2, 3.0), (1.5, 1e6), (3.0, 0.1)] {
            let Shares { reflected, crossing } = conductor(c, n, k);
            assert!((reflected + crossing - 1.0).abs() < 1e-12, "{c} {n} {k}");
        }
    }
}

#[test]
fn conductors_without_extinction_are_dielectrics() {
    for step in 0..=100 {
        let c = f64::from(step) / 100.0;
        for n in [0.5, 0.9, 1.3, 2.5] {
            let (metal, glass) = (conductor(c, n, 0.0), dielectric(c, n - 1.0));
            assert!((metal.reflected - glass.reflected).abs() < 1e-7, "{c} {n}");
        }
    }
}

#[test]
fn conductors_at_the_ends() {
    assert_close(conductor(1.0, 1.5, 1e3).crossing, 5.999_96e-6, 1e-6, "k = 1e3");
    assert_close(conductor(1.0, 1.5, 1e6).crossing, 6e-12, 1e-6, "k = 1e6");
    for c in [0.0, 1e-30, 0.3, 1.0] {
        let extreme = conductor(c, 1.5, 1e30);
        assert_eq!(extreme.reflected, 1.0);
        assert!(extreme.crossing.is_finite());
        let beyond = conductor(c, 1.5, f64::from(f32::MAX));
        assert!(beyond.reflected == 1.0 && beyond.crossing.is_finite());
        assert_eq!(conductor(c, 0.0, 0.0), Shares { reflected: 1.0, crossing: 0.0 });
        for k in [1e-3, 1.0, 1e9] {
            assert_eq!(conductor(c, 0.0, k), Shares { reflected: 1.0, crossing: 0.0 });
        }
    }
    // Normal incidence in closed form.
    let (n, k) = (0.2, 3.1);
    let expected = ((n - 1.0f64).powi(2) + k * k) / ((n + 1.0f64).powi(2) + k * k);
    assert_close(conductor(1.0, n, k).reflected, expected, 1e-12, "gold");
    // Aluminium at 60 degrees, amplitudes in complex arithmetic with arbitrary precision.
    assert_close(conductor(0.5, 1.0, 6.0).reflected, ALUMINIUM_AT_60, 1e-9, "aluminium");
}

/// Unpolarised reflectance of N = 1 + 6i at 60 degrees.
const ALUMINIUM_AT_60: f64 = 0.883_499_519_392_866_8;

#[test]
fn facets_are_dense_where_they_should_be() {
    for alpha in [1e-4_f64, 3e-4, 1e-3, 1e-2, 0.1, 0.5, 1.0] {
        let facets = Ggx::isotropic(alpha as f32);
        let peak = 1.0 / (PI * alpha * alpha);
        assert_close(facets.density(Vec3A::Z).into(), peak, 1e-5, "peak");
        for theta in [0.3 * alpha, alpha, 3.0 * alpha, 0.2] {
            let (sine, cosine) = theta.sin_cos();
            let slope = (sine / alpha).powi(2) + cosine * cosine;
            let h = Vec3A::new((0.6 * sine) as f32, (0.8 * sine) as f32, cosine as f32);
            let got = facets.density(h).into();
            assert_close(got, peak / (slope * slope), 1e-4, &format!("{alpha} {theta}"));
        }
    }
    let quarter = Ggx::isotropic(1e-4).density(direction((1e-4_f64).cos(), 0.0));
    assert_close(quarter.into(), 7.958e6, 1e-3, "density at theta = alpha = 1e-4");
}

#[test]
fn facets_cover_the_surface_once() {
    for alpha in [0.05, 0.3, 1.0] {
        let facets = Ggx::isotropic(alpha);
        let covered = integral(0.0, 1.0, |t| {
            // u is the share of slopes below tan; see Walter et al. 2007, equation 35.
            let tan_squared = f64::from(alpha * alpha) * t / (1.0 - t);
            let cosine = 1.0 / (1.0 + tan_squared).sqrt();
            let per_cosine = f64::from(alpha * alpha) / (1.0 - t).powi(2) * cosine.powi(3) / 2.0;
            let h = direction(cosine, 1.0);
            2.0 * PI * f64::from(facets.density(h)) * cosine * per_cosine
        });
        assert_close(covered, 1.0, 1e-4, "projected area");
    }
}

#[test]
fn matte_albedo_is_the_reflectance() {
    use etalon::material::Lambertian;
    let reflectance = Spectrum::splat(0.37);
    let paint = Bsdf::Lambertian(Lambertian { reflectance, two_sided: true });
    for wo in [Vec3A::Z, direction(0.2, 1.0), direction(-0.6, 2.0)] {
        let side = f64::from(wo.z.signum());
        let albedo = 2.0
            * PI
            * integral(0.0, 1.0, |z| {
                f64::from(paint.eval(wo, direction(side * z, 0.5), Quantity::Radiance).hero())
            });
        assert_close(albedo, 0.37, 1e-5, "albedo");
        assert!(paint.eval(wo, direction(-side * 0.4, 0.5), Quantity::Radiance).is_black());
    }
}
