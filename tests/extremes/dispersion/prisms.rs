//! Where dispersive glass sends light, and how much of it.

use super::same_within_four;
use crate::common::facets::textbook_fresnel;
use crate::common::hemisphere::gauss;
use crate::common::runs::{films, mean_of, picture_xyz};
use crate::common::scene;
use crate::record::Record;
use etalon::camera::Film;
use etalon::integrator::Integrator;
use etalon::light::Light;
use etalon::scene::Scene;
use etalon::spectrum::colour::{Xyz, xy_of, xyz_at};
use etalon::spectrum::grid_nm;
use glam::DVec3;
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};

/// The two faces of a prism of an apex angle, its apex up at (0, `height`, 0) and its edge along
/// z, open below: light that a face mirrors inside leaves downwards.
fn faces(apex_deg: f64, height: f64, material: &str) -> [Value; 2] {
    let base = height * (0.5 * apex_deg).to_radians().tan();
    let quad = |v: [[f64; 3]; 4]| json!({ "shape": { "quad": { "vertices": v } }, "material": material });
    let above = |z: f64| [0.0, height, z];
    [
        quad([[-base, 0.0, -2.0], [-base, 0.0, 2.0], above(2.0), above(-2.0)]),
        quad([[base, 0.0, 2.0], [base, 0.0, -2.0], above(-2.0), above(2.0)]),
    ]
}

/// Side of the square pictures of spots in pixels, and half of it as an angle in radians.
const SIDE_PX: u32 = 11;
const HALF_RAD: f64 = 4e-3;

// Case 20. The eye looks through the prism along the path of minimum deviation at a lamp that
// stands where the glass must send it; its spot is in the middle of the picture. The lamp has
// another line as well, which the glass sends past the picture: the spot has the colour of one.
pub fn a_prism_deviates_as_its_glass_demands(record: &mut Record) {
    record.note(
        "Path and bdpt are held to all five lines, mlt to the d line alone: its chains take longest to begin.",
    );
    for (name, nm, deviation_deg) in [
        ("F", 486.1327, 39.138_11),
        ("d", 587.5618, 38.646_70),
        ("C", 656.2725, 38.429_14),
        ("400 nm", 400.0, 39.889_50),
        ("700 nm", 700.0, 38.318_83),
    ] {
        let scene = spot(nm, deviation_deg);
        for integrator in [Integrator::Path, Integrator::Bdpt, Integrator::Mlt] {
            // Chains take longest to begin: one line is enough for them.
            if integrator == Integrator::Mlt && name != "d" {
                continue;
            }
            let films = films(&scene, integrator, record.samples(32), record.seed());
            for (channel, truth) in ["x", "y"].into_iter().zip(xy_of(xyz_at(nm)).unwrap_or([f64::NAN; 2])) {
                let found = mean_of(&films, |film| spot_xy(film)[usize::from(channel == "y")]);
                // The board behind the lamp, a thousandth as bright, has both lines.
                let what = format!("{name}, {}: {channel} of the spot", integrator.name());
                record.absolute(what, found.mean, truth, 5e-3);
            }
            for (axis, direction) in [(0, "across"), (1, "along")] {
                let off = mean_of(&films, |film| centroid_rad(film, axis));
                let what = format!(
                    "{name}, {}: centre of the spot {direction} the spectrum, rad",
                    integrator.name()
                );
                record.absolute(what, off.mean, 0.0, 1e-4);
                record.at_most(
                    format!("{name}, {}: its standard error", integrator.name()),
                    off.standard_error,
                    2e-5,
                );
            }
        }
    }
}

