//! `etalon replay`: one sample of a render or of a reading again, vertex by vertex.

use clap::Args;
use etalon::camera::Crop;
use etalon::error::{Error, Result};
use etalon::image::read_facts;
use etalon::integrator::{Bounded, Integrator, block_size, instrument_plan};
use etalon::metropolis::World;
use etalon::path::Eye;
use etalon::replay::{
    MeterSample, PixelSample, SampleName, explain, explain_path, replay_meter, replay_path, replay_pixel,
};
use etalon::scene::{Plan, Scene, View};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene file
    scene: PathBuf,
    /// Render (EXR), its report (JSON) or readings of `measure --json`, for the settings and the
    /// samples that were not finite
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
    /// Which of the samples that were not finite, counted from 0
    #[arg(long, value_name = "N", requires = "from", conflicts_with_all = ["pixel", "meter"])]
    sample: Option<usize>,
    /// Any sample of this pixel, counted from the top left, as COLUMN,ROW
    #[arg(long, value_name = "X,Y", value_parser = pixel, conflicts_with = "meter")]
    pixel: Option<[u32; 2]>,
    /// Any sample of this meter
    #[arg(long, value_name = "NAME")]
    meter: Option<String>,
    /// Block of the sample
    #[arg(long, value_name = "N", default_value_t = 0)]
    block: u32,
    /// Samples in that block [default: as in a whole block of the render]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    block_size: Option<u32>,
    /// Sample in its block, counted from 0
    #[arg(long, value_name = "N", default_value_t = 0)]
    index: u32,
    /// Seed of the random numbers [default: the render's, or 0]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Algorithm [default: the render's, or path]
    #[arg(long, value_name = "NAME", value_parser = super::arguments::integrator)]
    integrator: Option<Integrator>,
    /// Size of the picture [default: the render's, or the scene's]
    #[arg(long, value_name = "WxH", value_parser = super::arguments::resolution)]
    resolution: Option<[u32; 2]>,
}

/// What is known of the render or of the readings.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Known {
    scene_hash: Option<String>,
    seed: u64,
    integrator: Option<String>,
    samples: u64,
    samples_per_pixel: u64,
    max_bounces: Option<u32>,
    spectral_layers: usize,
    crop: Option<Crop>,
    non_finite: Vec<SampleName>,
    camera: Option<KnownCamera>,
    meters: Vec<KnownMeter>,
}

#[derive(Deserialize)]
struct KnownCamera {
    resolution: [u32; 2],
}

#[derive(Deserialize)]
struct KnownMeter {
    #[serde(default)]
    non_finite: Vec<SampleName>,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let scene = Scene::load(&arguments.scene)?;
    let known = match &arguments.from {
        Some(file) => read(file, &scene)?,
        None => Known::default(),
    };
    let name = chosen(arguments, &known)?;
    super::print(&format!("{:<12} {name}", "sample"));
    let text = match &name {
        SampleName::Pixel(sample) => {
            let view = view(arguments, &known, &scene)?;
            replay_pixel(&scene, &view, &plan(arguments, &known, &scene, &view)?, sample)
                .map(|replayed| explain(&scene, &replayed))?
        }
        SampleName::Meter(sample) => {
            let plan = instrument_plan(&scene, integrator(arguments, &known)?);
            let plan = Plan { most_bounces: known.max_bounces, ..plan };
            replay_meter(&scene, &plan, sample).map(|replayed| explain(&scene, &replayed))?
        }
        SampleName::Chain(path) => {
            let view = view(arguments, &known, &scene)?;
            let plan = plan(arguments, &known, &scene, &view)?;
            let bounded = Bounded::of(&scene, &plan, Eye::Camera(&view.camera));
            let replayed = replay_path(&World::new(&scene, &view, &bounded.plan), path)?;
            explain_path(&scene, &replayed)
        }
    };
    super::print(text.trim_end());
    Ok(ExitCode::SUCCESS)
}

/// Reads what a file says of the render or of the readings.
fn read(file: &Path, scene: &Scene) -> Result<Known> {
    let is_json = file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
    let text = if is_json {
        std::fs::read_to_string(file).map_err(|e| Error::io(file, "read the report", &e))?
    } else {
        read_facts(file)?
    };
    let known: Known = serde_json::from_str(&text).map_err(|e| {
        Error::new(format!("its facts cannot be read ({e})"))
            .hint("give an EXR of `etalon render`, its --report, or what `etalon measure --json` prints")
            .in_file(file)
    })?;
    match &known.scene_hash {
        Some(hash) if *hash != scene.hash => {
            Err(Error::new(format!("it is of another scene, of hash {hash}; this one has {}", scene.hash))
                .hint("give the scene as it was")
                .in_file(file))
        }
        _ => Ok(known),
    }
}

