//! Transport through media and many wavelengths against closed forms.

mod common;

use common::{SIGMAS, assert_reads, luminance, metered, read_one};
use etalon::camera::Sensor;
use etalon::integrator::{Draw, Reading, Tracer, eye_of};
use etalon::path::{Strategies, Subpaths};
use etalon::sampler::{BlockSampler, Stream};
use etalon::scene::{Leaving, Plan, Scene};
use serde_json::{Value, json};

/// A closed sphere that shines with 100 cd/m2 and reflects nothing, around an object.
fn furnace_scene(material: Value, shape: Value, meter: Value) -> Scene {
    let materials = json!({ "shell": { "lambertian": { "reflectance": 0 } }, "m": material });
    let objects = json!([
        { "shape": { "sphere": { "center": [0, 0, 0], "radius": 3 } }, "material": "shell",
          "emission": { "spectrum": "d65", "level": { "luminance_cd_m2": 100 }, "two_sided": true } },
        { "shape": shape, "material": "m" }
    ]);
    metered(materials, objects, json!([]), meter)
}

fn furnace(material: Value, shape: Value, meter: Value) -> Reading {
    read_one(&furnace_scene(material, shape, meter), 1 << 18)
}

fn ball() -> Value {
    json!({ "sphere": { "center": [0, 0, 0], "radius": 1 } })
}

/// Lossless glass of any dispersion disappears in a furnace: radiance over n^2 is conserved.
#[test]
fn lossless_glass_disappears_in_a_furnace() {
    let glasses = [
        ("constant", json!({ "dielectric": { "index": 1.5 } })),
        ("flint", json!({ "dielectric": { "index": "n-sf11" } })),
        ("diamond", json!({ "dielectric": { "index": "diamond" } })),
        ("low Abbe number", json!({ "dielectric": { "index": { "abbe": { "nd": 1.6, "vd": 20 } } } })),
        ("bubble in water", json!({ "dielectric": { "index": 1, "outside_index": "water" } })),
        ("nothing", json!({ "dielectric": { "index": 1 } })),
        ("ground nothing", json!({ "dielectric": { "index": 1, "roughness_alpha": 0.3 } })),
    ];
    for (name, glass) in glasses {
        let reading = furnace(glass, ball(), luminance([0.2, 0.55, -2.0], [0.0, 0.0, 1.0]));
        assert_reads(name, &reading, 100.0, 4e-3);
    }
}

/// Two narrow bands through ground dispersive glass at once, with all wavelengths on one
/// path, and each alone through glass of the index that it has there: the sums agree.
#[test]
fn wavelengths_that_share_a_rough_path_are_weighed_right() {
    let peak = |nm: f64, height: f64| (vec![nm - 2.0, nm, nm + 2.0], vec![0.0, height, 0.0]);
    let lamp = |bands: &[(f64, f64)]| {
        let (mut wavelengths_nm, mut values) = (Vec::new(), Vec::new());
        for (nm, height) in bands {
            let (w, v) = peak(*nm, *height);
            wavelengths_nm.extend(w);
            values.extend(v);
        }
        json!({ "spectrum": { "table": { "wavelengths_nm": wavelengths_nm, "values": values } },
            "level": { "spectral_radiance_factor": 1 } })
    };
    let read = |index: Value, bands: &[(f64, f64)]| {
        let materials = json!({ "black": { "lambertian": { "reflectance": 0 } },
            "ground": { "dielectric": { "index": index, "roughness_alpha": 0.15 } } });
        let objects = json!([
            { "shape": { "disk": { "center": [0.9, 0, 2], "normal": [0, 0, -1], "radius": 0.5 } }, "material": "black",
              "emission": lamp(bands) },
            { "shape": { "box": { "min": [-3, -3, 0], "max": [3, 3, 0.5] } }, "material": "ground" }
        ]);
        let meter = luminance([0.0, 0.0, -1.0], [0.3, 0.1, 1.0]);
        read_one(&metered(materials, objects, json!([]), meter), 1 << 20)
    };
    // Strong dispersion: n = 1.35 + 0.05 / lambda^2, 1.597 at 450 nm and 1.468 at 650 nm.
    let index_at = |nm: f64| 1.35 + 0.05 / (nm * nm * 1e-6);
    let both = read(json!({ "cauchy": { "a": 1.35, "b_um2": 0.05 } }), &[(450.0, 3.0), (650.0, 1.0)]);
    let blue = read(json!(index_at(450.0)), &[(450.0, 3.0)]);
    let red = read(json!(index_at(650.0)), &[(650.0, 1.0)]);
    let sum = blue.photometric.mean + red.photometric.mean;
    let error = [&both, &blue, &red].iter().map(|r| r.photometric.standard_error.powi(2)).sum::<f64>().sqrt();
    assert!(error < 0.01 * sum, "too noisy to judge: {sum} +- {error}");
    assert!(
        (both.photometric.mean - sum).abs() < SIGMAS * error,
        "{} against {sum} +- {error}",
        both.photometric.mean
    );
    // The blue share by itself: Z comes from the 450 nm band alone.
    let z_ratio = both.xyz[2] / (blue.xyz[2] + red.xyz[2]);
    assert!((z_ratio - 1.0).abs() < 0.03, "Z ratio {z_ratio}");
}

