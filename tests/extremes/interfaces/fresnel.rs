//! Fresnel's equations at angles and for indices at which textbook forms cancel or overflow.

use crate::common::hemisphere::integral;
use crate::common::{metered, refusals};
use crate::record::Record;
use etalon::material::Material;
use etalon::material::fresnel::{conductor, dielectric};
use serde_json::json;

/// Reflectance averaged over a diffuse field, seen from the side of index one.
fn diffuse_reflectance(eta: f64) -> f64 {
    let f = |c: f64| 2.0 * c * dielectric(c, eta - 1.0).reflected;
    if eta >= 1.0 {
        return integral(0.0, 1.0, f);
    }
    let critical = (1.0 - eta * eta).sqrt();
    critical * critical + integral(critical, 1.0, f)
}

// Case 25. (e / (2 + e))^2 for n = 1 + e, from a scene's text to the share that is reflected.
pub fn media_that_nearly_match_reflect_what_they_should(record: &mut Record) {
    for (inside, outside, excess) in [
        ("1.000001", "1", 1e-6_f64),
        ("0.999999", "1", -1e-6),
        ("1.5000015", "1.5", 1e-6),
        ("1.000000001", "1", 1e-9),
    ] {
        let number = |text: &str| serde_json::from_str::<serde_json::Value>(text).expect("a number");
        let glass = json!({ "dielectric": { "index": number(inside), "outside_index": number(outside) } });
        let scene = metered(json!({ "glass": glass }), json!([]), json!([]), json!([]));
        let Material::Dielectric { excess_index, .. } = &scene.materials[0] else { panic!("glass") };
        let reflected = dielectric(1.0, f64::from(excess_index.at_grid_point(0))).reflected;
        let truth = (excess / (2.0 + excess)).powi(2);
        // n - 1 itself is known to the rounding of n in f64 alone, 1e-16 of 1e-9.
        let bound = if excess.abs() < 1e-7 { 1e-5 } else { 1e-6 };
        record.relative(format!("R of {inside} in {outside} at normal incidence"), reflected, truth, bound);
    }
}

// Case 26.
pub fn a_thinner_medium_reflects_totally(record: &mut Record) {
    let critical = 0.9_f64.asin();
    record.absolute("critical angle for n = 0.9, degrees", critical.to_degrees(), 64.158, 1e-3);
    let at = |theta: f64| dielectric(theta.cos(), 0.9 - 1.0).reflected;
    record.exactly("R just beyond it", at(critical + 1e-7), 1.0);
    record.holds("R below one just before it", at(critical - 1e-7) < 1.0);
    record.absolute("cosine-averaged R", diffuse_reflectance(0.9), 0.212_244, 1e-5);
}

// Case 27.
pub fn glass_reflects_from_both_sides_as_one_boundary(record: &mut Record) {
    let (outside, inside) = (diffuse_reflectance(1.5), diffuse_reflectance(1.0 / 1.5));
    record.absolute("average R of glass from outside", outside, 0.091_778_0, 1e-6);
    record.absolute("average R of glass from inside", inside, 0.596_345_8, 1e-6);
    record.relative(
        "1 - R inside over (1 - R outside) / n^2",
        (1.0 - inside) * 2.25 / (1.0 - outside),
        1.0,
        1e-6,
    );
}

// Case 28.
pub fn total_reflection_begins_where_it_should_and_never_dips(record: &mut Record) {
    let critical = (1.0_f64 / 1.5).asin();
    let at = |theta: f64| dielectric(theta.cos(), 1.0 / 1.5 - 1.0).reflected;
    record.absolute("R 1e-6 below the critical angle", at(critical - 1e-6), 0.991_350, 1e-6);
    record.absolute("R 1e-8 below the critical angle", at(critical - 1e-8), 0.999_131, 1e-6);
    let beyond = (0..=1000).all(|step| at(critical + 1e-12 + f64::from(step) * 1e-4) == 1.0);
    record.holds("R is one beyond it", beyond);
    let below: Vec<f64> = (0..4000).rev().map(|step| at(critical - f64::from(step) * 1e-9)).collect();
    record.holds("R rises towards it", below.windows(2).all(|pair| pair[0] <= pair[1]));
    record.holds("R is a number from 0 to 1", below.iter().all(|share| (0.0..=1.0).contains(share)));
}

// Case 29. 1 - F with 40 digits.
pub fn grazing_light_still_enters(record: &mut Record) {
    for (cosine, crossing) in
        [(1e-4, 5.811_837_250_08e-4), (1e-5, 5.813_582_746_59e-5), (1e-7, 5.813_774_801_5e-7)]
    {
        record.relative(format!("1 - R at cos {cosine}"), dielectric(cosine, 0.5).crossing, crossing, 1e-5);
    }
}

// Case 30.
pub fn brewsters_angle_is_where_it_should_be(record: &mut Record) {
    let theta = 1.5_f64.atan();
    record.absolute("Brewster's angle of n = 1.5, degrees", theta.to_degrees(), 56.309_93, 1e-5);
    record.absolute("unpolarised R there", dielectric(theta.cos(), 0.5).reflected, 0.073_964_5, 1e-7);
}

// Case 31. Beyond f32 an extinction is refused, so f64 holds k^4 of what scenes can say.
pub fn metals_of_any_extinction_reflect_what_they_should(record: &mut Record) {
    record.relative("1 - R at k = 1e3", conductor(1.0, 1.5, 1e3).crossing, 5.999_962_500_23e-6, 1e-6);
    record.relative("1 - R at k = 1e6", conductor(1.0, 1.5, 1e6).crossing, 6e-12, 1e-6);
    for k in [1e20, 1e30, f64::from(f32::MAX)] {
        for cosine in [0.0, 1e-30, 0.3, 1.0] {
            let shares = conductor(cosine, 1.5, k);
            record.exactly(format!("R at k = {k:.1e}, cos {cosine}"), shares.reflected, 1.0);
            record
                .holds(format!("1 - R is finite at k = {k:.1e}, cos {cosine}"), shares.crossing.is_finite());
        }
    }
    let scene = "{\n\"name\": \"metal\", \"length_unit\": \"m\",\n\"materials\": {\"metal\": {\"conductor\": {\"metal\": {\"n\": 1.5,\n\
        \"k\": 1e39}}}}\n}\n";
    let (code, _, error) = refusals::check("metal-1e39", scene);
    record.exactly("exit code for k = 1e39", code.unwrap_or(-1), 2);
    record.says("k = 1e39", &error, "an imaginary part k of 1e39 is too large to be held");
    record.says("where", &error, &refusals::place("metal-1e39", scene, "\"k\""));
}

// Case 32.
pub fn a_metal_without_real_index_reflects_all(record: &mut Record) {
    for k in [0.0, 1e-30, 1e-3, 1.0, 1e9, 1e30] {
        let worst =
            (0..=1000).map(|step| conductor(f64::from(step) * 1e-3, 0.0, k).reflected).fold(1.0, f64::min);
        record.exactly(format!("smallest R at n = 0, k = {k}"), worst, 1.0);
    }
}
