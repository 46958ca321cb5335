//! `etalon develop`: another exposure, another development of a render that is there.

use super::render::check_output;
use clap::Args;
use etalon::camera::{CameraRecord, Darkroom, Matrix, Noise, SWITCHES, Tone, shows_recorded};
use etalon::error::{Error, Result};
use etalon::image::{DEVELOPED_ENDINGS, Label, Rendered, read_exr, write_developed, write_raw};
use etalon::input;
use etalon::scene::file::Anchor;
use etalon::scene::{check_white, equal_energy, white_named};
use etalon::spectrum::LampSpectrum;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, Args)]
pub struct Arguments {
    /// EXR written by `etalon render`
    render: PathBuf,
    /// Picture to write: PNG or JPEG (8 bits), TIFF (16 bits), or EXR (linear)
    #[arg(short, long, value_name = "OUT.png")]
    output: PathBuf,
    /// Exposure index
    #[arg(long, value_name = "ISO", value_parser = positive)]
    iso: Option<f64>,
    /// Exposure time in seconds, such as 1/60 or 0.5
    #[arg(long, value_name = "SECONDS", value_parser = fraction)]
    shutter: Option<f64>,
    /// f-number; the depth of field stays as it was rendered
    #[arg(long, value_name = "N", value_parser = positive)]
    f_stop: Option<f64>,
    /// Speed point that fixes the level: saturation, sos or meter
    #[arg(long, value_name = "NAME", value_parser = anchor)]
    anchor: Option<Anchor>,
    /// Built-in light that becomes white, or none
    #[arg(long, value_name = "NAME")]
    white_balance: Option<String>,
    /// From the sensor's channels to colours: a JSON file such as {"to": "srgb", "rows": [...]},
    /// or fitted, which shows the ColorChecker's reflectances best under the white
    #[arg(long, value_name = "FILE.json | fitted")]
    matrix: Option<PathBuf>,
    /// Encoding: srgb, linear, or gamma=2.2
    #[arg(long, value_name = "TONE", value_parser = tone)]
    tone: Option<Tone>,
    /// Add shot noise and read noise
    #[arg(long)]
    noise: bool,
    /// Seed of the noise
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Switch a stage off; may be given several times
    #[arg(long, value_name = "STAGE", value_parser = stage)]
    without: Vec<&'static str>,
    /// Also write the digital values, as a TIFF with 16 bits
    #[arg(long, value_name = "OUT.tiff")]
    raw: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let endings: Vec<&str> = DEVELOPED_ENDINGS.into_iter().chain(["exr"]).collect();
    check_output(&arguments.output, &endings, "a developed picture is a PNG, a TIFF, a JPEG or an EXR")?;
    if let Some(raw) = &arguments.raw {
        check_output(raw, &["tif", "tiff"], "digital values are written as a TIFF")?;
    }
    let rendered = read_exr(&arguments.render)?;
    let in_file = |e: Error| e.in_file(&arguments.render);
    if same_file(&arguments.output, &arguments.render) {
        return Err(
            in_file(Error::new("the picture would replace the render").hint("choose another name")).into()
        );
    }
    if let Some(raw) = arguments.raw.as_deref().filter(|raw| same_file(&arguments.output, raw)) {
        return Err(Error::new("the picture and the digital values would be the same file")
            .hint("choose another name for one of them")
            .in_file(raw)
            .into());
    }
    let mut camera = settings(arguments, &rendered)?;
    if arguments.output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr")) {
        if arguments.tone.is_some_and(|tone| tone != Tone::Linear) {
            return Err(Error::new("an EXR holds linear values")
                .hint("leave --tone out, or write a PNG")
                .into());
        }
        camera.tone = Tone::Linear;
        camera = camera.settled();
    }
    if arguments.noise && arguments.raw.is_none() && !shows_recorded(&camera) {
        return Err(in_file(
            Error::new("no noise would be seen: without a matrix the picture is made of X, Y, Z, not of the sensor's channels")
                .hint("add --matrix, or --raw for the digital values"),
        )
        .into());
    }
    let darkroom = Darkroom::new(&camera, &rendered.planes).map_err(in_file)?;
    let label = Label { scene: &rendered.scene, camera: &camera, tone: camera.tone };
    if let Some(raw) = &arguments.raw {
        let label = Label { tone: Tone::Linear, ..label };
        write_raw(raw, &darkroom, &label).map_err(in_file)?;
    }
    write_developed(&arguments.output, &darkroom, &label)?;
    tell(&camera, &rendered.camera, darkroom.saturated_pixels());
    Ok(ExitCode::SUCCESS)
}

