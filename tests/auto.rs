//! The algorithm that is picked where none is named: from figures that are right, the same on any
//! number of threads, and rendered with as if it had been named.

mod common;

use common::program::{etalon, folder, json_file};
use common::{SIGMAS, scene, scenes};
use etalon::integrator::{Budget, Integrator, Silent, Tracer};
use etalon::path::{Eye, Groups, Subpaths};
use etalon::pilot::{By, Choice, Selection, choose};
use etalon::sampler::BlockSampler;
use etalon::scene::{Plan, Scene};
use etalon::statistics::{BATCHES, BatchMean};
use std::path::Path;

/// Samples of a batch.
const SAMPLES: u32 = 1 << 13;

/// A budget large enough for a pilot of some thousand pixels.
fn budget(seed: u64) -> Budget {
    Budget { samples_per_pixel: 1 << 12, time: None, error: None, seed }
}

fn reference(name: &str) -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference").join(name).join("scene.json");
    Scene::load(&file).expect("a reference scene")
}

fn chosen(scene: &Scene, budget: &Budget) -> Choice {
    let mut view = scene.view().expect("a camera").clone();
    view.camera = view.camera.with_resolution([64, 48]);
    choose(scene, &view, budget, None)
}

/// What is summed over the samples of a batch under a plan: of each contribution weighted luminance,
/// luminance, and the path's number.
fn batches(
    scene: &Scene,
    groups: Groups,
    value: impl Fn(f64, f64, f64, &etalon::path::Shares) -> f64,
) -> BatchMean {
    let view = scene.view().expect("a camera");
    let plan = Plan::of(scene, &view.sensor, groups.strategies());
    let tracer = Tracer::new(scene, &plan, Eye::Camera(&view.camera));
    let [width, height] = view.camera.resolution();
    let mut paths = Subpaths::default();
    paths.shares = Some(Vec::new());
    let batch = |batch: usize| {
        let mut sum = 0.0;
        for index in 0..SAMPLES {
            // Every sample has a pixel and numbers of its own, and no list shares them with another.
            let seed = groups.strategies().splats() as u64 + 2 * u64::from(groups.joins);
            let numbers = BlockSampler::new(seed, u64::from(index), batch as u32, 1);
            let corner = [index % width, index / width % height].map(f64::from);
            let mut found = Vec::new();
            tracer.sample(corner, &numbers.sample(0), &mut paths, &mut |path, wavelengths| {
                let mut luminance = 0.0;
                view.sensor.record(path.estimate, wavelengths, |channel, value| {
                    luminance = if channel == 1 { value } else { luminance };
                });
                found.push((luminance, f64::from(path.weight), f64::from(path.kept), path.number));
            });
            let shares = paths.shares.as_deref().expect("asked for");
            sum += found
                .iter()
                .map(|(luminance, weight, kept, number)| {
                    value(*luminance, *weight, *kept, &shares[*number as usize])
                })
                .sum::<f64>();
        }
        sum / f64::from(SAMPLES)
    };
    let all: Vec<f64> = (0..BATCHES).map(batch).collect();
    BatchMean::of(&all.try_into().expect("as many as there are batches"))
}

/// The squares that a list of strategies contributes have the mean that all strategies together
/// predict. Three comparisons on each of two scenes, each with a false alarm in 1.7 million; the
/// figures must be known to 10 %.
#[test]
fn second_moments_are_predicted_by_strategies_that_a_list_does_not_have() {
    for json in [scenes::diffuse(), scenes::glossy()] {
        let scene = scene(&json);
        let view = scene.view().expect("a camera");
        for groups in
            [Groups::PATH, Groups { joins: false, ..Groups::ALL }, Groups { splats: false, ..Groups::ALL }]
        {
            let strategies = Plan::of(&scene, &view.sensor, groups.strategies()).strategies;
            let seen = batches(&scene, groups, |luminance, weight, kept, shares| {
                (weight * luminance).powi(2) * kept * shares.survival
            });
            let predicted = batches(&scene, Groups::ALL, |luminance, weight, kept, shares| {
                let moment = shares.second_moment(&strategies).expect("the list makes every path");
                weight * luminance * luminance * kept * shares.survival * moment
            });
            let error = seen.standard_error.hypot(predicted.standard_error);
            let what = format!(
                "{} {groups}: {} predicted, {} +- {error} seen",
                scene.name, predicted.mean, seen.mean
            );
            assert!(error < 0.1 * seen.mean, "too noisy to judge: {what}");
            assert!((predicted.mean - seen.mean).abs() < SIGMAS * error, "{what}");
        }
    }
}

