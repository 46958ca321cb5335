//! The algorithm that is picked where none is named: from figures that are right, the same on any
//! number of threads, and rendered with as if it had been named.

mod common;

use common::program::{etalon, folder, json_file};
use common::{SIGMAS, scene, scenes};
use etalon::integrator::{Budget, Integrator, Silent, Tracer};
use etalon::path::{Eye, Groups, Subpaths};
use etalon::pilot::{By, Choice, Selection, choose};
use etalon::sampler::BlockSampler;
use etalon::scene::{Leaving, Plan, Scene};
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
    choose(scene, &view, budget, None, &Leaving::all())
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

/// A point of light within a glass ball: light that no path from the camera meets.
fn point_in_glass() -> serde_json::Value {
    let mut json = scenes::light_in_glass();
    let lamp = json["objects"]
        .as_array_mut()
        .and_then(|objects| {
            let lamp = objects.iter().position(|object| object["emission"].is_object())?;
            Some(objects.remove(lamp))
        })
        .expect("a lamp");
    json["lights"] =
        serde_json::json!([{ "point": { "position": [0.1, 1.0, 0.4], "emission": lamp["emission"] } }]);
    json
}

/// Light that a list cannot find is seen to be missing, and how much of all that is.
#[test]
fn what_a_list_cannot_make_is_known_as_missing() {
    let scene = scene(&point_in_glass());
    let sensor = &scene.view().expect("a camera").sensor;
    let unreachable = |groups: Groups| Plan::of(&scene, sensor, groups.strategies()).unreachable;
    let choice = chosen(&scene, &budget(1));
    assert_eq!(choice.report.by, By::Pilot, "{}", choice.report);
    let mut missers = 0;
    for row in choice.report.candidates.iter().filter(|row| row.name.integrator != Integrator::Mlt) {
        let own = Plan::of(&scene, sensor, row.name.strategies()).unreachable;
        if own.len() > unreachable(Groups::ALL).len() {
            let reason = row.excluded.as_deref().unwrap_or_default();
            assert!(reason.contains(" % of the light"), "{}: {reason}", row.name);
            missers += 1;
        }
    }
    assert!(missers > 0, "{:?}", choice.report.candidates);
    assert!(choice.report.to_string().contains("path misses light"), "{}", choice.report);
    let own = Plan::of(&scene, sensor, choice.selection.strategies()).unreachable;
    assert_eq!(own, unreachable(Groups::ALL), "{}", choice.selection);
}

fn scene_of_the_readme() -> Scene {
    let readme = include_str!("../README.md");
    let start = readme.find("```json\n").expect("the README shows a scene") + "```json\n".len();
    let length = readme[start..].find("```").expect("the scene ends");
    Scene::from_text(&readme[start..start + length], Path::new(".")).expect("a scene")
}

/// A scene as a user has it first: there is light in it, and the pilot finds it whatever its seed.
#[test]
fn the_scene_in_the_readme_has_a_pilot() {
    let scene = scene_of_the_readme();
    let view = scene.view().expect("a camera");
    for seed in 0..8 {
        let ordinary = Budget { samples_per_pixel: 64, ..budget(seed) };
        let choice = choose(&scene, view, &ordinary, None, &Leaving::all());
        println!("seed {seed}: {}", choice.report);
        assert_eq!(choice.report.by, By::Pilot, "seed {seed}: {}", choice.report);
    }
}

/// Caustics on what the glass ball stands on are too rare for paths from the camera, whatever the
/// pilot's seed.
#[test]
fn the_scene_in_the_readme_is_not_left_to_path() {
    let scene = scene_of_the_readme();
    let view = scene.view().expect("a camera");
    for seed in 0..8 {
        let ordinary = Budget { samples_per_pixel: 64, ..budget(seed) };
        let choice = choose(&scene, view, &ordinary, None, &Leaving::all());
        assert_ne!(choice.selection, Selection::whole(Integrator::Path), "seed {seed}: {}", choice.report);
    }
}

/// Past a door that is hardly open, chains win by far, and by counted work alone.
#[test]
fn chains_are_picked_where_they_win_by_far() {
    let choice = chosen(&reference("door-ajar"), &budget(1));
    println!("{}", choice.report);
    assert_eq!(choice.report.by, By::Pilot);
    assert_eq!(choice.selection, Selection::whole(Integrator::Mlt), "{}", choice.report);
}

/// The figures are those of counted work and named random numbers, to the last bit, those of chains
/// as well.
#[test]
fn figures_do_not_depend_on_the_number_of_threads() {
    let figures = |scene: &Scene, threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let report =
            pool.install(|| chosen(scene, &Budget { samples_per_pixel: 1 << 11, ..budget(3) })).report;
        assert_eq!(report.by, By::Pilot);
        let words = serde_json::to_string(&(report.candidates, report.counts, report.pick)).expect("JSON");
        (words, report.mutations)
    };
    let (glossy, door) = (scene(&scenes::glossy()), reference("door-ajar"));
    assert_eq!(figures(&glossy, 1), figures(&glossy, 3));
    let by_chains = figures(&door, 1);
    assert!(by_chains.1 > 0, "chains were not tried: {}", by_chains.0);
    assert_eq!(by_chains, figures(&door, 3));
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
        ran.out + &ran.err,
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
    assert!(said.contains("going on from 4 samples per pixel of bdpt --groups path,joins"), "{said}");
    assert_eq!(facts["groups"], "path,joins");
    assert!(picture == again);
    let mut other = vec!["render", scene, "-o", "x.exr", "--spp", "4", "--resolution", "8x8", "--resume"];
    let file = checkpoint.to_str().expect("UTF-8");
    other.extend(["--checkpoint", file, "--integrator", "bdpt"]);
    let refused = etalon(other);
    assert_eq!(refused.code, 2);
    assert!(refused.err.contains("bdpt --groups path,joins"), "{}", refused.err);
}

#[test]
fn groups_belong_to_bdpt() {
    for (words, fault) in [
        ("--integrator path --groups path", "--groups path are groups of strategies of bdpt"),
        ("--integrator bdpt --groups path,splat", "did you mean \"splats\"?"),
        ("--groups path,joins", "add --integrator bdpt"),
    ] {
        let fixed = ["render", "tests/files/sound.json", "-o", "x.exr"];
        let ran = etalon(fixed.into_iter().chain(words.split(' ')));
        assert_eq!(ran.code, 2, "{words}");
        assert!(ran.err.contains(fault), "{words}: {}", ran.err);
    }
    let alone = etalon(["render", "tests/files/sound.json", "-o", "x.exr", "--groups", "path"]);
    assert_eq!(alone.err.trim().lines().count(), 1, "{}", alone.err);
}

/// Light that groups miss and all together find is not blamed on the scene.
#[test]
fn a_warning_names_the_group_that_would_find_the_light() {
    let folder = folder("groups_to_add");
    let file = folder.join("point_in_glass.json");
    std::fs::write(&file, point_in_glass().to_string()).expect("a scene");
    let warned = |scene: &str, groups: &str| {
        rendered(
            &folder,
            "warned",
            scene,
            &format!("--spp 1 --resolution 8x8 --integrator bdpt --groups {groups}"),
        )
        .1
    };
    let said = warned("tests/files/sound.json", "joins");
    assert!(said.contains("; add path to --groups"), "{said}");
    let said = warned(file.to_str().expect("UTF-8"), "path,joins");
    assert!(said.contains("; add splats to --groups"), "{said}");
}
