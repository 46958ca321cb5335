//! Absolute levels against closed forms: lamps of every shape, CIE 171, spheres.

mod common;

use common::{assert_reads, illuminance, instrument_plan, luminance, metered, read_one};
use etalon::camera::{CIE_SENSOR, Sensor};
use etalon::geometry::SurfacePoint;
use etalon::integrator::{Draw, Tracer};
use etalon::path::{Eye, Subpaths};
use etalon::sampler::{BlockSampler, Stream};
use etalon::scene::Scene;
use etalon::spectrum::CsvTable;
use glam::Vec3A;
use serde_json::{Value, json};

fn lamp(level: Value) -> Value {
    json!({ "spectrum": { "blackbody": { "temperature_k": 6500 } }, "level": level })
}

fn isotropic(level: Value) -> Value {
    json!([{ "point": { "position": [0, 0, 0], "emission": lamp(level) } }])
}

/// Efficacies of a black body of 6500 K with integrated watts: 195.627 lm/W over 380-780 nm,
/// 172.823 over 360-830, 95.363 over all. (A sum of 1 nm samples counts one sample too many
/// for an integral and gives 195.19 and 172.51.)
#[test]
fn radiant_watts_count_within_the_band_that_is_named() {
    for (band, efficacy) in
        [(json!([380, 780]), 195.627), (json!([360, 830]), 172.823), (json!("all"), 95.363)]
    {
        let level = json!({ "radiant_power": { "power_w": 10, "band_nm": band } });
        let scene = metered(json!({}), json!([]), isotropic(level), json!([]));
        let flux = scene.emitters[0].luminous_flux.0;
        assert!((flux / (10.0 * efficacy) - 1.0).abs() < 1e-5, "{band}: {flux} lm");
    }
}

/// Intensity is the table's, linear between its angles; the flux of a cone that falls linearly
/// from 1 at the axis to 0 at the angle a is 2 pi (1 - sin(a) / a) times the largest.
#[test]
fn a_profile_lights_as_its_table_says() {
    let cone_sr = std::f64::consts::TAU * (1.0 - 1.0 / std::f64::consts::FRAC_PI_2);
    for (angle, relative) in [(0.0, 1.0), (30.0, 2.0 / 3.0), (72.0, 0.2), (89.0, 1.0 / 90.0), (100.0, 0.0)] {
        let profile = json!([{ "point": { "position": [0, 0, 0], "distribution": { "profile": {
            "axis": [0, 2, 0], "angles_deg": [0, 90], "relative_intensity": [5, 0] } },
            "emission": lamp(json!({ "flux_lm": 100 })) } }]);
        let (sin, cos) = f64::to_radians(angle).sin_cos();
        let meter = illuminance([2.0 * sin, 2.0 * cos, 0.0], [-sin, -cos, 0.0]);
        let scene = metered(json!({}), json!([]), profile, meter);
        let truth = 100.0 / cone_sr * relative / 4.0;
        assert_reads(&format!("{angle} degrees"), &read_one(&scene, 1 << 14), truth, 1e-3);
    }
}

#[test]
fn a_white_furnace_shines_as_the_geometric_series_says() {
    for albedo in [0.0, 0.5, 0.9, 0.99] {
        let materials = json!({ "wall": { "lambertian": { "reflectance": albedo } } });
        let objects = json!([{ "shape": { "sphere": { "center": [0, 0, 0], "radius": 1 } }, "material": "wall",
            "emission": { "spectrum": "d65", "level": { "luminance_cd_m2": 100 }, "two_sided": true } }]);
        let scene = metered(materials, objects, json!([]), luminance([0.3, 0.2, -0.1], [0.4, 0.5, 0.6]));
        assert_reads(&format!("albedo {albedo}"), &read_one(&scene, 1 << 18), 100.0 / (1.0 - albedo), 2e-3);
    }
}

/// An integrating sphere: E = Phi / (4 pi R^2 (1 - rho)), direct light included.
#[test]
fn an_integrating_sphere_multiplies_its_lamp() {
    for (albedo, truth) in [(0.5, 270.56), (0.9, 1352.82), (0.98, 6764.09)] {
        let materials = json!({ "wall": { "lambertian": { "reflectance": albedo } } });
        let objects =
            json!([{ "shape": { "sphere": { "center": [0, 0, 0], "radius": 1 } }, "material": "wall" }]);
        let meter = illuminance([0.0, 0.0, -1.0], [0.0, 0.0, 1.0]);
        let scene = metered(materials, objects, isotropic(json!({ "flux_lm": 1700 })), meter);
        assert_reads(&format!("albedo {albedo}"), &read_one(&scene, 1 << 20), truth, 3e-3);
    }
}

