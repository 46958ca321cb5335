//! What holds between the functions of a model: sample against eval, both directions
//! against each other, lanes against heroes, energy.

use etalon::material::{Bsdf, Quantity, specimens};
use etalon::spectrum::LANES;
use glam::Vec3A;

use super::support::{Random, interface_of, radiance_factor, viewpoints, with_hero};

const QUANTITIES: [Quantity; 2] = [Quantity::Radiance, Quantity::Importance];

/// Calls `test` for draws from every specimen and every viewpoint.
fn for_draws(count: usize, mut test: impl FnMut(&str, &Bsdf, Vec3A, etalon::material::BsdfSample, Quantity)) {
    let mut random = Random(7);
    for (name, bsdf) in specimens() {
        for wo in viewpoints() {
            for quantity in QUANTITIES {
                for _ in 0..count {
                    let (u_lobe, u) = (random.uniform(), random.pair());
                    if let Some(sample) = bsdf.sample(wo, u_lobe, u, quantity) {
                        test(name, &bsdf, wo, sample, quantity);
                    }
                }
            }
        }
    }
}

#[test]
fn samples_repeat_what_eval_and_pdf_say() {
    for_draws(500, |name, bsdf, wo, sample, quantity| {
        let (value, pdf) = (bsdf.eval(wo, sample.wi, quantity), bsdf.pdf(wo, sample.wi, quantity));
        if sample.is_delta {
            assert!(value.hero() == 0.0 && pdf.hero() == 0.0, "{name}: a delta has a density");
        } else {
            assert_eq!((sample.value, sample.pdf), (value, pdf), "{name} from {wo}");
        }
        assert!((sample.wi.length() - 1.0).abs() < 1e-5, "{name}: length of {}", sample.wi);
        assert_eq!(sample.is_transmission, wo.z * sample.wi.z < 0.0, "{name} from {wo}");
        assert!(!sample.is_transmission || bsdf.transmits(), "{name}");
        assert!(!bsdf.is_delta() || sample.is_delta, "{name}");
        assert!(sample.pdf.hero() > 0.0, "{name}");
    });
}

#[test]
fn no_draw_gains_energy() {
    for_draws(2_000, |name, bsdf, wo, sample, quantity| {
        let weight = f64::from(sample.value.hero() / sample.pdf.hero());
        let most = match quantity {
            Quantity::Importance => 1.0,
            Quantity::Radiance => radiance_factor(bsdf, wo, sample.wi),
        };
        assert!(weight <= most * (1.0 + 1e-5), "{name} from {wo} to {}: {weight}", sample.wi);
    });
}

#[test]
fn companions_gain_no_energy() {
    // The hero's draws, weighted for each companion: an albedo of at most one.
    let mut random = Random(8);
    for (name, bsdf) in specimens() {
        for wo in viewpoints() {
            let mut sums = [super::support::Mean::default(); LANES];
            for _ in 0..20_000 {
                let (u_lobe, u) = (random.uniform(), random.pair());
                let sample = bsdf.sample(wo, u_lobe, u, Quantity::Importance);
                for (lane, sum) in sums.iter_mut().enumerate() {
                    let weight = sample.map_or(0.0, |s| s.value[lane] / s.pdf.hero());
                    sum.add(f64::from(weight));
                }
            }
            for (lane, albedo) in sums.iter().enumerate() {
                let (value, error) = (albedo.value(), albedo.error());
                assert!(value < 1.0 + 5.0 * error + 1e-5, "{name} {lane}: {value} +- {error}");
            }
        }
    }
}

/// Pairs of directions that see each other, with f(wo, wi) in both directions.
fn for_pairs(mut test: impl FnMut(&str, &Bsdf, Vec3A, Vec3A)) {
    for_draws(200, |name, bsdf, wo, sample, _| {
        if !sample.is_delta && sample.wi.z.abs() > 1e-3 {
            test(name, bsdf, wo, sample.wi);
        }
    });
}

fn scattering(bsdf: &Bsdf, wo: Vec3A, wi: Vec3A, quantity: Quantity) -> f64 {
    f64::from(bsdf.eval(wo, wi, quantity).hero()) / f64::from(wi.z.abs())
}

/// Relative difference allowed to two ways through the same formulas: facets are found
/// from rounded directions, and the narrower the lobe the more that shows.
fn rounding(bsdf: &Bsdf) -> f64 {
    let width = match bsdf {
        Bsdf::RoughDielectric(model) => f64::from(model.interface.excess().hero().abs()) * 0.01,
        _ => 0.01,
    };
    1e-5 / width
}

