//! Every strategy alone, unweighted, against closed forms and against every other one.

mod common;

use common::alone::{Findings, alone};
use common::{SIGMAS, assert_reads, illuminance, luminance, metered, read_with, scene};
use etalon::camera::Sensor;
use etalon::integrator::{Draw, Integrator, Tracer};
use etalon::path::{Eye, Strategies, Subpaths};
use etalon::sampler::{BlockSampler, Stream};
use etalon::scene::{Plan, Scene};
use etalon::statistics::{BATCHES, BatchMean};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Vertices of the longest paths compared.
const LONGEST: usize = 5;

fn camera(position: [f64; 3], look_at: [f64; 3], lens: bool) -> Value {
    let mut camera = json!({ "position": position, "look_at": look_at, "up": [0.1, 1, 0], "focal_length_mm": 500,
        "sensor_mm": [600, 600], "resolution": [8, 8], "iso": 100, "shutter_s": 0.01, "f_stop": 1 });
    if lens {
        camera["focus_distance"] = json!(1.4);
    }
    camera
}

/// The inside of a shining ball: joining two points of it has the constant geometry term
/// 1 / (4 R^2), and paths of n vertices carry Le rho^(n-2), found by whichever strategy.
#[test]
fn in_the_ball_every_strategy_finds_the_closed_form() {
    const ALBEDO: f64 = 0.6;
    for lens in [false, true] {
        let scene = scene(&json!({
            "name": "ball", "length_unit": "m",
            "materials": { "wall": { "lambertian": { "reflectance": ALBEDO } } },
            "objects": [{ "shape": { "sphere": { "center": [0, 0, 0], "radius": 1 } }, "material": "wall",
                "emission": { "spectrum": 1, "level": { "spectral_radiance_factor": 1 }, "two_sided": true } }],
            "camera": camera([0.1, 0.2, -0.4], [0.3, 0.0, 0.5], lens),
        }));
        // The outside shines too: half of what leaves the ball's surface is lost.
        for n in 2..=LONGEST {
            for s in 0..=n {
                let t = n - s;
                if t == 0 && !lens {
                    continue;
                }
                // Few subpaths from the light meet the lens.
                let samples = [1 << 20, 1 << 18, 1 << 16][t.min(2)];
                let found = alone(&scene, (s, t), samples);
                let truth = ALBEDO.powi(n as i32 - 2);
                let [reading] = found.values().collect::<Vec<_>>()[..] else {
                    panic!("strategy ({s}, {t}): one class of paths, found {:?}", found.keys());
                };
                let (mean, error) = (reading.mean, reading.standard_error);
                assert!(error < 0.05 * truth, "({s}, {t}): too noisy to judge: {mean} +- {error}");
                assert!(
                    (mean - truth).abs() <= SIGMAS * error + 1e-5 * truth,
                    "({s}, {t}), lens {lens}: {mean} +- {error}, truth {truth}"
                );
            }
        }
    }
}

/// A round room, so that nothing is met at a corner: what joins of near points find has a
/// finite variance.
fn round_room(objects: Value, camera: Value) -> Scene {
    let mut all = vec![
        json!({ "shape": { "sphere": { "center": [0, 0, 0], "radius": 1.5 } }, "material": "satin" }),
        json!({ "shape": { "sphere": { "center": [0.2, 1.0, 0.1], "radius": 0.2 } }, "material": "grey",
            "emission": { "spectrum": 1, "level": { "spectral_radiance_factor": 1 } } }),
    ];
    all.extend(objects.as_array().expect("a list").clone());
    scene(&json!({
        "name": "round room", "length_unit": "m",
        "materials": {
            "satin": { "conductor": { "metal": "gold", "roughness_alpha": 0.7, "two_sided": true } },
            "grey": { "lambertian": { "reflectance": 0.7 } },
            "crown": { "dielectric": { "index": 1.5 } },
            "flint": { "dielectric": { "index": { "abbe": { "nd": 1.6, "vd": 30 } } } },
            "ground": { "dielectric": { "index": 1.5, "roughness_alpha": 0.5 } },
            "mirror": { "mirror": { "reflectance": 0.8 } },
        },
        "objects": all, "camera": camera,
    }))
}

