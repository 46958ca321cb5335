//! What a scene says about the way from light to picture: sensor, lens, electronics, development.

use super::file::{
    CameraFile, DetectorFile, ElectronicsFile, SensorDescription, SensorFile, SpectrumFile, VignettingFile,
};
use super::files::{Files, Kind};
use super::spectra::Spectra;
use super::view::positive;
use crate::camera::{
    self, CIE_SENSOR, Detector, Digital, Electronics, FLAT_FIELD_CHANNEL, FlatField, Matrix, Noise,
    Responses, Sensor, Tone, Vignetting,
};
use crate::error::{Error, Result};
use crate::image::read_levels;
use crate::spectrum::colour::Xyz;
use crate::spectrum::{Curve, Dense, LampSpectrum, library};
use std::collections::BTreeMap;
use std::path::Path;

/// What happens to a film's values after the render.
#[derive(Clone, Debug)]
pub struct Chain {
    /// Lens constant on the axis of what the sensor's channels hold.
    pub sensor_q: f64,
    /// What the camera sees of the light that is white, or of equal energy.
    pub white: camera::White,
    /// Fall-off from the axis.
    pub vignetting: Vignetting,
    /// A measured fall-off.
    pub flat_field: Option<FlatField>,
    /// Electronics of the sensor.
    pub electronics: Option<Electronics>,
    /// Noise of the electronics.
    pub noise: Option<Noise>,
    /// From channels to colours.
    pub matrix: Option<Matrix>,
    /// Whether that matrix was fitted to the sensitivities.
    pub has_fitted_matrix: bool,
    /// Encoding.
    pub tone: Tone,
}

/// The light that is developed white.
pub(super) struct White {
    /// Its tristimulus values, where something is adapted to it.
    pub xyz: Option<Xyz>,
    /// What the camera sees of it.
    pub seen: camera::White,
    /// The matrix that shows colours best under it, where one is asked for.
    pub matrix: Option<Matrix>,
}

/// Whether a scene states a fall-off by itself.
pub(super) const fn falls_off(file: &CameraFile) -> bool {
    !matches!(file.vignetting, VignettingFile::None)
}

pub(super) fn build(
    file: &CameraFile,
    sensor: &Sensor,
    white: White,
    sensor_q: f64,
    half_extent: [f64; 2],
    spectra: &mut Spectra<'_>,
) -> Result<Chain> {
    let (vignetting, flat_field) =
        vignetting(&file.vignetting, half_extent, spectra).map_err(|e| e.under("vignetting"))?;
    let electronics = match &file.electronics {
        Some(electronics) => Some(self::electronics(electronics).map_err(|e| e.under("electronics"))?),
        None => None,
    };
    let noise = match (&file.noise, &electronics) {
        (Some(noise), Some(_)) => Some(Noise { seed: noise.seed, shot: noise.shot, read: noise.read }),
        (Some(_), None) => {
            return Err(Error::new("noise without electronics")
                .hint("add electronics with a quantum_efficiency, or leave noise out")
                .under("noise"));
        }
        (None, _) => None,
    };
    let at = |key: &'static str| move |e: Error| e.under(key).under("development");
    if let Some(matrix) = &white.matrix {
        matrix.check(sensor.recorded().count()).map_err(at("matrix"))?;
    }
    let tone = file.development.tone.check().map_err(at("tone"))?;
    Ok(Chain {
        sensor_q,
        white: white.seen,
        vignetting,
        flat_field,
        electronics,
        noise,
        matrix: white.matrix,
        has_fitted_matrix: file.development.fit_matrix,
        tone,
    })
}

/// The sensor, behind its lens.
pub(super) fn sensor(file: &CameraFile, spectra: &mut Spectra<'_>) -> Result<Sensor> {
    let sensor = bare_sensor(&file.sensor, spectra).map_err(|e| e.under("sensor"))?;
    let Some(lens) = &file.lens_transmission else { return Ok(sensor) };
    let lens = spectra.transmission(lens).and_then(|curve| {
        let dense = Dense::from_fn(|nm| curve.at(nm));
        let opaque = || Error::new("the lens passes no light").hint("check lens_transmission");
        if dense.is_zero() { Err(opaque()) } else { Ok(dense) }
    });
    Ok(sensor.behind(lens.map_err(|e| e.under("lens_transmission"))?))
}