/// Beer-Lambert: 0.1 m at 5 /m between two surfaces of transmittance 0.96, the orders inside
/// attenuated as well: T = 0.96^2 a / (1 - 0.04^2 a^2), a = exp(-0.5).
#[test]
fn an_absorbing_slab_follows_beer_and_lambert() {
    let materials = json!({ "glass": { "dielectric": { "index": 1.5, "absorption_per_m": 5 } },
        "lamp": { "lambertian": { "reflectance": 0 } } });
    let objects = json!([
        { "shape": { "box": { "min": [-9, -9, 0], "max": [9, 9, 0.1] } }, "material": "glass" },
        { "shape": { "disk": { "center": [0, 0, 1], "normal": [0, 0, -1], "radius": 5 } }, "material": "lamp",
          "emission": { "spectrum": "d65", "level": { "luminance_cd_m2": 1000 } } }
    ]);
    let scene = metered(materials, objects, json!([]), luminance([0., 0., -1.], [0., 0., 1.]));
    let a = (-0.5_f64).exp();
    let truth = 1000.0 * 0.96 * 0.96 * a / (1.0 - 0.04 * 0.04 * a * a);
    assert_reads("absorbing slab", &read_one(&scene, 1 << 18), truth, 1e-3);
}

fn cie_cases(case: &str) -> Vec<(String, [f64; 3], [f64; 3], f64)> {
    let text = include_str!("../reference/cie171/cases.csv");
    // The table mixes words and numbers, so it is no curve; its facts are checked all the same.
    assert!(CsvTable::parse(text).is_err() && text.starts_with("# title"));
    let number = |cell: &str| cell.parse::<f64>().unwrap_or(0.0);
    text.lines()
        .map(|line| line.split(',').collect::<Vec<_>>())
        .filter(|cells| cells[0] == case)
        .map(|cells| {
            let normal = match cells[5] {
                "+z" => [0.0, 0.0, 1.0],
                "+y" => [0.0, 1.0, 0.0],
                _ => [0.0; 3],
            };
            (
                cells[1].to_owned(),
                [number(cells[2]), number(cells[3]), number(cells[4])],
                normal,
                number(cells[7]),
            )
        })
        .collect()
}

/// The acceptance of this project: half a per cent at every point.
const CIE_TOLERANCE: f64 = 0.005;

#[test]
fn cie_171_case_5_2_diffuse_point_source() {
    let cases = cie_cases("5.2");
    assert_eq!(cases.len(), 10);
    for (point, position, normal, truth) in cases {
        let lights = json!([{ "point": { "position": [0, 0, 3], "distribution": { "cosine": { "axis": [0, 0, -1] } },
            "emission": lamp(json!({ "intensity_cd": 1000 })) } }]);
        let scene = metered(json!({}), json!([]), lights, illuminance(position, normal));
        let value = read_one(&scene, 1 << 16).photometric.mean;
        assert!((value / truth - 1.0).abs() < CIE_TOLERANCE, "5.2 {point}: {value} against {truth}");
    }
}

#[test]
fn cie_171_case_5_3_area_source() {
    let cases = cie_cases("5.3");
    assert_eq!(cases.len(), 14);
    for (point, position, normal, truth) in cases {
        let source = json!([[1.5, 1.5, 3], [1.5, 2.5, 3], [2.5, 2.5, 3], [2.5, 1.5, 3]]);
        let objects = json!([{ "shape": { "quad": { "vertices": source } }, "material": "black",
            "emission": lamp(json!({ "luminance_cd_m2": 1000 })) }]);
        let materials = json!({ "black": { "lambertian": { "reflectance": 0 } } });
        let scene = metered(materials, objects, json!([]), illuminance(position, normal));
        let value = read_one(&scene, 1 << 16).photometric.mean;
        assert!((value / truth - 1.0).abs() < CIE_TOLERANCE, "5.3 {point}: {value} against {truth}");
    }
}

