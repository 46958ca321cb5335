//! Chains of paths see the same pictures as independent samples.

mod common;

use common::{scene, scenes};
use etalon::integrator::{Budget, Integrator, Rendering, Silent};
use etalon::scene::{Plan, Scene};
use etalon::statistics::{Agreement, MARGIN, Verdict};
use serde_json::{Value, json};

/// Independent runs of either side.
const SEEDS: u64 = 16;
const LUMINANCE: usize = 1;
/// Largest |z| of the difference of two whole pictures: for one pair a false alarm once in
/// 16 000, for the 28 pairs once in 560.
const MOST_SIGMAS: f64 = 4.0;
/// Largest standard error of such a difference, relative: noisier ones would agree with anything.
const MOST_NOISE: f64 = 0.006;

/// Luminance pictures of independent runs.
fn runs(scene: &Scene, integrator: Integrator, samples_per_pixel: u64) -> Vec<Vec<f64>> {
    let view = scene.view().expect("a camera");
    let plan = Plan::of(scene, &view.sensor, integrator.strategies());
    let run = |run: u64| {
        let seed = run + 1000 * (1 + integrator as u64) + 10_000 * fresh();
        let budget = Budget { samples_per_pixel, time: None, error: None, seed };
        let film = integrator.render(scene, view, &plan, &budget, &Silent).film;
        (0..film.pixels()).map(|pixel| film.mean(pixel, LUMINANCE)).collect()
    };
    (0..SEEDS).map(run).collect()
}

/// Moves all seeds, for fresh draws by hand: `ETALON_SEEDS=7 cargo test --test metropolis`.
fn fresh() -> u64 {
    std::env::var("ETALON_SEEDS").ok().and_then(|number| number.parse().ok()).unwrap_or(0)
}

/// Mean over a run's pixels: the mean over runs, and its variance.
fn whole(runs: &[Vec<f64>]) -> (f64, f64) {
    let means: Vec<f64> = runs.iter().map(|run| run.iter().sum::<f64>() / run.len() as f64).collect();
    let n = means.len() as f64;
    let mean = means.iter().sum::<f64>() / n;
    (mean, means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0) / n)
}

/// Judges a scene; the numbers are samples per pixel in each run.
fn assert_agree(json: &Value, mlt_spp: u64, bdpt_spp: u64, path_spp: u64) {
    assert_agree_within(json, mlt_spp, bdpt_spp, path_spp, MOST_NOISE);
}

/// The same with another limit of the noise.
fn assert_agree_within(json: &Value, mlt_spp: u64, bdpt_spp: u64, path_spp: u64, most_noise: f64) {
    let name = json["name"].as_str().expect("a name");
    let scene = scene(json);
    let [width, height] = scene.view().expect("a camera").camera.resolution().map(|side| side as usize);
    let mlt = runs(&scene, Integrator::Mlt, mlt_spp);
    for (other, spp) in [(Integrator::Bdpt, bdpt_spp), (Integrator::Path, path_spp)] {
        let others = runs(&scene, other, spp);
        let ((a, var_a), (b, var_b)) = (whole(&mlt), whole(&others));
        let z = (a - b) / (var_a + var_b).sqrt();
        let off = a / b - 1.0;
        let sigma = (var_a + var_b).sqrt() / b;
        println!(
            "{name}, mlt against {}: {:+.3} % +- {:.3} %, z = {z:+.2}",
            other.name(),
            100.0 * off,
            100.0 * sigma
        );
        let agreement = Agreement::of(&mlt, &others, width, height, MARGIN);
        println!("{agreement}");
        assert!(sigma < most_noise, "{name}, mlt against {}: too noisy to judge: {sigma}", other.name());
        assert!(z.abs() < MOST_SIGMAS, "{name}, mlt against {}: z = {z}", other.name());
        assert!(
            !matches!(agreement.verdict, Verdict::Different),
            "{name}, mlt against {}: {agreement}",
            other.name()
        );
    }
}

macro_rules! agree {
    ($($test:ident: $scene:ident, $mlt:expr, $bdpt:expr, $path:expr;)*) => {$(
        #[test]
        fn $test() {
            assert_agree(&scenes::$scene(), $mlt, $bdpt, $path);
        }
    )*};
}

// Samples per pixel and run for mlt, bdpt and path.
agree! {
    a_diffuse_room: diffuse, 192, 48, 96;
    a_glossy_room: glossy, 384, 48, 96;
    glass: glass, 192, 48, 96;
    a_dispersive_prism: dispersive_prism, 192, 48, 96;
    metal_and_mirrors: metal, 192, 48, 96;
    a_wide_lens: thin_lens, 192, 48, 96;
    a_tiny_bulb: tiny_bulb, 192, 48, 96;
    a_large_panel: large_panel, 192, 48, 96;
    a_point_light: point_light, 192, 48, 96;
    a_light_in_glass: light_in_glass, 192, 48, 96;
    a_camera_in_glass: camera_in_glass, 512, 96, 192;
    a_camera_in_absorbing_glass: camera_in_absorbing_glass, 192, 48, 96;
    smooth_normals_on_flat_faces: smooth_normals, 192, 48, 96;
    the_ball: ball, 192, 48, 96;
}

