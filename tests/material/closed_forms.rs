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
