//! A thousand lamps in one room: what meters read against the sum over the lamps, and what
//! choosing lamps by place saves over choosing them by power alone.

mod common;

use common::{assert_reads, instrument_plan, metered};
use etalon::camera::{CIE_SENSOR, Sensor};
use etalon::geometry::{GeometryBuilder, SurfacePoint};
use etalon::integrator::{Integrator, read_meters};
use etalon::light::{Distribution, Light, Lights, PointLight};
use etalon::sampler::mix;
use etalon::scene::{MeterKind, Scene};
use etalon::spectrum::{Dense, Emission, Wavelengths};
use glam::{DVec3, Vec3A};
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::hint::black_box;
use std::time::Instant;

/// Lamps hang at this height in metres, far enough apart that none hides another.
const HEIGHT: f64 = 2.8;
/// Distance of neighbouring lamps in metres.
const PITCH: f64 = 0.3;
/// Radius of balls, half the edge of panels, in metres.
const SIZE: f64 = 0.02;

/// Where a meter stands, and the unit normal of what it measures on.
struct Place(DVec3, DVec3);

/// A lamp as a scene says it, and as its closed form knows it.
enum Lamp {
    Isotropic { candelas: f64 },
    Cosine { candelas: f64, axis: DVec3 },
    Ball { luminance: f64 },
    Panel { luminance: f64, axis: DVec3, two_sided: bool },
}

fn uniform(state: &mut u64) -> f64 {
    *state += 1;
    (mix(*state) >> 11) as f64 / (1_u64 << 53) as f64
}

/// The lamp of an index: candelas within two decades, its axis anywhere but mostly down.
fn lamp(index: u64) -> Lamp {
    let mut state = index << 8;
    let candelas = 10_f64.powf(2.0 * uniform(&mut state) - 1.0);
    let across = DVec3::new(uniform(&mut state) - 0.5, uniform(&mut state) - 0.5, 0.0);
    let axis = (across + DVec3::Z * (0.6 * uniform(&mut state) - 0.5)).normalize();
    match index % 4 {
        0 => Lamp::Isotropic { candelas },
        1 => Lamp::Cosine { candelas, axis },
        2 => Lamp::Ball { luminance: candelas / (PI * SIZE * SIZE) },
        _ => Lamp::Panel { luminance: candelas / (4.0 * SIZE * SIZE), axis, two_sided: index % 8 == 3 },
    }
}

fn lamp_position(index: u64, columns: u64) -> DVec3 {
    DVec3::new((index % columns) as f64 + 0.5, (index / columns) as f64 + 0.5, 0.0) * PITCH
        + DVec3::Z * HEIGHT
}

fn panel(center: DVec3, axis: DVec3) -> [DVec3; 4] {
    let (u, v) = axis.any_orthonormal_pair();
    [(-u - v), (u - v), (u + v), (v - u)].map(|corner| center + corner * SIZE)
}

/// Columns by rows of lamps under the ceiling of a black room, with meters.
fn room(columns: u64, rows: u64, places: &[Place]) -> Scene {
    let shining = |level: Value| json!({ "spectrum": "d65", "level": level });
    let size = [columns as f64 * PITCH, rows as f64 * PITCH, 3.0];
    let mut objects =
        vec![json!({ "shape": { "box": { "min": [0, 0, 0], "max": size } }, "material": "black" })];
    let mut lights = Vec::new();
    for index in 0..columns * rows {
        let center = lamp_position(index, columns);
        let mut bulb = |distribution: Value, candelas: f64| {
            lights.push(json!({ "point": { "position": center.to_array(), "distribution": distribution,
                "emission": shining(json!({ "intensity_cd": candelas })) } }));
        };
        let mut object = |shape: Value, luminance: f64, two_sided: bool| {
            objects.push(json!({ "shape": shape, "material": "black", "emission": { "spectrum": "d65",
                "level": { "luminance_cd_m2": luminance }, "two_sided": two_sided } }));
        };
        match lamp(index) {
            Lamp::Isotropic { candelas } => bulb(json!("isotropic"), candelas),
            Lamp::Cosine { candelas, axis } => {
                bulb(json!({ "cosine": { "axis": axis.to_array() } }), candelas)
            }
            Lamp::Ball { luminance } => {
                object(
                    json!({ "sphere": { "center": center.to_array(), "radius": SIZE } }),
                    luminance,
                    false,
                );
            }
            Lamp::Panel { luminance, axis, two_sided } => {
                let vertices = panel(center, axis).map(|v| v.to_array());
                object(json!({ "quad": { "vertices": vertices } }), luminance, two_sided);
            }
        }
    }
    let meters: Vec<Value> = places
        .iter()
        .map(|Place(position, normal)| {
            json!({ "illuminance": { "name": "meter", "position": position.to_array(), "normal": normal.to_array() } })
        })
        .collect();
    let materials = json!({ "black": { "lambertian": { "reflectance": 0 } } });
    metered(materials, json!(objects), json!(lights), json!(meters))
}

