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

/// Every channel of every pixel, in this order.
fn picture(scene: &Scene, integrator: Integrator, leaving: &Leaving, spp: u64, seed: u64) -> Vec<Vec<f64>> {
    let view = scene.view().expect("a camera");
    let plan = Plan::under(scene, &view.sensor, integrator.strategies(), leaving);
    let budget = Budget { samples_per_pixel: spp, time: None, error: None, seed };
    let film = integrator.render(scene, view, &plan, &budget, &Silent).film;
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
            let [lean, kept] =
                [Leaving::all(), more].map(|leaving| picture(&scene, integrator, &leaving, SPP, 1));
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
            let [one, all] =
                [Leaving::all(), kept].map(|leaving| picture(&scene, integrator, &leaving, SPP, 1));
            for (a, b) in one.iter().flatten().zip(all.iter().flatten()) {
                let what = format!("{}, {}", scene.name, integrator.name());
                assert!((a - b).abs() <= ROUNDING * a.abs().max(b.abs()), "{what}: {a} and {b}");
            }
        }
    }
}

/// Judges the bare plan against the full one; samples per pixel in each batch.
fn assert_same_picture(json: &Value, integrator: Integrator, spp: u64) {
    let scene = scene(json);
    let [width, height] = scene.view().expect("a camera").camera.resolution().map(|side| side as usize);
    let batches = |leaving: &Leaving, first: u64| -> Vec<Vec<f64>> {
        let batch = |seed| picture(&scene, integrator, leaving, spp, seed).swap_remove(LUMINANCE);
        (first..first + BATCHES).map(batch).collect()
    };
    let (lean, full) = (batches(&Leaving::all(), 1000), batches(&Leaving::none(), 2000));
    let agreement = Agreement::of(&lean, &full, width, height, MARGIN);
    let what = format!("{}, {}, lean against full", scene.name, integrator.name());
    println!("{what}\n{agreement}");
    assert!(agreement.verdict == Verdict::Equal, "{what}: {agreement}");
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
    a_point_in_glass_by_bdpt: scenes::point_in_glass, Bdpt, 64;
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
