//! Facets from nearly polished to the roughest, in exact grazing light, and on bent normals.

use crate::case::Case;
use crate::cases;
use crate::common::chi_squared::{SAMPLES, examine};
use crate::common::facets::{albedo, drawn, white};
use crate::common::hemisphere::direction;
use crate::common::program::{etalon, folder, scene_file};
use crate::common::runs::{films, picture_xyz};
use crate::common::{scene, scenes};
use crate::dispersion::same_within_four;
use crate::record::Record;
use etalon::integrator::Integrator;
use etalon::material::{Bsdf, Ggx, Quantity, specimens};
use glam::Vec3A;
use serde_json::json;
use std::f64::consts::{LN_2, PI};

/// The cases of this group.
pub const CASES: &[Case] = cases![
    fixed 35 => facets_are_dense_where_they_should_be,
    statistical 35 => the_smallest_roughness_is_as_good_as_polished,
    statistical 36 => the_roughest_mirror_keeps_its_closed_form_share,
    statistical 37 => white_facets_lose_what_quadrature_says,
    fixed 38 => exact_grazing_and_normal_directions_have_values,
    statistical 38 => draws_at_grazing_and_normal_directions_fall_as_the_pdf_says,
    statistical 39 => smooth_normals_are_the_same_from_both_ends,
];

/// Roughness from the smallest to the largest.
const ALPHAS: [f64; 6] = [1e-4, 1e-3, 1e-2, 0.1, 0.5, 1.0];

// Case 35.
pub fn facets_are_dense_where_they_should_be(record: &mut Record) {
    for alpha in ALPHAS {
        let facets = Ggx::isotropic(alpha as f32);
        for angle in [0.0, 0.3, 1.0, 3.0] {
            let (sine, cosine) = (angle * alpha).sin_cos();
            let slope = (sine / alpha).powi(2) + cosine * cosine;
            let truth = 1.0 / (PI * alpha * alpha * slope * slope);
            let h = Vec3A::new((0.6 * sine) as f32, (0.8 * sine) as f32, cosine as f32);
            let what = format!("D at theta = {angle} alpha, alpha = {alpha}");
            record.relative(what, facets.density(h).into(), truth, 1e-4);
        }
    }
}

// Case 35. A metal ball under a large lamp in a dim room, and the same ball polished.
pub fn the_smallest_roughness_is_as_good_as_polished(record: &mut Record) {
    let mean = |alpha: f64, record: &Record| {
        let scene = scene(&json!({
            "name": "ball", "length_unit": "m",
            "materials": { "metal": { "conductor": { "metal": { "n": 0.3, "k": 3 }, "roughness_alpha": alpha } },
                "black": { "lambertian": { "reflectance": 0 } } },
            "objects": [
                { "shape": { "sphere": { "center": [0, 0, 0], "radius": 4 } }, "material": "black",
                  "emission": { "spectrum": "cie-e", "level": { "luminance_cd_m2": 20 }, "two_sided": true } },
                { "shape": { "disk": { "center": [0, 3, 0], "normal": [0, -1, 0], "radius": 2 } }, "material": "black",
                  "emission": { "spectrum": "cie-e", "level": { "luminance_cd_m2": 100 } } },
                { "shape": { "sphere": { "center": [0, 0, 0], "radius": 0.5 } }, "material": "metal" }],
            "camera": { "position": [0, 0.3, -2], "look_at": [0, 0, 0], "up": [0, 1, 0], "focal_length_mm": 100,
                "sensor_mm": [60, 60], "resolution": [8, 8], "iso": 100, "shutter_s": 0.01, "f_stop": 8 },
        }));
        picture_xyz(&films(&scene, Integrator::Path, record.samples(384), record.seed()))[1]
    };
    let polished = mean(0.0, record);
    for alpha in [1e-4, 3e-4, 1e-3] {
        let rough = mean(alpha, record);
        let noise = rough.standard_error.hypot(polished.standard_error) / polished.mean;
        record.relative(
            format!("picture at alpha = {alpha} over polished"),
            rough.mean / polished.mean,
            1.0,
            2e-3,
        );
        record.at_most(format!("noise of that at alpha = {alpha}"), noise, 4e-4);
    }
}

/// Draws of each albedo by day.
const DRAWS: u64 = 400_000;

// Case 36.
pub fn the_roughest_mirror_keeps_its_closed_form_share(record: &mut Record) {
    for (alpha, mu, truth) in
        [(1.0, 1.0, 1.0 - LN_2), (0.5, 1.0, 0.688), (0.5, 0.5, 0.698), (0.5, 0.05, 0.913)]
    {
        let [kept, _] =
            drawn(&white(alpha), mu, Quantity::Radiance, 4 * record.samples(DRAWS), record.seed() ^ 36);
        record.absolute(format!("albedo at alpha = {alpha}, cos {mu}"), kept.value(), truth, 1e-3);
        record.at_most(format!("its standard error at alpha = {alpha}, cos {mu}"), kept.error(), 4e-4);
    }
}

