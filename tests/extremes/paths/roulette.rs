//! Roulette, whose probability is free but for the variance.

use super::furnace::furnace;
use crate::record::Record;
use etalon::integrator::{Draw, Integrator, Tracer, eye_of, instrument_plan};
use etalon::path::{Roulette, Subpaths};
use etalon::sampler::{BlockSampler, Stream};

/// Reflectance of the walls.
const ALBEDO: f64 = 0.9;

/// Mean, standard error and relative standard deviation of samples in the furnace.
fn sample(roulette: Roulette, samples: u64, seed: u64) -> [f64; 3] {
    let scene = furnace(ALBEDO);
    let mut plan = instrument_plan(&scene, Integrator::Path);
    plan.roulette = roulette;
    // What a path picks up by itself: a geometric sum, of known variance.
    plan.strategies.asks_lights = false;
    // Where nothing ends paths, what is left of them after so many bounces is below rounding:
    // 0.9^400 = 5e-19.
    plan.most_bounces = Some(400);
    let tracer = Tracer::new(&scene, &plan, eye_of(&scene.meters[0]));
    let mut paths = Subpaths::default();
    let (mut sum, mut squares) = (0.0, 0.0);
    // Every sample by itself: strata would hide the standard deviation of one.
    for index in 0..samples {
        let sampler = BlockSampler::new(seed, index, 0, 1).sample(0);
        let wavelengths = plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
        let draw = Draw { position: [0.5; 2], wavelengths: &wavelengths, sampler: &sampler };
        let emitted = 1.0 / f64::from(furnace_radiance(&scene, &wavelengths));
        let value = emitted * f64::from(tracer.gather(&draw, &mut paths).hero());
        sum += value;
        squares += value * value;
    }
    let n = samples as f64;
    let mean = sum / n;
    let deviation = (squares / n - mean * mean).max(0.0).sqrt();
    [mean, deviation / n.sqrt(), deviation / mean]
}

/// What the wall shines with by itself, at the hero.
fn furnace_radiance(scene: &etalon::scene::Scene, wavelengths: &etalon::spectrum::Wavelengths) -> f32 {
    scene.lights.get(0).emission(wavelengths).hero()
}

// Case 43. With q = rho all that go on carry the same, and the number of bounces is geometric: its
// relative variance is rho.
pub fn roulette_changes_no_mean(record: &mut Record) {
    let truth = 1.0 / (1.0 - ALBEDO);
    // Relative deviations of one sample: about one; at q = 0.5, where weights grow to a hundred
    // times what is usual with a probability of one in a hundred, about ten; none at q = 1.
    let rows = [
        ("in proportion to what is carried", Roulette::Carried, 16, 1.5),
        ("q = 0.5", Roulette::Constant(0.5), 20, 15.0),
        ("q = 0.9", Roulette::Constant(0.9), 16, 1.5),
        ("q = 1", Roulette::Constant(1.0), 8, 1e-3),
    ];
    let mut means = Vec::new();
    for (name, roulette, log2_samples, most_deviation) in rows {
        let samples = record.samples(1 << log2_samples);
        let [mean, error, deviation] = sample(roulette, samples, record.seed());
        let most_noise = most_deviation / (samples as f64).sqrt();
        record.mean(format!("{name}: L / Le"), mean, error, truth, most_noise);
        means.push([mean, error]);
        record.note(format!("Relative standard deviation of one sample, {name}: {deviation:.3}."));
        if name == "q = 0.9" {
            // The fourth moment of a geometric law is about nine times the squared variance, so
            // its deviation is known to sqrt(8 / 4 n).
            let bound = crate::common::SIGMAS * (2.0 / samples as f64).sqrt();
            record.relative("q = rho: deviation of one sample", deviation, ALBEDO.sqrt(), bound);
        }
    }
    record.same_mean("q = 0.5 as q = 0.9", means[1], means[2], 0.03);
}

// Case 43.
pub fn roulette_never_ends_what_is_heavy(record: &mut Record) {
    let mut least = f64::INFINITY;
    let mut within = true;
    for roulette in [Roulette::Carried, Roulette::Constant(0.5), Roulette::Constant(1e-3)] {
        for step in -40..=40 {
            let carried = 2.0_f32.powi(step);
            let survival = roulette.survival(carried);
            within &= survival > 0.0 && survival <= 1.0;
            let floor = f64::from((carried / 100.0).min(1.0));
            least = least.min(f64::from(survival) / floor);
        }
    }
    record.holds("q is above 0 and at most 1", within);
    record.at_least("q over a hundredth of the weight", least, 1.0);
}