/// The sample that is asked for.
fn chosen(arguments: &Arguments, known: &Known) -> Result<SampleName> {
    let seed = arguments.seed.unwrap_or(known.seed);
    let Arguments { block, index, .. } = *arguments;
    let or_usual = |samples: u64, usual: u64| if samples > 0 { samples } else { usual };
    let regular = if arguments.meter.is_some() {
        let samples = or_usual(known.samples, super::measure::DEFAULT_SAMPLES);
        samples.div_ceil(etalon::statistics::BATCHES as u64) as u32
    } else {
        block_size(or_usual(known.samples_per_pixel, super::render::DEFAULT_SPP))
    };
    let block_size = arguments.block_size.unwrap_or(regular.max(1));
    if let Some(meter) = arguments.meter.clone() {
        return Ok(SampleName::Meter(MeterSample { meter, seed, block, block_size, index }));
    }
    if let Some(pixel) = arguments.pixel {
        if integrator(arguments, known)? == Integrator::Mlt {
            return Err(Error::new("chains have no samples of a pixel")
                .hint("use --integrator bdpt, or --from FILE --sample N"));
        }
        let sample = PixelSample { pixel, seed, block, block_size, index, direct_light: false };
        return Ok(SampleName::Pixel(sample));
    }
    let named: Vec<&SampleName> =
        known.non_finite.iter().chain(known.meters.iter().flat_map(|meter| &meter.non_finite)).collect();
    let Some(file) = &arguments.from else {
        return Err(Error::new("no sample is named").hint("give --from FILE, or --pixel X,Y --index N"));
    };
    let number = arguments.sample.unwrap_or(0);
    named.get(number).map(|name| (*name).clone()).ok_or_else(|| {
        let fault = match named.len() {
            0 => "all of its samples were finite".to_owned(),
            count => format!("it names {count} samples that were not finite, and no number {number}"),
        };
        Error::new(fault).hint("give any sample as --pixel X,Y --block N --index N").in_file(file)
    })
}

fn integrator(arguments: &Arguments, known: &Known) -> Result<Integrator> {
    let Some(name) = known.integrator.as_deref() else {
        return Ok(arguments.integrator.unwrap_or_default());
    };
    let by_name = || Integrator::named(name);
    arguments
        .integrator
        .or_else(by_name)
        .ok_or_else(|| Error::unknown_name("integrator", name, Integrator::ALL.iter().map(|i| i.name())))
}

/// The view at the size of the render, with the channels of its film.
fn view(arguments: &Arguments, known: &Known, scene: &Scene) -> Result<View> {
    let mut view = scene.view().map_err(|e| e.in_file(&arguments.scene))?.clone();
    let rendered = known.camera.as_ref().map(|camera| camera.resolution);
    match (known.crop, arguments.resolution.or(rendered)) {
        (Some(Crop { whole, corner: [x, y] }), Some([width, height])) => {
            let part = view.camera.with_resolution(whole).cropped([x, y, width, height]);
            view.camera = part.ok_or_else(|| {
                Error::new("the part of the picture that was rendered lies outside of it")
                    .hint("leave --resolution out: the render knows its own")
            })?;
        }
        (None, Some(resolution)) => view.camera = view.camera.with_resolution(resolution),
        (_, None) => {}
    }
    if known.spectral_layers > 0 {
        view.sensor = view.sensor.with_spectral_layers(known.spectral_layers);
    }
    Ok(view)
}

fn plan(arguments: &Arguments, known: &Known, scene: &Scene, view: &View) -> Result<Plan> {
    let plan = Plan::of(scene, &view.sensor, integrator(arguments, known)?.strategies());
    Ok(Plan { most_bounces: known.max_bounces, ..plan })
}

fn pixel(text: &str) -> std::result::Result<[u32; 2], String> {
    let place = |part: &str| part.trim().parse::<u32>().ok();
    let both = text.split_once(',').and_then(|(x, y)| Some([place(x)?, place(y)?]));
    both.ok_or_else(|| "give column and row as in 12,34".to_owned())
}
