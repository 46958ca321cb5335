//! The level of a picture: what seeds agree on, and what the stated interval holds.

use super::{rendering, report};
use crate::common::{scene, scenes};
use crate::record::Record;
use etalon::integrator::Integrator;
use etalon::metropolis::{Report, World};
use etalon::path::Strategies;
use etalon::scene::Plan;
use serde_json::json;

/// 97.5 % quantile of the normal distribution.
const Z_975: f64 = 1.959_964;

// Case 64.
pub fn seeds_agree_and_chains_that_have_not_mixed_say_so(record: &mut Record) {
    /// 120 pairs, each a false alarm once in 16 000: once in 130 draws of the seeds.
    const MOST_SIGMAS: f64 = 4.0;
    const SEEDS: u64 = 16;
    /// Samples per pixel of a run that is too short to mix.
    const SHORT: u64 = 16;
    for json in [scenes::diffuse(), scenes::light_in_glass()] {
        let scene = scene(&json);
        let short: Vec<Report> = (0..SEEDS)
            .map(|run| {
                // By night as well: these runs are to be too short.
                report(&rendering(&scene, Integrator::Mlt, SHORT, record.seed().wrapping_add(run))).clone()
            })
            .collect();
        let level = |report: &Report| {
            let [low, high] = report.normalisation_ci95;
            (report.normalisation, 0.5 * (high - low) / Z_975)
        };
        let mut farthest = 0.0_f64;
        for (index, one) in short.iter().enumerate() {
            for other in &short[..index] {
                let ((a, error_a), (b, error_b)) = (level(one), level(other));
                farthest = farthest.max((a - b).abs() / error_a.hypot(error_b));
            }
        }
        let name = &json["name"];
        record.at_most(format!("{name}: largest |z| of two of 16 seeds"), farthest, MOST_SIGMAS);
        let noise = short.iter().map(|report| level(report).1 / level(report).0).fold(0.0, f64::max);
        record.at_most(format!("{name}: largest standard error of a level, relative"), noise, 0.05);
        let unsure = short.iter().filter(|report| !report.mixed).count();
        let said = short.iter().filter(|report| report.to_string().contains("not mixed")).count();
        record.exactly(format!("{name}: short runs that say they have not mixed"), said, unsure);
        record.at_least(format!("{name}: short runs that have not mixed"), unsure as f64, 1.0);
    }
    let mut json = scenes::ball();
    json["camera"]["resolution"] = json!([16, 16]);
    let long = rendering(&scene(&json), Integrator::Mlt, record.samples(8192), record.seed());
    let reduction = report(&long).scale_reduction.expect("there are many chains");
    record.at_most("a long run: scale reduction between chains, 16 blocks", reduction, 1.01);
    record.says("a long run", &report(&long).to_string(), ": mixed");
}

// Case 65.
pub fn the_interval_of_the_level_holds_the_truth(record: &mut Record) {
    const JUDGED: u64 = 100;
    /// Finds that a run is to have on average.
    const FINDS: f64 = 20.0;
    let scene = scene(&scenes::crack_of(0.018));
    let view = scene.view().expect("a camera");
    let plan = Plan::of(&scene, &view.sensor, Strategies::ALL);
    let world = World::new(&scene, view, &plan);
    let long = world.search(record.seed(), 0, record.samples(1 << 20)).estimates;
    let hits = long.found as f64 / long.paths as f64;
    let paths = (FINDS / hits) as u64;
    // The truth is known to some percent, of a level that each run knows to thirty. With 95 of
    // 100 expected, a false alarm in 36 draws of the seeds; as the interval is a conservative
    // one, fewer.
    let holds = |run: &u64| {
        let [low, high] = world.search(record.seed(), 1 + run, paths).estimates.interval();
        (low..high).contains(&long.mean())
    };
    let held = (0..JUDGED).filter(holds).count();
    record.absolute("probability that a fresh path finds light", hits, 1.25e-3, 0.75e-3);
    record.at_most("standard error of the truth, relative", long.standard_error() / long.mean(), 0.1);
    record.at_least("intervals of 100 that hold the truth", held as f64, 90.0);
}
