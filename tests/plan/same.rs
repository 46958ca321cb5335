//! The bare plan and the full one give the same picture.
//!
//! Numbers have names, so leaving some out shifts no other: items that decide nothing leave every
//! bit as it is. Densities kept for each wavelength differ by their rounding. The others, by which
//! wavelengths are drawn otherwise or paths are found by other strategies, change the noise, and
//! are judged by the agreement of independent batches: the same picture is called different once
//! in a thousand draws of the seeds, which are fixed. It must also be known to be equal, within
//! [`MARGIN`].

use crate::common::{scene, scenes as common};
use crate::needs::{SMALL, left_out};
use crate::scenes;
use etalon::integrator::{Budget, Integrator, Silent};
use etalon::scene::{Leaving, PLAN_ITEMS, Plan, Scene};
use etalon::spectrum::WavelengthSampler;
use etalon::statistics::{Agreement, Verdict};
use serde_json::Value;
use std::collections::BTreeSet;

/// Items without which every bit is the same: they decide nothing, or make no path that carries
/// light.
const SAME_BITS: [&str; 7] =
    ["media", "lens", "lamp-choice", "meets-lights", "asks-lights", "joins", "asks-eye"];
/// Relative difference of whole pictures that counts as none.
const MARGIN: f64 = 0.02;
const BATCHES: u64 = 16;
const LUMINANCE: usize = 1;

fn plan_of(scene: &Scene, integrator: Integrator, leaving: &Leaving) -> Plan {
    let view = scene.view().expect("a camera");
    Plan::under(scene, &view.sensor, integrator.strategies(), leaving)
}

/// Every channel of every pixel, in this order.
fn picture(scene: &Scene, integrator: Integrator, plan: &Plan, spp: u64, seed: u64) -> Vec<Vec<f64>> {
    let view = scene.view().expect("a camera");
    let budget = Budget { samples_per_pixel: spp, time: None, error: None, seed };
    let film = integrator.render(scene, view, plan, &budget, &Silent).film;
    assert_eq!(film.faults.count, 0, "{:?}", film.faults.named);
    let channel = |channel| (0..film.pixels()).map(|pixel| film.mean(pixel, channel)).collect();
    (0..view.sensor.channels.len()).map(channel).collect()
}

fn bits(picture: &[Vec<f64>]) -> Vec<u64> {
    picture.iter().flatten().map(|value| value.to_bits()).collect()
}

#[test]
fn what_decides_nothing_changes_no_bit() {
    const SPP: u64 = 4;
    let mut seen = BTreeSet::new();
    for (json, _) in SMALL {
        let scene = scene(&json());
        let view = scene.view().expect("a camera");
        let mut names = SAME_BITS.to_vec();
        if !view.camera.has_aperture() {
            names.push("meets-eye");
        }
        let more = Leaving::all_but(names.iter().copied()).expect("items");
        for integrator in [Integrator::Path, Integrator::Light, Integrator::Bdpt] {
            let plan = Plan::of(&scene, &view.sensor, integrator.strategies());
            let left: Vec<&str> = left_out(&plan).into_iter().filter(|name| names.contains(name)).collect();
            if left.is_empty() {
                continue;
            }
            let [lean, kept] = [Leaving::all(), more]
                .map(|leaving| picture(&scene, integrator, &plan_of(&scene, integrator, &leaving), SPP, 1));
            assert!(bits(&lean) == bits(&kept), "{}, {}: {left:?}", scene.name, integrator.name());
            seen.extend(left);
        }
    }
    let expected: BTreeSet<&str> = SAME_BITS.into_iter().chain(["meets-eye"]).collect();
    assert_eq!(seen, expected, "every item was left out somewhere");
}

/// Weights from densities of all wavelengths, which are all the same, round otherwise than those
/// of one: by a few roundings of `f32` for each contribution, of which a pixel is a sum of
/// positive ones.
#[test]
fn densities_of_one_wavelength_are_those_of_all() {
    const SPP: u64 = 4;
    const ROUNDING: f64 = 16.0 * f32::EPSILON as f64;
    for json in [common::diffuse(), common::glossy(), common::glass(), common::tiny_bulb()] {
        let scene = scene(&json);
        let kept = Leaving::all_but(["lane-densities"]).expect("an item");
        for integrator in [Integrator::Path, Integrator::Light, Integrator::Bdpt] {
            let [one, all] = [Leaving::all(), kept]
                .map(|leaving| picture(&scene, integrator, &plan_of(&scene, integrator, &leaving), SPP, 1));
            for (a, b) in one.iter().flatten().zip(all.iter().flatten()) {
                let what = format!("{}, {}", scene.name, integrator.name());
                assert!((a - b).abs() <= ROUNDING * a.abs().max(b.abs()), "{what}: {a} and {b}");
            }
        }
    }
}

