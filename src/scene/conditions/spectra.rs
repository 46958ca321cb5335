//! Wavelengths: dispersion, lamps of few wavelengths, ranges that do not meet.

use super::{ALL, Condition, EXTREME_BIAS, Kind, objects_of, percent, short, worst};
use crate::camera::Sensor;
use crate::integrator::Integrator;
use crate::light::Light;
use crate::material::Material;
use crate::scene::{Plan, Scene, View};
use crate::spectrum::colour::{CIE_1931, xyz_at};
use crate::spectrum::{
    C_NM, D_NM, Dense, Emission, F_NM, FIRST_NM, GRID_POINTS, LANES, WavelengthSampler, between_grid_points,
};

pub(super) fn conditions(scene: &Scene, view: Option<&View>) -> Vec<Condition> {
    let sensor = view.map_or_else(Sensor::cie, |view| view.sensor.clone());
    let plan = Plan::of(scene, &sensor, Integrator::Path.strategies());
    let mut found = dispersion(scene, &plan.wavelengths);
    let shining = || (0..scene.lights.len()).filter(|light| scene.emitters[*light].weight() > 0.0);
    let few = shining().filter_map(|light| few_wavelengths(scene, light)).collect();
    found.extend(worst(few, |c| -c.value("effective_bands_of_10_nm").unwrap_or(0.0)));
    let dark = shining().filter_map(|light| dark_range(scene, light, &sensor)).collect();
    found.extend(worst(dark, |c| c.value("share_of_response_in_the_dark").unwrap_or(0.0)));
    found.extend(sensor_range(&sensor));
    found
}

fn emission(scene: &Scene, light: usize) -> &Emission {
    match scene.lights.get(light as u32) {
        Light::Point(light) => &light.intensity,
        Light::Area(light) => light.radiance(),
    }
}

/// Smooth refraction of a path whose wavelengths would part: the hero goes on alone.
fn dispersion(scene: &Scene, sampler: &WavelengthSampler) -> Vec<Condition> {
    let brightest = (0..scene.lights.len())
        .max_by(|a, b| scene.emitters[*a].weight().total_cmp(&scene.emitters[*b].weight()));
    let Some(brightest) = brightest.filter(|light| scene.emitters[*light].weight() > 0.0) else {
        return Vec::new();
    };
    let alone = variance_of_one_wavelength(emission(scene, brightest), &scene.lines_nm, sampler);
    let with_media = scene.materials.iter().enumerate().filter_map(|(index, material)| match material {
        Material::Dielectric { excess_index, .. } if material.disperses() && material.is_smooth() => {
            Some((excess_index, objects_of(scene, index)?))
        }
        _ => None,
    });
    with_media.map(|(excess, objects)| one_wavelength(excess, &objects, alone)).collect()
}

fn one_wavelength(excess: &Dense, objects: &str, variance: [f64; 3]) -> Condition {
    let values: Vec<f64> = excess.values().into_iter().map(f64::from).collect();
    let [f, d, c] = [F_NM, D_NM, C_NM].map(|nm| between_grid_points(&values, nm));
    /// Angle of incidence at which the spread of colours is stated.
    const OBLIQUE_DEG: f64 = 45.0;
    let refracted = |nm: f64| {
        let sine = OBLIQUE_DEG.to_radians().sin() / (1.0 + between_grid_points(&values, nm));
        sine.min(1.0).asin().to_degrees()
    };
    let [x, y, z] = variance.map(|v| percent(v.sqrt()));
    let what = format!(
        "paths that it refracts go on with one wavelength of {LANES}: their variance is up to {LANES} times as large, and by colour alone one sample scatters by {x} in X, {y} in Y and {z} in Z; reflections and rough surfaces keep all wavelengths"
    );
    Condition::new(
        "dispersion",
        objects,
        "an index that differs between wavelengths at all: directions part, however little",
    )
    .figure("abbe_number", d / (f - c))
    .figure("refraction_spread_400_to_700_nm_at_45_deg_deg", (refracted(700.0) - refracted(400.0)).abs())
    .figure("variance_factor_at_most", LANES as f64)
    .figure("relative_variance_of_colour_x", variance[0])
    .figure("relative_variance_of_colour_y", variance[1])
    .figure("relative_variance_of_colour_z", variance[2])
    .effect(Kind::Noise, ALL, what)
    .remedy("a constant index, where the spread of colours does not matter")
}

