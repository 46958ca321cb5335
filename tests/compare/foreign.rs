//! Files of other renderers, and files that cannot be compared.

use crate::common::program::folder;
use crate::files::{compare, compared};
use crate::written::Written;
use exr::meta::attribute::Chromaticities;
use exr::prelude::*;
use serde_json::Value;
use std::path::Path;

const SIZE: [usize; 2] = [8, 4];
const PIXELS: usize = SIZE[0] * SIZE[1];

/// ITU-R BT.2020.
const BT_2020: Chromaticities = Chromaticities {
    red: Vec2(0.708, 0.292),
    green: Vec2(0.17, 0.797),
    blue: Vec2(0.131, 0.046),
    white: Vec2(0.3127, 0.329),
};

fn flat(value: f32) -> Vec<f32> {
    vec![value; PIXELS]
}

fn luminance(value: f32) -> Written {
    Written { channels: vec![("Y", flat(value))], white_luminance: Some(1.0), ..Written::default() }
}

fn rgb([r, g, b]: [f32; 3]) -> Written {
    Written { channels: vec![("R", flat(r)), ("G", flat(g)), ("B", flat(b))], ..Written::default() }
}

fn ratio(found: &Value) -> f64 {
    found["mean_ratio"].as_f64().unwrap_or_else(|| panic!("{found:#}"))
}

fn assert_near(value: f64, truth: f64) {
    assert!((value / truth - 1.0).abs() < 1e-5, "{value}, truth {truth}");
}

/// Green has the luminance 0.7152 in BT.709 and 0.6780 in BT.2020 (their recommendations, to four
/// digits).
#[test]
fn linear_rgb_has_the_primaries_of_its_file() {
    let folder = folder("compare-primaries");
    let one = luminance(1.0).write(&folder, "y.exr", SIZE);
    let green = Written { white_luminance: Some(1.0), ..rgb([0.0, 1.0, 0.0]) };
    for (name, chromaticities, truth) in [("709.exr", None, 0.7152), ("2020.exr", Some(BT_2020), 0.6780)] {
        let file = Written { chromaticities, ..green.clone() }.write(&folder, name, SIZE);
        let found = compared(&file, &one, "");
        assert!((ratio(&found) - truth).abs() < 1e-4, "{name}: {found:#}");
        let assumed = found["notes"].to_string().contains("BT.709");
        assert_eq!(assumed, chromaticities.is_none(), "{found:#}");
    }
}

#[test]
fn a_unit_is_stated_or_given_or_the_file_refused() {
    let folder = folder("compare-units");
    let known = luminance(100.0).write(&folder, "known.exr", SIZE);
    let white = Written { white_luminance: Some(50.0), ..rgb([1.0; 3]) }.write(&folder, "white.exr", SIZE);
    assert_near(ratio(&compared(&white, &known, "")), 0.5);
    let unknown = rgb([1.0; 3]).write(&folder, "unknown.exr", SIZE);
    let refused = compare(&known, &unknown, "");
    assert_eq!((refused.code, refused.err.lines().count()), (2, 1), "{}", refused.err);
    let says = "unknown.exr: nothing says what unit its values have";
    assert!(refused.err.contains(says) && refused.err.contains("--scale-b"), "{}", refused.err);
    assert_near(ratio(&compared(&known, &unknown, "--scale-b 179")), 100.0 / 179.0);
    assert_near(ratio(&compared(&unknown, &known, "--scale-a 179")), 1.79);
    let shape = compared(&known, &unknown, "--units relative");
    assert!(shape["mean_ratio"].is_null(), "{shape:#}");
    assert_near(shape["scale_fitted"].as_f64().expect("a factor"), 0.01);
    assert!(shape["mse"].as_f64().is_some_and(|mse| mse < 1e-12), "{shape:#}");
}

/// By hand: differences of 1 and 0 in halves of the picture, |A - B| / (A + B) = 1/3 and 0, and
/// (A - B)^2 / (B^2 + e) = 1 / (1 + 1e-4) and 0.
#[test]
fn measures_as_by_hand_and_no_verdict_without_noise() {
    let folder = folder("compare-by-hand");
    let a: Vec<f32> = (0..PIXELS).map(|p| if p < PIXELS / 2 { 2.0 } else { 1.0 }).collect();
    let a = Written { channels: vec![("Y", a)], ..luminance(0.0) }.write(&folder, "a.exr", SIZE);
    let b = luminance(1.0).write(&folder, "b.exr", SIZE);
    let found = compared(&a, &b, "");
    for (key, truth) in [("mse", 0.5), ("relmse", 0.5 / 1.0001), ("smape", 1.0 / 6.0), ("mean_ratio", 1.5)] {
        assert_near(found[key].as_f64().expect("a number"), truth);
    }
    assert_eq!(found["verdict"], "undecided");
    assert!(found["mse_corrected"].is_null() && found["mean_ratio_ci95"].is_null());
}