fn ball(center: [f64; 3], radius: f64, material: &str) -> Value {
    json!({ "shape": { "sphere": { "center": center, "radius": radius } }, "material": material })
}

/// Within a class of paths all strategies that reach it agree. One judgement in 1.7 million is
/// a false alarm; there are some 200.
fn assert_strategies_agree(name: &str, scene: &Scene, samples: u32) {
    let lens = scene.view().expect("a camera").camera.has_aperture();
    let (mut compared, mut sharp) = (0, 0);
    for n in 3..=LONGEST {
        let mut by_class: BTreeMap<String, Findings> = BTreeMap::new();
        for s in 0..=n {
            if s == n && !lens {
                continue;
            }
            for (class, mean) in alone(scene, (s, n - s), samples) {
                by_class.entry(class).or_default().push(((s, n - s), mean));
            }
        }
        for (class, means) in by_class {
            // The surest strategy is the judge of the others.
            let by_error = |a: &&((usize, usize), BatchMean), b: &&((usize, usize), BatchMean)| {
                a.1.standard_error.total_cmp(&b.1.standard_error)
            };
            let Some((judge, truth)) = means.iter().min_by(by_error) else { continue };
            for (strategy, mean) in means.iter().filter(|(strategy, _)| strategy != judge) {
                let error = mean.standard_error.hypot(truth.standard_error);
                compared += 1;
                sharp += usize::from(error < 0.1 * truth.mean);
                assert!(
                    (mean.mean - truth.mean).abs() <= SIGMAS * error + 1e-5 * truth.mean,
                    "{name}, class {class}: {strategy:?} finds {} +- {}, {judge:?} {} +- {}",
                    mean.mean,
                    mean.standard_error,
                    truth.mean,
                    truth.standard_error
                );
            }
        }
    }
    assert!(2 * sharp >= compared && sharp > 5, "{name}: only {sharp} of {compared} comparisons within 10 %");
}

#[test]
fn strategies_agree_in_a_glossy_room() {
    let objects = json!([ball([-0.5, -0.6, 0.3], 0.4, "grey"), ball([0.6, -0.5, 0.4], 0.35, "ground")]);
    let scene = round_room(objects, camera([0.0, 0.0, -1.2], [0.0, -0.3, 1.0], true));
    assert_strategies_agree("glossy room", &scene, 1 << 18);
}

/// Camera and matte core inside glass: light that enters and does not leave keeps its n^2.
#[test]
fn strategies_agree_in_the_aquarium() {
    let objects = json!([ball([0.0, -0.2, 0.0], 0.9, "crown"), ball([0.2, -0.3, 0.3], 0.3, "grey")]);
    let scene = round_room(objects, camera([-0.1, -0.2, -0.6], [0.1, -0.25, 0.4], false));
    assert_strategies_agree("aquarium", &scene, 1 << 18);
}

#[test]
fn strategies_agree_behind_dispersive_glass_and_mirrors() {
    let objects = json!([
        ball([-0.5, -0.6, 0.3], 0.4, "mirror"),
        ball([0.4, 0.3, 0.2], 0.4, "flint"),
        ball([0.2, -0.8, 0.2], 0.3, "grey")
    ]);
    let scene = round_room(objects, camera([0.0, 0.0, -1.2], [0.0, -0.2, 1.0], true));
    assert_strategies_agree("dispersive", &scene, 1 << 19);
}

fn point_lamp(flux_lm: f64) -> Value {
    json!([{ "point": { "position": [0, 0, 0], "emission": { "spectrum": { "blackbody": { "temperature_k": 6500 } },
        "level": { "flux_lm": flux_lm } } } }])
}