/// Glass that blurs what it refracts above 560 nm, and does nothing below: its vertices are
/// mirrors for one wavelength and not for another. A path's class must not depend on which of
/// them it might have been.
#[test]
fn glass_that_is_a_mirror_at_some_wavelengths() {
    let mut json = scenes::diffuse();
    json["name"] = json!("partly smooth");
    let index = json!({ "table": { "wavelengths_nm": [360, 559, 561, 830], "n": [1.0, 1.0, 1.4, 1.4] } });
    json["materials"]["glass"] = json!({ "dielectric": { "index": index, "roughness_alpha": 0.2 } });
    let slab = json!({ "shape": { "box": { "min": [-0.6, 0.3, -0.5], "max": [0.6, 1.9, -0.4] } }, "material": "glass" });
    json["objects"].as_array_mut().expect("objects").push(slab);
    // Two lines, on either side: between them lobes are so narrow that they are hardly found.
    for object in json["objects"].as_array_mut().expect("objects") {
        if object["emission"].is_object() {
            let lines = [500.0, 620.0].map(|nm| json!({ "wavelength_nm": nm, "power": 1.0 }));
            object["emission"]["spectrum"] = json!({ "lines": { "lines": lines } });
        }
    }
    // Surfaces that may be smooth count as stops of a walk even where they are: light that comes
    // through the slab twice is rare among fresh paths, and the pictures are noisy. Taking what is
    // blurred for direct light loses a quarter of them.
    assert_agree_within(&json, 384, 96, 192, 0.04);
}

/// Standard errors are what pictures of other seeds scatter by: sums over pixels of both
/// variances, from 24 runs. The scatter is known to a few percent as neighbours hardly depend on
/// each other; what is stated comes from 16 blocks.
#[test]
fn stated_errors_are_the_scatter_of_seeds() {
    const RUNS: u64 = 24;
    for json in [scenes::diffuse(), scenes::light_in_glass()] {
        let scene = scene(&json);
        let films: Vec<_> =
            (0..RUNS).map(|run| rendering(&scene, 64, 500 + run + 10_000 * fresh()).film).collect();
        let n = RUNS as f64;
        let (mut stated, mut scatter) = (0.0, 0.0);
        for pixel in 0..films[0].pixels() {
            let mean = films.iter().map(|film| film.mean(pixel, LUMINANCE)).sum::<f64>() / n;
            for film in &films {
                stated += film.standard_error(pixel, LUMINANCE).powi(2) / n;
                scatter += (film.mean(pixel, LUMINANCE) - mean).powi(2) / (n - 1.0);
            }
        }
        println!("{}: stated variance over scatter {:.3}", json["name"], stated / scatter);
        assert!((0.75..1.33).contains(&(stated / scatter)), "{}: {}", json["name"], stated / scatter);
    }
}

/// Light that is rare is either measured or said not to have been found: chains never go
/// without a level.
#[test]
fn few_samples_of_rare_light_have_a_level() {
    let scene = scene(&scenes::crack());
    for seed in 0..8 {
        let outcome = rendering(&scene, 1, seed).metropolis.expect("chains");
        let report = outcome.report.expect("there is light");
        assert!(report.fresh_paths_found >= 16, "{} found", report.fresh_paths_found);
        assert!(report.normalisation > 0.0 && report.normalisation_ci95.iter().all(|b| b.is_finite()));
    }
}

/// Renders a scene and returns what its chains say.
fn rendering(scene: &Scene, samples_per_pixel: u64, seed: u64) -> Rendering {
    let view = scene.view().expect("a camera");
    let plan = Plan::of(scene, &view.sensor, Integrator::Mlt.strategies());
    let budget = Budget { samples_per_pixel, time: None, error: None, seed };
    Integrator::Mlt.render(scene, view, &plan, &budget, &Silent)
}

/// Not a bit of the picture depends on the number of threads.
#[test]
fn threads_do_not_change_a_bit() {
    let scene = scene(&scenes::light_in_glass());
    let picture = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let film = pool.install(|| rendering(&scene, 20, 3)).film;
        let bits = |pixel: usize| {
            [0, 1, 2].map(|c| (film.mean(pixel, c).to_bits(), film.standard_error(pixel, c).to_bits()))
        };
        (0..film.pixels()).map(bits).collect::<Vec<_>>()
    };
    let one = picture(1);
    for threads in [2, 7, 64] {
        assert_eq!(one, picture(threads), "{threads} threads");
    }
}

/// A lamp of one line that is hardly luminous: chains see it by what any channel records, and
/// as bright as independent samples do.
#[test]
fn light_at_420_nm_alone_is_seen() {
    let mut json = scenes::light_in_glass();
    for object in json["objects"].as_array_mut().expect("objects") {
        if object["emission"].is_object() {
            object["emission"]["spectrum"] =
                json!({ "lines": { "lines": [{ "wavelength_nm": 420.0, "power": 1.0 }] } });
        }
    }
    json["name"] = json!("violet");
    assert_agree(&json, 64, 32, 64);
    let film = rendering(&scene(&json), 16, 1).film;
    let mean = |channel| (0..film.pixels()).map(|pixel| film.mean(pixel, channel)).sum::<f64>();
    assert!(mean(2) > 10.0 * mean(1) && mean(1) > 0.0, "Z {} Y {}", mean(2), mean(1));
}

/// Walls that reflect nothing: direct light is all there is, and the search for more says what
/// it knows.
#[test]
fn direct_light_alone_is_told_from_none() {
    let mut json = scenes::tiny_bulb();
    for object in json["objects"].as_array_mut().expect("objects") {
        if object["material"] == "blue" {
            continue;
        }
        object["material"] = json!("black");
    }
    let outcome = rendering(&scene(&json), 4, 1).metropolis.expect("chains");
    assert!(outcome.direct_light && outcome.report.is_none());
    let paths = outcome.found_none_in.expect("nothing beyond the block's direct light");
    assert_eq!(outcome.most_probable_hit(), Some(3.0 / paths as f64));
}