/// Illuminance of a lamp that is wholly above the horizon: the inverse square, pi L sin^2 of
/// a ball, Lambert's sum over the edges of a panel.
fn illuminance_of(lamp: &Lamp, center: DVec3, Place(position, normal): &Place) -> f64 {
    let span = center - *position;
    let direction = span.normalize();
    let by_intensity = normal.dot(direction) / span.length_squared();
    match *lamp {
        Lamp::Isotropic { candelas } => candelas * by_intensity,
        Lamp::Cosine { candelas, axis } => candelas * (-axis.dot(direction)).max(0.0) * by_intensity,
        Lamp::Ball { luminance } => luminance * PI * SIZE * SIZE * by_intensity,
        Lamp::Panel { two_sided: false, axis, .. } if axis.dot(direction) >= 0.0 => 0.0,
        Lamp::Panel { luminance, axis, .. } => {
            let corners = panel(center, axis).map(|corner| (corner - *position).normalize());
            let edge = |i: usize| {
                let (a, b) = (corners[i], corners[(i + 1) % 4]);
                a.cross(b).normalize().dot(*normal) * a.angle_between(b)
            };
            0.5 * luminance * (0..4).map(edge).sum::<f64>().abs()
        }
    }
}

fn places() -> [Place; 3] {
    [
        Place(DVec3::new(1.0, 0.7, 0.0), DVec3::Z),
        Place(DVec3::new(6.2, 4.1, 1.2), DVec3::Z),
        Place(DVec3::new(11.1, 7.0, 0.8), DVec3::new(0.1, -0.05, 1.0).normalize()),
    ]
}

#[test]
fn meters_under_a_thousand_lamps_read_the_sum_of_all() {
    let (columns, rows, places) = (40, 25, places());
    let scene = room(columns, rows, &places);
    assert_eq!(scene.lights.len(), 1000);
    for (reading, place) in read_meters(&scene, Integrator::Path, 1 << 18, 1).iter().zip(&places) {
        let truth: f64 = (0..columns * rows)
            .map(|index| illuminance_of(&lamp(index), lamp_position(index, columns), place))
            .sum();
        assert_reads("a thousand lamps", reading, truth, 2e-3);
    }
}

/// Mean and variance of one sample of next-event estimation at a place, by a way to choose.
fn scatter(scene: &Scene, place: usize, choose: impl Fn(Vec3A, f64) -> Option<(u32, f64)>) -> (f64, f64) {
    const SAMPLES: u32 = 200_000;
    let MeterKind::Illuminance(point) = scene.meters[place].kind else { unreachable!("all meters are") };
    let wavelengths =
        instrument_plan(scene, &Sensor::named(CIE_SENSOR).expect("built in")).wavelengths.sample(0.5);
    let (mut state, mut sum, mut squares) = (7, 0.0, 0.0);
    for _ in 0..SAMPLES {
        let (index, probability) = choose(point.position, uniform(&mut state)).expect("lamps shine");
        let u = [uniform(&mut state) as f32 * 0.999_999, uniform(&mut state) as f32 * 0.999_999];
        let value = sample_light(scene, &point, index, u, &wavelengths) / probability;
        (sum, squares) = (sum + value, squares + value * value);
    }
    let mean = sum / f64::from(SAMPLES);
    (mean, squares / f64::from(SAMPLES) - mean * mean)
}