#[test]
fn a_picture_is_found_among_layers() {
    let folder = folder("compare-layers");
    let known = luminance(1.0).write(&folder, "known.exr", SIZE);
    let channels = |layers: [&'static str; 6]| -> Vec<(&'static str, Vec<f32>)> {
        layers.into_iter().zip([1.0, 1.0, 1.0, 3.0, 3.0, 3.0]).map(|(name, v)| (name, flat(v))).collect()
    };
    let root = ["<root>.R", "<root>.G", "<root>.B", "normal.X", "normal.Y", "normal.Z"];
    let file = |channels, name| {
        Written { channels, white_luminance: Some(1.0), ..Written::default() }.write(&folder, name, SIZE)
    };
    assert_near(ratio(&compared(&file(channels(root), "root.exr"), &known, "")), 1.0);
    let several = file(
        channels(["beauty.R", "beauty.G", "beauty.B", "albedo.R", "albedo.G", "albedo.B"]),
        "several.exr",
    );
    let refused = compare(&several, &known, "");
    assert_eq!(refused.code, 2);
    assert!(
        refused.err.contains("several layers with a picture: albedo, beauty; choose one with --layer-a"),
        "{}",
        refused.err
    );
    assert_near(ratio(&compared(&several, &known, "--layer-a albedo")), 3.0);
    assert!(compare(&several, &known, "--layer-a albdo").err.contains("did you mean \"albedo\"?"));
    let none = compare(&known, &known, "--layer-a foo");
    assert_eq!((none.code, none.err.lines().count()), (2, 1), "{}", none.err);
    assert!(none.err.contains("it has no layers, and none is called \"foo\""), "{}", none.err);
}

#[test]
fn pixels_that_are_not_finite_are_named_and_left_out() {
    let folder = folder("compare-nan");
    let b = luminance(1.0).write(&folder, "b.exr", SIZE);
    let mut values = flat(1.0);
    (values[3], values[SIZE[0] + 1]) = (f32::NAN, f32::INFINITY);
    let a = Written { channels: vec![("Y", values)], ..luminance(0.0) }.write(&folder, "a.exr", SIZE);
    let found = compared(&a, &b, "");
    assert_eq!((&found["pixels_excluded"], &found["pixels"]), (&2.into(), &(PIXELS - 2).into()));
    assert_near(ratio(&found), 1.0);
    assert!(
        found["notes"].to_string().contains("2 pixels are not finite and left out: (3, 0), (1, 1)"),
        "{found:#}"
    );
    let nothing = luminance(f32::NAN).write(&folder, "nothing.exr", SIZE);
    let refused = compare(&nothing, &b, "");
    assert!(refused.code == 2 && refused.err.contains("no pixel is finite in both"), "{}", refused.err);
}

#[test]
fn what_cannot_be_compared_is_refused_in_one_line() {
    let folder = folder("compare-refused");
    let sound = luminance(1.0).write(&folder, "sound.exr", SIZE);
    let small =
        Written { channels: vec![("Y", vec![1.0; 4])], ..luminance(0.0) }.write(&folder, "small.exr", [2, 2]);
    let depth =
        Written { channels: vec![("Z", flat(1.0))], ..luminance(0.0) }.write(&folder, "depth.exr", SIZE);
    let text = folder.join("text.exr");
    std::fs::write(&text, "no picture").expect("the folder can be written to");
    let facts = Some("{\"seed\": \"one\"}".to_owned());
    let facts = Written { facts, ..luminance(1.0) }.write(&folder, "facts.exr", SIZE);
    let black = luminance(0.0).write(&folder, "black.exr", SIZE);
    let refused = |file: &Path, options: &str, says: &str| {
        let ran = compare(&sound, file, options);
        assert_eq!((ran.code, ran.err.lines().count()), (2, 1), "{}", ran.err);
        let name = file.file_name().and_then(|name| name.to_str()).expect("a name");
        assert!(ran.err.contains(name) && ran.err.contains(says), "{says}: {}", ran.err);
    };
    refused(&small, "", "it has 2 x 2 pixels, and ");
    refused(&depth, "", "no channels X, Y, Z, nor R, G, B, nor Y");
    refused(&text, "", "cannot be decoded");
    refused(&folder.join("none.exr"), "", "check the path");
    refused(&facts, "", "attribute \"etalon\" cannot be read");
    refused(&black, "--units relative", "its mean is not above zero");
    subsampled(&folder.join("half.exr"));
    refused(&folder.join("half.exr"), "", "its channel Y is subsampled");
}

/// A sound file whose header is changed afterwards, for the library writes none: sampling of the
/// channel Y by 2. Its layout is fixed: name, zero, type, linearity and 3 bytes, then the sampling.
fn subsampled(file: &Path) {
    let folder = file.parent().expect("a folder");
    let sound = luminance(1.0).write(folder, "full.exr", SIZE);
    let mut bytes = std::fs::read(sound).expect("it was written");
    let channels = bytes.windows(7).position(|w| w == b"chlist\0").expect("a list of channels");
    let sampling = channels + 7 + 4 + 2 + 4 + 4;
    assert_eq!(bytes[sampling..sampling + 8], [1, 0, 0, 0, 1, 0, 0, 0], "the layout of OpenEXR");
    (bytes[sampling], bytes[sampling + 4]) = (2, 2);
    std::fs::write(file, bytes).expect("the folder can be written to");
}

#[test]
fn two_black_pictures_do_not_differ() {
    let folder = folder("compare-black");
    let black = luminance(0.0).write(&folder, "black.exr", SIZE);
    let found = compared(&black, &black, "");
    assert_eq!(
        (&found["mse"], &found["smape"], &found["mean_ratio"]),
        (&0.0.into(), &0.0.into(), &1.0.into())
    );
}
