//! Directions that surfaces scatter into.

use crate::support::{Map, ROUNDING, Tally, direction, pair};
use etalon::material::{
    Bsdf, Ggx, Interface, Quantity, RoughConductor, RoughDielectric, SmoothConductor, SmoothDielectric,
    specimens,
};
use etalon::spectrum::Spectrum;
use glam::{DVec3, Vec3A};

const QUANTITY: Quantity = Quantity::Radiance;

/// A number that chooses the reflected, and one that chooses the crossing lobe wherever that
/// has a share that `f32` can tell.
const LOBES: [(f32, &str); 2] = [(0.0, "reflection"), (1.0 - ROUNDING as f32, "crossing")];

/// Roundings that add up in a drawn direction and in that asked for: some ten operations each
/// on three coordinates.
const ROUNDINGS: f64 = 32.0;

/// All models, and the rough ones from the least roughness to the greatest.
fn models() -> Vec<(String, Bsdf)> {
    let mut all: Vec<_> = specimens().into_iter().map(|(name, bsdf)| (name.to_owned(), bsdf)).collect();
    let splat = Spectrum::splat;
    for alpha in [1e-4, 1e-3, 0.03, 0.3, 1.0] {
        for eta in [1.5, 1.0 / 1.5, 1.12, 2.4] {
            let glass = Bsdf::dielectric(Interface::new(splat(eta)), alpha);
            all.push((format!("glass {eta} alpha {alpha}"), glass));
        }
        all.push((format!("metal alpha {alpha}"), Bsdf::conductor(splat(0.2), splat(3.0), alpha, true)));
        let metal = SmoothConductor { n: splat(0.2), k: splat(3.0), two_sided: true };
        let facets = Ggx::anisotropic(alpha, (20.0 * alpha).min(1.0));
        all.push((format!("brushed alpha {alpha}"), Bsdf::RoughConductor(RoughConductor { metal, facets })));
    }
    all
}

/// From straight above to grazing, on both sides.
fn viewpoints() -> Vec<Vec3A> {
    let heights = [1.0, 0.8, 0.3, 0.05, 1e-3, -1.0, -0.7, -0.1, -2e-3];
    let view = |(index, z): (usize, f64)| {
        let (sin, cos) = (0.3 + 1.7 * index as f64).sin_cos();
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * cos, across * sin, z).as_vec3a()
    };
    heights.into_iter().enumerate().map(view).collect()
}

/// Rounding of a direction drawn: refraction stretches it by the index and, as total
/// reflection nears, by the cosine of the refracted ray to its facet.
fn direction_rounding(bsdf: &Bsdf, wo: Vec3A, wi: DVec3) -> f64 {
    let Bsdf::RoughDielectric(glass) = bsdf else { return ROUNDINGS * ROUNDING };
    if f64::from(wo.z) * wi.z > 0.0 {
        return ROUNDINGS * ROUNDING;
    }
    let eta = refraction(glass.interface, wo);
    let wo = wo.as_dvec3();
    let facet = (wo + wi * eta).normalize();
    ROUNDINGS * ROUNDING * (1.0 + 1.0 / eta) * (1.0 + wo.dot(facet).abs() / (eta * wi.dot(facet).abs()))
}

/// Index of the far side over that of the side of `wo`, for the hero.
fn refraction(interface: Interface, wo: Vec3A) -> f64 {
    let eta = 1.0 + f64::from(interface.excess().hero());
    if wo.z > 0.0 { eta } else { 1.0 / eta }
}

/// Directions are told apart where the lobe is wider than their rounding.
#[test]
fn drawn_directions_give_back_their_numbers() {
    let mut all = Tally::default();
    for (name, bsdf) in models() {
        if bsdf.is_delta() {
            continue;
        }
        for (seed, wo) in viewpoints().into_iter().enumerate() {
            for (u_lobe, lobe) in LOBES {
                let draw = |u| {
                    let sample = bsdf.sample(wo, u_lobe, u, QUANTITY)?;
                    (!sample.is_delta).then(|| (u32::from(sample.is_transmission), sample.wi.as_dvec3()))
                };
                let rounding = |wi: DVec3| direction_rounding(&bsdf, wo, wi);
                let name = format!("{name}, {lobe}, from {wo}");
                let map = Map { name, draw: &draw, rounding: &rounding, step: 0.01 };
                let tally = map.inverts(seed as u64, |u| {
                    let sample = bsdf.sample(wo, u_lobe, u, QUANTITY)?;
                    bsdf.invert(wo, sample.wi, QUANTITY)
                });
                all.add(&tally);
            }
        }
    }
    all.assert_telling("all", 0.6);
}