fn sample_light(
    scene: &Scene,
    point: &SurfacePoint,
    index: u32,
    u: [f32; 2],
    wavelengths: &Wavelengths,
) -> f64 {
    let light = scene.lights.get(index);
    let Some(sample) = light.sample_towards(&scene.geometry, point, u, wavelengths) else { return 0.0 };
    let cosine = point.normal.dot(sample.shadow_ray.direction).max(0.0);
    f64::from(sample.radiance.hero() * cosine / sample.pdf_solid_angle)
}

/// Ratio of variances, by power alone over by place, at each meter; the means agree.
fn gains(scene: &Scene) -> Vec<f64> {
    let gain = |place| {
        let (mean, by_power) = scatter(scene, place, |_, u| scene.lights.choose_emitting(u));
        let (same, by_place) = scatter(scene, place, |from, u| scene.lights.choose_towards(from, u));
        assert!((mean / same - 1.0).abs() < 0.05, "means {mean} and {same}");
        by_power / by_place
    };
    (0..scene.meters.len()).map(gain).collect()
}

/// Measured at the three meters: 11.3, 9.7 and 9.3 times less.
#[test]
fn choosing_by_place_scatters_less_than_choosing_by_power() {
    let gains = gains(&room(40, 25, &places()));
    assert!(gains.iter().all(|gain| *gain > 5.0), "{gains:?}");
}

/// From two lamps on, weighing them pays: whatever their number, the scatter is lower.
#[test]
fn even_two_lamps_are_better_chosen_by_place() {
    for (columns, rows) in [(2, 1), (2, 2), (4, 2), (3, 3), (8, 4)] {
        let gains = gains(&room(columns, rows, &places_within(columns, rows)));
        assert!(gains.iter().all(|gain| *gain > 1.5), "{columns} x {rows}: {gains:?}");
    }
}

/// On the floor, half way up, and a hand's breadth below the lamps.
fn places_within(columns: u64, rows: u64) -> [Place; 3] {
    let (x, y) = (columns as f64 * PITCH, rows as f64 * PITCH);
    [(0.5, 0.5, 0.0), (0.1, 0.2, 1.5), (0.9, 0.6, 2.4)]
        .map(|(u, v, z)| Place(DVec3::new(u * x, v * y, z), DVec3::Z))
}

/// Run with `cargo test --release --test many_lights -- --ignored --nocapture`.
#[test]
#[ignore = "measures, asserts nothing"]
fn what_choosing_costs_and_saves() {
    for (columns, rows) in [(1, 1), (2, 1), (2, 2), (4, 2), (4, 4), (8, 4), (8, 8), (40, 25)] {
        let scene = room(columns, rows, &places_within(columns, rows));
        let time = |choose: &dyn Fn(Vec3A, f64) -> Option<(u32, f64)>| {
            let (start, mut state) = (Instant::now(), 1);
            for _ in 0..1_000_000 {
                let u = uniform(&mut state);
                black_box(choose(Vec3A::new(u as f32, 0.1, 0.1), uniform(&mut state)));
            }
            start.elapsed().as_nanos() / 1_000_000
        };
        let by_power = time(&|_, u| scene.lights.choose_emitting(u));
        let by_place = time(&|from, u| scene.lights.choose_towards(from, u));
        let gains = gains(&scene);
        println!(
            "{:5} lamps: {by_power} ns by power, {by_place} ns by place, variance {gains:.2?}",
            columns * rows
        );
    }

    let geometry = GeometryBuilder::new().build().expect("an empty scene");
    let mut state = 5;
    let lamps: Vec<(Light, f64)> = (0..100_000)
        .map(|_| {
            let [position, axis] =
                [0; 2].map(|_| Vec3A::from_array([0; 3].map(|_| uniform(&mut state) as f32 - 0.5)));
            let distribution = Distribution::Cosine(axis.normalize());
            let light =
                PointLight { position, distribution, intensity: Emission::new(Dense::Flat(1.0), vec![]) };
            (Light::Point(light), uniform(&mut state))
        })
        .collect();
    let start = Instant::now();
    let lights = Lights::new(&geometry, lamps);
    println!("{} lamps: hierarchy in {:.3?}", lights.len(), start.elapsed());
}
