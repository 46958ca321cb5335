//! Sellmeier's and Cauchy's formulas where they say nothing about glass.

use crate::common::refusals::{check, place};
use crate::record::Record;
use etalon::spectrum::library::{refractive_index, table};
use etalon::spectrum::{C_NM, D_NM, F_NM, RefractiveIndex};

/// The coefficients of BK7, as a user may write them.
fn bk7() -> RefractiveIndex {
    let terms =
        vec![[1.039_612_12, 0.006_000_698_67], [0.231_792_344, 0.020_017_914_4], [1.010_469_45, 103.560_653]];
    RefractiveIndex::Sellmeier { terms, range_nm: (50.0, 20_000.0) }
}

/// What `etalon check` says about glass of an index that it must refuse.
fn refused(record: &mut Record, name: &str, index: &str, says: &str) {
    let scene = format!(
        "{{\n\"name\": \"glass\",\n\"length_unit\": \"m\",\n\"materials\": {{\"glass\": {{\"dielectric\": {{\n\"index\": {index}}}}}}}\n}}\n"
    );
    let file = format!("index-{}", name.replace([' ', '.', '^'], "-"));
    let (code, _, error) = check(&file, &scene);
    record.exactly(format!("{name}: exit code"), code.unwrap_or(-1), 2);
    record.says(format!("{name}: what is said"), &error, says);
    record.says(format!("{name}: where"), &error, &place(&file, &scene, "\"index\""));
}

// Case 18. The indices and V with 40 digits from the formula.
pub fn poles_of_a_formula_are_refused(record: &mut Record) {
    let built_in = refractive_index(&table("n-bk7").expect("built in")).expect("an index");
    for (name, nm, n) in [("F", F_NM, 1.522_376_29), ("d", D_NM, 1.516_800_035), ("C", C_NM, 1.514_322_347)] {
        let found = built_in.at(nm).unwrap_or(f64::NAN);
        record.relative(format!("index of BK7 at {name}"), found, n, 1e-6);
    }
    let abbe = built_in.abbe_number().unwrap_or(f64::NAN);
    record.relative("V of BK7", abbe, 64.167_336, 1e-6);
    let glass = bk7();
    for pole in [77.464, 141.485, 10_176.475] {
        let near = [-0.99, -0.5, -1e-3, 0.0, 1e-3, 0.5, 0.99].map(|off| glass.at(pole + off).is_err());
        record.holds(format!("refused within 1 nm of the pole at {pole} nm"), near == [true; 7]);
    }
    let dark = |nm: i32| glass.at(f64::from(nm) * 0.1).is_err();
    record.holds(
        "refused where n^2 is negative: 75, 77, 138, 140 nm",
        [750, 770, 1380, 1400].into_iter().all(dark),
    );
    let sound = |nm: i32| match glass.at(f64::from(nm) * 0.1) {
        Ok(n) => n > 1e-3 && n.is_finite(),
        Err(_) => true,
    };
    record.holds("an index or an error, never NaN, from 50 to 20 000 nm", (500..200_000).all(sound));
    for (name, index, says) in [
        (
            "a pole at 550.3 nm",
            r#"{"sellmeier": {"b": [1, 0.001], "c_um2": [0.01, 0.30283009], "range_nm": [400, 700]}}"#,
            "a pole at 550.30 nm",
        ),
        (
            "a pole at 359.2 nm",
            r#"{"sellmeier": {"b": [1, 0.001], "c_um2": [0.01, 0.12902464], "range_nm": [400, 700]}}"#,
            "a pole at 359.20 nm",
        ),
        (
            "a pole at 830.7 nm",
            r#"{"sellmeier": {"b": [1, 0.001], "c_um2": [0.01, 0.69006249], "range_nm": [400, 700]}}"#,
            "a pole at 830.70 nm",
        ),
        // n^2 = 1 - (1 - 1e-7) l^2 / (l^2 - 0) = 1e-7 at every wavelength.
        (
            "n^2 = 1e-7",
            r#"{"sellmeier": {"b": [-0.9999999], "c_um2": [0], "range_nm": [400, 700]}}"#,
            "Sellmeier's formula gives n^2 =",
        ),
    ] {
        refused(record, name, index, says);
    }
}

// Case 19.
pub fn a_formula_beyond_its_range_is_refused(record: &mut Record) {
    record.note(
        "Transport considers 360 to 830 nm alone, within the 300 to 2500 nm that Cauchy's formula is taken to \
         describe, so that no scene can ask beyond and no warning is due; nor is there a way to force an index \
         above 10.",
    );
    let fit = RefractiveIndex::Cauchy { a: 1.504_584, b_um2: 0.004_217_4 };
    let error = fit.at(1.0).err().map(|error| error.to_string()).unwrap_or_default();
    record.says("n at 1 nm", &error, "the refractive index at 1 nm is 4218.9");
    let range = fit.fitted_range_nm().unwrap_or((0.0, f64::INFINITY));
    record.exactly("range of the formula, nm", format!("{range:?}"), "(300.0, 2500.0)".to_owned());
    record.relative("n at 400 nm", fit.at(400.0).unwrap_or(f64::NAN), 1.504_584 + 0.004_217_4 / 0.16, 1e-12);
    // 1.5 + 1.2 / 0.36^2 = 10.76.
    refused(
        record,
        "Cauchy above 10",
        r#"{"cauchy": {"a": 1.5, "b_um2": 1.2}}"#,
        "the refractive index at 360 nm is 10.759",
    );
    refused(
        record,
        "Cauchy below 0",
        r#"{"cauchy": {"a": 1.5, "b_um2": -1.2}}"#,
        "the refractive index at 360 nm is -7.759",
    );
}
