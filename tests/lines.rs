//! Spectral lines against closed forms: levels, colours, shares beside a continuum, noise,
//! dispersion between two close lines.

mod common;

use common::{
    SIGMAS, assert_reads, illuminance, instrument_plan, irradiance, luminance, metered, read_one, scene,
};
use etalon::camera::Sensor;
use etalon::geometry::SurfacePoint;
use etalon::light::Light;
use etalon::sampler::{BlockSampler, Stream};
use etalon::scene::{MeterKind, Plan, Scene};
use etalon::spectrum::colour::{CIE_1931, Xyz};
use etalon::spectrum::{FIRST_NM, LANES};
use etalon::statistics::BatchMean;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Wavelengths and powers of the sodium D lines.
const SODIUM: [(f64, f64); 2] = [(588.995_095, 2.0), (589.592_424, 1.0)];

fn lines(list: &[(f64, f64)]) -> Value {
    let lines: Vec<Value> =
        list.iter().map(|(nm, power)| json!({ "wavelength_nm": nm, "power": power })).collect();
    json!({ "lines": { "lines": lines } })
}

fn point(spectrum: Value, level: Value) -> Value {
    json!([{ "point": { "position": [0, 0, 0], "emission": { "spectrum": spectrum, "level": level } } }])
}

/// A point lamp above a meter, 1 m away.
fn over_a_meter(spectrum: Value, level: Value) -> Scene {
    metered(json!({}), json!([]), point(spectrum, level), illuminance([0., 0., -1.], [0., 0., 1.]))
}

/// The CIE table, linear between its rows; read here independently of the library.
fn matching_at(nm: f64) -> Xyz {
    let row = ((nm - FIRST_NM) as usize).min(469);
    let fraction = nm - FIRST_NM - row as f64;
    CIE_1931.matching.each_ref().map(|m| m[row] * (1.0 - fraction) + m[row + 1] * fraction)
}

/// Powers times matching functions, summed.
fn xyz_of_lines(list: &[(f64, f64)]) -> Xyz {
    list.iter().fold([0.0; 3], |sum, (nm, power)| {
        let matching = matching_at(*nm);
        std::array::from_fn(|i| sum[i] + 683.0 * power * matching[i])
    })
}

#[test]
fn a_sodium_lamp_lights_a_metre_away_with_its_lumens() {
    let y = xyz_of_lines(&SODIUM)[1] / 3.0;
    for (level, lux) in [
        (json!({ "flux_lm": 1700 }), 1700.0 / (4.0 * PI)),
        (json!({ "intensity_cd": 100 }), 100.0),
        (json!({ "electrical_power": { "power_w": 18, "efficacy_lm_per_w": 100 } }), 1800.0 / (4.0 * PI)),
        (json!({ "radiant_power": { "power_w": 3, "band_nm": [360, 830] } }), 3.0 * y / (4.0 * PI)),
        (json!({ "radiant_power": { "power_w": 3, "band_nm": "all" } }), 3.0 * y / (4.0 * PI)),
        // Two thirds of the power lie in the stronger line.
        (json!({ "radiant_power": { "power_w": 2, "band_nm": [588, 589.2] } }), 3.0 * y / (4.0 * PI)),
    ] {
        for spectrum in [json!("sodium-low-pressure"), lines(&SODIUM)] {
            let reading = read_one(&over_a_meter(spectrum, level.clone()), 1 << 12);
            assert_reads(&format!("{level}"), &reading, lux, 1e-3);
            let watts = reading.radiant.mean;
            assert!((watts * y / lux - 1.0).abs() < 1e-4, "{level}: {watts} W/m2");
        }
    }
}

#[test]
fn a_shining_surface_of_lines_has_its_luminance() {
    let materials = json!({ "black": { "lambertian": { "reflectance": 0 } } });
    let y = xyz_of_lines(&SODIUM)[1];
    for (level, truth) in [
        (json!({ "luminance_cd_m2": 250 }), 250.0),
        (json!({ "flux_lm": 400 }), 400.0 / PI / (PI * 0.25)),
        (json!({ "radiance": { "radiance_w_sr_m2": 6, "band_nm": [500, 600] } }), 2.0 * y),
        (json!({ "spectral_radiance_factor": 0.5 }), 0.5 * y),
    ] {
        let objects = json!([{ "shape": { "disk": { "center": [0, 0, 1], "normal": [0, 0, -1], "radius": 0.5 } },
            "material": "black", "emission": { "spectrum": lines(&SODIUM), "level": level } }]);
        let scene = metered(materials.clone(), objects, json!([]), luminance([0., 0., 0.], [0., 0., 1.]));
        assert_reads(&format!("{level}"), &read_one(&scene, 1 << 12), truth, 1e-3);
    }
}