/// Absorbing bodies within one another, and instruments inside of them: exp(-a d) over each
/// stretch, with surfaces that bend nothing.
#[test]
fn absorbing_media_nest() {
    let materials = json!({ "black": { "lambertian": { "reflectance": 0 } },
        "clear": { "dielectric": { "index": 1 } }, "grey": { "dielectric": { "index": 1, "absorption_per_m": 0.5 } } });
    let lamp = json!({ "shape": { "disk": { "center": [0, 0, 9], "normal": [0, 0, -1], "radius": 5 } }, "material": "black",
        "emission": { "spectrum": "d65", "level": { "luminance_cd_m2": 1000 } } });
    let sphere = |radius: f64, material: &str| json!({ "shape": { "sphere": { "center": [0, 0, 0], "radius": radius } }, "material": material });
    let objects = json!([lamp, sphere(3.0, "grey"), sphere(1.0, "clear")]);
    // Where the meter is, and the length of grey before it on the way to the lamp.
    for (z, grey_m) in [(-5.0, 4.0), (-2.0, 3.0), (0.0, 2.0), (2.0, 1.0), (4.0, 0.0)] {
        let scene =
            metered(materials.clone(), objects.clone(), json!([]), luminance([0.0, 0.0, z], [0.0, 0.0, 1.0]));
        let truth = 1000.0 * f64::exp(-0.5 * grey_m);
        assert_reads(&format!("from z = {z}"), &read_one(&scene, 1 << 16), truth, 2e-3);
    }
}

/// Light that total reflection traps in clear glass does not hold up a render.
#[test]
fn trapped_light_ends() {
    let materials =
        json!({ "glass": { "dielectric": { "index": 1.5 } }, "mirror": { "mirror": { "reflectance": 1 } } });
    let objects = json!([
        { "shape": { "box": { "min": [-1, -1, -1], "max": [1, 1, 1] } }, "material": "glass" },
        { "shape": { "box": { "min": [-3, -3, -3], "max": [3, 3, 3] } }, "material": "mirror" }
    ]);
    let lights = json!([{ "point": { "position": [0, 0, 2], "emission": { "spectrum": "d65", "level": { "flux_lm": 1 } } } }]);
    let scene = metered(materials, objects, lights, luminance([0.1, 0.2, 0.3], [0.5, 0.6, 0.7]));
    assert_eq!(read_one(&scene, 64).faults.count, 0);
}

