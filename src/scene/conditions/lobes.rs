//! Microfacets: lobes that are spikes, and light that facets lose to one another.
//!
//! A flat mirror of GGX facets of small roughness alpha casts the light of a lamp without
//! extent on a matte point. A ray scattered there, in proportion to the cosine, finds the lamp
//! in a reflection tilted by h from the facets' mean with the value c D(h); seen from the
//! matte point D varies over h = k theta, with k = 1/2 for a lamp far away and 1 for one as
//! near as the point. The first two moments of D, integral D = 1 and integral D^2 =
//! 1 / (3 pi alpha^2), give the relative variance of one sample: k^2 / (3 alpha^2).

use super::emitters::variance;
use super::probe::Probe;
use super::{
    ALL, Condition, EXTREME_BIAS, EXTREME_VARIANCE, Kind, ORDINARY_SPP, objects_of, ordinary_error, percent,
    samples_for_1_percent, short,
};
use crate::material::{Bsdf, Ggx, Interface, Material, Quantity, fresnel};
use crate::scene::Scene;
use crate::spectrum::{Dense, FIRST_NM, Spectrum};
use glam::Vec3A;

/// Where losses are stated: in the blue, at the peak of the photopic curve, in the red.
const COLOURS_NM: [f64; 3] = [450.0, 555.0, 650.0];
/// A cosine close to grazing, as in the table of [`crate::material::ggx`].
const GRAZING: f32 = 0.05;

pub(super) fn conditions(scene: &Scene, probe: &Probe) -> Vec<Condition> {
    let mut found = Vec::new();
    for (index, material) in scene.materials.iter().enumerate() {
        let Some(alpha) = roughness(material).filter(|alpha| *alpha > 0.0) else { continue };
        let Some(objects) = objects_of(scene, index) else { continue };
        found.extend(if alpha < Ggx::MIN_ALPHA {
            Some(polished(&objects, alpha))
        } else {
            near_specular(scene, probe, &objects, alpha)
        });
        found.extend(facet_loss(material, &objects, alpha));
    }
    found
}

const fn roughness(material: &Material) -> Option<f32> {
    match material {
        Material::Dielectric { roughness_alpha, .. } | Material::Conductor { roughness_alpha, .. } => {
            Some(*roughness_alpha)
        }
        _ => None,
    }
}

fn polished(objects: &str, alpha: f32) -> Condition {
    let what = format!(
        "taken as polished: its highlights, {} degrees wide, are points",
        short((2.0 * f64::from(alpha)).to_degrees())
    );
    let limit = format!("an alpha below {} is narrower than directions of 32 bits resolve", Ggx::MIN_ALPHA);
    Condition::new("polished_roughness", objects, limit)
        .figure("roughness_alpha", f64::from(alpha))
        .effect(Kind::Bias, ALL, what)
        .remedy("write a roughness of 0, which means the same")
}

/// The noise of a lamp's light that the lobe casts on something matte.
fn near_specular(scene: &Scene, probe: &Probe, objects: &str, alpha: f32) -> Option<Condition> {
    let alpha = f64::from(alpha);
    // A lamp wider than the lobe is met by chance before that.
    let shining = (0..scene.lights.len()).filter(|light| scene.emitters[*light].weight() > 0.0);
    let smallest = shining.map(|light| probe.meets[light].unwrap_or(0.0)).reduce(f64::min)?;
    let [far, near] = [12.0, 3.0].map(|factor| variance((smallest + factor * alpha * alpha).min(1.0)));
    if far < EXTREME_VARIANCE {
        return None;
    }
    let what = format!(
        "light that the lobe casts on other surfaces: a relative variance of {} (lamp far away) to {} (as near as the surface) per sample, an error of {} or more after {ORDINARY_SPP}",
        short(far),
        short(near),
        percent(ordinary_error(far))
    );
    let limit = format!(
        "1 / (12 alpha^2), the relative variance of what the lobe casts, is above {EXTREME_VARIANCE}: the default of {ORDINARY_SPP} samples leaves a relative error above 100 %"
    );
    Some(
        Condition::new("near_specular_lobe", objects, limit)
            .figure("roughness_alpha", alpha)
            .figure("peak_density_per_sr", 1.0 / (std::f64::consts::PI * alpha * alpha))
            .figure("relative_variance_per_sample", far)
            .figure("samples_for_1_percent", samples_for_1_percent(far))
            .effect(Kind::Noise, &["path"], what)
            .effect(
                Kind::Noise,
                &["light", "bdpt", "mlt"],
                "walks from the lamp draw the lobe itself; only light that such a lobe casts and another one shows stays as noisy",
            )
            .remedy("--integrator bdpt or mlt"),
    )
}