/// E = Phi / (4 pi R^2 (1 - rho)), direct light included.
#[test]
fn an_integrating_sphere_multiplies_its_lamp() {
    for (albedo, truth, samples) in
        [(0.5, 270.56, 1 << 15), (0.9, 1352.82, 1 << 15), (0.98, 6764.09, 1 << 13)]
    {
        let materials = json!({ "wall": { "lambertian": { "reflectance": albedo } } });
        let objects = json!([ball([0.0; 3], 1.0, "wall")]);
        let meter = illuminance([0.0, 0.0, -1.0], [0.0, 0.0, 1.0]);
        let scene = metered(materials, objects, point_lamp(1700.0), meter);
        let reading = read_with(&scene, Integrator::Bdpt, samples);
        assert_reads(&format!("albedo {albedo}"), &reading, truth, 5e-3);
    }
}

/// A point light at the centre of a lossless glass sphere: all light leaves along radii, after
/// however many reflections, so a white board outside is lit as without the sphere. Path
/// tracing cannot find any of it.
#[test]
fn glass_around_a_point_light_changes_nothing_outside() {
    let read = |integrator: Integrator| {
        let scene = scene(&json!({
            "name": "lamp in glass", "length_unit": "m",
            "materials": { "glass": { "dielectric": { "index": 1.5 } }, "white": { "lambertian": { "reflectance": 1 } } },
            "objects": [ball([0.0; 3], 0.25, "glass"),
                { "shape": { "disk": { "center": [0, 0, 1], "normal": [0, 0, -1], "radius": 0.8 } }, "material": "white" }],
            "lights": [{ "point": { "position": [0, 0, 0], "emission": { "spectrum": "cie-e", "level": { "intensity_cd": 1000 } } } }],
            "camera": { "position": [2, 0, 0.2], "look_at": [0, 0, 1], "up": [0, 1, 0], "focal_length_mm": 50,
                "sensor_mm": [24, 24], "resolution": [4, 4], "iso": 100, "shutter_s": 0.01, "f_stop": 8 },
        }));
        picture_mean(&scene, integrator, 1 << 20)
    };
    assert_eq!(read(Integrator::Path).mean, 0.0);
    // E = I cos / d^2 = I / (1 + r^2)^1.5 at r from the board's middle, L = E / pi.
    let truth = 1000.0 / std::f64::consts::PI * mean_falloff();
    for integrator in [Integrator::Light, Integrator::Bdpt] {
        let reading = read(integrator);
        let (mean, error) = (reading.mean, reading.standard_error);
        assert!(error < 5e-3 * truth, "too noisy to judge: {mean} +- {error}");
        assert!((mean - truth).abs() < SIGMAS * error, "{integrator:?}: {mean} +- {error}, truth {truth}");
    }
}

/// Mean of 1 / (1 + r^2)^1.5 over the board as the camera above sees it, by projecting a grid of
/// the picture onto the board.
fn mean_falloff() -> f64 {
    const STEPS: i32 = 1000;
    let (eye, forward) = (glam::DVec3::new(2.0, 0.0, 0.2), glam::DVec3::new(-2.0, 0.0, 0.8).normalize());
    let right = forward.cross(glam::DVec3::Y).normalize();
    let up = right.cross(forward);
    let mut sum = 0.0;
    for row in 0..STEPS {
        for column in 0..STEPS {
            let at = |index: i32| 0.24 * (2.0 * (f64::from(index) + 0.5) / f64::from(STEPS) - 1.0);
            let direction = forward + right * at(column) + up * at(row);
            let hit = eye + direction * ((1.0 - eye.z) / direction.z);
            let squared = hit.x * hit.x + hit.y * hit.y;
            sum += if squared < 0.64 { 1.0 / (1.0 + squared).powf(1.5) } else { 0.0 };
        }
    }
    sum / f64::from(STEPS * STEPS)
}

/// Mean luminance of a picture.
fn picture_mean(scene: &Scene, integrator: Integrator, samples: u32) -> BatchMean {
    let view = scene.view().expect("a camera");
    mean_under(scene, &Plan::of(scene, &view.sensor, integrator.strategies()), samples)
}

