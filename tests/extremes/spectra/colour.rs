//! Colours at the ends of the Planckian locus, and whites.

use crate::common::{luminance, metered, read_seeded, refusals};
use crate::record::Record;
use etalon::camera::{Development, Tone};
use etalon::integrator::Integrator;
use etalon::light::EmitterFacts;
use etalon::spectrum::colour::{CIE_1931, Xyz, chromaticity_of, colour_temperature, xyz_of};
use etalon::spectrum::library::{self, Purpose};
use etalon::spectrum::{Curve, Dense, grid_nm};
use etalon::units::Kelvin;
use serde_json::{Value, json};

/// What colours are compared to, in chromaticity.
const CLOSE: f64 = 2e-5;

// Case 6. Recomputed with 40 digits over the same table.
pub fn the_planckian_locus_holds_at_its_ends(record: &mut Record) {
    for (kelvin, x, y) in [
        (1e-3, 0.734_690, 0.265_310),
        (1.0, 0.734_690, 0.265_310),
        (1000.0, 0.652_751, 0.344_462),
        (2856.0, 0.447_535, 0.407_428),
        (6500.0, 0.313_526, 0.323_628),
        (1e6, 0.240_134, 0.234_419),
        (1e15, 0.239_877, 0.234_037),
    ] {
        let found = chromaticity_of(&Curve::Blackbody(Kelvin(kelvin))).unwrap_or([f64::NAN; 2]);
        record.absolute(format!("x at {kelvin} K"), found[0], x, CLOSE);
        record.absolute(format!("y at {kelvin} K"), found[1], y, CLOSE);
    }
    record.exactly("Y at 1 K", xyz_of(&Curve::Blackbody(Kelvin(1.0)))[1], 0.0);
    let scene = lamp(json!({ "blackbody": { "temperature_k": 1 } }), json!({ "flux_lm": 100 }));
    let EmitterFacts { luminous_flux, chromaticity, .. } = &scene.emitters[0];
    record.relative("lumens of a lamp with the colour of 1 K", luminous_flux.0, 100.0, 1e-6);
    let [x, y] = chromaticity.unwrap_or([f64::NAN; 2]);
    record.absolute("its x", x, 0.734_690, CLOSE);
    record.absolute("its y", y, 0.265_310, CLOSE);
}

fn lamp(spectrum: Value, level: Value) -> etalon::scene::Scene {
    let lights =
        json!([{ "point": { "position": [0, 0, 0], "emission": { "spectrum": spectrum, "level": level } } }]);
    metered(json!({}), json!([]), lights, json!([]))
}

// Case 7.
pub fn six_and_a_half_thousand_kelvin_is_not_d65(record: &mut Record) {
    let d65 = built_in("d65");
    let [x, y] = chromaticity_of(&d65).unwrap_or([f64::NAN; 2]);
    record.absolute("x of D65", x, 0.312_727, CLOSE);
    record.absolute("y of D65", y, 0.329_023, CLOSE);
    let [_, body] = chromaticity_of(&Curve::Blackbody(Kelvin(6500.0))).unwrap_or([f64::NAN; 2]);
    record.absolute("y of D65 above that of a black body of 6500 K", y - body, 0.0054, 5e-5);
    let cct = colour_temperature([x, y]).map_or(f64::NAN, |found| found.kelvin.0);
    record.absolute("correlated colour temperature of D65, K", cct, 6504.0, 2.0);
}

fn built_in(name: &str) -> Curve {
    let table = library::table(name).expect("built in");
    library::curve(&table, None, Purpose::Emission).expect("one curve")
}

// Case 8.
pub fn the_observer_is_the_published_one(record: &mut Record) {
    let [x, y, z] = &CIE_1931.matching;
    for (name, column, sum) in [("x", x, 106.865_47), ("y", y, 106.856_92), ("z", z, 106.892_25)] {
        record.absolute(format!("sum of {name}"), column.iter().sum(), sum, 1e-4);
    }
    // The first moments find what sums do not: values exchanged or moved.
    for (name, column, mean_nm) in [("x", x, MEAN_NM[0]), ("y", y, MEAN_NM[1]), ("z", z, MEAN_NM[2])] {
        let moment: f64 = grid_nm().zip(column).map(|(nm, value)| nm * value).sum();
        record.relative(
            format!("mean wavelength of {name}, nm"),
            moment / column.iter().sum::<f64>(),
            mean_nm,
            1e-9,
        );
    }
    let entry = library::entries().find(|e| e.name == "cie-1931-2deg").expect("built in");
    let numbers: String =
        entry.text().lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).collect();
    record.exactly(
        "checksum (FNV-1a of its rows)",
        format!("{:016x}", fnv_1a(numbers.as_bytes())),
        CHECKSUM.to_owned(),
    );
}

