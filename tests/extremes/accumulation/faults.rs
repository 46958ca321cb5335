//! Samples that are not finite: of a material that is no number, and of a lamp beyond what
//! channels hold.

use crate::common::program::{etalon, folder, json_file, scene_file};
use crate::common::scene;
use crate::record::Record;
use etalon::integrator::{Budget, Integrator, Silent, instrument_plan, read_meters};
use etalon::material::Material;
use etalon::metropolis::World;
use etalon::replay::{
    MOST_NAMES, PixelSample, Replayed, SampleName, explain, explain_path, replay_meter, replay_path,
    replay_pixel,
};
use etalon::scene::{Plan, Scene};
use etalon::spectrum::Dense;
use serde_json::{Value, json};

/// A room with a lamp and a ball in it, 8 x 6 pixels, and a meter.
fn room(lamp: Value) -> Value {
    json!({
        "name": "room", "length_unit": "m",
        "materials": { "wall": { "lambertian": { "reflectance": 0.5 } }, "ball": { "lambertian": { "reflectance": 0.5 } } },
        "objects": [
            { "shape": { "sphere": { "center": [0, 0, 0], "radius": 2 } }, "material": "wall" },
            { "name": "the ball", "shape": { "sphere": { "center": [0.5, 0, 1], "radius": 0.4 } }, "material": "ball" },
            { "shape": { "sphere": { "center": [-0.5, 0.2, 1], "radius": 0.2 } }, "material": "wall", "emission": lamp },
        ],
        "meters": [{ "luminance": { "name": "at the lamp", "position": [0, 0, -0.5], "direction": [-0.5, 0.2, 1.5] } }],
        "camera": { "position": [0, 0, -0.5], "look_at": [0, 0, 1], "up": [0, 1, 0], "focal_length_mm": 36,
            "sensor_mm": [36, 27], "resolution": [8, 6], "iso": 100, "shutter_s": 0.01, "f_stop": 1 },
    })
}

fn bright() -> Value {
    json!({ "spectrum": 1, "level": { "luminance_cd_m2": 100 } })
}

/// The room with a ball whose reflectance is no number between 500 and 510 nm: no file can say so.
fn broken_room() -> Scene {
    let mut scene = scene(&room(bright()));
    let ball = scene.material_names.iter().position(|name| name == "ball").expect("it has one");
    let broken = |nm: f64| if (500.0..=510.0).contains(&nm) { f64::NAN } else { 0.5 };
    scene.materials[ball] = Material::Lambertian { reflectance: Dense::from_fn(broken), two_sided: false };
    scene
}

fn budget(samples_per_pixel: u64) -> Budget {
    Budget { samples_per_pixel, time: None, error: None, seed: 5 }
}

// Case 77.
pub fn samples_that_are_not_finite_are_counted_and_named(record: &mut Record) {
    let scene = broken_room();
    let view = scene.view().expect("a camera");
    for integrator in Integrator::ALL {
        let name = integrator.name();
        let plan = Plan::of(&scene, &view.sensor, integrator.strategies());
        let film = integrator.render(&scene, view, &plan, &budget(64), &Silent).film;
        let faults = &film.faults;
        record.at_least(format!("{name}: contributions that were not finite"), faults.count as f64, 1.0);
        record.holds(
            format!("{name}: some samples are named, at most {MOST_NAMES}"),
            (1..=MOST_NAMES).contains(&faults.named.len()),
        );
        let finite =
            (0..film.pixels()).all(|pixel| (0..3).all(|channel| film.mean(pixel, channel).is_finite()));
        record.holds(format!("{name}: every pixel is finite"), finite);
        let (mut again, mut told) = (0, 0);
        for sample in &faults.named {
            let (is_broken, text) = match sample {
                SampleName::Pixel(sample) => {
                    let replayed = replay_pixel(&scene, view, &plan, sample).expect("it is of this picture");
                    (replayed.non_finite > 0, explain(&scene, &replayed))
                }
                SampleName::Chain(path) => {
                    let world = World::new(&scene, view, &plan);
                    let replayed = replay_path(&world, path).expect("it is of this scene");
                    (!replayed.is_valid, explain_path(&scene, &replayed))
                }
                SampleName::Meter(_) => unreachable!("a picture has no meters"),
            };
            again += usize::from(is_broken);
            told += usize::from(text.contains("not finite") && text.contains("the ball (material ball"));
        }
        record.exactly(format!("{name}: named samples that replay as not finite"), again, faults.named.len());
        record.exactly(format!("{name}: of them told where"), told, faults.named.len());
    }
    let sound = crate::common::scene(&room(bright()));
    let view = sound.view().expect("a camera");
    for integrator in Integrator::ALL {
        let plan = Plan::of(&sound, &view.sensor, integrator.strategies());
        let film = integrator.render(&sound, view, &plan, &budget(16), &Silent).film;
        record.exactly(format!("{}: not finite in a sound room", integrator.name()), film.faults.count, 0);
    }
}

