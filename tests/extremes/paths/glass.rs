//! Glass that loses nothing: what it traps, and what it lets out.

use crate::common::{SIGMAS, luminance, metered};
use crate::record::Record;
use etalon::camera::Sensor;
use etalon::integrator::{Draw, Integrator, Tracer, eye_of, instrument_plan_under, read_meters_under};
use etalon::path::{Strategies, Subpaths};
use etalon::sampler::{BlockSampler, Stream};
use etalon::scene::{Leaving, Plan, Scene};
use serde_json::{Value, json};

const INDEX: f64 = 1.5;

fn lit(glass: Value, absorption_per_m: f64, lamp: [f64; 3], shell_radius: f64) -> Scene {
    let materials = json!({ "black": { "lambertian": { "reflectance": 0 } },
        "glass": { "dielectric": { "index": INDEX, "absorption_per_m": absorption_per_m } } });
    let shell = json!({ "sphere": { "center": [0, 0, 0], "radius": shell_radius } });
    let objects = json!([{ "shape": glass, "material": "glass" }, { "shape": shell, "material": "black" }]);
    let lights = json!([{ "point": { "position": lamp,
        "emission": { "spectrum": "cie-e", "level": { "intensity_cd": 1 } } } }]);
    metered(materials, objects, lights, luminance([0.0, 0.0, 0.9 * shell_radius], [0.0, 0.0, 1.0]))
}

fn cube() -> Value {
    json!({ "box": { "min": [-0.5, -0.5, -0.5], "max": [0.5, 0.5, 0.5] } })
}

fn ball(radius: f64) -> Value {
    json!({ "sphere": { "center": [0, 0, 0], "radius": radius } })
}

/// What walks from the lamp come to.
struct Emitted {
    /// Share of the power that reaches the shell.
    arrives: f64,
    /// Standard error of it.
    error: f64,
    /// Share that reaches it without having been reflected.
    at_once: f64,
    /// Share that was trapped.
    trapped: f64,
}

fn emit(scene: &Scene, samples: u64, seed: u64) -> Emitted {
    // Walks are looked at, not what they bring: a plan would leave out those that bring nothing.
    let plan = Plan::under(scene, &Sensor::cie(), Strategies::LIGHT, &Leaving::none());
    let tracer = Tracer::new(scene, &plan, eye_of(&scene.meters[0]));
    let mut paths = Subpaths::default();
    let (mut sum, mut squares, mut at_once) = (0.0, 0.0, 0.0);
    for index in 0..samples {
        let sampler = BlockSampler::new(seed, index, 0, 1).sample(0);
        let wavelengths = plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
        let draw = Draw { position: [0.5; 2], wavelengths: &wavelengths, sampler: &sampler };
        tracer.trace(&draw, &mut paths, &mut |_| {});
        let (Some(first), Some(last)) = (paths.light.get(1), paths.light.last()) else { continue };
        // Relative to what reaches the glass before it absorbs: nothing has been lost there, so
        // that the throughput is what the walk set out with.
        let before = std::f64::consts::TAU * 2.0;
        let is_outside = last.surface().is_some_and(|surface| surface.object == 1);
        if is_outside {
            let power = f64::from(last.throughput.hero()) / before;
            sum += power;
            squares += power * power;
            at_once += if paths.light.len() == 3 { power } else { 0.0 };
        }
        assert!(first.surface().is_some_and(|surface| surface.object == 0), "the lamp is in the glass");
    }
    let n = samples as f64;
    let arrives = sum / n;
    let error = ((squares / n - arrives * arrives).max(0.0) / n).sqrt();
    Emitted { arrives, error, at_once: at_once / n, trapped: paths.fates.from_lights.trapped_share() }
}

// Case 44. Of the light of a lamp in a cube, what meets all faces beyond the critical angle never
// leaves: 3 cos(c) - 2 of it. In a ball it is what leaves off the centre at more than the sine of
// 1 / (n r / R).
pub fn trapped_light_ends_and_is_reported(record: &mut Record) {
    let cosine = (1.0 - INDEX.powi(-2)).sqrt();
    let offset: f64 = 0.9;
    let rows = [
        ("cube", cube(), [0.1, 0.05, -0.2], 3.0 * cosine - 2.0),
        ("ball", ball(1.0), [0.0, 0.0, offset], (1.0 - (INDEX * offset).powi(-2)).sqrt()),
    ];
    let samples = record.samples(1 << 12);
    for (name, glass, lamp, share) in rows {
        let scene = lit(glass, 0.0, lamp, 2.0);
        let found = emit(&scene, samples, record.seed());
        let error = SIGMAS * (share * (1.0 - share) / samples as f64).sqrt();
        record.absolute(format!("{name}: share of the light that is trapped"), found.trapped, share, error);
        record.absolute(format!("{name}: share that leaves"), found.arrives, 1.0 - share, error);
        let plan = instrument_plan_under(&scene, Integrator::Light, &Leaving::none());
        let reading = read_meters_under(&scene, &plan, samples, record.seed()).remove(0);
        let text = reading.truncation.trapped_message().unwrap_or_default();
        record.says(format!("{name}: message"), &text, "trapped light: ");
    }
}

// Case 44. Glass that absorbs 1e-3 per mm traps nothing for long. From its centre a ball lets out
// (1 - F) a / (1 - F a^2) with a = exp(-R per m) and F = 0.04.
pub fn absorbing_glass_keeps_its_closed_form_share(record: &mut Record) {
    const ABSORPTION_PER_M: f64 = 1.0;
    let reflected = ((INDEX - 1.0) / (INDEX + 1.0)).powi(2);
    for radius in [0.01, 0.1, 1.0] {
        let scene = lit(ball(radius), ABSORPTION_PER_M, [0.0; 3], 2.0 * radius);
        let found = emit(&scene, record.samples(1 << 18), record.seed());
        let passed = f64::exp(-ABSORPTION_PER_M * radius);
        let truth = (1.0 - reflected) * passed / (1.0 - reflected * passed * passed);
        let what = format!("ball of {radius} m: share of the light that leaves");
        record.mean(what, found.arrives, found.error, truth, 5e-3);
    }
    let scene = lit(cube(), ABSORPTION_PER_M, [0.1, 0.05, -0.2], 2.0);
    record.exactly("cube: share trapped", emit(&scene, 1 << 12, record.seed()).trapped, 0.0);
}

// Case 45. Every ray meets the surface at right angles: 4 % go back, through the lamp, and meet it
// again.
pub fn glass_around_a_lamp_passes_all_its_light(record: &mut Record) {
    let samples = record.samples(1 << 20);
    for radius in [1e-3, 1.0, 1e3] {
        let scene = lit(ball(radius), 0.0, [0.0; 3], 2.0 * radius);
        let found = emit(&scene, samples, record.seed());
        record.relative(format!("ball of {radius} m: intensity outside"), found.arrives, 1.0, 1e-3);
        // 0.96 of a million coins: 5 standard errors are 1e-3 of it.
        record.relative(format!("ball of {radius} m: of it at the first pass"), found.at_once, 0.96, 1e-3);
    }
}