/// Of the table in `spectra/observer`, by another program with 40 digits.
const MEAN_NM: [f64; 3] = [571.754_368_425_232, 560.191_867_597_544, 454.064_004_338_332];
const CHECKSUM: &str = "14a266f5506dc160";

fn fnv_1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

// Case 9.
pub fn a_white_surface_is_balanced_once(record: &mut Record) {
    let d65 = white_board("d65", record);
    record.absolute("X/Y of a white surface under D65", d65[0] / d65[1], 0.950_47, 1e-4);
    record.absolute("Z/Y of a white surface under D65", d65[2] / d65[1], 1.088_83, 1e-4);
    let tungsten = white_board("cie-a", record);
    // sRGB's own white is D65 rounded to four digits of chromaticity.
    for (what, seen, white, neutral) in [
        ("D65, balanced to D65", d65, Some(d65), true),
        ("illuminant A, balanced to A", tungsten, Some(xyz_of(&built_in("cie-a"))), true),
        ("D65, not balanced", d65, None, true),
        ("illuminant A, not balanced", tungsten, None, false),
    ] {
        let development = Development { white_luminance_cd_m2: seen[1], white, tone: Tone::Linear };
        let [red, green, blue] = development.linear(seen);
        if neutral {
            record.absolute(format!("red over green under {what}"), red / green, 1.0, 1e-3);
            record.absolute(format!("blue over green under {what}"), blue / green, 1.0, 1e-3);
        } else {
            // Tristimulus values of A in linear sRGB, by the matrix of IEC 61966-2-1.
            record.at_least(format!("red over blue under {what}"), red / blue, 4.0);
        }
    }
}

/// Tristimulus values of a white Lambertian board under a lamp.
fn white_board(illuminant: &str, record: &Record) -> Xyz {
    let materials = json!({ "white": { "lambertian": { "reflectance": 1 } } });
    let board = json!([{ "shape": { "disk": { "center": [0, 0, 1], "normal": [0, 0, -1], "radius": 1 } }, "material": "white" }]);
    let lights = json!([{ "point": { "position": [0.5, 0, 0], "emission": { "spectrum": illuminant, "level": { "flux_lm": 100 } } } }]);
    let scene = metered(materials, board, lights, luminance([0.0; 3], [0.0, 0.0, 1.0]));
    read_seeded(&scene, Integrator::Path, record.samples(1 << 18), record.seed()).xyz
}

// Case 15.
pub fn a_reflectance_is_a_spectrum_and_never_a_triple(record: &mut Record) {
    record.note(
        "Scenes describe surfaces by spectra alone: there is no conversion from RGB whose round trip could be \
         measured. A triple is refused, a constant reflectance is flat, and none exceeds one.",
    );
    let scene = |reflectance: &str| {
        format!(
            "{{\n\"name\": \"paint\", \"length_unit\": \"m\",\n\"materials\": {{\"paint\": {{\"lambertian\": {{\n\"reflectance\": {reflectance}}}}}}},\n\"objects\": []\n}}\n"
        )
    };
    for (name, reflectance, says) in [
        ("list", "[1, 1, 1]", "a number, the name of a spectrum, or a description"),
        ("rgb", "{\"rgb\": [1, 1, 1]}", "unknown key \"rgb\""),
        ("above", "1.0000001", "is above 1"),
    ] {
        let file = format!("reflectance-{name}");
        let text = scene(reflectance);
        let (code, _, error) = refusals::check(&file, &text);
        record.exactly(format!("exit code for {reflectance}"), code.unwrap_or(-1), 2);
        record.says(format!("{reflectance}: what is said"), &error, says);
        record.says(format!("{reflectance}: where"), &error, &format!("{file}.json:4:"));
    }
    let materials = json!({ "white": { "lambertian": { "reflectance": 1 } } });
    let white = &metered(materials, json!([]), json!([]), json!([])).materials[0];
    let etalon::material::Material::Lambertian { reflectance, .. } = white else { panic!("matte") };
    record.holds("a reflectance of 1 is 1 at every wavelength, to the bit", *reflectance == Dense::Flat(1.0));
}
