//! Directions and indices at the edge of what can be asked.

use etalon::material::{Bsdf, Interface, Quantity, specimens};
use etalon::spectrum::{LANES, Spectrum};
use glam::Vec3A;

use super::support::{Random, direction, viewpoints, with_hero};

/// Directions in the surface, hardly out of it, and along the normal.
fn extreme_directions() -> Vec<Vec3A> {
    let mut all = vec![];
    for z in [0.0, -0.0, 1e-45, -1e-45, 1e-30, -1e-30, 1e-7, -1e-7, 0.5, -0.5, 1.0, -1.0f32] {
        for (x, y) in [(1.0f32, 0.0f32), (-1.0, 0.0), (0.6, 0.8)] {
            let sine = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
            all.push(Vec3A::new(x * sine, y * sine, z));
        }
    }
    all
}

#[test]
fn extreme_directions_give_finite_values() {
    let directions = extreme_directions();
    for (name, bsdf) in specimens() {
        for &wo in &directions {
            for &wi in &directions {
                let both = bsdf.evaluate(wo, wi, Quantity::Radiance);
                assert!(both.value.is_finite() && both.pdf.is_finite(), "{name}: {wo:?} {wi:?} {both:?}");
                let not_negative = |s: Spectrum| s.0.iter().all(|&v| v >= 0.0);
                assert!(not_negative(both.value) && not_negative(both.pdf), "{name}: {both:?}");
                if wo.z == 0.0 || wi.z == 0.0 {
                    assert!(both.value.is_black() && both.pdf.is_black(), "{name}: in the plane");
                }
            }
        }
    }
}

#[test]
fn extreme_directions_give_finite_samples() {
    let ends = [0.0, 1e-7, 0.3, 0.5, 1.0 - 0.5f32.powi(24)];
    for (name, bsdf) in specimens() {
        for wo in extreme_directions() {
            for (u_lobe, a, b) in
                ends.iter().flat_map(|&l| ends.iter().flat_map(move |&a| ends.map(|b| (l, a, b))))
            {
                let Some(s) = bsdf.sample(wo, u_lobe, [a, b], Quantity::Radiance) else { continue };
                let weight = s.value.hero() / s.pdf.hero();
                assert!(s.wi.is_finite() && s.value.is_finite() && s.pdf.is_finite(), "{name}: {wo:?} {s:?}");
                assert!(weight.is_finite() && s.wi.z != 0.0, "{name}: {wo:?} {s:?}");
            }
        }
    }
}

#[test]
fn directions_that_are_no_numbers_carry_nothing() {
    let broken = Vec3A::new(0.0, f32::NAN, f32::NAN);
    for (name, bsdf) in specimens() {
        assert!(bsdf.sample(broken, 0.5, [0.5; 2], Quantity::Radiance).is_none(), "{name}");
        assert!(bsdf.eval(broken, Vec3A::Z, Quantity::Radiance).is_black(), "{name}");
    }
}

#[test]
fn nothing_stays_nothing_however_rough() {
    let mut random = Random(24);
    for alpha in [0.0, 1e-4, 0.01, 0.3, 1.0] {
        let nothing = Bsdf::dielectric(Interface::new(Spectrum::ONE), alpha);
        assert!(nothing.is_delta() && nothing.transmits());
        for _ in 0..200_000 {
            let wo = random.on_sphere();
            let (u_lobe, u) = (random.uniform(), random.pair());
            let Some(s) = nothing.sample(wo, u_lobe, u, Quantity::Radiance) else {
                assert_eq!(wo.z, 0.0);
                continue;
            };
            assert_eq!((s.wi, s.value, s.pdf), (-wo, Spectrum::ONE, Spectrum::ONE));
            assert!(s.is_delta && s.is_transmission && !s.hero_only);
        }
    }
}

