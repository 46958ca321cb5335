//! Chains that stay where they are, cannot get elsewhere, or stand on nothing.

use super::{mean_of, over_runs, rendering, report};
use crate::common::rooms::rooms;
use crate::common::{scene, scenes};
use crate::record::Record;
use etalon::integrator::Integrator;
use etalon::metropolis::{Mutation, Mutator, Numbers, Path, Place, World, acceptance_of};
use etalon::path::Strategies;
use etalon::scene::Plan;
use rayon::prelude::*;
use serde_json::json;

// Case 68.
pub fn long_rejections_and_large_pixels_are_told(record: &mut Record) {
    let mut json = scenes::light_in_glass();
    // A point in glass lights nothing straight: the picture is what the chains leave.
    json["objects"].as_array_mut().expect("objects").retain(|object| !object["emission"].is_object());
    json["lights"] = json!([{ "point": { "position": [0.1, 1.1, 0.4],
        "emission": { "spectrum": "d65", "level": { "flux_lm": 400 } } } }]);
    let scene = scene(&json);
    let view = scene.view().expect("a camera");
    let plan = Plan::of(&scene, &view.sensor, Strategies::ALL);
    let world = World::new(&scene, view, &plan);
    let run = rendering(&scene, Integrator::Mlt, record.samples(64), record.seed());
    let told = report(&run);
    let film = &run.film;
    let weight =
        |pixel: usize| (0..film.channels()).map(|c| film.mean(pixel, c) * world.weights[c]).sum::<f64>();
    let all: f64 = (0..film.pixels()).map(weight).sum();
    let largest = (0..film.pixels()).map(weight).fold(0.0, f64::max) / all;
    record.relative(
        "largest share of one pixel",
        told.largest_pixel_share.unwrap_or(f64::NAN),
        largest,
        1e-9,
    );
    record.at_least("longest run of rejections", told.longest_rejection as f64, 10.0);
    let text = told.to_string();
    record.says("the report", &text, &format!("longest rejection run {} of", told.longest_rejection));
    record.says("the report", &text, &format!("largest share of one pixel {:.2} %", 100.0 * largest));
    record.note("No path is ever accepted for having been proposed long enough.");
}

// Case 69.
pub fn fresh_paths_are_always_among_the_mutations(record: &mut Record) {
    /// What chains propose, whatever path they are at.
    const FRESH: f64 = 0.2;
    for json in [scenes::diffuse(), scenes::crack()] {
        let run = rendering(&scene(&json), Integrator::Mlt, record.samples(128), record.seed());
        let told = report(&run);
        let fresh = told.mutation_table.iter().find(|row| row.mutation == Mutation::Fresh.name());
        let n = told.mutations as f64;
        let share = fresh.map_or(0.0, |row| row.proposed as f64 / n);
        let what = format!("{}: share of fresh paths among all mutations", json["name"]);
        record.mean(what, share, (FRESH * (1.0 - FRESH) / n).sqrt(), FRESH, 0.01);
    }
    record.note("There is no setting to leave fresh paths out: their share is a constant of the program.");
}

// Case 69.
pub fn rooms_beside_one_another_are_as_bright_as_by_independent_samples(record: &mut Record) {
    // A partition from wall to wall but for a gap beside the camera; the lamp is on one side.
    let mut json = scenes::diffuse();
    let objects = json["objects"].as_array_mut().expect("objects");
    objects.retain(|object| !object["emission"].is_object());
    objects.push(
        json!({ "shape": { "box": { "min": [-0.02, 0, 0.1], "max": [0.02, 2, 1] } }, "material": "white" }),
    );
    objects.push(json!({ "shape": { "quad": { "vertices": [[0.8, 1.99, 0.2], [0.8, 1.99, 0.8], [0.3, 1.99, 0.8], [0.3, 1.99, 0.2]] } },
        "material": "black", "emission": { "spectrum": "d65", "level": { "luminance_cd_m2": 1000 } } }));
    json["camera"]["position"] = json!([0.0, 1.0, -0.95]);
    json["camera"]["resolution"] = json!([16, 16]);
    let scene = scene(&json);
    let ratio = |integrator: Integrator, samples: u64, seed: u64| {
        over_runs(seed, |seed| {
            let run = rendering(&scene, integrator, samples, seed);
            // Columns in the middle see the edge of the partition.
            mean_of(&run, 1, |column| column >= 9) / mean_of(&run, 1, |column| column < 7)
        })
    };
    let chains = ratio(Integrator::Mlt, record.samples(1536), record.seed());
    let samples = ratio(Integrator::Bdpt, record.samples(128), record.seed().wrapping_add(1000));
    record.relative("one room over the other, mlt against bdpt", chains[0], samples[0], 0.02);
    record.same_mean("the same, by its errors", chains, samples, 0.01);
}