/// Relative variance of X, Y and Z of a lamp's light from one wavelength each.
fn variance_of_one_wavelength(
    emission: &Emission,
    lines_nm: &[f64],
    sampler: &WavelengthSampler,
) -> [f64; 3] {
    let values: Vec<f64> = emission.at_grid_points().collect();
    std::array::from_fn(|channel| {
        let (mut mean, mut square) = (0.0, 0.0);
        for cell in 0..GRID_POINTS - 1 {
            let nm = FIRST_NM + cell as f64 + 0.5;
            let value = between_grid_points(&values, nm) * xyz_at(nm)[channel];
            let density = sampler.pdf_per_nm(nm);
            if density > 0.0 {
                mean += value;
                square += value * value / density;
            }
        }
        for (line, power) in emission.lines() {
            let value = power * xyz_at(lines_nm[line as usize])[channel];
            let probability = sampler.line_probability(line);
            if probability > 0.0 {
                mean += value;
                square += value * value / probability;
            }
        }
        if mean > 0.0 { (square / (mean * mean) - 1.0).max(0.0) } else { f64::NAN }
    })
}

/// A lamp whose light is that of a few wavelengths.
fn few_wavelengths(scene: &Scene, light: usize) -> Option<Condition> {
    /// Width of the bands that errors of a spectral table are taken to be independent in: what
    /// spectrophotometers resolve.
    const BAND_NM: f64 = 10.0;
    /// Fewer independent bands halve the errors of a reflectance table at most.
    const FEWEST: f64 = 4.0;
    let emission = emission(scene, light);
    let mut bands = vec![0.0; 1 + ((GRID_POINTS - 1) as f64 / BAND_NM) as usize];
    let band = |nm: f64| ((nm - FIRST_NM) / BAND_NM) as usize;
    for (value, (point, y_bar)) in emission.at_grid_points().zip(CIE_1931.matching[1].iter().enumerate()) {
        bands[band(FIRST_NM + point as f64)] += value * y_bar;
    }
    let of_lines: f64 = emission
        .lines()
        .map(|(line, power)| {
            let nm = scene.lines_nm[line as usize];
            let value = power * between_grid_points(&CIE_1931.matching[1], nm);
            bands[band(nm)] += value;
            value
        })
        .sum();
    let sum: f64 = bands.iter().sum();
    let effective = sum * sum / bands.iter().map(|b| b * b).sum::<f64>();
    (effective < FEWEST).then(|| {
        let what = format!(
            "errors of reflectances, filters and sensitivities average over {} bands of {BAND_NM} nm instead of about ten: {} of such an error comes through",
            short(effective),
            percent(effective.sqrt().recip())
        );
        Condition::new(
            "few_wavelengths",
            &scene.emitters[light].name,
            format!("fewer than {FEWEST} independent bands of {BAND_NM} nm: at least half of a table's error at one wavelength comes through"),
        )
        .figure("effective_bands_of_10_nm", effective)
        .figure("share_of_luminance_in_lines", of_lines / sum)
        .effect(Kind::Sensitivity, ALL, what)
        .effect(Kind::Noise, ALL, "none: lines are drawn by themselves, each with its own probability")
        .remedy("check the tables of what it lights at its wavelengths")
    })
}

/// A lamp that ends within what the sensor sees.
fn dark_range(scene: &Scene, light: usize, sensor: &Sensor) -> Option<Condition> {
    let values: Vec<f64> = emission(scene, light).at_grid_points().collect();
    let first = values.iter().position(|v| *v > 0.0)?;
    let last = values.iter().rposition(|v| *v > 0.0)?;
    let attention = sensor.attention();
    let all: f64 = attention.iter().sum();
    let dark = (attention[..first].iter().sum::<f64>() + attention[last + 1..].iter().sum::<f64>()) / all;
    (dark > EXTREME_BIAS).then(|| {
        let [from, to] = [first, last].map(|point| FIRST_NM + point as f64);
        let what = format!(
            "counts as dark below {from} and above {to} nm, where {} of the sensor's response lies: if the lamp does shine there, that much of an even light is missing",
            percent(dark)
        );
        Condition::new(
            "dark_range",
            &scene.emitters[light].name,
            format!("more than {} of the sensor's response lies where the lamp is dark", percent(EXTREME_BIAS)),
        )
        .figure("first_nm", from)
        .figure("last_nm", to)
        .figure("share_of_response_in_the_dark", dark)
        .effect(Kind::Bias, ALL, what)
        .remedy("a table of the lamp that covers what the sensor sees, if there is one")
    })
}

/// A sensor that responds beyond the wavelengths of transport.
fn sensor_range(sensor: &Sensor) -> Option<Condition> {
    let least = sensor.coverage.iter().copied().fold(1.0, f64::min);
    (1.0 - least > EXTREME_BIAS).then(|| {
        let what = format!(
            "{} of a channel's sensitivity lies outside 360 to 830 nm and sees nothing: an even light is low by as much there",
            percent(1.0 - least)
        );
        Condition::new(
            "sensor_range",
            &sensor.name,
            format!("more than {} of a channel's sensitivity lies outside", percent(EXTREME_BIAS)),
        )
        .figure("share_outside", 1.0 - least)
        .effect(Kind::Bias, ALL, what)
        .remedy("a sensor behind its infrared filter, or light without infrared")
    })
}