/// The camera of a render with what is asked for changed.
fn settings(arguments: &Arguments, rendered: &Rendered) -> Result<CameraRecord> {
    let mut camera = rendered.camera.clone();
    let in_render = |e: Error| e.in_file(&arguments.render);
    camera.iso = arguments.iso.unwrap_or(camera.iso);
    camera.shutter_s = arguments.shutter.unwrap_or(camera.shutter_s);
    camera.f_stop = arguments.f_stop.unwrap_or(camera.f_stop);
    camera.anchor = arguments.anchor.unwrap_or(camera.anchor);
    camera.tone = arguments.tone.unwrap_or(camera.tone);
    if arguments.noise || arguments.seed.is_some() {
        camera.noise = Some(noise(arguments, &camera).map_err(in_render)?);
    }
    let without_white = arguments.without.contains(&"white_balance");
    let white = if without_white { Some("none") } else { arguments.white_balance.as_deref() };
    let light = white.map(|name| whiten(&mut camera, name, rendered)).transpose()?;
    set_matrix(&mut camera, arguments, light.as_ref(), rendered).map_err(in_render)?;
    check_white(&camera.white, camera.matrix.is_some()).map_err(in_render)?;
    for stage in &arguments.without {
        camera = camera.without(stage).expect("the stages are those of SWITCHES");
    }
    if (arguments.noise || arguments.seed.is_some()) && !makes_noise(&camera) {
        return Err(in_render(Error::new("noise is asked for, and no stage that makes it is on").hint(
            "leave out --noise and --seed, or what --without says of electrons, shot_noise and read_noise",
        )));
    }
    let camera = camera.settled();
    // Far beyond any camera, and well within what the files' numbers hold.
    if (1e-30..1e30).contains(&camera.white_luminance_cd_m2) {
        return Ok(camera);
    }
    Err(Error::new(format!("at this exposure {:e} cd/m2 would be white", camera.white_luminance_cd_m2))
        .hint("check --iso, --shutter and --f-stop"))
}

fn noise(arguments: &Arguments, camera: &CameraRecord) -> Result<Noise> {
    if camera.electronics.is_none() {
        return Err(Error::new("noise needs electrons, and the render's camera states no electronics")
            .hint("add electronics to the scene's camera and render again"));
    }
    let Some(before) =
        camera.noise.or_else(|| arguments.noise.then_some(Noise { seed: 0, shot: true, read: true }))
    else {
        return Err(Error::new("a seed without noise").hint("add --noise"));
    };
    let all = arguments.noise;
    Ok(Noise {
        seed: arguments.seed.unwrap_or(before.seed),
        shot: before.shot || all,
        read: before.read || all,
    })
}

fn makes_noise(camera: &CameraRecord) -> bool {
    let stated = camera.noise.zip(camera.electronics.as_ref());
    stated.is_some_and(|(noise, sensor)| noise.shot || noise.read && sensor.read_noise_electrons > 0.0)
}

/// Sets the light that becomes white, and gives it back.
fn whiten(camera: &mut CameraRecord, name: &str, rendered: &Rendered) -> Result<LampSpectrum> {
    let (light, xyz) = if name == "none" {
        (equal_energy(), None)
    } else {
        let (light, xyz) = white_named(name)?;
        (light, Some(xyz))
    };
    (camera.white_xyz, camera.white) = (xyz, rendered.responses.white(&light));
    Ok(light)
}

/// Sets the matrix that is asked for; one that was fitted to another white is fitted again.
fn set_matrix(
    camera: &mut CameraRecord,
    arguments: &Arguments,
    light: Option<&LampSpectrum>,
    rendered: &Rendered,
) -> Result<()> {
    let fit =
        arguments.matrix.as_deref().map_or(camera.has_fitted_matrix, |file| file == Path::new("fitted"));
    match (&arguments.matrix, light) {
        (Some(file), _) if !fit => {
            let matrix = read_matrix(file)?;
            matrix.check(camera.channels.len()).map_err(|e| e.in_file(file))?;
            (camera.matrix, camera.has_fitted_matrix) = (Some(matrix), false);
        }
        (_, Some(light)) if fit => camera.matrix = Some(rendered.responses.fitted_matrix(light)?),
        (Some(_), None) if !camera.has_fitted_matrix => {
            return Err(Error::new("a matrix is fitted to a white")
                .hint("add --white-balance with the name of a light, or none"));
        }
        _ => {}
    }
    camera.has_fitted_matrix = fit && camera.matrix.is_some();
    Ok(())
}