/// Illuminance at each of many points of a wall, for the cases that average over walls.
fn mean_over_walls(scene: &Scene, size: [f64; 3], points: u32) -> f64 {
    let sensor = Sensor::named(CIE_SENSOR).expect("built in");
    let plan = instrument_plan(scene, &sensor);
    let mut paths = Subpaths::default();
    let (mut flux, mut area) = (0.0, 0.0);
    for face in 0..6_usize {
        let (axis, high) = (face / 2, face % 2 == 1);
        let (u_axis, v_axis) = ((axis + 1) % 3, (axis + 2) % 3);
        let face_area = size[u_axis] * size[v_axis];
        let numbers = BlockSampler::new(5, face as u64, 0, points);
        let mut sum = 0.0;
        for index in 0..points {
            let sampler = numbers.sample(index);
            let [u, v] = sampler.pair(Stream::Lens, 0).map(f64::from);
            let mut metres = [0.0; 3];
            metres[axis] = if high { size[axis] } else { 0.0 };
            metres[u_axis] = u * size[u_axis];
            metres[v_axis] = v * size[v_axis];
            let mut normal = [0.0; 3];
            normal[axis] = if high { -1.0 } else { 1.0 };
            // A point that starts from the wall itself: its error box is the wall's.
            let unit = scene.geometry.metres_per_unit();
            let position = Vec3A::from_array(metres.map(|c| (c / unit) as f32));
            let point = SurfacePoint {
                position,
                error: Vec3A::splat(4.0 * f32::EPSILON),
                normal: Vec3A::from_array(normal.map(|c| c as f32)),
            };
            let wavelengths = plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
            let position = sampler.pair(Stream::Pixel, 0).map(f64::from);
            let draw = Draw { position, wavelengths: &wavelengths, sampler: &sampler };
            let irradiance = Tracer::new(scene, &plan, Eye::Irradiance(point)).gather(&draw, &mut paths);
            sensor.record(irradiance, &wavelengths, |channel, value| {
                if channel == 1 {
                    sum += value;
                }
            });
        }
        flux += sum / f64::from(points) * face_area;
        area += face_area;
    }
    flux / area
}

fn room(size: [f64; 3], albedo: f64) -> Scene {
    let centre = size.map(|side| side / 2.0);
    let materials = json!({ "wall": { "lambertian": { "reflectance": albedo } } });
    let objects = json!([{ "shape": { "box": { "min": [0, 0, 0], "max": size } }, "material": "wall" }]);
    let lights = json!([{ "point": { "position": centre, "emission": { "spectrum": "cie-e", "level": { "flux_lm": 10_000 } } } }]);
    metered(materials, objects, lights, json!([]))
}

#[test]
fn cie_171_case_5_4_flux_is_conserved() {
    let size = [4.0, 4.0, 3.0];
    let surface = 2.0 * (4.0 * 4.0 + 4.0 * 3.0 + 4.0 * 3.0);
    let ratio = mean_over_walls(&room(size, 0.0), size, 1 << 14) * surface / 10_000.0;
    let truth = cie_cases("5.4")[0].3;
    assert!((ratio / truth - 1.0).abs() < CIE_TOLERANCE, "5.4: {ratio} against {truth}");
}

/// Whatever its shape, all of a lamp's flux arrives on the walls around it.
#[test]
fn lamps_of_every_shape_give_off_the_flux_they_state() {
    let size = [4.0; 3];
    let wall = json!({ "shape": { "box": { "min": [0, 0, 0], "max": size } }, "material": "black" });
    let square = json!([[1, 2, 1], [3, 2, 1], [3, 2, 3], [1, 2, 3]]);
    let lamps = [
        ("box", json!({ "box": { "min": [1, 1.5, 1], "max": [2, 2, 3] } }), false),
        (
            "capped cylinder",
            json!({ "cylinder": { "from": [1, 1, 1], "to": [3, 2, 2], "radius": 0.5 } }),
            false,
        ),
        (
            "open cylinder",
            json!({ "cylinder": { "from": [1, 1, 1], "to": [3, 2, 2], "radius": 0.5, "capped": false } }),
            false,
        ),
        ("sphere", json!({ "sphere": { "center": [1, 2, 2], "radius": 0.7 } }), false),
        ("both sides of a quad", json!({ "quad": { "vertices": square } }), true),
        (
            "both sides of a bent quad",
            json!({ "quad": { "vertices": [[1, 2, 1], [3, 2, 1], [3, 2.2, 3.2], [1, 2, 3]] } }),
            true,
        ),
    ];
    for (name, shape, two_sided) in lamps {
        let mut emission = lamp(json!({ "flux_lm": 1000 }));
        emission["two_sided"] = json!(two_sided);
        let objects = json!([wall, { "shape": shape, "material": "black", "emission": emission }]);
        let materials = json!({ "black": { "lambertian": { "reflectance": 0 } } });
        let scene = metered(materials, objects, json!([]), json!([]));
        // The standard deviation over seeds is 0.12 %, a quarter of the tolerance.
        let flux = mean_over_walls(&scene, size, 1 << 19) * 6.0 * 16.0;
        // An open cylinder's inside is dark and hides nothing of its outside.
        assert!((flux / 1000.0 - 1.0).abs() < CIE_TOLERANCE, "{name}: {flux} lm of 1000");
    }
}

