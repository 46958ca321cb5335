//! The three things in a scene that are a number, a name or a description: spectra,
//! refractive indices and bands. Read by hand so that faults keep their place.

use super::file::BandFile;
use crate::units::Kelvin;
#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use std::collections::BTreeMap;
use std::fmt;

/// A spectrum: a number (the same at every wavelength), a name, or a description.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(untagged))]
pub enum SpectrumFile {
    /// The same value at every wavelength.
    Value(f64),
    /// A spectrum of this scene, or a built-in one.
    Name(String),
    /// A spectrum described here.
    Described(SpectrumDescription),
}

/// A spectrum described in place.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum SpectrumDescription {
    /// Black body.
    Blackbody {
        /// Temperature in kelvin.
        temperature_k: Kelvin,
    },
    /// Points, joined linearly.
    Table {
        /// Rising wavelengths in nm.
        wavelengths_nm: Vec<f64>,
        /// Value at each.
        values: Vec<f64>,
    },
    /// A column of a CSV file.
    Csv {
        /// Path, relative to the scene file.
        file: String,
        /// Column, where there is more than one.
        #[serde(default)]
        column: Option<String>,
        /// Factor on the values: 0.01 for per cent. Default 1.
        #[serde(default = "one")]
        factor: f64,
    },
    /// Spectral lines, narrower than anything else that matters, and perhaps a continuum
    /// beneath them. Light only: lamps and white balance.
    Lines {
        /// The lines, in any order.
        lines: Vec<LineFile>,
        /// The continuum, itself without lines. Default none.
        #[serde(default)]
        continuum: Option<Box<SpectrumFile>>,
    },
    /// Another spectrum times a factor.
    Scaled {
        /// The other spectrum.
        spectrum: Box<SpectrumFile>,
        /// The factor.
        factor: f64,
    },
}

/// A spectral line.
#[derive(Clone, Copy, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LineFile {
    /// Wavelength in nm, in air as the other tables. Outside 360 to 830 nm a line counts in
    /// radiant levels whose band holds it, and is not rendered.
    pub wavelength_nm: f64,
    /// Power: the line's integral over wavelength, in the continuum's unit times nm. It weighs
    /// as much as a continuum of this value over 1 nm.
    pub power: f64,
}

const fn one() -> f64 {
    1.0
}

/// A refractive index: a number, a name, or a description.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(untagged))]
pub enum IndexFile {
    /// Without dispersion.
    Value(f64),
    /// A built-in glass.
    Name(String),
    /// An index described here.
    Described(IndexDescription),
}

/// A refractive index described in place.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum IndexDescription {
    /// n = a + b / lambda^2.
    Cauchy {
        /// Constant term.
        a: f64,
        /// Dispersion term in um^2.
        b_um2: f64,
    },
    /// n^2 = 1 + sum of b lambda^2 / (lambda^2 - c).
    Sellmeier {
        /// Coefficients b.
        b: Vec<f64>,
        /// Coefficients c in um^2.
        c_um2: Vec<f64>,
        /// Wavelengths for which they hold.
        range_nm: [f64; 2],
    },
    /// Index at the d line and Abbe number.
    Abbe {
        /// Index at 587.56 nm.
        nd: f64,
        /// Abbe number (nd - 1) / (nF - nC).
        vd: f64,
    },
    /// Points, joined linearly; an error outside them.
    Table {
        /// Rising wavelengths in nm.
        wavelengths_nm: Vec<f64>,
        /// Index at each.
        n: Vec<f64>,
    },
    /// A CSV file with columns `wavelength_nm`, `n`.
    Csv {
        /// Path, relative to the scene file.
        file: String,
    },
}

/// A metal: a built-in name, or its complex refractive index n + i k.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(untagged))]
pub enum MetalFile {
    /// A built-in metal.
    Name(String),
    /// Written out.
    Described(MetalDescription),
}

/// A metal's complex refractive index.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MetalDescription {
    /// Real part.
    pub n: SpectrumFile,
    /// Imaginary part, not negative.
    pub k: SpectrumFile,
}

/// A camera's sensitivities: a built-in name, a table, or filters before a detector.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(untagged))]
pub enum SensorFile {
    /// `cie-1931`, or a built-in sensitivity.
    Name(String),
    /// A table of one's own.
    Described(SensorDescription),
}