// Case 77.
pub fn the_same_name_gives_the_same_sample_bit_by_bit(record: &mut Record) {
    let scene = scene(&room(bright()));
    let view = scene.view().expect("a camera");
    let [width, height] = view.camera.resolution();
    let channels = view.sensor.channels.len();
    for integrator in [Integrator::Path, Integrator::Light, Integrator::Bdpt] {
        let plan = Plan::of(&scene, &view.sensor, integrator.strategies());
        let film = integrator.render(&scene, view, &plan, &budget(1), &Silent).film;
        // Added up as the film does: a row's own samples, then what they left elsewhere.
        let mut sums = vec![0.0; film.pixels() * channels];
        let mut add = |pixel: u32, values: &[f64]| {
            let from = pixel as usize * channels;
            sums[from..from + channels].iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        };
        for y in 0..height {
            let row: Vec<Replayed> = (0..width)
                .map(|x| replay_pixel(&scene, view, &plan, &first_sample([x, y])).expect("in the picture"))
                .collect();
            (0..width).zip(&row).for_each(|(x, sample)| add(y * width + x, &sample.own));
            row.iter().flat_map(|sample| &sample.splats).for_each(|(pixel, values)| add(*pixel, values));
        }
        let differing = (0..film.pixels())
            .filter(|pixel| {
                (0..channels).any(|c| film.mean(*pixel, c).to_bits() != sums[pixel * channels + c].to_bits())
            })
            .count();
        record.exactly(format!("{}: pixels that differ from their replay", integrator.name()), differing, 0);
        let lit = sums.iter().filter(|sum| **sum > 0.0).count();
        record.at_least(format!("{}: values that are not black", integrator.name()), lit as f64, 1.0);
    }
}

/// The only sample of a pixel where there is one.
const fn first_sample(pixel: [u32; 2]) -> PixelSample {
    PixelSample { pixel, seed: 5, block: 0, block_size: 1, index: 0, direct_light: false }
}

// Case 77. A lamp of 1e34 W sr^-1 m^-2 nm^-1 is held by 32 bits; what a channel makes of it, some
// 5e39 cd/m2, is not. Walls that it lights are dimmer by a thousand.
pub fn a_sum_that_overflows_fails_under_strict_and_is_replayed(record: &mut Record) {
    let folder = folder("extremes-overflow");
    let lamp = json!({ "spectrum": 1, "level": { "spectral_radiance_factor": 1e34 } });
    let text = room(lamp);
    let scene_path = scene_file(&folder, &text);
    let [exr, report, readings] = ["out.exr", "report.json", "readings.json"].map(|name| folder.join(name));
    let words = |strict: bool| {
        let mut words = vec!["render".into(), scene_path.clone(), "-o".into(), exr.clone()];
        words.extend(["--spp", "8", "--report"].map(Into::into));
        words.push(report.clone());
        words.extend(strict.then(|| "--strict".into()));
        words
    };
    let lenient = etalon(words(false));
    record.exactly("exit code without --strict", lenient.code, 0);
    record.says("warning", &lenient.err, "warning: ");
    record.says("its text", &lenient.err, "biased by an unknown amount, at least in the pixels");
    let _ = std::fs::remove_file(&exr);
    let strict = etalon(words(true));
    record.exactly("exit code with --strict", strict.code, 3);
    record.says("error", &strict.err, "error: ");
    record.holds("the picture is written", exr.is_file());
    let facts = json_file(&report);
    record.at_least("samples in the report", facts["non_finite_samples"].as_f64().unwrap_or(f64::NAN), 1.0);
    record.at_least("names in the report", facts["non_finite"].as_array().map_or(0, Vec::len) as f64, 1.0);
    for from in [&exr, &report] {
        let words = ["replay".into(), scene_path.clone(), "--from".into(), from.clone()];
        let replayed = etalon(words);
        record.exactly("replay: exit code", replayed.code, 0);
        record.says(
            "replay",
            &replayed.out,
            "not finite, 1 time(s): first in the sum over strategies or over lanes",
        );
    }
    let any = etalon([
        "replay".as_ref(),
        scene_path.as_os_str(),
        "--pixel".as_ref(),
        "0,0".as_ref(),
        "--index".as_ref(),
        "3".as_ref(),
    ]);
    record.says("replay of any sample", &any.out, "verdict      finite");

    let measure = |strict: bool| {
        let mut words = vec!["measure".into(), scene_path.clone().into_os_string()];
        words.extend(["--samples", "64", "--json"].map(Into::into));
        words.extend(strict.then(|| "--strict".into()));
        etalon(words)
    };
    record.exactly("measure: exit code without --strict", measure(false).code, 0);
    let strict = measure(true);
    record.exactly("measure: exit code with --strict", strict.code, 3);
    std::fs::write(&readings, &strict.out).expect("the folder can be written to");
    let replayed = etalon(["replay".into(), scene_path.clone(), "--from".into(), readings]);
    record.says("replay of a meter", &replayed.out, "not finite, 1 time(s)");

    let scene = scene(&text);
    let reading = read_meters(&scene, Integrator::Path, 64, 1).remove(0);
    record.exactly("meter at the lamp: samples that are not finite", reading.faults.count, 64);
    record.exactly("and its value without them", reading.photometric.mean, 0.0);
    let plan = instrument_plan(&scene, Integrator::Path);
    let named = reading.faults.named.iter().filter(|name| match name {
        SampleName::Meter(sample) => {
            replay_meter(&scene, &plan, sample).is_ok_and(|replayed| replayed.non_finite == 1)
        }
        _ => false,
    });
    record.exactly("of them named and replayed", named.count(), 64);
}