/// Mean luminance of a picture under a plan.
fn mean_under(scene: &Scene, plan: &Plan, samples: u32) -> BatchMean {
    let view = scene.view().expect("a camera");
    let tracer = Tracer::new(scene, plan, Eye::Camera(&view.camera));
    let [width, height] = view.camera.resolution().map(f64::from);
    let size = samples / BATCHES as u32;
    let batch = |batch: usize| {
        let numbers = BlockSampler::new(23, 0, batch as u32, size);
        let (mut sum, mut paths) = (0.0, Subpaths::default());
        for index in 0..size {
            let sampler = numbers.sample(index);
            let wavelengths = plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
            let [x, y] = sampler.pair(Stream::Pixel, 0).map(f64::from);
            let draw =
                Draw { position: [x * width, y * height], wavelengths: &wavelengths, sampler: &sampler };
            tracer.trace(&draw, &mut paths, &mut |found| {
                let put = |channel, value| sum += if channel == 1 { value } else { 0.0 };
                view.sensor.record(found.estimate * found.weight, &wavelengths, put);
            });
        }
        sum / f64::from(size)
    };
    BatchMean::of(&std::array::from_fn(batch))
}

/// What a plan leaves out of bidirectional path tracing is found by what it keeps: in scenes
/// where each strategy that is ever left out finds something of its own.
#[test]
fn what_a_plan_leaves_out_is_not_missed() {
    let lamp = |position: [f64; 3]| json!({ "point": { "position": position, "emission": { "spectrum": "cie-e", "level": { "flux_lm": 100 } } } });
    let room = |objects: Value, lights: Value, lens: bool| {
        let mut camera = camera([0.0, 0.0, -1.2], [0.0, -0.2, 1.0], lens);
        camera["f_stop"] = json!(2);
        let mut all = vec![ball([0.0; 3], 1.5, "wall")];
        all.extend(objects.as_array().expect("a list").clone());
        scene(&json!({
            "name": "room", "length_unit": "m",
            "materials": {
                "wall": { "lambertian": { "reflectance": 0.3, "two_sided": true } },
                "crown": { "dielectric": { "index": 1.5 } },
                "smoke": { "dielectric": { "index": 1.2, "absorption_per_m": 0.7 } },
                "mirror": { "mirror": { "reflectance": 0.8 } },
            },
            "objects": all, "lights": lights, "camera": camera,
        }))
    };
    let shining = json!([{ "shape": { "sphere": { "center": [0.3, 0.6, 0.2], "radius": 0.2 } }, "material": "wall",
        "emission": { "spectrum": "cie-e", "level": { "luminance_cd_m2": 100 } } }]);
    let smoke = json!([{ "shape": { "box": { "min": [-0.6, -0.6, -0.9], "max": [0.6, 0.6, -0.1] } }, "material": "smoke" }]);
    let scenes = [
        (
            "point lamp in glass before a lens",
            room(json!([ball([0.1, -0.1, 0.3], 0.3, "crown")]), json!([lamp([0.1, -0.1, 0.3])]), true),
        ),
        ("point lamp in view of a lens", room(json!([]), json!([lamp([0.1, -0.1, 0.3])]), true)),
        ("point lamp in view of a pinhole", room(json!([]), json!([lamp([0.1, -0.1, 0.3])]), false)),
        ("point lamp in smoke before a lens", room(smoke.clone(), json!([lamp([0.0, -0.1, -0.5])]), true)),
        ("ball behind smoke before a lens", room(json!([smoke[0], shining[0]]), json!([]), true)),
        ("ball before a lens", room(shining, json!([]), true)),
    ];
    for (name, scene) in scenes {
        let view = scene.view().expect("a camera");
        let planned = Plan::of(&scene, &view.sensor, Strategies::ALL);
        let full = Plan { strategies: Strategies::ALL, ..planned.clone() };
        let [a, b] = [planned, full].map(|plan| mean_under(&scene, &plan, 1 << 19));
        let error = a.standard_error.hypot(b.standard_error);
        assert!(error < 0.02 * b.mean, "{name}: too noisy to judge: {} +- {error}", b.mean);
        assert!(
            (a.mean - b.mean).abs() < SIGMAS * error,
            "{name}: planned {} +- {}, all strategies {} +- {}",
            a.mean,
            a.standard_error,
            b.mean,
            b.standard_error
        );
        // An integrator with other strategies for most of it.
        let others = [Integrator::Path, Integrator::Light];
        let reaches =
            |other: &Integrator| Plan::of(&scene, &view.sensor, other.strategies()).unreachable.is_empty();
        let other = others.into_iter().find(reaches).expect("one reaches everything");
        let c = picture_mean(&scene, other, 1 << 19);
        let error = a.standard_error.hypot(c.standard_error);
        assert!(error < 0.05 * a.mean, "{name}: too noisy to judge by {other:?}: {} +- {error}", c.mean);
        assert!(
            (a.mean - c.mean).abs() < SIGMAS * error,
            "{name}: {} by {other:?} {} +- {error}",
            a.mean,
            c.mean
        );
    }
}

