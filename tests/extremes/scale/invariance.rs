//! Other lengths, other light: the same picture, bit for bit where the factor is a power of two.

use crate::common::scaling::{with_coordinates, with_lengths, with_light};
use crate::common::{scene, scenes};
use crate::record::Record;
use etalon::camera::{Darkroom, Film, planes};
use etalon::integrator::{Budget, Integrator, Silent};
use etalon::scene::Plan;
use serde_json::{Value, json};

/// Exponents of two: a million times larger and smaller.
const EXPONENTS: [i32; 2] = [-20, 20];
/// Samples per pixel: bits differ with the first path that feels a scale.
const SAMPLES: u64 = 2;

/// The scenes of the project's agreement tests, and one with many lamps of every kind.
fn demanding() -> Vec<Value> {
    let mut all = scenes::all();
    all.push(scenes::many_lamps());
    all
}

fn film(json: &Value, integrator: Integrator, samples_per_pixel: u64, seed: u64) -> Film {
    let scene = scene(json);
    let view = scene.view().expect("a camera");
    let plan = Plan::of(&scene, &view.sensor, integrator.strategies());
    let budget = Budget { samples_per_pixel, time: None, error: None, seed };
    integrator.render(&scene, view, &plan, &budget, &Silent).film
}

/// Values of a film, means and standard errors, that are not `factor` times those of another
/// to the bit; all of them must be finite.
fn differing(film: &Film, other: &Film, factor: f64) -> usize {
    let values = |film: &Film, index: usize| {
        let (pixel, channel) = (index / film.channels(), index % film.channels());
        [film.mean(pixel, channel), film.standard_error(pixel, channel)]
    };
    (0..film.pixels() * film.channels())
        .filter(|&index| {
            let [ours, theirs] = [values(film, index), values(other, index)];
            !(0..2).all(|i| ours[i].is_finite() && ours[i].to_bits() == (factor * theirs[i]).to_bits())
        })
        .count()
}

/// Judges the same scenes after a change for every integrator.
fn compare(
    record: &mut Record,
    what: &str,
    factor: impl Fn(i32) -> f64,
    change: impl Fn(&Value, i32) -> Value,
) {
    let scenes = demanding();
    for integrator in Integrator::ALL {
        for exponent in EXPONENTS {
            let (mut differ, mut dark, mut where_at) = (0, 0, Vec::new());
            for json in &scenes {
                let before = film(json, integrator, SAMPLES, 1);
                let after = film(&change(json, exponent), integrator, SAMPLES, 1);
                let count = differing(&after, &before, factor(exponent));
                if count > 0 {
                    where_at.push(format!("{} {count}", json["name"]));
                }
                differ += count;
                dark += usize::from((0..before.pixels()).all(|pixel| before.mean(pixel, 1) == 0.0));
            }
            let name = integrator.name();
            if !where_at.is_empty() {
                record.note(format!("{name}, 2^{exponent}: values that differ: {}", where_at.join(", ")));
            }
            record.exactly(format!("{name}, {what} times 2^{exponent}: values that differ"), differ, 0);
            record.at_most(format!("{name}: pictures without light"), dark as f64, 2.0);
        }
    }
}

// Case 48.
pub fn scaling_all_lengths_by_a_power_of_two_changes_no_bit(record: &mut Record) {
    compare(record, "lengths", |_| 1.0, |json, exponent| with_lengths(json, 2.0_f64.powi(exponent)));
}

// Case 49.
pub fn scaling_all_lamps_by_a_power_of_two_scales_the_picture_exactly(record: &mut Record) {
    let factor = |exponent: i32| 2.0_f64.powi(exponent);
    compare(record, "light", factor, |json, exponent| with_light(json, factor(exponent)));
}

// Case 49.
pub fn twice_the_iso_at_half_the_time_develops_to_the_same_picture(record: &mut Record) {
    for json in [scenes::diffuse(), scenes::many_lamps()] {
        let developed = |iso: f64, shutter_s: f64| {
            let mut json = json.clone();
            (json["camera"]["iso"], json["camera"]["shutter_s"]) = (json!(iso), json!(shutter_s));
            let scene = scene(&json);
            let view = scene.view().expect("a camera");
            let film = film(&json, Integrator::Path, 4, 1);
            let planes = planes(&film, &view.sensor, &view.flat_field());
            let camera = view.record();
            let darkroom = Darkroom::new(&camera, &planes).expect("a picture");
            let pixels = (0..film.pixels()).map(|pixel| darkroom.display(pixel).map(f64::to_bits));
            (pixels.collect::<Vec<_>>(), view.facts().white_luminance_cd_m2)
        };
        let ((before, white), (name, [width, height])) = (
            developed(100.0, 0.1),
            (&json["name"], scene(&json).view().expect("a camera").camera.resolution()),
        );
        for exponent in [-20, -1, 1, 20] {
            let factor = 2.0_f64.powi(exponent);
            let (after, same_white) = developed(100.0 * factor, 0.1 / factor);
            let differ = before.iter().zip(&after).filter(|(a, b)| a != b).count();
            record.exactly(
                format!("{name}, ISO times 2^{exponent}: pixels that differ of {}", width * height),
                differ,
                0,
            );
            record.exactly(
                format!("{name}, ISO times 2^{exponent}: luminance of white, cd/m2"),
                same_white,
                white,
            );
        }
    }
}

/// Mean luminance of a picture and its standard error, over runs of their own seeds.
fn mean_luminance(json: &Value, integrator: Integrator, samples: u64, seed: u64) -> [f64; 2] {
    const RUNS: u64 = 32;
    let run = |run: u64| {
        let film = film(json, integrator, samples, seed.wrapping_add(run));
        (0..film.pixels()).map(|pixel| film.mean(pixel, 1)).sum::<f64>() / film.pixels() as f64
    };
    let means: Vec<f64> = (0..RUNS).map(run).collect();
    let n = RUNS as f64;
    let mean = means.iter().sum::<f64>() / n;
    [mean, (means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt()]
}

// Case 48.
pub fn any_scale_and_unit_shows_the_same_picture(record: &mut Record) {
    let in_unit = |json: &Value, unit: &str, per_metre: f64| {
        let mut json = with_coordinates(json, per_metre);
        json["length_unit"] = json!(unit);
        json
    };
    for json in [scenes::many_lamps(), scenes::camera_in_absorbing_glass()] {
        let read = |json: &Value, run: u64| {
            mean_luminance(json, Integrator::Bdpt, record.samples(8), record.seed() + 1000 * run)
        };
        let truth = read(&json, 0);
        let others = [
            ("a million times larger", with_lengths(&json, 1e6)),
            ("a million times smaller", with_lengths(&json, 1e-6)),
            ("in millimetres", in_unit(&json, "mm", 1000.0)),
        ];
        let readings: Vec<_> =
            (1..).zip(&others).map(|(run, (what, other))| (what, read(other, run))).collect();
        for (what, reading) in readings {
            record.same_mean(format!("{} {what}, mean luminance, cd/m2", json["name"]), reading, truth, 0.01);
        }
    }
}