// Case 70.
pub fn chains_leave_paths_that_are_worth_nothing_or_no_number(record: &mut Record) {
    let steps = record.samples(12_000);
    let (mut proposed, mut complete) = (0_u64, 0_u64);
    for (name, scene) in rooms() {
        let view = scene.view().expect("a camera");
        let plan = Plan::of(&scene, &view.sensor, Strategies::ALL);
        let world = World::new(&scene, view, &plan);
        let starts =
            world.starts(&world.find(record.seed(), 4096, 1 << 24).found, 8, &mut Numbers::of(&[70]));
        let walk = |(chain, start): (usize, Path)| {
            let mut mutator = Mutator::new(&world, Place { key: record.seed(), chain: 0, bits: 0, drawn: 0 });
            let mut numbers = Numbers::of(&[record.seed(), 70, chain as u64]);
            let (mut x, mut y) = (start.clone(), Path::empty(start.wavelengths));
            // Proposals, paths proposed, paths proposed from one of no number, paths that are worth
            // nothing, and proposals from a worthless path that would not be taken.
            let mut counts = [0_u64; 5];
            for step in 0..steps {
                // Every so often the chain stands on nothing, or on no number.
                let spoilt = step % 7 == 0;
                let sound = x.ln_target;
                let no_number = spoilt && step % 2 == 1;
                if spoilt {
                    x.ln_target = if no_number { f64::NAN } else { f64::NEG_INFINITY };
                }
                let mutation = Mutation::ALL[numbers.index(Mutation::ALL.len())];
                counts[0] += 1;
                let applies = mutation.applies(&x);
                let ratio = if applies { mutator.propose(mutation, &x, &mut y, &mut numbers) } else { None };
                x.ln_target = sound;
                let Some(ratio) = ratio else { continue };
                counts[1] += 1;
                counts[2] += u64::from(no_number);
                counts[3] += u64::from(!y.ln_target.is_finite() || !y.ln_estimate().is_finite());
                let acceptance = acceptance_of(ratio);
                counts[4] += u64::from(spoilt && acceptance < 1.0);
                if numbers.fine() < acceptance {
                    std::mem::swap(&mut x, &mut y);
                }
            }
            counts
        };
        let all: Vec<[u64; 5]> = starts.into_par_iter().enumerate().map(walk).collect();
        let sum = |index: usize| all.iter().map(|counts| counts[index]).sum::<u64>();
        proposed += sum(0);
        complete += sum(1);
        record.exactly(format!("{name}: paths proposed from one whose worth is no number"), sum(2), 0);
        record.exactly(format!("{name}: paths handed over that are worth nothing"), sum(3), 0);
        record.exactly(
            format!("{name}: paths worth something that a worthless one is kept before"),
            sum(4),
            0,
        );
    }
    record.exactly("acceptance of a ratio that is no number", acceptance_of(f64::NAN), 0.0);
    record.exactly(
        "acceptance of a path worth something, before a worthless one",
        acceptance_of(f64::INFINITY),
        1.0,
    );
    record.at_least("steps", proposed as f64, record.by_day_or_night(1e6, 1e7));
    record.at_least("of which propose a path", complete as f64, record.by_day_or_night(1e5, 1e6));
    record.note("A run by night takes the 1e7 steps of the catalogue, one by day a tenth of them.");
    record.note("A worthless path is left for the first one that is worth something; where its worth is no number the proposal is void, and counted. A chain never starts at either.");
}