/// Several lights are the sum of each alone, also a weak one beside one that is a thousand
/// million times stronger and hidden.
#[test]
fn lights_add_up() {
    let point = |x: f64, lm: f64| json!({ "point": { "position": [x, 0, 0], "emission": lamp(json!({ "flux_lm": lm })) } });
    let disk = json!({ "shape": { "disk": { "center": [0, 0, 1], "normal": [0, 0, -1], "radius": 0.3 } }, "material": "black",
        "emission": lamp(json!({ "luminance_cd_m2": 50 })) });
    let shade = json!({ "shape": { "box": { "min": [4.9, -0.1, -0.1], "max": [5.1, 0.1, 0.1] } }, "material": "black" });
    let materials = json!({ "black": { "lambertian": { "reflectance": 0 } } });
    let read = |objects: Value, lights: Value| {
        let meter = illuminance([0., 0., -1.], [0., 0., 1.]);
        read_one(&metered(materials.clone(), objects, lights, meter), 1 << 18)
    };
    let parts = [
        read(json!([]), json!([point(0.0, 10.0)])),
        read(json!([]), json!([point(0.5, 3.0)])),
        read(json!([disk]), json!([])),
    ];
    let truth: f64 = parts.iter().map(|r| r.photometric.mean).sum();
    let all = read(json!([disk, shade]), json!([point(0.0, 10.0), point(0.5, 3.0)]));
    assert_reads("three lights", &all, truth, 3e-3);
    let hidden = read(json!([disk, shade]), json!([point(0.0, 10.0), point(5.0, 1e10), point(0.5, 3.0)]));
    assert_reads("and a hidden strong one", &hidden, truth, 2e-2);
}

/// A line narrower than the grid keeps its power, wherever it lies between grid points.
#[test]
fn narrow_lines_keep_their_power() {
    for (centre, width) in [(550.0, 1.0), (550.3, 1.0), (550.5, 0.8), (589.0, 0.02)] {
        let table =
            json!({ "wavelengths_nm": [centre - width, centre, centre + width], "values": [0, 1, 0] });
        let lights = json!([{ "point": { "position": [0, 0, 0], "emission": { "spectrum": { "table": table },
            "level": { "radiant_power": { "power_w": 2, "band_nm": [360, 830] } } } } }]);
        let scene = metered(json!({}), json!([]), lights, json!([]));
        let power = scene.emitters[0].radiant_flux.0;
        assert!((power - 2.0).abs() < 1e-5, "{centre} nm, {width} nm wide: {power} W");
    }
}

#[test]
fn cie_171_case_5_8_diffuse_interreflection() {
    let size = [4.0; 3];
    let direct = mean_over_walls(&room(size, 0.0), size, 1 << 14);
    let cases = cie_cases("5.8");
    assert_eq!(cases.len(), 12);
    for (name, .., truth) in cases {
        let albedo: f64 = name.trim_start_matches("rho=").parse().expect("the table says rho=");
        // The same random numbers with and without reflection: what differs is indirect.
        let indirect = mean_over_walls(&room(size, albedo), size, 1 << 14) - direct;
        assert!((indirect - truth).abs() <= CIE_TOLERANCE * truth, "5.8 {name}: {indirect} against {truth}");
    }
}