#[test]
fn radiance_over_n_squared_is_reciprocal() {
    for_pairs(|name, bsdf, wo, wi| {
        let forth = scattering(bsdf, wo, wi, Quantity::Radiance);
        let back = scattering(bsdf, wi, wo, Quantity::Radiance) * radiance_factor(bsdf, wo, wi);
        assert!(
            (forth - back).abs() <= rounding(bsdf) * forth.abs(),
            "{name}: {wo} to {wi}: {forth}, back {back}"
        );
    });
}

#[test]
fn importance_is_the_adjoint_of_radiance() {
    for_pairs(|name, bsdf, wo, wi| {
        let radiance = scattering(bsdf, wi, wo, Quantity::Radiance);
        let importance = scattering(bsdf, wo, wi, Quantity::Importance);
        assert!(
            (radiance - importance).abs() <= rounding(bsdf) * radiance.abs(),
            "{name}: {wo} to {wi}: {importance}, adjoint {radiance}"
        );
        assert_eq!(
            bsdf.pdf(wo, wi, Quantity::Radiance),
            bsdf.pdf(wo, wi, Quantity::Importance),
            "{name}: what is carried does not steer"
        );
    });
}

#[test]
fn every_lane_is_what_it_would_be_as_the_hero() {
    for_pairs(|name, bsdf, wo, wi| {
        for lane in 0..LANES {
            let turned = with_hero(bsdf, lane).evaluate(wo, wi, Quantity::Radiance);
            let lanes = bsdf.evaluate(wo, wi, Quantity::Radiance);
            assert_eq!(
                (lanes.value[lane], lanes.pdf[lane]),
                (turned.value.hero(), turned.pdf.hero()),
                "{name}, lane {lane}"
            );
        }
    });
}

#[test]
fn polished_surfaces_share_out_all_lanes() {
    let mut random = Random(9);
    for (name, bsdf) in specimens() {
        let Some(interface) = interface_of(&bsdf).filter(|_| bsdf.is_delta()) else { continue };
        for wo in viewpoints() {
            let mut draw = |u_lobe| bsdf.sample(wo, u_lobe, random.pair(), Quantity::Importance);
            let (first, last) = (draw(0.0), draw(0.999_999_9));
            let (Some(first), Some(last)) = (first, last) else { panic!("{name}") };
            let flat = interface.excess().is_flat();
            if first.is_transmission {
                // Nothing is reflected: a straight passage.
                assert_eq!((first.wi, first.value.hero()), (-wo, 1.0), "{name}");
                continue;
            }
            assert_eq!(first.wi, Vec3A::new(-wo.x, -wo.y, wo.z), "{name}");
            assert!(!first.hero_only && first.value == first.pdf, "{name}");
            if !last.is_transmission {
                assert_eq!(first.pdf.hero(), 1.0, "{name}: total reflection");
                continue;
            }
            assert_eq!(last.hero_only, !flat, "{name}");
            assert!((first.pdf.hero() + last.pdf.hero() - 1.0).abs() < 1e-6, "{name}");
            assert_eq!(last.pdf[1] == 0.0, !flat, "{name}: companions of refraction");
            snell(name, &bsdf, wo, last.wi);
        }
    }
}

/// Snell's law, and the way back.
fn snell(name: &str, bsdf: &Bsdf, wo: Vec3A, wi: Vec3A) {
    let factor = radiance_factor(bsdf, wo, wi);
    let (sine_o, sine_i) = (wo.truncate().length(), wi.truncate().length());
    let expected = f64::from(sine_o) * factor.sqrt();
    assert!((f64::from(sine_i) - expected).abs() < 1e-6, "{name}: {sine_o} to {sine_i}");
    let back = bsdf.sample(wi, 0.999_999_9, [0.5; 2], Quantity::Radiance).expect("a way back");
    assert!((back.wi - wo).length() < 1e-4, "{name}: {wo} comes back as {}", back.wi);
    let weight = f64::from(back.value.hero() / back.pdf.hero());
    assert!((weight * factor - 1.0).abs() < 1e-5, "{name}: radiance {weight} against {factor}");
}

#[test]
fn draws_follow_their_random_numbers_continuously() {
    const STEP: f32 = 1e-4;
    let mut random = Random(10);
    for (name, bsdf) in specimens() {
        for wo in viewpoints() {
            for _ in 0..500 {
                let (u_lobe, u) = (random.uniform(), random.pair().map(|u| 0.02 + 0.9 * u));
                let draw = |u| bsdf.sample(wo, u_lobe, u, Quantity::Radiance);
                let (Some(here), Some(near)) = (draw(u), draw([u[0] + STEP, u[1] + STEP])) else {
                    continue;
                };
                let apart = (here.wi - near.wi).length();
                let same_lobe = here.is_transmission == near.is_transmission;
                assert!(!same_lobe || apart < 200.0 * STEP, "{name}: {apart} at {u:?}");
            }
        }
    }
}