#[test]
fn the_colour_of_lines_is_that_of_their_wavelengths_in_the_cie_table() {
    let all: [&[(f64, f64)]; 4] =
        [&SODIUM, &[(555.0, 1.0)], &[(830.0, 1.0)], &[(404.656_5, 3.0), (546.075, 1.0)]];
    for list in all {
        let xyz = xyz_of_lines(list);
        let scene = over_a_meter(lines(list), json!({ "radiant_power": { "power_w": 1, "band_nm": "all" } }));
        let [x, y] = scene.emitters[0].chromaticity.expect("it shines");
        let reading = read_one(&scene, 1 << 14);
        let read_sum: f64 = reading.xyz.iter().sum();
        for (name, value, read, truth) in
            [("x", x, reading.xyz[0] / read_sum, xyz[0]), ("y", y, reading.xyz[1] / read_sum, xyz[1])]
        {
            let truth = truth / xyz.iter().sum::<f64>();
            assert!((value - truth).abs() < 1e-6, "{list:?} {name}: {value} against {truth}");
            assert!((read - truth).abs() < 2e-3, "{list:?} {name}: read {read} against {truth}");
        }
    }
}

/// A line of 20 nm units on a continuum of 1 per nm from 360 to 830 nm: the whole, and what a
/// band of 10 nm around the line holds, as spectral layers see it.
#[test]
fn a_line_keeps_its_share_beside_a_continuum() {
    let spectrum = json!({ "lines": { "continuum": 1, "lines": [{ "wavelength_nm": 585.3, "power": 20 }] } });
    let level = json!({ "radiant_power": { "power_w": 490, "band_nm": [360, 830] } });
    let scene = over_a_meter(spectrum, level);
    // The irradiance of one unit of the spectrum, 490 of which are spread over the sphere.
    let unit = 1.0 / (4.0 * PI);
    let reading = read_one(&scene, 1 << 16);
    let y_of_continuum: f64 = CIE_1931.matching[1].iter().sum::<f64>() * 683.0;
    let y_of_line = 20.0 * 683.0 * matching_at(585.3)[1];
    assert_reads("light", &reading, unit * (y_of_continuum + y_of_line), 1e-3);
    let (watts, error) = (reading.radiant.mean, reading.radiant.standard_error);
    assert!((watts - 490.0 * unit).abs() < SIGMAS * error && error < 2e-3 * watts, "{watts} +- {error} W/m2");

    let layers = Sensor::cie().with_spectral_layers(47);
    let means = channel_means(&scene, &layers, 1 << 12);
    // XYZ first, then bands of 10 nm, of which the 23rd from 0 reaches from 580 to 590 nm.
    for (band, expected) in [(21, 1.0), (22, 3.0), (23, 1.0)] {
        let (mean, error) = (means[3 + band].mean / unit, means[3 + band].standard_error / unit);
        assert!(error < 0.03, "band {band}: too noisy to judge: {mean} +- {error}");
        assert!(
            (mean - expected).abs() < SIGMAS * error + 1e-4,
            "band {band}: {mean} +- {error}, {expected}"
        );
    }
}

/// What each channel records at the scene's illuminance meter.
fn channel_means(scene: &Scene, sensor: &Sensor, samples_per_batch: u32) -> Vec<BatchMean> {
    let plan = instrument_plan(scene, sensor);
    let batch = |batch: u32| {
        let numbers = BlockSampler::new(7, 0, batch, samples_per_batch);
        let mut sums = vec![0.0; sensor.channels.len()];
        for index in 0..samples_per_batch {
            let sampler = numbers.sample(index);
            let wavelengths = plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
            let received = irradiance(scene, &plan, meter_point(scene), &wavelengths, &sampler);
            sensor.record(received, &wavelengths, |channel, value| sums[channel] += value);
        }
        sums.iter().map(|sum| sum / f64::from(samples_per_batch)).collect::<Vec<_>>()
    };
    let batches: [Vec<f64>; etalon::statistics::BATCHES] = std::array::from_fn(|index| batch(index as u32));
    (0..sensor.channels.len())
        .map(|channel| BatchMean::of(&std::array::from_fn(|index| batches[index][channel])))
        .collect()
}

