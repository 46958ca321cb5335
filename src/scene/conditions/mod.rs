//! Extreme conditions of a scene, and what each does to the error to be expected.
//!
//! A condition is listed where a figure of the resolved scene passes a limit, and every limit
//! is a statement about error: so many samples leave so much noise, an input wrong by so much
//! makes the result wrong by so much, a model leaves out so much. What is not extreme is not
//! listed. Figures come from the scene itself and from [`Probe`], a few thousand rays with
//! fixed random numbers; it takes well under a second and gives the same text every time.

mod albedo;
mod emitters;
mod exposure;
mod interfaces;
mod light_paths;
mod lobes;
mod probe;
mod scale;
mod sight;
mod spectra;

pub use probe::Probe;

use super::{Scene, View};
use serde::{Serialize, Serializer};
use std::fmt;

/// Samples of a pixel in a render for which nothing is said (`etalon render`).
pub const ORDINARY_SPP: f64 = 64.0;

/// Relative variance of one sample from which noise is extreme: [`ORDINARY_SPP`] samples then
/// leave a relative error above 100 %.
pub const EXTREME_VARIANCE: f64 = ORDINARY_SPP;

/// Factor from the relative error of an input to that of the result from which a condition is
/// extreme: a reflectance or an absorption known to 1 % then leaves a level known to 10 %.
pub const EXTREME_AMPLIFICATION: f64 = 10.0;

/// Relative bias from which a condition is extreme: the error that closed forms of photometry
/// are held to.
pub const EXTREME_BIAS: f64 = 1e-3;

/// All integrators by name.
const ALL: &[&str] = &["path", "light", "bdpt", "mlt"];

/// What is looked for: the names of conditions, and what each means.
pub const LOOKED_FOR: [(&str, &str); 18] = [
    ("small_emitter", "a lamp that scattered light hardly ever meets, beside smooth surfaces"),
    ("hidden_lamps", "light that comes round corners only"),
    ("unequal_lights", "a lamp that is alone in lighting something and hardly ever asked"),
    ("unreachable_light", "paths that no strategy can make"),
    ("near_specular_lobe", "facets so flat that their lobe is a spike"),
    ("polished_roughness", "a roughness below what directions resolve"),
    ("facet_loss", "light lost between the facets of rough surfaces"),
    ("dispersion", "smooth refraction that keeps a single wavelength"),
    ("few_wavelengths", "a lamp that shines at a few wavelengths only"),
    ("dark_range", "a lamp that is dark where the sensor sees"),
    ("sensor_range", "a sensor that sees beyond 360 to 830 nm"),
    ("high_albedo", "reflections that hardly end"),
    ("matched_index", "media whose refractive indices nearly match"),
    ("optical_depth", "a medium that lets hardly anything through"),
    ("exposure_range", "a picture beyond the range of its encoding"),
    ("beyond_half_float", "luminances beyond 16-bit floats"),
    ("camera_model", "settings at which the camera model leaves something out"),
    ("coarse_positions", "things hardly larger than the spacing of positions"),
];

/// How a condition acts on a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// The result is wrong however many samples are taken.
    Bias,
    /// The result scatters more.
    Noise,
    /// Samples take longer.
    Cost,
    /// Errors of the scene's data weigh more in the result.
    Sensitivity,
    /// The file or picture holds less than the render.
    Encoding,
}

impl Kind {
    /// The name, as in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bias => "bias",
            Self::Noise => "noise",
            Self::Cost => "cost",
            Self::Sensitivity => "sensitivity",
            Self::Encoding => "encoding",
        }
    }
}

/// What a condition does to the error to be expected.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Effect {
    /// How it acts.
    pub kind: Kind,
    /// The integrators that it concerns.
    pub integrators: &'static [&'static str],
    /// What it does, in figures.
    pub what: String,
}

/// An extreme condition.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Condition {
    /// One of the names in [`LOOKED_FOR`].
    pub name: &'static str,
    /// The lamp, objects or camera that it is found at.
    #[serde(rename = "where")]
    pub place: String,
    /// Figures by names that carry the unit; all finite.
    #[serde(serialize_with = "as_map")]
    pub figures: Vec<(&'static str, f64)>,
    /// The limit that is passed, and its reason.
    pub limit: String,
    /// What it does.
    pub effect: Vec<Effect>,
    /// What may be done about it.
    pub remedy: Option<String>,
}

