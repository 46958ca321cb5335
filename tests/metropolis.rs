//! Chains of paths see the same pictures as independent samples.

mod common;

use common::{scene, scenes};
use etalon::integrator::{Budget, Integrator, Silent};
use etalon::scene::{Plan, Scene};
use etalon::statistics::{Agreement, MARGIN, Verdict};
use serde_json::Value;

/// Independent runs of either side.
const SEEDS: u64 = 16;
const LUMINANCE: usize = 1;
/// Largest |z| of the difference of two whole pictures: for one pair a false alarm once in
/// 16 000, for the 28 pairs once in 560.
const MOST_SIGMAS: f64 = 4.0;

/// Luminance pictures of independent runs.
fn runs(scene: &Scene, integrator: Integrator, samples_per_pixel: u64) -> Vec<Vec<f64>> {
    let view = scene.view().expect("a camera");
    let plan = Plan::of(scene, &view.sensor, integrator.strategies());
    let run = |run: u64| {
        let seed = run + 1000 * (1 + integrator as u64) + 10_000 * fresh();
        let budget = Budget { samples_per_pixel, time: None, seed };
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
        println!("{name}, mlt against {}: {:+.3} % +- {:.3} %, z = {z:+.2}", other.name(), 100.0 * off, 100.0 * sigma);
        let agreement = Agreement::of(&mlt, &others, width, height, MARGIN);
        println!("{agreement}");
        assert!(z.abs() < MOST_SIGMAS, "{name}, mlt against {}: z = {z}", other.name());
        assert!(!matches!(agreement.verdict, Verdict::Different), "{name}, mlt against {}: {agreement}", other.name());
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
    a_diffuse_room: diffuse, 256, 64, 128;
    a_glossy_room: glossy, 256, 64, 128;
    glass: glass, 256, 64, 128;
    a_dispersive_prism: dispersive_prism, 256, 64, 128;
    metal_and_mirrors: metal, 256, 64, 128;
    a_wide_lens: thin_lens, 256, 64, 128;
    a_tiny_bulb: tiny_bulb, 256, 64, 128;
    a_large_panel: large_panel, 256, 64, 128;
    a_point_light: point_light, 256, 64, 128;
    a_light_in_glass: light_in_glass, 256, 64, 128;
    a_camera_in_glass: camera_in_glass, 256, 64, 128;
    a_camera_in_absorbing_glass: camera_in_absorbing_glass, 256, 64, 128;
    smooth_normals_on_flat_faces: smooth_normals, 256, 64, 128;
    the_ball: ball, 256, 64, 128;
}
