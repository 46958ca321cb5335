//! Colours, lamps and indices against figures that colour-science computed
//! (`tests/oracle/colour_science.py`).

use etalon::spectrum::colour::{chromaticity_of, colour_temperature, xyz_of_grid};
use etalon::spectrum::library::{self, Purpose};
use etalon::spectrum::{C_NM, Curve, D_NM, F_NM, LampSpectrum, grid_nm};
use etalon::units::Kelvin;
use serde_json::Value;

fn oracle() -> Value {
    serde_json::from_str(include_str!("oracle/colour_science.json")).expect("the oracle is JSON")
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("no {key} in {value}"))
}

fn near(what: &str, value: f64, truth: f64, bound: f64) {
    assert!((value - truth).abs() <= bound, "{what}: {value} against {truth}");
}

fn agree(what: &str, curve: &Curve, truth: &Value) {
    let xyz = xyz_of_grid(&curve.shape(grid_nm()));
    let [x, y] = chromaticity_of(curve).expect("a lamp shines");
    near(&format!("{what} x"), x, number(truth, "chromaticity_x"), 1e-4);
    near(&format!("{what} y"), y, number(truth, "chromaticity_y"), 1e-4);
    near(&format!("{what} X/Y"), xyz[0] / xyz[1], number(truth, "tristimulus_x_over_y"), 1e-4);
    near(&format!("{what} Z/Y"), xyz[2] / xyz[1], number(truth, "tristimulus_z_over_y"), 1e-4);
}

#[test]
fn every_built_in_lamp_has_the_colour_that_colour_science_gives_it() {
    let oracle = oracle();
    let lights = oracle["lights"].as_object().expect("a map of lights");
    let lamps: Vec<_> = library::entries().filter(|e| matches!(e.kind, "illuminant" | "emission")).collect();
    assert_eq!(lamps.len(), lights.len());
    for entry in lamps {
        let truth = &lights[entry.name];
        let curve = library::curve(&entry.table(), None, Purpose::Emission).expect("a lamp is one curve");
        agree(entry.name, &curve, truth);
        // The oracle sums its watts as it sums its lumens; an integral counts the ends by half.
        let shape = curve.shape(grid_nm());
        let sum: f64 = shape.iter().sum();
        let ends = 0.5 * (shape[0] + shape[shape.len() - 1]);
        let efficacy = LampSpectrum::from(curve.clone()).efficacy_lm_per_w().expect("a lamp shines")
            * (sum - ends)
            / sum;
        let expected = number(truth, "luminous_efficacy_lm_per_w");
        near(&format!("{} lm/W", entry.name), efficacy, expected, 1e-4 * expected);
        let found = chromaticity_of(&curve).and_then(colour_temperature);
        match (found, truth["cct_k"].as_f64()) {
            (Some(found), Some(cct)) => near(&format!("{} CCT", entry.name), found.kelvin.0, cct, 1e-4 * cct),
            // Beyond a distance of 0.05 from the locus there is no CCT.
            (None, Some(_)) => assert!(number(truth, "duv").abs() > 0.05, "{}", entry.name),
            (_, None) => {}
        }
    }
}

#[test]
fn black_bodies_have_the_colour_that_colour_science_gives_them() {
    let oracle = oracle();
    let bodies = &oracle["blackbodies"];
    let mut compared = 0;
    for kelvin in (1000..=20_000).step_by(500) {
        let truth = match bodies {
            Value::Object(map) => map.get(&kelvin.to_string()).cloned(),
            Value::Array(list) => list.iter().find(|b| b["temperature_k"] == kelvin).cloned(),
            _ => None,
        };
        agree(
            &format!("{kelvin} K"),
            &Curve::Blackbody(Kelvin(f64::from(kelvin))),
            &truth.expect("in the oracle"),
        );
        compared += 1;
    }
    assert_eq!(compared, 39);
}