fn as_map<S: Serializer>(figures: &[(&'static str, f64)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(figures.iter().map(|(name, value)| (name, value)))
}

impl Condition {
    fn new(name: &'static str, place: impl Into<String>, limit: impl Into<String>) -> Self {
        debug_assert!(LOOKED_FOR.iter().any(|(known, _)| *known == name), "{name}");
        Self {
            name,
            place: place.into(),
            figures: Vec::new(),
            limit: limit.into(),
            effect: Vec::new(),
            remedy: None,
        }
    }

    /// Adds a figure; those that are not finite have nothing to say.
    fn figure(mut self, name: &'static str, value: f64) -> Self {
        if value.is_finite() {
            self.figures.push((name, value));
        }
        self
    }

    fn effect(mut self, kind: Kind, integrators: &'static [&'static str], what: impl Into<String>) -> Self {
        self.effect.push(Effect { kind, integrators, what: what.into() });
        self
    }

    fn remedy(mut self, what: impl Into<String>) -> Self {
        self.remedy = Some(what.into());
        self
    }

    /// A figure by its name.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.figures.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
    }
}

/// The extreme conditions of a scene, seen by a camera if there is one.
pub fn conditions(scene: &Scene, view: Option<&View>) -> Vec<Condition> {
    let probe = Probe::new(scene, view);
    let families = [
        emitters::conditions(scene, &probe),
        light_paths::conditions(scene, view, &probe),
        lobes::conditions(scene, &probe),
        spectra::conditions(scene, view),
        albedo::conditions(&probe).into_iter().collect(),
        interfaces::conditions(scene),
        view.map_or_else(Vec::new, |view| exposure::conditions(scene, view, &probe)),
        scale::conditions(scene).into_iter().collect(),
    ];
    families.into_iter().flatten().collect()
}

/// The conditions on one line, those of one name with their number: `3 extreme: facet_loss (2),
/// dispersion`.
pub fn in_short(conditions: &[Condition]) -> String {
    if conditions.is_empty() {
        return "none extreme".to_owned();
    }
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for Condition { name, .. } in conditions {
        match counts.iter_mut().find(|(known, _)| known == name) {
            Some((_, count)) => *count += 1,
            None => counts.push((name, 1)),
        }
    }
    let listed = |(name, count): &(&str, usize)| match count {
        1 => (*name).to_owned(),
        _ => format!("{name} ({count})"),
    };
    let names: Vec<String> = counts.iter().map(listed).collect();
    format!("{} extreme: {}", conditions.len(), names.join(", "))
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "extreme    {} ({})", self.name, self.place)?;
        let figures: Vec<String> =
            self.figures.iter().map(|(name, value)| format!("{name} {}", short(*value))).collect();
        let mut line = |label: &str, text: &str| writeln!(f, "  {label:<11} {text}");
        if !figures.is_empty() {
            line("figures", &figures.join(", "))?;
        }
        line("limit", &self.limit)?;
        for Effect { kind, integrators, what } in &self.effect {
            let of =
                if *integrators == ALL { String::new() } else { format!("{}: ", integrators.join(", ")) };
            line(kind.name(), &format!("{of}{what}"))?;
        }
        self.remedy.as_ref().map_or(Ok(()), |remedy| line("remedy", remedy))
    }
}

/// The worst of conditions of one name, by the value of a figure; the others are counted.
fn worst(mut list: Vec<Condition>, badness: impl Fn(&Condition) -> f64) -> Option<Condition> {
    list.sort_by(|a, b| badness(b).total_cmp(&badness(a)));
    let more = list.len().saturating_sub(1);
    let mut first = list.into_iter().next()?;
    if more > 0 {
        first.place = format!("{} and {more} more", first.place);
    }
    Some(first)
}

/// A number with three digits.
fn short(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e4).contains(&size) {
        let decimals = (2 - size.log10().floor() as i32).max(0) as usize;
        let text = format!("{value:.decimals$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{value:.1e}")
    }
}

/// A share in per cent with three digits.
fn percent(share: f64) -> String {
    format!("{} %", short(100.0 * share))
}

/// Samples after which a mean of samples with this relative variance has an error of 1 %.
fn samples_for_1_percent(relative_variance: f64) -> f64 {
    relative_variance * 1e4
}

/// The relative error that [`ORDINARY_SPP`] samples leave.
fn ordinary_error(relative_variance: f64) -> f64 {
    (relative_variance / ORDINARY_SPP).sqrt()
}

/// Names of the objects made of a material, the first few of them.
fn objects_of(scene: &Scene, material: usize) -> Option<String> {
    const NAMED: usize = 4;
    let made = |object: &&super::SceneObject| object.material as usize == material;
    let names: Vec<&str> = scene.objects.iter().filter(made).map(|object| object.name.as_str()).collect();
    let more = names.len().saturating_sub(NAMED);
    let listed = names[..names.len() - more].join(", ");
    (!names.is_empty()).then(|| if more > 0 { format!("{listed} and {more} more") } else { listed })
}