fn meter_point(scene: &Scene) -> SurfacePoint {
    match scene.meters[0].kind {
        MeterKind::Illuminance(point) => point,
        MeterKind::Luminance { .. } => panic!("an illuminance meter"),
    }
}

/// A lamp in a grey room, seen by a meter on the floor.
fn grey_room(spectrum: Value) -> Scene {
    let materials = json!({ "grey": { "lambertian": { "reflectance": 0.5 } } });
    let objects = json!([
        { "shape": { "box": { "min": [0, 0, 0], "max": [4, 4, 3] } }, "material": "grey" },
        { "shape": { "sphere": { "center": [1, 2, 2], "radius": 0.2 } }, "material": "grey",
          "emission": { "spectrum": spectrum, "level": { "spectral_radiance_factor": 1 } } }
    ]);
    metered(materials, objects, json!([]), illuminance([2.5, 2.0, 0.0], [0.0, 0.0, 1.0]))
}

/// A thousand paths: each one's illuminance.
fn thousand_readings(scene: &Scene, value_of: impl Fn(&Plan, u32) -> f64) -> Vec<f64> {
    let plan = instrument_plan(scene, &Sensor::cie());
    (0..1000).map(|index| value_of(&plan, index)).collect()
}

/// Relative standard error of the mean, and the largest value over the mean.
fn noise(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0);
    ((variance / count).sqrt() / mean, values.iter().copied().fold(0.0, f64::max) / mean)
}

/// Path by path a lamp of one line is a monochromatic estimate: nothing is lost on
/// wavelengths at which nothing shines, and no rare path carries the whole line.
#[test]
fn a_lamp_of_one_line_is_no_noisier_than_one_wavelength_alone() {
    let numbers = BlockSampler::new(3, 0, 0, 1000);
    let white = grey_room(json!(1));
    // Radiance of the hero, without any weight of a sensor or a wavelength: geometry alone.
    let alone = thousand_readings(&white, |plan, index| {
        let sampler = numbers.sample(index);
        let wavelengths = plan.wavelengths.sample(0.5);
        f64::from(irradiance(&white, plan, meter_point(&white), &wavelengths, &sampler).hero())
    });
    let y = |scene: &Scene| {
        thousand_readings(scene, |plan, index| {
            let sampler = numbers.sample(index);
            let wavelengths = plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
            let received = irradiance(scene, plan, meter_point(scene), &wavelengths, &sampler);
            let mut value = 0.0;
            Sensor::cie()
                .record(received, &wavelengths, |channel, v| value += if channel == 1 { v } else { 0.0 });
            value
        })
    };
    let (truth, largest) = noise(&alone);
    assert!(truth > 0.005, "the room must scatter to be a test: {truth}");
    let (line, spike) = noise(&y(&grey_room(lines(&[(589.0, 1.0)]))));
    assert!((line / truth - 1.0).abs() < 1e-3, "{line} against {truth}");
    assert!((spike / largest - 1.0).abs() < 1e-3, "largest {spike} against {largest}");
    // On a continuum that carries as much light, the wavelengths add a little.
    let mixed =
        json!({ "lines": { "continuum": "d65", "lines": [{ "wavelength_nm": 589.0, "power": 13_000 }] } });
    let (mixture, spike) = noise(&y(&grey_room(mixed)));
    assert!(mixture < 1.5 * truth, "{mixture} against {truth}");
    assert!(spike < 2.5 * largest, "largest {spike} against {largest}");
}

/// Two lamps share a line, a third lacks it; what they give is the sum of each alone.
#[test]
fn lamps_with_and_without_a_line_add_up() {
    let level = json!({ "flux_lm": 100 });
    let spectra =
        [lines(&[(546.075, 1.0)]), lines(&[(435.833_5, 1.0), (546.075, 1.0), (650.0, 0.1)]), json!("d65")];
    let all: Vec<Value> = spectra.iter().map(|s| point(s.clone(), level.clone())[0].clone()).collect();
    let meter = illuminance([0., 0., -1.], [0., 0., 1.]);
    let scene = metered(json!({}), json!([]), json!(all), meter);
    assert_eq!(scene.lines_nm, [546.075, 435.833_5, 650.0]);
    let reading = read_one(&scene, 1 << 17);
    assert_reads("three lamps", &reading, 300.0 / (4.0 * PI), 5e-3);
    let truth = spectra.iter().fold([0.0; 3], |sum, spectrum| {
        let alone = over_a_meter(spectrum.clone(), level.clone());
        std::array::from_fn(|i| sum[i] + alone.emitters[0].xyz[i])
    });
    for (value, truth) in reading.xyz.iter().zip(truth) {
        assert!((value / truth - 1.0).abs() < 0.02, "{:?} against {truth}", reading.xyz);
    }
}