/// A lamp of one line behind a prism of BK7 with an apex of 60 degrees.
fn spot(nm: f64, deviation_deg: f64) -> Scene {
    let height = 30.0_f64.to_radians().cos();
    // In and out at half the height of the prism, level inside.
    let (middle, half_width) = (0.5 * height, 0.25);
    let slope = 0.5 * deviation_deg.to_radians();
    let (cos, sin) = (slope.cos(), slope.sin());
    let eye = [-half_width - cos, middle - sin, 0.0];
    let along = |distance: f64| [half_width + distance * cos, middle - distance * sin, 0.0];
    let [left, right] = faces(60.0, height, "glass");
    let other_nm = if nm == 400.0 { 700.0 } else { 400.0 };
    let lines = [nm, other_nm].map(|nm| json!({ "wavelength_nm": nm, "power": 1 }));
    scene(&json!({
        "name": "spot", "length_unit": "m",
        "materials": { "glass": { "dielectric": { "index": "n-bk7" } }, "grey": { "lambertian": { "reflectance": 0.5 } } },
        "objects": [left, right,
            { "shape": { "sphere": { "center": along(3.0), "radius": 0.008 } }, "material": "grey",
              "emission": { "spectrum": { "lines": { "lines": lines } }, "level": { "luminance_cd_m2": 100 } } },
            // A board behind the lamp, which light reaches by way of the lamp alone: work for chains.
            { "shape": { "disk": { "center": along(3.2), "normal": [-cos, sin, 0], "radius": 0.5 } }, "material": "grey" }],
        "camera": { "position": eye, "look_at": [-half_width, middle, 0], "up": [0, 1, 0], "focal_length_mm": 1000,
            "sensor_mm": [2000.0 * HALF_RAD, 2000.0 * HALF_RAD], "resolution": [SIDE_PX, SIDE_PX],
            "iso": 100, "shutter_s": 0.01, "f_stop": 8 },
    }))
}

/// Mean place of a spot along an axis of the picture, as an angle from the middle.
fn centroid_rad(film: &Film, axis: usize) -> f64 {
    let place = |pixel: usize| [pixel % SIDE_PX as usize, pixel / SIDE_PX as usize][axis] as f64 + 0.5;
    let pixel_rad = 2.0 * HALF_RAD / f64::from(SIDE_PX);
    let (mut moment, mut sum) = (0.0, 0.0);
    for pixel in spot_of(film) {
        moment += film.mean(pixel, 1) * (place(pixel) - 0.5 * f64::from(SIDE_PX));
        sum += film.mean(pixel, 1);
    }
    moment / sum * pixel_rad
}

/// Chromaticity of a spot.
fn spot_xy(film: &Film) -> [f64; 2] {
    let xyz = [0, 1, 2].map(|channel| spot_of(film).iter().map(|pixel| film.mean(*pixel, channel)).sum());
    xy_of(xyz).unwrap_or([f64::NAN; 2])
}

/// The pixels of the spot, without the board around it.
fn spot_of(film: &Film) -> Vec<usize> {
    let largest = (0..film.pixels()).map(|pixel| film.mean(pixel, 1)).fold(0.0, f64::max);
    (0..film.pixels()).filter(|pixel| film.mean(*pixel, 1) > 0.05 * largest).collect()
}

/// Apex and height of the prism that spreads a beam, its index at the d line, and half the
/// beam's angle.
const APEX_DEG: f64 = 40.0;
const HEIGHT_M: f64 = 2.0;
const ND: f64 = 1.6;
const BEAM_DEG: f64 = 3.0;
/// The screen's reflectance: what comes back from it by way of the prism is below 1e-4.
const SCREEN: f64 = 0.02;

// Case 21.
pub fn dispersion_moves_light_and_takes_none(record: &mut Record) {
    record.note(
        "The truth is the integral of Fresnel's transmittances of both faces over the beam and the spectrum. Path \
         tracing finds none of this light: the lamp is a point.",
    );
    for (name, index) in [("no dispersion", json!(ND)), ("V = 20", json!({ "abbe": { "nd": ND, "vd": 20 } }))]
    {
        let scene = beam(&index);
        let truth = screened(&scene, name == "V = 20");
        for (integrator, spp) in [(Integrator::Light, 192), (Integrator::Bdpt, 256), (Integrator::Mlt, 768)] {
            let films = films(&scene, integrator, record.samples(spp), record.seed());
            let channels = ["X", "Y", "Z"].into_iter().zip(picture_xyz(&films)).zip(truth);
            for ((channel, found), truth) in channels {
                // Radiance of the screen is its irradiance times reflectance over pi; the picture
                // shows an area of the screen's plane.
                let [flux, error] =
                    [found.mean, found.standard_error].map(|value| value * PI / SCREEN * SHOWN_M2);
                let what = format!("{name}, {}: {channel} on the screen", integrator.name());
                if integrator == Integrator::Mlt {
                    // With dispersion by night alone: by day its error is a good part of 0.3 %.
                    if name != "V = 20" || record.is_nightly() {
                        record.relative(format!("{what}, as the catalogue bounds it"), flux, truth, 3e-3);
                    }
                    record.mean(what, flux, error, truth, 3e-3);
                } else {
                    record.relative(what.clone(), flux, truth, 3e-3);
                    record.at_most(format!("{what}, relative standard error"), error / flux, 8e-4);
                }
            }
        }
    }
    record.note("Chains are noisier than samples. Without dispersion they are held to the 0.3 % of the catalogue by day too; with V = 20 only by night: by day five of their standard errors are allowed, each below 0.3 %.");
}