/// A sensor by name, where tables of other kinds are none, or of the scene's own.
fn bare_sensor(file: &SensorFile, spectra: &mut Spectra<'_>) -> Result<Sensor> {
    let name = match file {
        SensorFile::Described(SensorDescription::Csv { file }) => {
            let (path, table) = spectra.read_csv(file).map_err(|e| e.under("file").under("csv"))?;
            return Sensor::of_table(file, &table).map_err(|e| e.in_file(&path));
        }
        SensorFile::Described(SensorDescription::FilterSet { filters, detector }) => {
            return filter_set(filters, detector, spectra).map_err(|e| e.under("filter_set"));
        }
        SensorFile::Name(name) => name.as_str(),
    };
    let cameras = library::entries().filter(|entry| entry.kind == "sensitivity").map(|entry| entry.name);
    let known: Vec<&str> = cameras.chain([CIE_SENSOR]).collect();
    if known.contains(&name) { Sensor::named(name) } else { Err(Error::unknown_name("sensor", name, known)) }
}

fn filter_set(
    filters: &BTreeMap<String, SpectrumFile>,
    detector: &DetectorFile,
    spectra: &mut Spectra<'_>,
) -> Result<Sensor> {
    if filters.is_empty() {
        return Err(Error::new("the filter set is empty")
            .hint("name a transmission for each channel, such as \"B550\": \"cornell-filter-550\"")
            .under("filters"));
    }
    let mut curves: Vec<(String, Curve)> = Vec::new();
    for (name, transmission) in filters {
        let curve = spectra.transmission(transmission).map_err(|e| e.under(name).under("filters"))?;
        curves.push((name.clone(), curve));
    }
    let detector = match detector {
        DetectorFile::QuantumEfficiency(efficiency) => Detector::QuantumEfficiency(
            spectra.response(efficiency).map_err(|e| e.under("quantum_efficiency").under("detector"))?,
        ),
        DetectorFile::RelativeResponsivity(response) => Detector::Responsivity(
            spectra.response(response).map_err(|e| e.under("relative_responsivity").under("detector"))?,
        ),
    };
    Sensor::of_filters("filter set", &curves, &detector).map_err(|e| e.under("filters"))
}

/// The light that a scene's camera develops white; equal energy where it names none.
pub(super) fn white(file: &CameraFile, sensor: &Sensor, spectra: &mut Spectra<'_>) -> Result<White> {
    let responses = Responses::of(sensor);
    let (light, xyz) = match &file.white_balance {
        None => (equal_energy(), None),
        Some(spectrum) => {
            let at = |e: Error| e.under("white_balance");
            let light = spectra.emission(spectrum).map_err(at)?;
            let xyz = visible(&light).map_err(at)?;
            (light, Some(xyz))
        }
    };
    let seen = responses.white(&light);
    let with_matrix = file.development.matrix.is_some() || file.development.fit_matrix;
    check_white(&seen, with_matrix).map_err(|e| e.under("white_balance"))?;
    let matrix = match (&file.development.matrix, file.development.fit_matrix) {
        (Some(_), true) => Err(Error::new("both matrix and fit_matrix are given").hint("keep one")),
        (_, true) => responses.fitted_matrix(&light).map(Some),
        (matrix, false) => Ok(matrix.clone()),
    };
    let matrix = matrix.map_err(|e| e.under("fit_matrix").under("development"))?;
    Ok(White { xyz, seen, matrix })
}

/// The light that a camera without a white is balanced to.
pub fn equal_energy() -> LampSpectrum {
    Curve::Constant(1.0).into()
}

/// A built-in light by name, with its tristimulus values.
pub fn white_named(name: &str) -> Result<(LampSpectrum, Xyz)> {
    const LIGHTS: [&str; 3] = ["illuminant", "emission", "line"];
    if let Some(entry) = library::entries().find(|e| e.name == name && !LIGHTS.contains(&e.kind)) {
        return Err(Error::new(format!("\"{name}\" is no light, it is of the kind {}", entry.kind))
            .hint("name an illuminant, such as \"d65\""));
    }
    let none = BTreeMap::new();
    let files = Files::in_folder(Path::new("."));
    let light = Spectra::new(&files, &none).emission(&SpectrumFile::Name(name.to_owned()))?;
    let xyz = visible(&light)?;
    Ok((light, xyz))
}

fn visible(light: &LampSpectrum) -> Result<Xyz> {
    let white = light.xyz();
    if white.iter().all(|value| *value > 0.0 && value.is_finite()) {
        return Ok(white);
    }
    Err(Error::new("a white without visible light").hint("name an illuminant, such as \"d65\""))
}

/// Refuses a white that the lens holds back, or of which a channel sees nothing although what
/// it sees is divided by: with a matrix.
pub fn check_white(seen: &camera::White, with_matrix: bool) -> Result<()> {
    if seen.luminous_transmission > 0.0 && (!with_matrix || seen.channels.iter().all(|value| *value > 0.0)) {
        return Ok(());
    }
    Err(Error::new("a channel of the sensor sees nothing of the white").hint("name another illuminant"))
}