/// A prism of BK7 at minimum deviation, seen by the walk from the eye at the lines F, d and C:
/// 39.13811, 38.64670, 38.42914 degrees.
#[test]
fn a_prism_deviates_as_its_glass_demands() {
    for (line_nm, truth_deg) in [(486.1327, 39.138_11), (587.5618, 38.646_70), (656.2725, 38.429_14)] {
        let deviation = prism_deviation_deg(line_nm, truth_deg);
        assert!((deviation - truth_deg).abs() < 2e-5, "{line_nm} nm: {deviation} for {truth_deg} degrees");
    }
}

/// Deviation of a ray that enters a prism of 60 degrees as minimum deviation demands.
fn prism_deviation_deg(line_nm: f64, expected_deg: f64) -> f64 {
    // Apex up; the ray enters the left face at (apex + deviation) / 2 from its normal.
    let half = 30.0_f64.to_radians();
    let incidence = 0.5 * (60.0 + expected_deg).to_radians();
    let (apex, base) = ([0.0, half.cos(), 0.0], half.sin());
    let corner = |x: f64, z: f64| [x, 0.0, z];
    let quad = |v: [[f64; 3]; 4]| json!({ "shape": { "quad": { "vertices": v } }, "material": "glass" });
    let above = |z: f64| [apex[0], apex[1], z];
    let (left, right) = (-base, base);
    // The left face's normal points left and up by 30 degrees.
    let angle = incidence - half;
    let direction = [angle.cos(), angle.sin(), 0.0];
    let start = [-0.25 - direction[0], 0.5 * half.cos() - direction[1], 0.0];
    let scene = metered(
        json!({ "glass": { "dielectric": { "index": "n-bk7" } }, "black": { "lambertian": { "reflectance": 0 } } }),
        json!([
            quad([corner(left, -1.0), corner(left, 1.0), above(1.0), above(-1.0)]),
            quad([corner(right, 1.0), corner(right, -1.0), above(-1.0), above(1.0)]),
            quad([corner(left, 1.0), corner(left, -1.0), corner(right, -1.0), corner(right, 1.0)]),
            { "shape": { "sphere": { "center": [0, 0, 0], "radius": 4 } }, "material": "black",
              "emission": { "spectrum": { "lines": { "lines": [{ "wavelength_nm": line_nm, "power": 1 }] } },
                "level": { "luminance_cd_m2": 100 }, "two_sided": true } }
        ]),
        json!([]),
        luminance(start, direction),
    );
    let plan = Plan::of(&scene, &Sensor::cie(), Strategies::ALL);
    let etalon::scene::MeterKind::Luminance { position, direction } = scene.meters[0].kind else {
        unreachable!("a luminance meter")
    };
    let tracer = Tracer::new(&scene, &plan, Eye::Radiance(etalon::geometry::Ray::new(position, direction)));
    let mut paths = Subpaths::default();
    for index in 0..1000 {
        let sampler = BlockSampler::new(1, 0, 0, 1000).sample(index);
        let wavelengths = plan.wavelengths.sample(0.5);
        let draw = Draw { position: [0.5; 2], wavelengths: &wavelengths, sampler: &sampler };
        tracer.trace(&draw, &mut paths, &mut |_| {});
        // In by the left face, out by the right one, on to the shell.
        if let [_, entry, exit, shell, ..] = &paths.eye[..]
            && shell.point.position.length() * scene.geometry.metres_per_unit() as f32 > 3.9
            && exit.point.normal.x > 0.1
        {
            let inside = (exit.point.position - entry.point.position).as_dvec3();
            assert!(inside.y.abs() < 1e-4 * inside.length(), "minimum deviation runs level: {inside}");
            let out = (shell.point.position - exit.point.position).as_dvec3().normalize();
            let into = direction.as_dvec3().normalize();
            return into.cross(out).length().atan2(into.dot(out)).to_degrees();
        }
    }
    panic!("no path passes the prism");
}