// Case 37.
pub fn white_facets_lose_what_quadrature_says(record: &mut Record) {
    record.note(
        "Facets scatter once; light that would meet a second facet is lost, and nothing is added to make up for it. \
         What holds is that exactly that share is missing, by an independent quadrature over facets (good to 5e-4), \
         that none is gained, and that the loss is told: `etalon check --explain`.",
    );
    for alpha in ALPHAS {
        for mu in [1.0, 0.5, 0.05] {
            let truth = albedo(alpha, mu, 1.5, |_| (1.0, 0.0))[0];
            let [kept, _] = drawn(
                &white(alpha as f32),
                mu,
                Quantity::Radiance,
                record.samples(DRAWS),
                record.seed() ^ 37,
            );
            let what = format!("share lost at alpha = {alpha}, cos {mu}");
            record.absolute(what, 1.0 - kept.value(), 1.0 - truth, 2e-3);
        }
    }
    // White metal: what the program says of it is what quadrature says.
    let file = scene_file(
        &folder("extremes-facet-loss"),
        &json!({
            "name": "rough", "length_unit": "m",
            "materials": { "white": { "conductor": { "metal": { "n": 0, "k": 1 }, "roughness_alpha": 0.5 } },
                "black": { "lambertian": { "reflectance": 0 } } },
            "objects": [
                { "shape": { "disk": { "center": [0, 0, 0], "normal": [0, 0, 1], "radius": 0.5 } }, "material": "white" },
                { "shape": { "sphere": { "center": [0, 0, 0], "radius": 5 } }, "material": "black",
                  "emission": { "spectrum": "cie-e", "level": { "luminance_cd_m2": 100 }, "two_sided": true } }],
            "camera": { "position": [0, 0, 2], "look_at": [0, 0, 0], "up": [0, 1, 0], "focal_length_mm": 36,
                "sensor_mm": [36, 36], "resolution": [4, 4], "iso": 100, "shutter_s": 0.01, "f_stop": 8 },
        }),
    );
    let ran = etalon(["check".as_ref(), "--explain".as_ref(), file.as_os_str()]);
    record.says("check --explain", &ran.out, "extreme    facet_loss");
    record.says("check --explain", &ran.out, "what meets a second facet is lost");
    let said =
        ran.out.split("white_loss_normal ").nth(1).and_then(|rest| rest.split(',').next()?.parse().ok());
    let truth = 1.0 - albedo(0.5, 1.0, 1.5, |_| (1.0, 0.0))[0];
    let what = "share lost at alpha = 0.5, cos 1, as check --explain says";
    record.absolute(what, said.unwrap_or(f64::NAN), truth, 2e-3);
}

/// Cosines at which a tangent is undefined or hardly defined; a direction's components are f32,
/// in which 5e-324 is 0 and 1e-45 the smallest number.
const COSINES: [f64; 5] = [0.0, 1e-45, 1e-30, 1.0, -1e-45];

// Case 38.
pub fn exact_grazing_and_normal_directions_have_values(record: &mut Record) {
    record.note("The catalogue's 5e-324 is 0 in 32 bits, in which directions are held: 1e-45, the smallest number there, stands for it.");
    let directions = || COSINES.iter().flat_map(|&mu| [0.0, 2.0].map(|phi| direction(mu, phi)));
    let (mut pairs, mut faults) = (0_u64, 0_u64);
    for (_, bsdf) in specimens() {
        for wo in directions() {
            for wi in directions() {
                let both = bsdf.evaluate(wo, wi, Quantity::Radiance);
                let sound = both.value.is_finite() && both.pdf.is_finite();
                let positive = both.value.0.iter().chain(&both.pdf.0).all(|&v| v >= 0.0);
                pairs += 1;
                faults += u64::from(!sound || !positive);
            }
        }
    }
    record.exactly(
        format!("values or densities that are no numbers, of {pairs} pairs of directions"),
        faults,
        0,
    );
    let in_plane = specimens()
        .iter()
        .filter(|(_, bsdf)| bsdf.sample(Vec3A::X, 0.3, [0.4, 0.6], Quantity::Radiance).is_some())
        .count();
    record.exactly("materials that scatter light from within the surface's plane", in_plane, 0);
}

// Case 38. A false alarm once in a thousand draws of all seeds, after Sidak.
pub fn draws_at_grazing_and_normal_directions_fall_as_the_pdf_says(record: &mut Record) {
    let names = ["paint", "satin glass", "ground glass", "satin gold", "roughest gold"];
    let lobes: Vec<(&str, Bsdf)> = specimens().into_iter().filter(|(name, _)| names.contains(name)).collect();
    record.exactly("lobes that are judged", lobes.len(), names.len());
    let cosines = [1e-45, 1e-30, 1.0];
    let level = 1.0 - (1.0 - 1e-3_f64).powf(1.0 / (lobes.len() * cosines.len()) as f64);
    for (name, bsdf) in &lobes {
        for mu in cosines {
            let verdict = examine(bsdf, direction(mu, 0.7), record.seed() ^ mu.to_bits());
            record.at_least(format!("{name}, cos {mu}: p of chi-squared"), verdict.p, level);
            // Draws of nothing are binomial; quadrature adds a rounding of its own.
            let deviation = (verdict.drawn * (1.0 - verdict.drawn) / SAMPLES as f64).sqrt();
            let what = format!("{name}, cos {mu}: integral of the pdf, against the share drawn");
            record.absolute(what, verdict.integral, verdict.drawn, 5.0 * deviation + 1e-3);
        }
    }
}

// Case 39.
pub fn smooth_normals_are_the_same_from_both_ends(record: &mut Record) {
    let mut json = scenes::smooth_normals();
    json["camera"]["resolution"] = json!([8, 8]);
    let scene = scene(&json);
    let all =
        [(Integrator::Path, 128), (Integrator::Light, 256), (Integrator::Bdpt, 64), (Integrator::Mlt, 256)];
    let means = all.map(|(integrator, spp)| {
        (integrator.name(), picture_xyz(&films(&scene, integrator, record.samples(spp), record.seed()))[1])
    });
    for (first, (name, mean)) in means.iter().enumerate() {
        for (other_name, other) in &means[first + 1..] {
            same_within_four(record, &format!("{name} against {other_name}"), *mean, *other, 6e-3);
        }
    }
}