/// Light that meets a second facet, which the model loses.
fn facet_loss(material: &Material, objects: &str, alpha: f32) -> Option<Condition> {
    let limit =
        format!("more than {} of the light is lost on average over directions", percent(EXTREME_BIAS));
    let condition = Condition::new("facet_loss", objects, limit).figure("roughness_alpha", f64::from(alpha));
    let (condition, lost, what) = match material {
        Material::Conductor { n, k, .. } => of_metal(condition, n, k, alpha),
        Material::Dielectric { excess_index, .. } => of_glass(condition, excess_index, alpha),
        Material::Lambertian { .. } | Material::Mirror { .. } => return None,
    };
    let what = format!(
        "{what} is missing on average over directions: facets scatter once, what meets a second facet is lost"
    );
    (lost > EXTREME_BIAS).then(|| {
        let condition = condition.effect(Kind::Bias, ALL, what);
        condition.remedy("none in this model: state the loss beside the result, or lower the roughness")
    })
}

fn at(dense: &Dense, nm: f64) -> f64 {
    f64::from(dense.at_grid_point((nm - FIRST_NM) as usize))
}

/// With its figures, the largest loss, and the loss in words.
fn of_metal(condition: Condition, n: &Dense, k: &Dense, alpha: f32) -> (Condition, f64, String) {
    let white = Bsdf::conductor(Spectrum::splat(0.0), Spectrum::splat(1.0), alpha, false);
    let losses = Losses::of(&white, 1.0);
    let missing_at = |nm| {
        let reflectance = mean_over_cosines(|mu| fresnel::conductor(mu, at(n, nm), at(k, nm)).reflected);
        missing(reflectance, losses.mean)
    };
    let [blue, green, red] = COLOURS_NM.map(missing_at);
    let condition = losses
        .figures(
            condition,
            ["white_loss_normal", "white_loss_60_deg", "white_loss_87_deg", "white_loss_mean"],
        )
        .figure("missing_450_nm", blue)
        .figure("missing_555_nm", green)
        .figure("missing_650_nm", red);
    let what = format!(
        "of the light that falls on it {} at 450 nm, {} at 555 nm and {} at 650 nm",
        percent(blue),
        percent(green),
        percent(red)
    );
    (condition, blue.max(green).max(red), what)
}

/// With its figures, the largest loss, and the loss in words.
fn of_glass(condition: Condition, excess_index: &Dense, alpha: f32) -> (Condition, f64, String) {
    let [_, green_nm, _] = COLOURS_NM;
    let interface = Interface::from_excess(Spectrum::splat(at(excess_index, green_nm) as f32));
    let glass = Bsdf::dielectric(interface, alpha);
    let [outside, inside] = [1.0, -1.0].map(|side| Losses::of(&glass, side));
    let condition = outside
        .figures(condition, ["loss_normal", "loss_60_deg", "loss_87_deg", "loss_mean"])
        .figure("inside_loss_mean", inside.mean);
    let what = format!(
        "{} of the light from outside and {} of that from within",
        percent(outside.mean),
        percent(inside.mean)
    );
    (condition, outside.mean.max(inside.mean), what)
}

/// What scattering between facets of a metal would still bring, averaged over directions: a
/// geometric series in the mean reflectance and the mean loss of white facets (Kulla and
/// Conty 2017).
fn missing(mean_reflectance: f64, mean_loss: f64) -> f64 {
    let (f, kept) = (mean_reflectance, 1.0 - mean_loss);
    f * f * kept / (1.0 - f * mean_loss) * mean_loss
}

/// Shares of light that a lossless lobe loses.
struct Losses {
    normal: f64,
    oblique: f64,
    grazing: f64,
    mean: f64,
}

