//! Slabs and balls of glass: all orders together, and radiance in a denser medium.

use crate::common::runs::{films, picture_xyz};
use crate::common::{luminance, metered, read_seeded, scene};
use crate::record::Record;
use etalon::integrator::Integrator;
use serde_json::{Value, json};

// Case 33. Orders beyond the fourth hold 3e-9 of the light, so that "all" is known.
pub fn a_slab_passes_all_orders(record: &mut Record) {
    record.note(
        "There is no depth to choose: paths go on by roulette, and all orders are in the sum. Eight vertices \
         would hold all but 1e-9 of it.",
    );
    // Before the slab the lamp stands behind the meter, which sees it mirrored.
    for (what, z, facing, truth) in [("T", 1.0, -1.0, 12.0 / 13.0), ("R", -2.0, 1.0, 1.0 / 13.0)] {
        let materials = json!({ "glass": { "dielectric": { "index": 1.5 } }, "lamp": { "lambertian": { "reflectance": 0 } } });
        let objects = json!([
            { "shape": { "box": { "min": [-9, -9, 0], "max": [9, 9, 0.1] } }, "material": "glass" },
            { "shape": { "disk": { "center": [0, 0, z], "normal": [0, 0, facing], "radius": 5 } }, "material": "lamp",
              "emission": { "spectrum": "d65", "level": { "luminance_cd_m2": 1000 } } }
        ]);
        let scene = metered(materials, objects, json!([]), luminance([0., 0., -1.], [0., 0., 1.]));
        for (integrator, samples) in [(Integrator::Path, 1 << 20), (Integrator::Bdpt, 1 << 19)] {
            let reading = read_seeded(&scene, integrator, record.samples(samples), record.seed());
            let [mean, error] =
                [reading.photometric.mean, reading.photometric.standard_error].map(|v| v / 1000.0);
            let what = format!("{what} of n = 1.5, {}", integrator.name());
            // As sharp as a tenth of what is measured: 0.1 % of T, 1 % of R.
            record.mean(what, mean, error, truth, if z > 0.0 { 1e-3 } else { 1e-2 });
        }
    }
}

/// A ball of glass in a furnace of 100 cd/m2 whose wall reflects half of what it gets, and a
/// camera.
fn furnace(position: [f64; 3], look_at: [f64; 3]) -> Value {
    json!({
        "name": "furnace", "length_unit": "m",
        "materials": { "wall": { "lambertian": { "reflectance": 0.5 } }, "glass": { "dielectric": { "index": 1.5 } } },
        "objects": [
            { "shape": { "sphere": { "center": [0, 0, 0], "radius": 3 } }, "material": "wall",
              "emission": { "spectrum": "cie-e", "level": { "luminance_cd_m2": 50 }, "two_sided": true } },
            { "shape": { "sphere": { "center": [0, 0, 0], "radius": 1 } }, "material": "glass" }],
        "camera": { "position": position, "look_at": look_at, "up": [0, 1, 0], "focal_length_mm": 50, "sensor_mm": [40, 40],
            "resolution": [2, 2], "iso": 100, "shutter_s": 0.01, "f_stop": 8 },
    })
}

// Case 34.
pub fn radiance_inside_glass_is_larger_by_the_square_of_its_index(record: &mut Record) {
    for (what, position, look_at, truth) in [
        ("at the centre of a ball of n = 1.5", [0.0; 3], [0.1, 0.2, 1.0], 2.25),
        ("outside of it", [0.2, 0.1, -2.0], [0.0, 0.0, 0.0], 1.0),
    ] {
        let scene = scene(&furnace(position, look_at));
        for (integrator, spp) in
            [(Integrator::Path, 1 << 12), (Integrator::Bdpt, 1 << 10), (Integrator::Mlt, 1 << 13)]
        {
            let films = films(&scene, integrator, record.samples(spp), record.seed());
            let [_, found, _] = picture_xyz(&films);
            let [mean, error] = [found.mean, found.standard_error].map(|v| v / 100.0);
            let what = format!("radiance {what}, {}", integrator.name());
            record.mean(what.clone(), mean, error, truth, 1e-3);
            record.relative(what, mean, truth, 1e-3);
        }
    }
}