/// Area of the screen's plane in the picture, m2: 1.6 m by 1.6 m.
const SHOWN_M2: f64 = 1.6 * 1.6;

/// Incidence and deviation of the beam's axis at minimum deviation for the d line, radians.
fn axis() -> (f64, f64) {
    let half = (0.5 * APEX_DEG).to_radians();
    let incidence = (ND * half.sin()).asin();
    (incidence, 2.0 * (incidence - half))
}

/// Lamp and direction of the beam's axis.
fn lamp() -> (DVec3, DVec3) {
    let (_, deviation) = axis();
    let direction = DVec3::new((0.5 * deviation).cos(), (0.5 * deviation).sin(), 0.0);
    let half_width = 0.5 * HEIGHT_M * (0.5 * APEX_DEG).to_radians().tan();
    (DVec3::new(-half_width, 0.5 * HEIGHT_M, 0.0) - 0.5 * direction, direction)
}

/// A beam of equal energy through a prism onto a screen, which a camera sees square on from
/// beside the beam.
fn beam(index: &Value) -> Scene {
    let (from, direction) = lamp();
    let outward = DVec3::new(direction.x, -direction.y, 0.0);
    let exit = DVec3::new(-from.x, from.y, 0.0);
    let middle = exit + outward * 0.7;
    let [left, right] = faces(APEX_DEG, HEIGHT_M, "glass");
    // A picture of 1.6 m at 0.5 m, the screen at its side: the camera is out of the beam.
    let eye = middle - outward * 0.5 + DVec3::Z * 0.35;
    scene(&json!({
        "name": "beam", "length_unit": "m",
        "materials": { "glass": { "dielectric": { "index": index } }, "screen": { "lambertian": { "reflectance": SCREEN } } },
        "objects": [left, right,
            { "shape": { "disk": { "center": middle.to_array(), "normal": (-outward).to_array(), "radius": 0.4 } }, "material": "screen" }],
        "lights": [{ "point": { "position": from.to_array(), "emission": { "spectrum": "cie-e", "level": { "flux_lm": 100 } },
            "distribution": { "profile": { "axis": direction.to_array(), "angles_deg": [0, BEAM_DEG], "relative_intensity": [1, 1] } } } }],
        "camera": { "position": eye.to_array(), "look_at": (eye + outward).to_array(), "up": [0, 0, 1], "focal_length_mm": 50,
            "sensor_mm": [160, 160], "resolution": [8, 8], "iso": 100, "shutter_s": 0.01, "f_stop": 8 },
    }))
}

/// Tristimulus flux of the beam behind the prism.
fn screened(scene: &Scene, disperses: bool) -> Xyz {
    let Light::Point(light) = scene.lights.get(0) else { panic!("a point light") };
    let stored: Vec<f64> = light.intensity.at_grid_points().collect();
    // Stored per scene unit; the lamp's facts are per metre.
    let per_metre =
        scene.emitters[0].xyz[1] / grid_nm().zip(&stored).map(|(nm, i)| i * xyz_at(nm)[1]).sum::<f64>();
    let intensity = stored.into_iter().map(|intensity| intensity * per_metre);
    // Cauchy's law through nd with V = 20, lines F and C.
    let b_um2 = if disperses {
        (ND - 1.0) / 20.0 / (1e6 / 486.1327_f64.powi(2) - 1e6 / 656.2725_f64.powi(2))
    } else {
        0.0
    };
    let a = ND - b_um2 * 1e6 / 587.5618_f64.powi(2);
    grid_nm().zip(intensity).fold([0.0; 3], |sum, (nm, intensity)| {
        let flux = intensity * transmitted_sr(a + b_um2 * 1e6 / (nm * nm));
        let xyz = xyz_at(nm);
        std::array::from_fn(|channel| sum[channel] + flux * xyz[channel])
    })
}