fn read_matrix(file: &Path) -> Result<Matrix> {
    const EXAMPLE: &str = "for example {\"to\": \"srgb\", \"rows\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}";
    /// A matrix has a few hundred characters.
    const MOST_BYTES: u64 = 1 << 20;
    let bytes =
        input::read_bytes_or_pipe(file, MOST_BYTES).map_err(|e| Error::io(file, "read the matrix", &e))?;
    let text = input::text_of(&bytes).map_err(|e| e.in_file(file))?;
    // A list of the fields' values would pass for an object of them.
    if text.trim_start().starts_with('[') {
        let list = Error::new("a list where an object with \"to\" and \"rows\" belongs");
        return Err(list.hint(EXAMPLE).in_file(file));
    }
    serde_json::from_str(text).map_err(|e| {
        Error::new(in_plain_words(&e)).hint(EXAMPLE).at(e.line(), Some(e.column())).in_file(file)
    })
}

/// What is wrong with a matrix, without the names that the program has for types.
fn in_plain_words(fault: &serde_json::Error) -> String {
    let whole = fault.to_string();
    let what = whole.split(" at line").next().unwrap_or_default();
    let Some((found, expected)) =
        what.strip_prefix("invalid type: ").and_then(|what| what.split_once(", expected "))
    else {
        return what.to_owned();
    };
    let belongs = match expected {
        "f64" => "a number",
        "a sequence" => "a list",
        "struct Matrix" => "an object with \"to\" and \"rows\"",
        _ => "\"srgb\" or \"xyz\"",
    };
    format!("{found} where {belongs} belongs")
}

/// Whether two names are of the same file, which need not be there yet.
fn same_file(a: &Path, b: &Path) -> bool {
    let place = |file: &Path| {
        file.canonicalize().ok().or_else(|| {
            let whole = std::path::absolute(file).ok()?;
            Some(whole.parent()?.canonicalize().ok()?.join(whole.file_name()?))
        })
    };
    matches!((place(a), place(b)), (Some(a), Some(b)) if a == b)
}

/// The chain, and what of it the render has decided already.
fn tell(camera: &CameraRecord, before: &CameraRecord, saturated: Option<u64>) {
    for stage in &camera.stages {
        let state = if stage.on { "on " } else { "off" };
        super::print(&format!("{:<18} {state}  {}", stage.name, stage.what));
    }
    if let Some(pixels) = saturated {
        super::print(&format!("saturated          {pixels} of {} pixels", camera.optics.pixels()));
    }
    if camera.has_aperture && camera.f_stop != before.f_stop {
        eprintln!(
            "warning: the depth of field is that of f/{}, with which the scene was rendered; only the exposure is that of f/{}",
            before.f_stop, camera.f_stop
        );
    }
    camera.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
}

pub fn positive(text: &str) -> std::result::Result<f64, String> {
    let value = text.parse().ok().filter(|value: &f64| *value > 0.0 && value.is_finite());
    value.ok_or_else(|| "give a positive number".to_owned())
}

fn fraction(text: &str) -> std::result::Result<f64, String> {
    let value = match text.split_once('/') {
        Some((above, below)) => positive(above).and_then(|above| Ok(above / positive(below)?)),
        None => positive(text),
    };
    let value = value.ok().filter(|value| *value > 0.0 && value.is_finite());
    value.ok_or_else(|| "give positive seconds, such as 1/60 or 0.5".to_owned())
}

fn anchor(name: &str) -> std::result::Result<Anchor, String> {
    match name {
        "saturation" => Ok(Anchor::Saturation),
        "sos" => Ok(Anchor::Sos),
        "meter" => Ok(Anchor::Meter),
        _ => Err(Error::unknown_name("anchor", name, ["saturation", "sos", "meter"]).to_string()),
    }
}

fn tone(text: &str) -> std::result::Result<Tone, String> {
    match (text, text.strip_prefix("gamma=")) {
        ("srgb", _) => Ok(Tone::Srgb),
        ("linear", _) => Ok(Tone::Linear),
        (_, Some(gamma)) => positive(gamma).map(Tone::Gamma),
        _ => Err(Error::unknown_name("encoding", text, ["srgb", "linear", "gamma=2.2"]).to_string()),
    }
}

fn stage(name: &str) -> std::result::Result<&'static str, String> {
    let known = SWITCHES.into_iter().find(|known| *known == name);
    known.ok_or_else(|| Error::unknown_name("stage", name, SWITCHES).to_string())
}