/// The mean of 1 / p over what is drawn with density p is the size of what is covered: here
/// the area of the room's wall, reached from a light and from the eye by one bounce.
#[test]
fn walks_land_as_densely_as_they_say() {
    let scene = scene(&json!({
        "name": "shell", "length_unit": "m",
        "materials": { "satin": { "conductor": { "metal": { "n": 0, "k": 1 }, "roughness_alpha": 0.8, "two_sided": true } } },
        "objects": [ball([0.0; 3], 1.0, "satin")],
        "lights": [{ "point": { "position": [0.2, 0.1, 0.3], "emission": { "spectrum": "cie-e", "level": { "flux_lm": 100 } } } }],
        "camera": camera([0.1, 0.2, -0.4], [0.3, 0.0, 0.5], false),
    }));
    let view = scene.view().expect("a camera");
    let plan = Plan::of(&scene, &Sensor::cie(), Strategies::ALL);
    let tracer = Tracer::new(&scene, &plan, Eye::Camera(&view.camera));
    let unit = scene.geometry.metres_per_unit();
    let truth = 4.0 * std::f64::consts::PI / (unit * unit);
    const SIZE: u32 = 1 << 13;
    let mut sums = [[[0.0; BATCHES]; 2]; 2];
    #[expect(clippy::needless_range_loop, reason = "the number names the batch as well")]
    for batch in 0..BATCHES {
        let numbers = BlockSampler::new(29, 0, batch as u32, SIZE);
        for index in 0..SIZE {
            let sampler = numbers.sample(index);
            let wavelengths = plan.wavelengths.sample(0.5);
            let [x, y] = sampler.pair(Stream::Pixel, 0).map(|u| 8.0 * f64::from(u));
            let draw = Draw { position: [x, y], wavelengths: &wavelengths, sampler: &sampler };
            let mut paths = Subpaths::default();
            tracer.trace(&draw, &mut paths, &mut |_| {});
            for (side, walk) in [&paths.light, &paths.eye].into_iter().enumerate() {
                // The light's first wall vertex sees all of the wall; the eye's only through
                // the picture. The second is drawn by the material, roulette apart, from the
                // hemisphere above: all of the wall.
                for (step, vertex) in walk.iter().skip(1).take(2).enumerate() {
                    if side == 0 || step == 1 {
                        let density = vertex.forward.hero() * f64::from(vertex.survival);
                        sums[side][step][batch] += 1.0 / (density * f64::from(SIZE));
                    }
                }
            }
        }
    }
    for (side, step) in [(0, 0), (0, 1), (1, 1)] {
        let mean = BatchMean::of(&sums[side][step]);
        // A facet that mirrors below the surface ends the walk: what is missing is known only
        // to be missing, so the wall may come out too small, never too large.
        let covered = mean.mean / truth;
        assert!(mean.standard_error < 0.01 * truth, "side {side}, step {step}: too noisy");
        let most = 1.0 + SIGMAS * mean.standard_error / truth + 1e-5;
        assert!(covered < most, "side {side}, step {step}: {covered} of the wall");
        let least = if step == 0 { 1.0 - 1e-4 } else { 0.98 };
        assert!(
            covered > least - SIGMAS * mean.standard_error / truth,
            "side {side}, step {step}: {covered} of the wall"
        );
    }
}