fn vignetting(
    file: &VignettingFile,
    half_extent: [f64; 2],
    spectra: &mut Spectra<'_>,
) -> Result<(Vignetting, Option<FlatField>)> {
    match file {
        VignettingFile::None => Ok((Vignetting::None, None)),
        VignettingFile::Cos4 => Ok((Vignetting::Cos4, None)),
        VignettingFile::RadialTable { file } => {
            let at = |e: Error| e.under("file").under("radial_table");
            let (path, table) = spectra.read_csv(file).map_err(at)?;
            let table = Vignetting::of_table(file, &table).map_err(|e| at(e.in_file(&path)))?;
            Ok((table, None))
        }
        VignettingFile::FlatField { file } => {
            let at = |e: Error| e.under("file").under("flat_field");
            let (path, bytes) = spectra.read_file(file, Kind::Picture).map_err(at)?;
            // A picture has no lines: its faults stand where the scene names it.
            let named = |e: Error| at(Error { message: format!("\"{file}\": {}", e.message), ..e });
            let (size, levels) = read_levels(&path, &bytes).map_err(named)?;
            let field = FlatField::new(size, levels, half_extent).map_err(named)?;
            let channel = FLAT_FIELD_CHANNEL.to_owned();
            Ok((Vignetting::FlatField { file: file.clone(), channel }, Some(field)))
        }
    }
}

fn electronics(file: &ElectronicsFile) -> Result<Electronics> {
    if !(file.quantum_efficiency > 0.0 && file.quantum_efficiency <= 1.0) {
        return Err(Error::new(format!(
            "a quantum efficiency of {} is outside 0 to 1",
            file.quantum_efficiency
        ))
        .hint("give electrons per photon where the sensor is most efficient, such as 0.5")
        .under("quantum_efficiency"));
    }
    for (side, pitch) in file.pixel_pitch_um.iter().flatten().enumerate() {
        positive(*pitch, side, "[4.3, 4.3]").map_err(|e| e.under("pixel_pitch_um"))?;
    }
    if let Some(well) = file.full_well_electrons {
        positive(well, "full_well_electrons", "30000")?;
    }
    for (value, key) in [
        (file.read_noise_electrons, "read_noise_electrons"),
        (file.dark_current_electrons_per_s, "dark_current_electrons_per_s"),
        (file.black_level_dn, "black_level_dn"),
    ] {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(Error::new(format!("{value} is not a finite number from 0 up"))
                .hint("give 0 or leave it out for none")
                .under(key));
        }
    }
    positive(file.base_iso, "base_iso", "100")?;
    Ok(Electronics {
        pixel_pitch_um: file.pixel_pitch_um,
        quantum_efficiency: file.quantum_efficiency,
        full_well_electrons: file.full_well_electrons,
        read_noise_electrons: file.read_noise_electrons,
        dark_current_electrons_per_s: file.dark_current_electrons_per_s,
        digital: digital(file)?,
    })
}

fn digital(file: &ElectronicsFile) -> Result<Option<Digital>> {
    let Some(bit_depth) = file.bit_depth else {
        let (needless, key) = match (file.electrons_per_dn, file.black_level_dn != 0.0) {
            (Some(_), _) => ("a gain", "electrons_per_dn"),
            (None, true) => ("a black level", "black_level_dn"),
            (None, false) => return Ok(None),
        };
        return Err(Error::new(format!("{needless} without digital values"))
            .hint("add bit_depth, such as 14, or leave it out")
            .under(key));
    };
    if !(1..=16).contains(&bit_depth) {
        return Err(Error::new(format!("{bit_depth} bits"))
            .hint("a digital value has 1 to 16 bits")
            .under("bit_depth"));
    }
    let white_level_dn = f64::from((1_u32 << bit_depth) - 1);
    if file.black_level_dn >= white_level_dn {
        return Err(Error::new(format!(
            "a black level of {} is not below the largest value of {bit_depth} bits, {white_level_dn}",
            file.black_level_dn
        ))
        .hint("check black_level_dn and bit_depth")
        .under("black_level_dn"));
    }
    let electrons_per_dn = match (file.electrons_per_dn, file.full_well_electrons) {
        (Some(gain), _) => positive(gain, "electrons_per_dn", "0.5")?,
        (None, Some(well)) => well / (white_level_dn - file.black_level_dn),
        (None, None) => {
            return Err(Error::new("digital values without a gain")
                .hint("add electrons_per_dn or full_well_electrons")
                .under("bit_depth"));
        }
    };
    Ok(Some(Digital {
        electrons_per_dn,
        base_iso: file.base_iso,
        black_level_dn: file.black_level_dn,
        bit_depth,
    }))
}