/// Judges a plan against the full one; samples per pixel in each batch.
fn against_full(scene: &Scene, integrator: Integrator, lean: &Plan, spp: u64) -> Agreement {
    let [width, height] = scene.view().expect("a camera").camera.resolution().map(|side| side as usize);
    let batches = |plan: &Plan, first: u64| -> Vec<Vec<f64>> {
        let batch = |seed| picture(scene, integrator, plan, spp, seed).swap_remove(LUMINANCE);
        (first..first + BATCHES).map(batch).collect()
    };
    let full = plan_of(scene, integrator, &Leaving::none());
    let agreement = Agreement::of(&batches(lean, 1000), &batches(&full, 2000), width, height, MARGIN);
    println!("{}, {}, lean against full\n{agreement}", scene.name, integrator.name());
    agreement
}

fn assert_same_picture(json: &Value, integrator: Integrator, spp: u64) {
    let scene = scene(json);
    let lean = plan_of(&scene, integrator, &Leaving::all());
    let agreement = against_full(&scene, integrator, &lean, spp);
    assert!(agreement.verdict == Verdict::Equal, "{}: {agreement}", scene.name);
}

macro_rules! same_picture {
    ($($test:ident: $scene:path, $integrator:ident, $spp:expr;)*) => {
        /// The scenes and integrators that are judged.
        const JUDGED: &[(fn() -> Value, Integrator)] = &[$(($scene, Integrator::$integrator),)*];
        $(#[test]
        fn $test() {
            assert_same_picture(&$scene(), Integrator::$integrator, $spp);
        })*
    };
}

// Samples per pixel and batch from a first run's estimate of what the margin needs.
same_picture! {
    a_matte_room_by_path: common::diffuse, Path, 8;
    a_matte_room_by_bdpt: common::diffuse, Bdpt, 8;
    a_wide_lens_by_light: common::thin_lens, Light, 64;
    a_wide_lens_by_bdpt: common::thin_lens, Bdpt, 16;
    a_point_light_by_bdpt: common::point_light, Bdpt, 16;
    absorbing_glass_by_path: common::camera_in_absorbing_glass, Path, 64;
    a_dispersive_prism_by_bdpt: common::dispersive_prism, Bdpt, 24;
    few_wavelengths_by_path: scenes::band, Path, 24;
    lines_by_path: scenes::lines, Path, 16;
    a_chart_by_bdpt: scenes::chart, Bdpt, 8;
    mirrors_by_bdpt: scenes::mirrors, Bdpt, 8;
    glass_by_mlt: common::glass, Mlt, 32;
}

#[test]
fn every_item_is_judged() {
    let mut seen = BTreeSet::new();
    for (json, integrator) in JUDGED {
        let scene = scene(&json());
        let view = scene.view().expect("a camera");
        seen.extend(left_out(&Plan::of(&scene, &view.sensor, integrator.strategies())));
    }
    assert_eq!(seen, PLAN_ITEMS.into_iter().collect());
}

/// Leaving out what a scene needs is noticed: each of these plans is spoilt in one thing.
fn assert_noticed(json: &Value, integrator: Integrator, spp: u64, spoil: impl Fn(&mut Plan)) {
    let scene = scene(json);
    let mut plan = plan_of(&scene, integrator, &Leaving::all());
    spoil(&mut plan);
    let agreement = against_full(&scene, integrator, &plan, spp);
    assert!(agreement.verdict == Verdict::Different, "{}: {agreement}", scene.name);
}

#[test]
fn a_cut_of_20_nm_is_noticed() {
    // The lamp's radiance rises from 500 to 550 nm and falls to 600: 8 % of it lies beyond 580.
    assert_noticed(&scenes::band(), Integrator::Path, 24, |plan| {
        let weights: Vec<f64> = etalon::spectrum::grid_nm()
            .map(|nm| if nm < 580.0 { plan.wavelengths.pdf_per_nm(nm + 0.5) } else { 0.0 })
            .collect();
        plan.wavelengths = WavelengthSampler::proportional_to(&weights).expect("most is left");
    });
}

#[test]
fn media_that_are_not_tracked_are_noticed() {
    let glass = common::camera_in_absorbing_glass();
    assert_noticed(&glass, Integrator::Path, 24, |plan| plan.tracks_media = false);
}

#[test]
fn light_that_must_meet_the_lens_is_missed() {
    let glass = scenes::point_in_glass();
    assert_noticed(&glass, Integrator::Bdpt, 32, |plan| plan.strategies.meets_eye = false);
}

#[test]
fn a_point_light_in_view_is_missed() {
    let room = scenes::point_in_view();
    assert_noticed(&room, Integrator::Bdpt, 8, |plan| plan.strategies.light_to_eye = false);
}

#[test]
fn one_density_for_wavelengths_that_part_is_noticed() {
    let prism = common::dispersive_prism();
    assert_noticed(&prism, Integrator::Bdpt, 24, |plan| plan.lanes_differ = false);
}

#[test]
fn the_first_of_two_lamps_in_place_of_a_choice_is_noticed() {
    let prism = common::dispersive_prism();
    assert_noticed(&prism, Integrator::Bdpt, 8, |plan| plan.chooses_lamps = false);
}