/// The glass sees each of two close lines at its own index.
#[test]
fn two_close_lines_have_two_indices() {
    let materials = json!({ "glass": { "dielectric": { "index": "n-sf11" } } });
    let objects =
        json!([{ "shape": { "sphere": { "center": [0, 0, 9], "radius": 1 } }, "material": "glass" }]);
    let lights = point(lines(&SODIUM), json!({ "flux_lm": 1 }));
    let scene = metered(materials, objects, lights, json!([]));
    let plan = instrument_plan(&scene, &Sensor::cie());
    let etalon::material::Material::Dielectric { excess_index, .. } = &scene.materials[0] else {
        panic!("glass");
    };
    let drawn = plan.wavelengths.sample(0.1);
    let indices = excess_index.at(&drawn);
    let n = |line: u32| {
        let lane = (0..LANES).find(|lane| drawn.line(*lane) == Some(line)).expect("eight lanes meet both");
        1.0 + f64::from(indices[lane])
    };
    // SCHOTT's formula for N-SF11, between grid points the chord.
    let sellmeier = |nm: f64| {
        let um2 = nm * nm * 1e-6;
        let terms =
            [(1.737_596_95, 0.013_188_707_0), (0.313_747_346, 0.062_306_814_2), (1.898_781_01, 155.236_29)];
        (1.0 + terms.iter().map(|(b, c)| b * um2 / (um2 - c)).sum::<f64>()).sqrt()
    };
    for (line, (nm, _)) in (0..).zip(SODIUM) {
        assert!((n(line) - sellmeier(nm)).abs() < 1e-6, "{nm} nm: {} against {}", n(line), sellmeier(nm));
    }
    assert!(n(0) - n(1) > 5e-5, "{} and {}", n(0), n(1));
}

/// Two lines through ground dispersive glass on shared paths, and each alone through glass of
/// the index that it has there: the sums agree.
#[test]
fn lines_that_share_a_rough_path_are_weighed_right() {
    let read = |index: Value, list: &[(f64, f64)]| {
        let materials = json!({ "black": { "lambertian": { "reflectance": 0 } },
            "ground": { "dielectric": { "index": index, "roughness_alpha": 0.15 } } });
        let objects = json!([
            { "shape": { "disk": { "center": [0.9, 0, 2], "normal": [0, 0, -1], "radius": 0.5 } }, "material": "black",
              "emission": { "spectrum": lines(list), "level": { "spectral_radiance_factor": 1 } } },
            { "shape": { "box": { "min": [-3, -3, 0], "max": [3, 3, 0.5] } }, "material": "ground" }
        ]);
        let meter = luminance([0.0, 0.0, -1.0], [0.3, 0.1, 1.0]);
        read_one(&metered(materials, objects, json!([]), meter), 1 << 19)
    };
    // The index of the Cauchy glass at grid points, where the lines are put.
    let index_at = |nm: f64| 1.35 + 0.05 / (nm * nm * 1e-6);
    let (blue, red) = ((450.0, 12.0), (650.0, 4.0));
    let both = read(json!({ "cauchy": { "a": 1.35, "b_um2": 0.05 } }), &[blue, red]);
    let [blue, red] = [blue, red].map(|line| read(json!(index_at(line.0)), &[line]));
    let sum = blue.photometric.mean + red.photometric.mean;
    let error = [&both, &blue, &red].iter().map(|r| r.photometric.standard_error.powi(2)).sum::<f64>().sqrt();
    assert!(error < 0.01 * sum, "too noisy to judge: {sum} +- {error}");
    let value = both.photometric.mean;
    assert!((value - sum).abs() < SIGMAS * error, "{value} against {sum} +- {error}");
}

