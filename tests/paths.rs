//! Paths as subpaths make them, against the same paths judged from their vertices alone.
//!
//! Every contribution of every strategy is taken apart into its vertices; value, densities and
//! weights computed from those by `Whole` must be what the walks multiplied up on their way.

mod common;

use common::contributions::each_contribution;
use common::rooms::rooms;
use etalon::integrator::Tracer;
use etalon::path::{Eye, Strategies, Subpaths, Vertex, needs_no_vertices};
use etalon::sampler::{BlockSampler, Sampler};
use etalon::scene::Plan;
use etalon::spectrum::LANES;

/// Largest relative difference of two computations in 32 bits of the same number.
const ROUNDING: f64 = 2e-3;
/// Share of a scene's mean contribution that is no contribution: at grazing angles in deep
/// paths nothing is left but rounding.
const NOTHING: f64 = 1e-5;

#[test]
fn contributions_are_value_over_density() {
    for (name, scene) in rooms() {
        let mut compared: Vec<(String, [f64; LANES], [f64; LANES])> = Vec::new();
        each_contribution(&scene, Strategies::ALL, (1 << 10, 3), |found, paths, whole, _| {
            // Roulette on the last step to the lens is not kept.
            if found.t == 0 {
                return;
            }
            let survival = |walk: &[Vertex], count: usize| match count {
                0 => 1.0,
                _ => walk.get(count - 1).map_or(1.0, |vertex| f64::from(vertex.survival)),
            };
            let alive = survival(if found.s > 1 { &paths.light } else { &[] }, found.s)
                * survival(&paths.eye, found.t);
            let truth = whole.estimate(found.s).expect("a path with a value");
            let value = found.estimate.0.map(|v| f64::from(v) * alive * f64::from(found.kept));
            compared.push((format!("{name}: strategy ({}, {})", found.s, found.t), value, truth));
        });
        let largest = |truth: &[f64; LANES]| truth.iter().copied().fold(0.0, f64::max);
        let mean = compared.iter().map(|(_, _, truth)| largest(truth)).sum::<f64>() / compared.len() as f64;
        for (what, value, truth) in &compared {
            let allowed = ROUNDING * largest(truth) + NOTHING * mean;
            let fits = value.iter().zip(truth).all(|(value, truth)| (value - truth).abs() <= allowed);
            assert!(fits, "{what}: {value:?}, whole {truth:?}");
        }
        assert!(compared.len() > 500, "{name}: {} contributions", compared.len());
    }
}

/// Path tracing that keeps no vertices finds what the general loop finds: the same paths with the
/// same estimates bit for bit, and weights that differ by the rounding of one measure or another.
#[test]
fn keeping_no_vertices_changes_nothing() {
    let (mut scenes, mut dispersive, mut all) = (0, 0, [0; 2]);
    for (name, scene) in rooms() {
        let view = scene.view().expect("a camera");
        for direct_only in [false, true] {
            let plan = Plan { direct_only, ..Plan::of(&scene, &view.sensor, Strategies::PATH) };
            if !needs_no_vertices(&plan) {
                assert!(plan.lanes_differ, "{name}");
                dispersive += 1;
                continue;
            }
            scenes += 1;
            let tracer = Tracer::new(&scene, &plan, Eye::Camera(&view.camera));
            let contributions = |sampler: &Sampler, forgetful: bool| {
                let mut paths = if forgetful { Subpaths::forgetful() } else { Subpaths::default() };
                let mut found = Vec::new();
                tracer.sample([3.0, 2.0], sampler, &mut paths, &mut |path, _| found.push(*path));
                assert_eq!(paths.eye.is_empty(), forgetful);
                (found, paths.fates)
            };
            let mut seen = [0; 2];
            for index in 0..1 << 10 {
                let sampler = BlockSampler::new(5, 0, 0, 1 << 10).sample(index);
                let (kept, forgotten) = (contributions(&sampler, false), contributions(&sampler, true));
                assert_eq!(kept.1, forgotten.1, "{name}");
                assert_eq!(kept.0.len(), forgotten.0.len(), "{name}");
                for (kept, forgotten) in kept.0.iter().zip(&forgotten.0) {
                    assert_eq!((kept.s, kept.t), (forgotten.s, forgotten.t), "{name}");
                    assert_eq!(kept.estimate, forgotten.estimate, "{name}: ({}, {})", kept.s, kept.t);
                    let (a, b) = (kept.weight, forgotten.weight);
                    assert!((a - b).abs() <= 4.0 * f32::EPSILON * a, "{name}: weights {a} and {b}");
                    seen[kept.s] += 1;
                }
            }
            all = [all[0] + seen[0], all[1] + seen[1]];
        }
    }
    assert_eq!(scenes + dispersive, 2 * rooms().len());
    assert!(
        scenes > dispersive && all.iter().all(|count| *count > 100),
        "{scenes} scenes, {all:?} contributions"
    );
}

/// Lists of strategies as plans have them, and odd ones.
fn lists() -> [(&'static str, Strategies); 7] {
    let all = Strategies::ALL;
    [
        ("all", all),
        ("path", Strategies::PATH),
        ("path for instruments", Strategies::PATH.for_instruments()),
        ("planned", Strategies { direct_asks_eye: false, light_to_eye: false, ..all }),
        ("no joins", Strategies { joins: false, ..all }),
        ("nothing asked", Strategies { asks_lights: false, light_to_eye: false, ..all }),
        ("nothing met", Strategies { meets_lights: false, meets_eye: false, ..all }),
    ]
}

/// The weight in use is the whole path's share of the strategy; it is kept in 32 bits.
#[test]
fn weights_are_those_of_the_whole_path() {
    for (name, scene) in rooms() {
        for (list, strategies) in lists() {
            // Close to one, where most weights are, or relative to what little is left.
            let (mut seen, mut sum, mut exact) = (std::collections::BTreeSet::new(), 0.0, 0.0);
            each_contribution(&scene, strategies, (1 << 8, 3), |found, _, whole, plan| {
                let weights = whole.weights(&plan.strategies);
                let (fast, slow) = (f64::from(found.weight), weights[found.s]);
                assert!(
                    (fast - slow).abs() < ROUNDING * slow + 1e-6,
                    "{name}, {list}: strategy ({}, {}): {fast}, whole {slow}, all {weights:?}",
                    found.s,
                    found.t
                );
                sum += fast;
                exact += slow;
                seen.insert((found.s.min(3), found.t.min(3)));
            });
            // Rounding goes both ways, a wrong factor does not.
            assert!((sum / exact - 1.0).abs() < 1e-5, "{name}, {list}: {sum} against {exact}");
            assert!(!seen.is_empty(), "{name}, {list}");
        }
    }
}