/// A lamp in a cube of clear glass shines on a grey disk alone: what the disk sends on beyond the
/// critical angle of all faces is trapped with what the disk has left of it.
#[test]
fn light_is_trapped_after_it_has_lost_some() {
    let materials = json!({ "black": { "lambertian": { "reflectance": 0 } },
        "grey": { "lambertian": { "reflectance": 0.3 } }, "glass": { "dielectric": { "index": 1.5 } } });
    let disk = |z: f64, normal: f64, radius: f64| json!({ "disk": { "center": [0.1, 0.05, z], "normal": [0, 0, normal], "radius": radius } });
    let objects = json!([
        { "shape": { "box": { "min": [-0.5, -0.5, -0.5], "max": [0.5, 0.5, 0.5] } }, "material": "glass" },
        { "shape": disk(-0.205, 1.0, 0.02), "material": "grey" },
        { "shape": disk(-0.2, -1.0, 0.001), "material": "black",
          "emission": { "spectrum": "cie-e", "level": { "flux_lm": 1 } } }
    ]);
    let meter = luminance([0.0, 0.0, 0.9], [0.0, 0.0, 1.0]);
    let scene = metered(materials, objects, json!([]), meter);
    let plan = Plan::under(&scene, &Sensor::cie(), Strategies::LIGHT, &Leaving::none());
    let tracer = Tracer::new(&scene, &plan, eye_of(&scene.meters[0]));
    let (mut paths, mut after_the_disk) = (Subpaths::default(), 0);
    for index in 0..1 << 12 {
        let sampler = BlockSampler::new(3, index, 0, 1).sample(0);
        let wavelengths = plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
        let before = paths.fates.from_lights.trapped;
        let draw = Draw { position: [0.5; 2], wavelengths: &wavelengths, sampler: &sampler };
        tracer.trace(&draw, &mut paths, &mut |_| {});
        let first = paths.light.get(1).and_then(|vertex| vertex.surface());
        let was_dimmed = first.is_some_and(|surface| surface.object == 1);
        after_the_disk += u64::from(was_dimmed) * (paths.fates.from_lights.trapped - before);
    }
    // About 0.3 x 0.25 of 4096 walks set out for good, and most of them pass the disk for 1000 bounces.
    assert!(after_the_disk > 0);
}

/// A matte ball inside a glass shell: what lands on it has crossed the surface both ways.
/// In a furnace the ball of reflectance 1 disappears as well.
#[test]
fn a_white_core_inside_glass_disappears_in_a_furnace() {
    let materials = json!({ "shell": { "lambertian": { "reflectance": 0 } }, "glass": { "dielectric": { "index": "n-sf11" } },
        "white": { "lambertian": { "reflectance": 1 } } });
    let objects = json!([
        { "shape": { "sphere": { "center": [0, 0, 0], "radius": 3 } }, "material": "shell",
          "emission": { "spectrum": "d65", "level": { "luminance_cd_m2": 100 }, "two_sided": true } },
        { "shape": ball(), "material": "glass" },
        { "shape": { "sphere": { "center": [0, 0, 0], "radius": 0.5 } }, "material": "white" }
    ]);
    let scene = metered(materials, objects, json!([]), luminance([0.1, 0.2, -2.0], [0.0, 0.0, 1.0]));
    assert_reads("white core", &read_one(&scene, 1 << 19), 100.0, 4e-3);
}

/// Scaling all lengths by a power of two changes no bit of a luminance.
#[test]
fn length_units_change_no_bit() {
    let read = |scale: f64| {
        let materials = json!({ "glass": { "dielectric": { "index": "n-bk7" } }, "wall": { "lambertian": { "reflectance": 0.5 } } });
        let at = |v: [f64; 3]| json!(v.map(|c| c * scale));
        let objects = json!([
            { "shape": { "sphere": { "center": at([0.1, 0.2, 0.3]), "radius": 3.0 * scale } }, "material": "wall",
              "emission": { "spectrum": "d65", "level": { "luminance_cd_m2": 100 }, "two_sided": true } },
            { "shape": { "box": { "min": at([-1.0, -0.7, -0.3]), "max": at([0.4, 0.5, 0.6]) } }, "material": "glass" }
        ]);
        let meter = luminance([0.2 * scale, 0.3 * scale, -2.0 * scale], [0.1, 0.0, 1.0]);
        read_one(&metered(materials, objects, json!([]), meter), 1 << 12).xyz.map(f64::to_bits)
    };
    let truth = read(1.0);
    for exponent in [-20, -3, 1, 20] {
        assert_eq!(read(2.0_f64.powi(exponent)), truth, "2^{exponent}");
    }
}