/// CIELAB 1976 of tristimulus values under a white.
fn lab(xyz: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let f = |t: f64| {
        if t > (6.0_f64 / 29.0).powi(3) { t.cbrt() } else { t * (29.0_f64 / 6.0).powi(2) / 3.0 + 4.0 / 29.0 }
    };
    let [fx, fy, fz] = [0, 1, 2].map(|c| f(xyz[c] / white[c]));
    [116.0 * fy - 16.0, 500.0 * (fx - fy), 200.0 * (fy - fz)]
}

/// dE2000 is below 2.13 times the Euclidean difference in CIELAB: its weights S are at least
/// one, a* is stretched by at most 1.5 and the rotation term at most doubles the square. What
/// is allowed here keeps it below 0.01.
const EUCLIDEAN_FOR_DE2000_OF_0_01: f64 = 0.01 / 2.13;

#[test]
fn the_cornell_patches_have_the_colours_that_colour_science_gives_them() {
    let oracle = oracle();
    let patches = oracle["patches_under_cornell_lamp"].as_object().expect("a map of patches").clone();
    let lamp = library::curve(&library::table("cornell-lamp").expect("built in"), None, Purpose::Emission)
        .expect("a curve");
    let lamp: Vec<f64> = grid_nm().map(|nm| lamp.at(nm)).collect();
    let white = xyz_of_grid(&lamp);
    let scale = |xyz: [f64; 3]| xyz.map(|c| 100.0 * c / white[1]);
    let mut compared = 0;
    for (name, truth) in &patches {
        let Some(expected) = truth["lab"].as_array() else { continue };
        let curve = match library::table(name) {
            Ok(table) => library::curve(&table, None, Purpose::Reflectance).expect("a curve"),
            Err(_) => Curve::Constant(1.0), // the perfect diffuser
        };
        let reflected: Vec<f64> = grid_nm().zip(&lamp).map(|(nm, e)| curve.at(nm) * e).collect();
        let found = lab(scale(xyz_of_grid(&reflected)), scale(white));
        let squares = found.iter().zip(expected).map(|(v, t)| (v - t.as_f64().expect("a number")).powi(2));
        let difference = squares.sum::<f64>().sqrt();
        assert!(difference < EUCLIDEAN_FOR_DE2000_OF_0_01, "{name}: {found:?} against {expected:?}");
        compared += 1;
    }
    assert_eq!(compared, 6);
}

#[test]
fn glasses_and_metals_have_their_published_indices() {
    let oracle = oracle();
    for (name, truth) in oracle["glasses"].as_object().expect("a map") {
        let index = library::refractive_index(&library::table(name).expect("built in")).expect("an index");
        for (key, nm) in [("n_f", F_NM), ("n_d", D_NM), ("n_c", C_NM)] {
            near(&format!("{name} {key}"), index.at(nm).expect("in range"), number(truth, key), 1e-9);
        }
        near(
            &format!("{name} V"),
            index.abbe_number().expect("in range"),
            number(truth, "abbe_number"),
            0.02,
        );
    }
    for (name, truth) in oracle["metals"].as_object().expect("a map") {
        let table = library::table(name).expect("built in");
        for column in ["n", "k"] {
            let curve = library::curve(&table, Some(column), Purpose::Reflectance).expect("a column");
            for nm in [450, 550, 650] {
                let entry = &truth[format!("n_k_at_{nm}_nm")];
                let expected = entry[if column == "n" { 0 } else { 1 }].as_f64().expect("a number");
                near(&format!("{name} {column} at {nm}"), curve.at(f64::from(nm)), expected, 1e-9);
            }
        }
    }
}

#[test]
fn the_oracle_names_every_glass_and_metal() {
    let oracle = oracle();
    for (kind, key) in [("glass", "glasses"), ("metal", "metals")] {
        let known = library::entries().filter(|e| e.kind == kind).count();
        assert_eq!(oracle[key].as_object().expect("a map").len(), known, "{kind}");
    }
}