/// Any direction either has no density, or numbers that draw it.
#[test]
fn any_direction_that_can_be_drawn_is_drawn_again() {
    let mut tally = Tally::default();
    for (name, bsdf) in models() {
        for wo in viewpoints() {
            for index in 0..500 {
                let wi = direction(index).as_vec3a();
                let numbers = bsdf.invert(wo, wi, QUANTITY);
                assert_eq!(
                    numbers.is_some(),
                    bsdf.pdf(wo, wi, QUANTITY).hero() > 0.0,
                    "{name}: {wo} to {wi}"
                );
                let Some(numbers) = numbers else { continue };
                let crosses = wo.z * wi.z < 0.0;
                if crosses && bsdf.lobe_probability(wo, wi, QUANTITY) < 2.0 * ROUNDING {
                    // A share that the lobe's number does not resolve.
                    continue;
                }
                let u_lobe = LOBES[usize::from(crosses)].0;
                let draw = |u| {
                    let sample = bsdf.sample(wo, u_lobe, u, QUANTITY)?;
                    Some((u32::from(sample.is_transmission), sample.wi.as_dvec3()))
                };
                let rounding = |wi: DVec3| direction_rounding(&bsdf, wo, wi);
                let map =
                    Map { name: format!("{name} from {wo}"), draw: &draw, rounding: &rounding, step: 0.01 };
                map.redraws((u32::from(crosses), wi.as_dvec3()), numbers, &mut tally);
            }
        }
    }
    assert!(tally.tried > 50_000);
    assert!(tally.lost < tally.tried / 20, "{} of {} are lost", tally.lost, tally.tried);
}

/// Rounding of Fresnel's shares at the facet between two directions. They change with the
/// cosine c to the facet by no more than 2 (1 + 1 / eta^2) / q with q^2 = c^2 + eta^2 - 1, the
/// steepest as total reflection sets in.
fn share_rounding(bsdf: &Bsdf, wo: Vec3A, wi: Vec3A) -> f64 {
    let (Bsdf::RoughDielectric(RoughDielectric { interface, .. })
    | Bsdf::SmoothDielectric(SmoothDielectric { interface })) = bsdf
    else {
        return 0.0;
    };
    let eta = refraction(*interface, wo);
    let (wo, wi) = (wo.as_dvec3(), wi.as_dvec3());
    let along = wo + wi * if wo.z * wi.z > 0.0 { 1.0 } else { eta };
    let cosine = wo.dot(along.normalize_or(DVec3::Z));
    // Total reflection is never closer than the rounding of a squared cosine.
    let refracted = (cosine * cosine + eta * eta - 1.0).max(2.0 * ROUNDING).sqrt();
    ROUNDINGS * ROUNDING * (1.0 + 2.0 * (1.0 + 1.0 / (eta * eta)) / refracted)
}

/// Below the share of reflection the lobe's number reflects, and above it does not; what one
/// facet reflects and refracts has shares that add up to one.
///
#[test]
fn lobes_are_chosen_as_often_as_they_say() {
    let mut judged = 0;
    for (name, bsdf) in models().into_iter().filter(|(_, bsdf)| bsdf.transmits()) {
        for (seed, wo) in viewpoints().into_iter().enumerate() {
            for u in (0..100).map(|index| pair(seed as u64, index)) {
                let shares = LOBES.map(|(u_lobe, _)| {
                    let sample = bsdf.sample(wo, u_lobe, u, QUANTITY)?;
                    Some((sample, bsdf.lobe_probability(wo, sample.wi, QUANTITY)))
                });
                for (sample, share) in shares.iter().flatten() {
                    assert!((0.0..=1.0).contains(share), "{name}: {share}");
                    let tolerance = share_rounding(&bsdf, wo, sample.wi);
                    let reflected = if sample.is_transmission { 1.0 - share } else { *share };
                    for (u_lobe, transmits) in [(reflected - tolerance, false), (reflected + tolerance, true)]
                    {
                        if !(0.0..1.0).contains(&u_lobe) {
                            continue;
                        }
                        // The other lobe may draw nothing.
                        let Some(other) = bsdf.sample(wo, u_lobe as f32, u, QUANTITY) else { continue };
                        assert_eq!(other.is_transmission, transmits, "{name}: {wo} {u:?} {u_lobe}");
                        judged += 1;
                    }
                }
                if let [Some((reflected, a)), Some((crossing, b))] = shares
                    && !reflected.is_transmission
                    && crossing.is_transmission
                {
                    let tolerance = 2.0 * share_rounding(&bsdf, wo, reflected.wi);
                    assert!((a + b - 1.0).abs() < tolerance, "{name}: {a} + {b} from {wo}");
                }
            }
        }
    }
    assert!(judged > 30_000, "{judged}");
}

#[test]
fn where_there_is_no_choice_the_probability_is_one() {
    for (name, bsdf) in models() {
        for wo in viewpoints() {
            let Some(sample) = bsdf.sample(wo, 0.3, [0.3, 0.4], QUANTITY) else { continue };
            let share = bsdf.lobe_probability(wo, sample.wi, QUANTITY);
            assert!(bsdf.transmits() || share == 1.0, "{name}: {share}");
            if sample.is_delta {
                assert_eq!(bsdf.invert(wo, sample.wi, QUANTITY), None, "{name}");
            }
        }
    }
}