impl Losses {
    /// Of a lobe seen from one side, by the sign of the cosine.
    fn of(bsdf: &Bsdf, side: f32) -> Self {
        let loss = |mu: f32| 1.0 - albedo(bsdf, side * mu);
        let mean = mean_over_cosines(|mu| loss(mu as f32));
        Self { normal: loss(1.0), oblique: loss(0.5), grazing: loss(GRAZING), mean }
    }

    fn figures(&self, condition: Condition, names: [&'static str; 4]) -> Condition {
        let values = [self.normal, self.oblique, self.grazing, self.mean];
        names
            .into_iter()
            .zip(values)
            .fold(condition, |condition, (name, value)| condition.figure(name, value))
    }
}

/// Integral of 2 mu f(mu) over the hemisphere's cosines.
fn mean_over_cosines(f: impl Fn(f64) -> f64) -> f64 {
    const STRATA: u32 = 8;
    let at = |stratum| f(((f64::from(stratum) + 0.5) / f64::from(STRATA)).sqrt());
    (0..STRATA).map(at).sum::<f64>() / f64::from(STRATA)
}

/// Reflected and transmitted share of light that comes in at a cosine, by the model's own
/// draws on a regular grid.
fn albedo(bsdf: &Bsdf, mu: f32) -> f64 {
    /// Turns of the facet about the normal, and steps outwards: the long tail of GGX asks for
    /// more of these.
    const TURNS: u32 = 16;
    const STEPS: u32 = 128;
    /// Chooses reflection wherever there is any.
    const REFLECT: f32 = 0.0;
    /// Chooses transmission wherever there is any.
    const TRANSMIT: f32 = 1.0 - f32::EPSILON;
    let wo = Vec3A::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
    let place = |i: u32, of: u32| (i as f32 + 0.5) / of as f32;
    let lobe = |u: [f32; 2], u_lobe: f32| {
        let drawn = bsdf.sample(wo, u_lobe, u, Quantity::Importance);
        drawn.filter(|drawn| drawn.is_transmission == (u_lobe == TRANSMIT)).map_or(0.0, |drawn| {
            let chosen = bsdf.lobe_probability(wo, drawn.wi, Quantity::Importance);
            chosen * f64::from(drawn.value.hero() / drawn.pdf.hero())
        })
    };
    let both = |u| lobe(u, REFLECT) + lobe(u, TRANSMIT);
    let draws = (0..TURNS * STEPS).map(|i| [place(i % TURNS, TURNS), place(i / TURNS, STEPS)]);
    draws.map(both).sum::<f64>() / f64::from(TURNS * STEPS)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1 - ln 2 of white facets of alpha 1, and the table of [`crate::material::ggx`].
    #[test]
    fn losses_are_those_of_closed_form_and_table() {
        let white = |alpha| Bsdf::conductor(Spectrum::splat(0.0), Spectrum::splat(1.0), alpha, false);
        assert!((albedo(&white(1.0), 1.0) - (1.0 - std::f64::consts::LN_2)).abs() < 2e-3);
        for (alpha, normal, oblique, grazing) in [(0.2, 5.2, 10.5, 6.8), (0.5, 31.2, 30.1, 8.7)] {
            let losses = Losses::of(&white(alpha), 1.0);
            for (got, table) in
                [(losses.normal, normal), (losses.oblique, oblique), (losses.grazing, grazing)]
            {
                assert!((100.0 * got - table).abs() < 0.3, "alpha {alpha}: {got}, {table} %");
            }
        }
        let glass = Bsdf::dielectric(Interface::from_excess(Spectrum::splat(0.5)), 0.5);
        let losses = Losses::of(&glass, 1.0);
        assert!((100.0 * losses.normal - 3.2).abs() < 0.5, "{}", losses.normal);
        assert!((100.0 * losses.oblique - 12.3).abs() < 0.5, "{}", losses.oblique);
    }

    #[test]
    fn facets_that_reflect_all_miss_all_that_they_lose() {
        assert!((missing(1.0, 0.3) - 0.3).abs() < 1e-12);
        assert_eq!(missing(0.0, 0.3), 0.0);
    }
}
