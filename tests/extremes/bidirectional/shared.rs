//! Weights: what strategies share of one path.

use crate::common::alone::alone_with;
use crate::common::contributions::each_contribution;
use crate::common::rooms::rooms;
use crate::common::scene;
use crate::record::Record;
use etalon::measure::AreaPdf;
use etalon::path::{Known, Made, Strategies, Whole};
use etalon::spectrum::Spectrum;
use etalon::statistics::BatchMean;
use serde_json::json;

/// A vertex of a path as weights know it, by its densities from the light and from the eye.
fn known([light, eye]: [f64; 2], is_delta: bool) -> Known {
    let [light, eye] = [light, eye].map(AreaPdf::of_all_lanes);
    Known { light, eye, lanes: Spectrum::ONE, is_delta }
}

/// Sum of the weights of all strategies that can make a path.
fn sum_of_weights(vertices: &[Known], asked: f64, can: impl Fn(usize) -> bool) -> f64 {
    let count = vertices.len();
    let weight =
        |from_light: usize| Made { vertices, count, from_light, asked }.judge::<f64>(&Strategies::ALL).weight;
    (0..=count).filter(|s| can(*s)).map(weight).sum()
}

// Case 58.
pub fn weights_of_all_strategies_of_a_path_add_up_to_one(record: &mut Record) {
    /// Two computations in 32 bits of the same weight may differ by this share of it, and by so
    /// much where hardly anything is left.
    const ROUNDING: [f64; 2] = [2e-3, 1e-6];
    let [few, many] = [1 << 9, 1 << 11].map(|samples| record.samples(samples) as u32);
    let mut all = 0_u64;
    for (name, scene) in rooms() {
        let (mut farthest, mut faulty, mut largest) = (0.0_f64, 0_u64, 0.0_f64);
        let check = |whole: &Whole<'_, '_>| {
            let (densities, asked) = whole.vertex_densities();
            let vertices: Vec<Known> =
                densities.iter().enumerate().map(|(i, pair)| known(*pair, whole.is_delta(i))).collect();
            sum_of_weights(&vertices, asked, |s| whole.is_made_by(&Strategies::ALL, s))
        };
        each_contribution(&scene, Strategies::ALL, (many, record.seed()), |_, _, whole, _| {
            let sum = check(&whole);
            faulty += u64::from(!sum.is_finite());
            farthest = farthest.max((sum - 1.0).abs());
            all += 1;
        });
        each_contribution(&scene, Strategies::ALL, (few, record.seed()), |found, _, whole, _| {
            let (fast, slow) = (f64::from(found.weight), whole.weights(&Strategies::ALL)[found.s]);
            largest = largest.max((fast - slow).abs() / (ROUNDING[0] * slow + ROUNDING[1]));
        });
        record.at_most(format!("{name}: largest distance of a sum from one"), farthest, 1e-9);
        record.exactly(format!("{name}: sums that are no number"), faulty, 0);
        let what =
            format!("{name}: largest difference of a weight in use from the whole path's, in roundings");
        record.at_most(what, largest, 1.0);
    }
    record.at_least("recorded paths", all as f64, record.by_day_or_night(1e5, 1e6));
    record.note("A run by night judges the 1e6 paths of the catalogue, over all scenes together; one by day a tenth of them. Weights in use are compared with the whole path's on a quarter of the samples.");
}

// Case 58.
pub fn ratios_of_ten_thousand_thirty_times_over_and_deltas_leave_weights_sound(record: &mut Record) {
    // 30 squared ratios of 1e4 are 1e240, and with twice as many vertices beyond any f64.
    for vertices in [32, 64, 1000] {
        for (what, ratio) in [
            ("the light surer at every vertex", [1e4, 1.0]),
            ("the eye surer at every vertex", [1.0, 1e4]),
            ("both alike", [1.0, 1.0]),
        ] {
            for delta_every in [0, 2, 3] {
                let is_delta = |i: usize| delta_every > 0 && i % delta_every == 1 && i + 1 < vertices;
                let path: Vec<Known> = (0..vertices).map(|i| known(ratio, is_delta(i))).collect();
                let open = |s: usize| s == 0 || s == vertices || !is_delta(s - 1) && !is_delta(s);
                let sum = sum_of_weights(&path, ratio[0], open);
                let mirrors =
                    if delta_every == 0 { String::new() } else { format!(", every {delta_every}. a mirror") };
                record.absolute(
                    format!("{vertices} vertices, {what}{mirrors}: sum of weights"),
                    sum,
                    1.0,
                    1e-9,
                );
            }
        }
    }
}

// Case 63.
pub fn every_two_strategies_for_paths_of_one_length_agree(record: &mut Record) {
    /// Some 40 pairs: a false alarm once in 400 draws of the seeds.
    const MOST_SIGMAS: f64 = 4.0;
    let scene = scene(&json!({
        "name": "ball", "length_unit": "m",
        "materials": { "wall": { "lambertian": { "reflectance": 0.6 } } },
        "objects": [{ "shape": { "sphere": { "center": [0, 0, 0], "radius": 1 } }, "material": "wall",
            "emission": { "spectrum": 1, "level": { "spectral_radiance_factor": 1 }, "two_sided": true } }],
        "camera": { "position": [0.1, 0.2, -0.4], "look_at": [0.3, 0.0, 0.5], "up": [0.1, 1, 0], "focal_length_mm": 500,
            "sensor_mm": [600, 600], "resolution": [8, 8], "iso": 100, "shutter_s": 0.01, "f_stop": 0.5,
            "focus_distance": 1.4 },
    }));
    for vertices in 2..=5_usize {
        let all: Vec<((usize, usize), BatchMean)> = (0..=vertices)
            .map(|s| {
                let strategy = (s, vertices - s);
                // Few subpaths from the light meet the lens.
                let samples = record.samples([1 << 19, 1 << 16, 1 << 14][strategy.1.min(2)]);
                let found = alone_with(&scene, strategy, samples as u32, record.seed());
                (strategy, *found.values().next().expect("the strategy finds something"))
            })
            .collect();
        let mut farthest = (0.0_f64, String::new());
        for (index, (a, one)) in all.iter().enumerate() {
            for (b, other) in &all[..index] {
                // What no chance enters has rounding left.
                let error = one.standard_error.hypot(other.standard_error) + 1e-5 * other.mean;
                let z = (one.mean - other.mean).abs() / error;
                if z > farthest.0 {
                    farthest = (z, format!("{a:?} and {b:?}"));
                }
            }
        }
        let noise = all.iter().map(|(_, m)| m.standard_error / m.mean).fold(0.0, f64::max);
        let what = format!("{vertices} vertices: largest |z| of two strategies, {}", farthest.1);
        record.at_most(what, farthest.0, MOST_SIGMAS);
        record.at_most(format!("{vertices} vertices: largest standard error, relative"), noise, 0.05);
    }
    record.note("In the ball every strategy has support everywhere and finite variance; other rooms are compared pair by pair in tests/strategies.rs.");
}