/// Light that a list cannot find is seen to be missing: of a bulb that is a point within glass.
#[test]
fn what_a_list_cannot_make_is_known_as_missing() {
    let scene = scene(&scenes::light_in_glass());
    let choice = chosen(&scene, &budget(1));
    let plan = Plan::of(&scene, &scene.view().expect("a camera").sensor, Groups::ALL.strategies());
    for row in &choice.report.candidates {
        let Integrator::Mlt = row.name.integrator else {
            let strategies = row.name.strategies();
            let own = Plan::of(&scene, &scene.view().expect("a camera").sensor, strategies);
            let misses = own.unreachable.len() > plan.unreachable.len();
            assert!(!misses || row.excluded.is_some(), "{}", row.name);
            continue;
        };
    }
    let picked = choice.selection.strategies();
    let own = Plan::of(&scene, &scene.view().expect("a camera").sensor, picked);
    assert_eq!(own.unreachable, plan.unreachable, "{}", choice.selection);
}

/// The figures are those of counted work and named random numbers, to the last bit.
#[test]
fn figures_do_not_depend_on_the_number_of_threads() {
    let scene = scene(&scenes::glossy());
    let figures = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let report = pool.install(|| chosen(&scene, &budget(3))).report;
        assert_eq!(report.by, By::Pilot);
        serde_json::to_string(&(report.candidates, report.counts, report.pick)).expect("JSON")
    };
    assert_eq!(figures(1), figures(3));
}

/// A room of matte walls under a lamp that paths find is no place for chains.
#[test]
fn chains_are_not_tried_where_samples_do_well() {
    let choice = chosen(&scene(&scenes::diffuse()), &budget(1));
    assert_eq!((choice.report.by, choice.report.mutations), (By::Pilot, 0), "{}", choice.report);
    assert_ne!(choice.selection.integrator, Integrator::Mlt);
}

/// Path tracing hardly ever finds the light of a small bulb over smooth metal and in glass, and looks
/// sure of itself: the pilot is not taken in, whatever its seed.
#[test]
fn light_that_paths_hardly_find_is_not_left_to_them() {
    for name in ["schoedl-2007-small-bulb", "schoedl-2007-glass-bulb"] {
        let scene = reference(name);
        for seed in 1..=4 {
            let choice = chosen(&scene, &budget(seed));
            assert_eq!(choice.report.by, By::Pilot);
            assert_ne!(
                choice.selection,
                Selection::whole(Integrator::Path),
                "{name}, seed {seed}: {}",
                choice.report
            );
        }
    }
}

/// Where too little is rendered for a pilot to learn from, what the scene is made of decides.
#[test]
fn a_small_render_has_no_pilot() {
    let little = Budget { samples_per_pixel: 4, ..budget(1) };
    let of = |json| {
        let choice = chosen(&scene(&json), &little);
        assert_eq!((choice.report.by, choice.report.samples), (By::Rule, 0));
        choice.selection
    };
    assert_eq!(of(scenes::diffuse()), Selection::whole(Integrator::Path));
    assert_eq!(of(scenes::glass()), Selection::whole(Integrator::Bdpt));
}

/// The same groups under two names make the same picture, bit for bit.
#[test]
fn groups_make_the_picture_of_the_algorithm_that_they_are() {
    let scene = scene(&scenes::glossy());
    let view = scene.view().expect("a camera");
    let budget = Budget { samples_per_pixel: 4, time: None, error: None, seed: 5 };
    for (groups, integrator) in [
        (Groups::PATH, Integrator::Path),
        (Groups::LIGHT, Integrator::Light),
        (Groups::ALL, Integrator::Bdpt),
    ] {
        let of = |integrator: Integrator, strategies| {
            let plan = Plan::of(&scene, &view.sensor, strategies);
            let film = integrator.render(&scene, view, &plan, &budget, &Silent).film;
            (0..film.pixels()).map(|pixel| film.mean(pixel, 1).to_bits()).collect::<Vec<_>>()
        };
        assert_eq!(of(Integrator::Bdpt, groups.strategies()), of(integrator, integrator.strategies()));
        assert_eq!(Selection::of_groups(groups), Selection::whole(integrator));
    }
}