/// A prism throws two lines to two places: a meter of direction finds each line where its own
/// index bends it, and the other elsewhere.
#[test]
fn a_prism_parts_two_lines() {
    let glass = json!({ "cauchy": { "a": 1.35, "b_um2": 0.05 } });
    let index_at = |nm: f64| 1.35 + 0.05 / (nm * nm * 1e-6);
    // A wedge of 30 degrees, its first face across the line of sight.
    let (angle, depth): (f64, f64) = (PI / 6.0, 0.5);
    let far = 2.0 * angle.tan() * depth;
    let wedge = json!({ "mesh": {
        "vertices": [[-depth, -3, 0], [depth, -3, 0], [depth, -3, far], [-depth, 3, 0], [depth, 3, 0], [depth, 3, far]],
        "triangles": [[0, 3, 4], [0, 4, 1], [0, 2, 5], [0, 5, 3], [1, 4, 5], [1, 5, 2], [0, 1, 2], [3, 5, 4]] } });
    // A ray up the z axis meets the slanted face at (0, 0, far / 2) and leaves at this angle
    // towards the thick end, by Snell's law.
    let bent = |nm: f64| (index_at(nm) * angle.sin()).asin() - angle;
    let list = [(450.0, 1.0), (650.0, 1.0)];
    for (nm, _) in list {
        let away = bent(nm);
        let (x, z) = (5.0 * away.sin(), 0.5 * far + 5.0 * away.cos());
        let lamp = json!({ "shape": { "sphere": { "center": [x, 0.1, z], "radius": 0.05 } }, "material": "black",
            "emission": { "spectrum": lines(&list), "level": { "spectral_radiance_factor": 1 } } });
        let materials = json!({ "black": { "lambertian": { "reflectance": 0 } }, "glass": { "dielectric": { "index": glass } } });
        let objects = json!([lamp, { "shape": wedge, "material": "glass" }]);
        let scene = metered(materials, objects, json!([]), luminance([0.0, 0.1, -1.0], [0.0, 0.0, 1.0]));
        let reading = read_one(&scene, 1 << 14);
        let matching = matching_at(nm);
        assert!(reading.photometric.mean > 0.0, "{nm} nm does not arrive");
        for (value, m) in reading.xyz.iter().zip(matching) {
            let truth = m / matching[1];
            let ratio = value / reading.photometric.mean;
            assert!((ratio - truth).abs() < 1e-4 * truth.max(1.0), "{nm} nm: {ratio} against {truth}");
        }
    }
}

/// Ultraviolet lines count in radiant levels that name them, with a note, and are not rendered.
#[test]
fn lines_outside_the_range_count_in_their_bands_alone() {
    let list = [(253.652_1, 60.0), (546.075, 40.0)];
    for (band, watts) in [(json!("all"), 4.0), (json!([360, 830]), 10.0), (json!([200, 600]), 4.0)] {
        let level = json!({ "radiant_power": { "power_w": 10, "band_nm": band } });
        let scene = over_a_meter(lines(&list), level);
        let flux = scene.emitters[0].radiant_flux.0;
        assert!((flux - watts).abs() < 1e-5, "{band}: {flux} W");
        assert_eq!(scene.lines_nm, [546.075]);
        assert_eq!(scene.notes.iter().filter(|note| note.contains("253.6521 nm")).count(), 1);
    }
}

#[test]
fn lines_are_scaled_named_and_read_from_files_like_other_spectra() {
    let truth = over_a_meter(lines(&SODIUM), json!({ "flux_lm": 5 })).emitters[0].xyz;
    let mut spectra = vec![json!({ "scaled": { "spectrum": "sodium-low-pressure", "factor": 0.25 } })];
    spectra.push(json!({ "csv": { "file": "spectra/line/sodium-low-pressure.csv", "factor": 3 } }));
    spectra.push(json!("own"));
    for spectrum in spectra {
        let scene = scene(&json!({ "name": "test", "length_unit": "m",
            "spectra": { "own": { "scaled": { "spectrum": lines(&SODIUM), "factor": 7 } } },
            "lights": point(spectrum, json!({ "flux_lm": 5 })) }));
        let Light::Point(light) = scene.lights.get(0) else { panic!("a point light") };
        assert_eq!(light.intensity.lines().count(), 2);
        for (value, truth) in scene.emitters[0].xyz.iter().zip(truth) {
            assert!((value / truth - 1.0).abs() < 1e-6, "{value} against {truth}");
        }
    }
}
