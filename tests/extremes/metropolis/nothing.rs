//! No light: none found, none there, none of it luminous.

use super::{mean_of, over_runs, rendering};
use crate::common::program::{folder, render};
use crate::common::{scene, scenes};
use crate::record::Record;
use etalon::integrator::Integrator;
use serde_json::{Value, json};

// Case 66.
pub fn light_that_is_not_found_is_no_picture(record: &mut Record) {
    // A lamp in a closed box, and a camera outside.
    let scene = json!({
        "name": "box", "length_unit": "m",
        "materials": { "card": { "lambertian": { "reflectance": 0.5 } } },
        "objects": [
            { "shape": { "box": { "min": [-1, -1, 0], "max": [1, 1, 2] } }, "material": "card" },
            { "shape": { "disk": { "center": [0, -1.5, 0], "normal": [0, 1, 0], "radius": 3 } }, "material": "card" }
        ],
        "lights": [{ "point": { "position": [0, 0, 1],
            "emission": { "spectrum": "d65", "level": { "flux_lm": 500 } } } }],
        "camera": { "position": [0, 0, -2], "look_at": [0, 0, 0], "up": [0, 1, 0], "focal_length_mm": 30,
            "sensor_mm": [24, 24], "resolution": [8, 8], "f_stop": 2, "shutter_s": 0.01, "iso": 100 }
    });
    let folder = folder("extremes-nothing-found");
    let run = render(&scene, &folder, "--spp 1 --integrator mlt");
    let told = std::fs::read_to_string(folder.join("out.json")).expect("a report");
    let facts: Value = serde_json::from_str(&told).expect("JSON");
    let paths = facts["metropolis"]["found_none_in"].as_u64().expect("a number");
    let said =
        format!("found none in {paths} paths; hit probability below {:.1e} at 95 %", 3.0 / paths as f64);
    record.exactly("exit code", run.code, 4);
    record.says("the message", &run.err, &said);
    record.exactly("lines of the message", run.err.lines().count(), 1);
    record.at_least("paths looked at before giving up", paths as f64, 1e6);
    record.holds("no picture is written", !folder.join("out.exr").exists());
}

// Case 67.
pub fn without_lamps_the_picture_is_black_and_says_why(record: &mut Record) {
    let mut json = scenes::diffuse();
    for object in json["objects"].as_array_mut().expect("objects") {
        object.as_object_mut().expect("an object").remove("emission");
    }
    let scene = scene(&json);
    let folder = folder("extremes-black");
    for integrator in Integrator::ALL {
        let film = rendering(&scene, integrator, 4, 1).film;
        let values = (0..film.pixels()).flat_map(|pixel| [0, 1, 2].map(|channel| film.mean(pixel, channel)));
        let name = integrator.name();
        record.exactly(
            format!("{name}: values that are not zero"),
            values.filter(|value| *value != 0.0).count(),
            0,
        );
        let run = render(&json, &folder, &format!("--spp 4 --integrator {name}"));
        record.exactly(format!("{name}: exit code"), run.code, 0);
        record.says(format!("{name}: the reason"), &run.err, "nothing shines: the picture is black");
    }
}

// Case 71.
pub fn light_that_is_hardly_luminous_is_seen(record: &mut Record) {
    let violet = |nm: f64, response: Option<[f64; 2]>| {
        let mut json = scenes::light_in_glass();
        for object in json["objects"].as_array_mut().expect("objects") {
            if object["emission"].is_object() {
                object["emission"] = json!({
                    "spectrum": { "lines": { "lines": [{ "wavelength_nm": nm, "power": 1.0 }] } },
                    "level": { "spectral_radiance_factor": 0.1 } });
            }
        }
        if let Some([from, to]) = response {
            let band = json!({ "table": { "wavelengths_nm": [360, from, from + 1.0, to, to + 1.0, 830],
                "values": [0, 0, 1, 1, 0, 0] } });
            json["camera"]["sensor"] = json!({ "filter_set": { "filters": { "U": band },
                "detector": { "relative_responsivity": 1 } } });
        }
        scene(&json)
    };
    // A channel that sees 365 nm, where luminance is a hundred thousandth; and X, Y, Z at 420 nm.
    for (what, nm, response, channel) in [
        ("420 nm, Z", 420.0, None, 2),
        ("420 nm, Y", 420.0, None, 1),
        ("365 nm, a channel of its own", 365.0, Some([361.0, 380.0]), 3),
    ] {
        let scene = violet(nm, response);
        let mean = |integrator: Integrator, samples: u64, seed: u64| {
            over_runs(seed, |seed| mean_of(&rendering(&scene, integrator, samples, seed), channel, |_| true))
        };
        let chains = mean(Integrator::Mlt, record.samples(16), record.seed());
        let samples = mean(Integrator::Bdpt, record.samples(16), record.seed().wrapping_add(1000));
        record.same_mean(format!("{what}: mlt against bdpt"), chains, samples, 0.03);
    }
}