/// A sensor described in place.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum SensorDescription {
    /// A CSV file with wavelengths in its first column and one column for each channel.
    Csv {
        /// Path, relative to the scene file.
        file: String,
    },
    /// A detector that looks through one filter after the other.
    FilterSet {
        /// Transmission of each filter, 0 to 1; `"B550": ...` makes the channel `sensor.B550`.
        filters: BTreeMap<String, SpectrumFile>,
        /// The detector behind them.
        detector: DetectorFile,
    },
}

/// How a detector behind filters answers to light, as far as wavelengths differ; levels are
/// the business of `electronics`.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DetectorFile {
    /// Electrons per photon: 1 counts all photons alike. A channel then holds the integral of
    /// spectral radiance times transmissions times this, times wavelength over 555 nm.
    QuantumEfficiency(SpectrumFile),
    /// Response per watt: 1 counts all watts alike.
    RelativeResponsivity(SpectrumFile),
}

/// Reads a value that may be a number, a string or a map, keeping the position of faults.
struct NumberNameOrMap<T>(std::marker::PhantomData<T>);

/// How a value is made from each of the forms that a scene may write.
trait FromForms<'de>: Sized {
    const EXPECTED: &'static str;
    fn from_number(_: f64) -> Option<Self> {
        None
    }
    fn from_name(_: String) -> Option<Self> {
        None
    }
    fn from_map<A: MapAccess<'de>>(map: A) -> Result<Self, A::Error>;
}

impl<'de, T: FromForms<'de>> Visitor<'de> for NumberNameOrMap<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(T::EXPECTED)
    }

    fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<T, E> {
        T::from_number(value).ok_or_else(|| E::custom(format!("a number where {} belongs", T::EXPECTED)))
    }

    fn visit_u64<E: serde::de::Error>(self, value: u64) -> Result<T, E> {
        self.visit_f64(value as f64)
    }

    fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<T, E> {
        self.visit_f64(value as f64)
    }

    fn visit_str<E: serde::de::Error>(self, value: &str) -> Result<T, E> {
        T::from_name(value.to_owned())
            .ok_or_else(|| E::custom(format!("a name where {} belongs", T::EXPECTED)))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
        T::from_map(map)
    }
}

macro_rules! read_forms {
    ($($type:ident: $expected:literal, $described:ident $(, number $value:ident)?;)*) => {$(
        impl<'de> FromForms<'de> for $type {
            const EXPECTED: &'static str = $expected;
            $(fn from_number(value: f64) -> Option<Self> {
                Some(Self::$value(value))
            })?
            fn from_name(name: String) -> Option<Self> {
                Some(Self::Name(name))
            }
            fn from_map<A: MapAccess<'de>>(map: A) -> Result<Self, A::Error> {
                $described::deserialize(MapAccessDeserializer::new(map)).map(Self::Described)
            }
        }
        impl<'de> Deserialize<'de> for $type {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_any(NumberNameOrMap(std::marker::PhantomData))
            }
        }
    )*};
}

read_forms! {
    SpectrumFile: "a number, the name of a spectrum, or a description such as {\"blackbody\": {\"temperature_k\": 6500}}",
        SpectrumDescription, number Value;
    IndexFile: "a number, the name of a glass, or a description such as {\"abbe\": {\"nd\": 1.5168, \"vd\": 64.2}}",
        IndexDescription, number Value;
    MetalFile: "the name of a metal, or {\"n\": ..., \"k\": ...}", MetalDescription;
    SensorFile: "the name of a sensor, {\"csv\": {\"file\": ...}}, or {\"filter_set\": ...}", SensorDescription;
}

impl<'de> Deserialize<'de> for BandFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Band;
        impl<'de> Visitor<'de> for Band {
            type Value = BandFile;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a band in nm such as [360, 830], or \"all\"")
            }

            fn visit_str<E: serde::de::Error>(self, value: &str) -> Result<BandFile, E> {
                if value == "all" {
                    Ok(BandFile::All)
                } else {
                    Err(E::custom("a band is [from, to] in nm, or \"all\""))
                }
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<BandFile, A::Error> {
                let mut next = || {
                    seq.next_element::<f64>()?.ok_or_else(|| A::Error::custom("a band has two wavelengths"))
                };
                Ok(BandFile::Range([next()?, next()?]))
            }
        }
        deserializer.deserialize_any(Band)
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for BandFile {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "BandFile".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "The wavelengths over which a radiant quantity is counted: [from, to] in nm, or \"all\".",
            "anyOf": [
                { "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 },
                { "const": "all" }
            ]
        })
    }
}