/// Transmittance of both faces, integrated over the beam's solid angle.
fn transmitted_sr(n: f64) -> f64 {
    let half = (0.5 * APEX_DEG).to_radians();
    let entry = DVec3::new(half.cos(), -half.sin(), 0.0);
    let exit = DVec3::new(half.cos(), half.sin(), 0.0);
    let (_, axis) = lamp();
    let up = DVec3::new(-axis.y, axis.x, 0.0);
    let cap = 1.0 - BEAM_DEG.to_radians().cos();
    const AZIMUTHS: i32 = 16;
    let through = |t: f64, phi: f64| {
        let cos = 1.0 - cap * t;
        let sin = (1.0 - cos * cos).sqrt();
        let w = axis * cos + (up * phi.cos() + DVec3::Z * phi.sin()) * sin;
        let (reflected, cos_t) = textbook_fresnel(w.dot(entry), n);
        let inside = w / n + entry * (cos_t - w.dot(entry) / n);
        let (mirrored, _) = textbook_fresnel(inside.dot(exit), 1.0 / n);
        (1.0 - reflected) * (1.0 - mirrored)
    };
    let ring = |t: f64| {
        (0..AZIMUTHS).map(|i| through(t, TAU * f64::from(i) / f64::from(AZIMUTHS))).sum::<f64>()
            / f64::from(AZIMUTHS)
    };
    TAU * cap * gauss(6).iter().map(|&(t, weight)| weight * ring(t)).sum::<f64>()
}

// Case 22.
pub fn wavelengths_are_dropped_once_on_both_sides_of_a_joint(record: &mut Record) {
    let glass = json!({ "dielectric": { "index": { "abbe": { "nd": 1.6, "vd": 20 } } } });
    let slab = |min: [f64; 3], max: [f64; 3]| json!({ "shape": { "box": { "min": min, "max": max } }, "material": "glass" });
    let scene = scene(&json!({
        "name": "slabs", "length_unit": "m",
        "materials": { "glass": glass, "grey": { "lambertian": { "reflectance": 0.7 } }, "black": { "lambertian": { "reflectance": 0 } } },
        "objects": [
            // Lamp, slab, board; board, slab, camera.
            { "shape": { "disk": { "center": [0, 1.5, 0], "normal": [0, -1, 0], "radius": 1 } }, "material": "black",
              "emission": { "spectrum": "cie-e", "level": { "luminance_cd_m2": 100 } } },
            slab([-3.0, 0.9, -3.0], [3.0, 1.2, 3.0]),
            { "shape": { "quad": { "vertices": [[-1, 0, -1], [-1, 0.3, 1], [1, 0.3, 1], [1, 0, -1]] } }, "material": "grey" },
            slab([-3.0, -0.5, -2.0], [3.0, 0.85, -1.7])],
        "camera": { "position": [0, 0.6, -2.6], "look_at": [0, 0.15, 0], "up": [0, 1, 0], "focal_length_mm": 50,
            "sensor_mm": [20, 10], "resolution": [4, 2], "iso": 100, "shutter_s": 0.01, "f_stop": 8 },
    }));
    let means = [(Integrator::Path, 768), (Integrator::Bdpt, 704), (Integrator::Mlt, 2304)].map(
        |(integrator, spp)| {
            (integrator.name(), picture_xyz(&films(&scene, integrator, record.samples(spp), record.seed())))
        },
    );
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        for (index, channel) in ["X", "Y", "Z"].into_iter().enumerate() {
            let what = format!("{channel}, {} against {}", means[a].0, means[b].0);
            same_within_four(record, &what, means[a].1[index], means[b].1[index], 0.01);
        }
    }
}