#[test]
fn media_that_nearly_match_stay_finite_however_rough() {
    let mut random = Random(25);
    for excess in [1e-8, -1e-6, 1e-6, 3e-5, -1e-4, 1e-3, 0.01] {
        for alpha in [1e-4, 1e-3, 0.03, 0.3, 1.0] {
            let bsdf = Bsdf::dielectric(Interface::from_excess(Spectrum::splat(excess)), alpha);
            for _ in 0..20_000 {
                let wo = random.on_sphere();
                let (u_lobe, u) = (random.uniform(), random.pair());
                let sample = bsdf.sample(wo, u_lobe, u, Quantity::Importance);
                let Some(s) = sample else { continue };
                let weight = s.value.hero() / s.pdf.hero();
                assert!(s.value.is_finite() && s.pdf.is_finite(), "{excess} {alpha} {wo} {s:?}");
                assert!(weight <= 1.0 + 1e-5, "{excess} {alpha} {wo} {s:?}");
            }
        }
    }
}

#[test]
fn a_hero_whose_media_match_goes_alone() {
    let (_, bsdf) = specimens()
        .into_iter()
        .find(|(name, _)| *name == "matched at the hero")
        .expect("a specimen of that name");
    let wo = direction(0.6, 1.0);
    let sample = bsdf.sample(wo, 0.5, [0.5; 2], Quantity::Radiance).expect("a passage");
    assert!(sample.is_delta && sample.hero_only && sample.wi == -wo);
    assert_eq!(sample.value, Spectrum::ONE.hero_only());
    assert!(!bsdf.is_delta(), "its companions have lobes");
    for lane in 1..LANES {
        let turned = with_hero(&bsdf, lane);
        let sample = turned.sample(wo, 0.5, [0.3; 2], Quantity::Radiance).expect("a draw");
        let lobe = turned.eval(wo, sample.wi, Quantity::Radiance);
        assert_eq!(lobe[LANES - lane], 0.0, "the lobe knows nothing of the matched lane");
    }
}

#[test]
fn the_smallest_roughness_is_as_good_as_polished() {
    let mut random = Random(35);
    let n = Spectrum::splat(0.3);
    let k = Spectrum::splat(3.0);
    let glass = Interface::new(Spectrum::splat(1.5));
    for (rough, smooth) in [
        (Bsdf::conductor(n, k, 1e-4, false), Bsdf::conductor(n, k, 0.0, false)),
        (Bsdf::dielectric(glass, 1e-4), Bsdf::dielectric(glass, 0.0)),
    ] {
        for wo in viewpoints() {
            for _ in 0..2_000 {
                let (u_lobe, u) = (random.uniform(), random.pair());
                let draw = |bsdf: &Bsdf| bsdf.sample(wo, u_lobe, u, Quantity::Radiance);
                let (Some(a), Some(b)) = (draw(&rough), draw(&smooth)) else { continue };
                if a.is_transmission != b.is_transmission {
                    continue;
                }
                let weights = [a, b].map(|s| s.value.hero() / s.pdf.hero());
                assert!((weights[0] / weights[1] - 1.0).abs() < 0.02, "{wo}: {weights:?}");
            }
            let mean = |bsdf: &Bsdf| {
                let mut random = Random(36);
                let mut sum = Vec3A::ZERO;
                for _ in 0..20_000 {
                    let (u_lobe, u) = (random.uniform(), random.pair());
                    if let Some(s) = bsdf.sample(wo, u_lobe, u, Quantity::Radiance) {
                        sum += s.wi * (s.value.hero() / s.pdf.hero());
                    }
                }
                sum / 20_000.0
            };
            let (a, b) = (mean(&rough), mean(&smooth));
            assert!((a - b).length() < 2e-3, "{wo}: {a}, polished {b}");
        }
    }
}

#[test]
fn backs_are_black_unless_two_sided() {
    let inside = direction(-0.5, 1.0);
    for (name, black) in [("paint", true), ("paper", false), ("satin gold", false), ("gold", true)] {
        let (_, bsdf) = specimens().into_iter().find(|s| s.0 == name).expect("a specimen");
        let sample = bsdf.sample(inside, 0.5, [0.4; 2], Quantity::Radiance);
        assert_eq!(sample.is_none(), black, "{name}");
        assert!(sample.is_none_or(|s| s.wi.z < 0.0), "{name} reflects to its own side");
    }
}
