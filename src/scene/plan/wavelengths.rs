//! Which wavelengths paths carry: those at which a lamp shines and a sensor responds, in
//! proportion to what both make of them, lines among them.

use super::item::Decisions;
use super::leaving::{EVEN_WAVELENGTHS, OUTER_WAVELENGTHS};
use crate::camera::Sensor;
use crate::light::Light;
use crate::scene::Scene;
use crate::spectrum::{FIRST_NM, GRID_POINTS, LANES, LAST_NM, WavelengthSampler, between_grid_points};

/// The sampler; even over all wavelengths where no sensor responds or no lamp shines. What it
/// draws from is said in `remarks` where it is not among the decisions.
pub(super) fn wavelengths(
    scene: &Scene,
    sensor: &Sensor,
    decisions: &mut Decisions<'_>,
    remarks: &mut Vec<String>,
) -> WavelengthSampler {
    let (mut continuum, mut lines) = weights(scene, sensor);
    if continuum.iter().chain(lines.iter().map(|(_, weight)| weight)).all(|weight| *weight <= 0.0) {
        return WavelengthSampler::even();
    }
    remarks.extend(lines_drawn(&lines));
    let range = range_nm(&continuum);
    let words = range.map_or_else(
        || "lamps give off lines alone: nothing is drawn between them".to_owned(),
        |[first, last]| {
            format!("wavelengths from {first} to {last} nm: elsewhere nothing shines or nothing responds")
        },
    );
    let is_cut = range != Some([FIRST_NM as usize, LAST_NM as usize]);
    let every = "lamps shine and sensors respond from 360 to 830 nm: the range is not cut";
    let cuts = decisions.leave_out(OUTER_WAVELENGTHS, is_cut, &words, every);
    let weighs = decisions.leave_out(
        EVEN_WAVELENGTHS,
        true,
        "wavelengths are drawn as sensor and lamps weigh them, not evenly",
        "",
    );
    if is_cut && !cuts {
        // The sampler's even share reaches whatever has a weight at all.
        continuum.iter_mut().for_each(|weight| *weight = weight.max(f64::MIN_POSITIVE));
    }
    if !weighs {
        spread_evenly(&mut continuum, &mut lines);
    }
    WavelengthSampler::mixture(&continuum, &lines).unwrap_or_else(WavelengthSampler::even)
}

/// What sensors and lamps make of each grid point, per nm, and of each line, with its wavelength
/// in nm.
fn weights(scene: &Scene, sensor: &Sensor) -> (Vec<f64>, Vec<(f64, f64)>) {
    let attention = sensor.attention();
    let (mut continuum, mut lines) = (vec![0.0; GRID_POINTS], vec![0.0; scene.lines_nm.len()]);
    for index in 0..scene.lights.len() {
        let emission = match scene.lights.get(index as u32) {
            Light::Point(light) => &light.intensity,
            Light::Area(light) => light.radiance(),
        };
        let values: Vec<f64> = emission.at_grid_points().collect();
        let total: f64 = values.iter().sum::<f64>() + emission.lines().map(|(_, power)| power).sum::<f64>();
        if total > 0.0 {
            // A lamp that the sensors hardly see still counts a little.
            let weight = scene.emitters[index].weight().max(f64::MIN_POSITIVE) / total;
            continuum.iter_mut().zip(values).for_each(|(sum, v)| *sum += weight * v);
            emission.lines().for_each(|(line, power)| lines[line as usize] += weight * power);
        }
    }
    continuum.iter_mut().zip(&attention).for_each(|(weight, a)| *weight *= a);
    let attended = |(nm, weight): (&f64, f64)| (*nm, weight * between_grid_points(&attention, *nm));
    let lines = scene.lines_nm.iter().zip(lines).map(attended).collect();
    (continuum, lines)
}

/// First and last grid point in nm at which the continuum has a weight; `None` without one.
fn range_nm(weights: &[f64]) -> Option<[usize; 2]> {
    let first = weights.iter().position(|weight| *weight > 0.0)?;
    let last = weights.iter().rposition(|weight| *weight > 0.0)?;
    Some([first, last].map(|point| FIRST_NM as usize + point))
}

/// Draws all wavelengths of the continuum alike, and as often as those any of the lines.
fn spread_evenly(continuum: &mut [f64], lines: &mut [(f64, f64)]) {
    let mut drawn = 0.0;
    for weight in continuum.iter_mut().filter(|weight| **weight > 0.0) {
        (*weight, drawn) = (1.0, drawn + 1.0);
    }
    let shining = lines.iter().filter(|(_, weight)| *weight > 0.0).count() as f64;
    for (_, weight) in lines.iter_mut().filter(|(_, weight)| *weight > 0.0) {
        *weight = f64::max(drawn, 1.0) / shining;
    }
}

fn lines_drawn(lines: &[(f64, f64)]) -> Option<String> {
    let count = lines.iter().filter(|(_, weight)| *weight > 0.0).count();
    (count > 0).then(|| {
        let lines = if count == 1 { "spectral line" } else { "spectral lines" };
        format!("{count} {lines}: drawn each by itself, at its wavelength exactly")
    })
}

/// How many wavelengths a path carries. Their number is one for all scenes: `validation/plan.md`
/// has what fewer and more would do, least and most over its scenes.
pub(super) fn per_path(lanes_differ: bool) -> String {
    let fate = if lanes_differ { "until a smooth refraction with dispersion" } else { "all to its end" };
    format!(
        "{LANES} wavelengths a path, {fate}; on the scenes measured before the sampler's guide, 4 would be 6 to 16 % more efficient, 16 14 to 22 % less"
    )
}