/// Facts of a render of the program, and the values of its picture.
fn rendered(folder: &Path, name: &str, scene: &str, options: &str) -> (serde_json::Value, String, Vec<u8>) {
    let [exr, png, report] = ["exr", "png", "json"].map(|ending| folder.join(format!("{name}.{ending}")));
    let mut words = vec!["render".into(), scene.to_owned()];
    for (option, file) in [("-o", &exr), ("--png", &png), ("--report", &report)] {
        words.extend([option.to_owned(), file.to_str().expect("UTF-8").to_owned()]);
    }
    words.extend(options.split_whitespace().map(ToOwned::to_owned));
    let ran = etalon(&words);
    assert_eq!(ran.code, 0, "{}", ran.err);
    (
        json_file(&report),
        ran.out,
        etalon::image::read_facts(&exr).map(|_| std::fs::read(&png)).expect("an EXR").expect("a PNG"),
    )
}

/// What auto picks is rendered as if it had been named, says so, and its samples can be taken again.
#[test]
fn the_pick_is_rendered_as_if_it_had_been_named() {
    let folder = folder("the_pick");
    let scene = "reference/schoedl-2007/scene.json";
    let size = "--spp 160 --resolution 96x96 --seed 4";
    let (auto, said, picture) = rendered(&folder, "auto", scene, size);
    assert!(said.contains("auto: "), "{said}");
    let mut named = format!("{size} --integrator {}", auto["integrator"].as_str().expect("a name"));
    if let Some(groups) = auto["groups"].as_str() {
        named += &format!(" --groups {groups}");
    }
    let (facts, said, same) = rendered(&folder, "named", scene, &named);
    assert!(!said.contains("auto: ") && facts["auto"].is_null());
    assert_eq!(auto["relative_error"], facts["relative_error"]);
    assert!(picture == same, "{named}");
    assert_eq!(auto["auto"]["by"], "pilot");
    let replay = |name: &str| {
        let exr = folder.join(format!("{name}.exr"));
        etalon(["replay", scene, "--from", exr.to_str().expect("UTF-8"), "--pixel", "40,60", "--index", "3"])
            .out
    };
    assert_eq!(replay("auto").replace("auto.exr", ""), replay("named").replace("named.exr", ""));
}

/// A run that is gone on with keeps what was picked for it, whatever would be picked now.
#[test]
fn a_resumed_run_keeps_its_pick() {
    let folder = folder("resumed_pick");
    let checkpoint = folder.join("run.checkpoint");
    let keep = format!("--checkpoint {}", checkpoint.display());
    let scene = "tests/files/sound.json";
    let named = format!("--spp 4 --resolution 8x8 --integrator bdpt --groups path,joins {keep}");
    let (_, _, picture) = rendered(&folder, "named", scene, &named);
    let (facts, said, again) =
        rendered(&folder, "resumed", scene, &format!("--spp 4 --resolution 8x8 {keep} --resume"));
    assert!(said.contains("auto: bdpt path,joins, as picked"), "{said}");
    assert_eq!(facts["groups"], "path,joins");
    assert!(picture == again);
    let mut other = vec!["render", scene, "-o", "x.exr", "--spp", "4", "--resolution", "8x8", "--resume"];
    let file = checkpoint.to_str().expect("UTF-8");
    other.extend(["--checkpoint", file, "--integrator", "bdpt"]);
    let refused = etalon(other);
    assert_eq!(refused.code, 2);
    assert!(refused.err.contains("bdpt path,joins"), "{}", refused.err);
}

#[test]
fn groups_belong_to_bdpt() {
    for (words, fault) in [
        ("--integrator path --groups path", "--groups path are groups of strategies of bdpt"),
        ("--integrator bdpt --groups path,splat", "did you mean \"splats\"?"),
        ("--groups path", "--integrator"),
    ] {
        let fixed = ["render", "tests/files/sound.json", "-o", "x.exr"];
        let ran = etalon(fixed.into_iter().chain(words.split(' ')));
        assert_eq!(ran.code, 2, "{words}");
        assert!(ran.err.contains(fault), "{words}: {}", ran.err);
    }
}
