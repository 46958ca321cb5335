//! `etalon replay`: one sample of a render or of a reading again, vertex by vertex.

use clap::Args;
use etalon::camera::Crop;
use etalon::error::{Error, Result};
use etalon::image::read_facts;
use etalon::integrator::{Bounded, Budget, Integrator, block_size, instrument_plan_under, size_of_block};
use etalon::metropolis::World;
use etalon::path::{Eye, Groups};
use etalon::pilot::Selection;
use etalon::replay::{
    MeterSample, PixelSample, SampleName, explain, explain_path, replay_meter, replay_path, replay_pixel,
};
use etalon::scene::{Leaving, Plan, Scene, View};
use etalon::statistics::BATCHES;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

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
    /// Half of a render that ended by --error or --time [default: 0]
    #[arg(long, value_name = "0|1", requires = "from", requires = "pixel", value_parser = clap::value_parser!(u8).range(0..=1))]
    half: Option<u8>,
    /// Block of the sample, counted from 0
    #[arg(long, value_name = "N", default_value_t = 0)]
    block: u32,
    /// Samples in that block [default: as in the render, or as in a whole block of the default]
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
    /// What the plan leaves out: lean, full, or keep=NAME,... [default: as the render's, or lean]
    #[arg(long = "plan", value_name = "WHAT", value_parser = super::arguments::leaving)]
    leaving: Option<Leaving>,
}

/// What is known of the render or of the readings.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Known {
    scene_hash: Option<String>,
    seed: u64,
    integrator: Option<String>,
    groups: Option<String>,
    samples: u64,
    samples_per_pixel: u64,
    max_bounces: Option<u32>,
    plan_setting: Option<String>,
    spectral_layers: usize,
    stopping: KnownStopping,
    crop: Option<Crop>,
    non_finite: Vec<SampleName>,
    camera: Option<KnownCamera>,
    meters: Vec<KnownMeter>,
}

/// When the render was to end, and the samples that its halves have in the picture.
#[derive(Default, Deserialize)]
#[serde(default)]
struct KnownStopping {
    samples_per_pixel: Option<u64>,
    error: Option<f64>,
    time_s: Option<f64>,
    ends: Vec<KnownEnd>,
}

#[derive(Deserialize)]
struct KnownEnd {
    samples_per_pixel: u64,
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

impl Known {
    /// The rule that the sizes of the blocks follow from.
    fn budget(&self) -> Budget {
        let Self { seed, samples_per_pixel, stopping, .. } = self;
        Budget {
            samples_per_pixel: stopping.samples_per_pixel.unwrap_or(*samples_per_pixel),
            // Of a time it only matters that there was one.
            time: stopping.time_s.map(|_| Duration::ZERO),
            error: stopping.error,
            seed: *seed,
        }
    }

    /// What the plan left out; all where the file does not say, or not in words of this program.
    fn leaving(&self) -> Leaving {
        self.plan_setting.as_deref().and_then(|setting| setting.parse().ok()).unwrap_or_default()
    }

    /// What in the arguments is not as it was, so that the sample is none of the render's or the
    /// readings'.
    fn departures(&self, arguments: &Arguments, block_size: Option<u32>) -> Vec<&'static str> {
        let is_any = arguments.pixel.is_some() || arguments.meter.is_some();
        let resolution = self.camera.as_ref().map(|camera| camera.resolution);
        let differ = [
            ("--seed", is_any && arguments.seed.is_some_and(|seed| seed != self.seed)),
            ("--block-size", is_any && arguments.block_size.is_some_and(|size| Some(size) != block_size)),
            (
                "--integrator",
                arguments.integrator.is_some_and(|i| Some(i.name()) != self.integrator.as_deref()),
            ),
            ("--resolution", arguments.resolution.is_some() && arguments.resolution != resolution),
            ("--plan", arguments.leaving.is_some_and(|leaving| leaving != self.leaving())),
        ];
        differ.into_iter().filter(|(_, differs)| *differs).map(|(option, _)| option).collect()
    }
}

pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let scene = Scene::load(&arguments.scene)?;
    let known = match &arguments.from {
        Some(file) => read(file, &scene)?,
        None => Known::default(),
    };
    let Chosen { name, regular_size } = chosen(arguments, &known)?;
    let text = match &name {
        SampleName::Pixel(sample) => {
            let view = view(arguments, &known, &scene)?;
            replay_pixel(&scene, &view, &plan(arguments, &known, &scene, &view)?, sample)
                .map(|replayed| explain(&scene, &replayed))?
        }
        SampleName::Meter(sample) => {
            let plan =
                instrument_plan_under(&scene, integrator(arguments, &known)?, &leaving(arguments, &known));
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
    super::print(&format!("{:<12} {name}", "sample"));
    if let Some(file) = &arguments.from {
        let options = known.departures(arguments, regular_size);
        if !options.is_empty() {
            let file = file.display();
            super::print(&format!("{:<12} no sample of {file}, for its {}", "note", options.join(", ")));
        }
    }
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
    let remedy = "give an EXR of `etalon render`, its --report, or what `etalon measure --json` prints";
    let known: Known = serde_json::from_str(&text)
        .map_err(|e| Error::new(format!("its facts cannot be read ({e})")).hint(remedy).in_file(file))?;
    match &known.scene_hash {
        None => Err(Error::new("it is of no render and no readings: it has no \"scene_hash\"")
            .hint(remedy)
            .in_file(file)),
        Some(hash) if *hash != scene.hash => {
            Err(Error::new(format!("it is of another scene, of hash {hash}; this one has {}", scene.hash))
                .hint("give the scene as it was")
                .in_file(file))
        }
        Some(_) if known.samples == 0 && known.samples_per_pixel == 0 => {
            Err(Error::new("it is of no render and no readings: it counts no samples")
                .hint(remedy)
                .in_file(file))
        }
        Some(_) => Ok(known),
    }
}

/// A sample that was asked for.
struct Chosen {
    name: SampleName,
    /// Samples of its block in the render or in the readings; `None` where that has no such block.
    regular_size: Option<u32>,
}

/// The sample that is asked for.
fn chosen(arguments: &Arguments, known: &Known) -> Result<Chosen> {
    if let Some(meter) = &arguments.meter {
        let (seed, regular) = in_file(arguments, of_the_readings(arguments, known))?;
        let (block_size, regular_size) = in_file(arguments, size(arguments, regular))?;
        let Arguments { block, index, .. } = *arguments;
        let name = SampleName::Meter(MeterSample { meter: meter.clone(), seed, block, block_size, index });
        return Ok(Chosen { name, regular_size });
    }
    if let Some(pixel) = arguments.pixel {
        if integrator(arguments, known)? == Integrator::Mlt {
            return Err(Error::new("chains have no samples of a pixel")
                .hint("use --integrator bdpt, or --from FILE --sample N"));
        }
        let (seed, regular) = in_file(arguments, of_the_render(arguments, known))?;
        let (block_size, regular_size) = in_file(arguments, size(arguments, regular))?;
        let Arguments { block, index, .. } = *arguments;
        let sample = PixelSample { pixel, seed, block, block_size, index, direct_light: false };
        return Ok(Chosen { name: SampleName::Pixel(sample), regular_size });
    }
    non_finite(arguments, known).map(|name| Chosen { name, regular_size: None })
}

/// Says of which file an error is, if there is one.
fn in_file<T>(arguments: &Arguments, result: Result<T>) -> Result<T> {
    result.map_err(|e| match &arguments.from {
        Some(file) => e.in_file(file),
        None => e,
    })
}

/// The size of a block that is asked for, and the regular one; the latter may instead be the
/// number of blocks that there were.
fn size(arguments: &Arguments, regular: std::result::Result<u32, u64>) -> Result<(u32, Option<u32>)> {
    match (arguments.block_size, regular) {
        (Some(size), regular) => Ok((size, regular.ok())),
        (None, Ok(size)) => Ok((size, Some(size))),
        (None, Err(blocks)) => {
            let of = if arguments.half.is_some() { " of that half" } else { "" };
            Err(Error::new(format!("there is no block {} among the {blocks}{of}", arguments.block))
                .hint("blocks are counted from 0"))
        }
    }
}

/// The seed of a meter's samples, and the size of the block or the number of blocks.
fn of_the_readings(arguments: &Arguments, known: &Known) -> Result<(u64, std::result::Result<u32, u64>)> {
    if arguments.from.is_some() && known.samples == 0 {
        return Err(Error::new("it is of a picture and has no readings").hint("give --pixel X,Y"));
    }
    let samples = if arguments.from.is_some() { known.samples } else { super::measure::DEFAULT_SAMPLES };
    let size = samples.div_ceil(BATCHES as u64).clamp(1, u64::from(u32::MAX)) as u32;
    let is_there = arguments.from.is_none() || (arguments.block as usize) < BATCHES;
    let seed = arguments.seed.unwrap_or(known.seed);
    Ok((seed, if is_there { Ok(size) } else { Err(BATCHES as u64) }))
}

/// The seed of a picture's samples, and the size of the block or the number of blocks.
fn of_the_render(arguments: &Arguments, known: &Known) -> Result<(u64, std::result::Result<u32, u64>)> {
    if arguments.from.is_none() {
        return Ok((arguments.seed.unwrap_or(0), Ok(block_size(super::render::DEFAULT_SPP))));
    }
    if known.samples_per_pixel == 0 {
        return Err(Error::new("it is of readings and has no picture").hint("give --meter NAME"));
    }
    let budget = known.budget();
    let half = usize::from(arguments.half.unwrap_or(0));
    let samples = match (budget.is_open(), arguments.half) {
        (false, None) => known.samples_per_pixel,
        (false, Some(_)) => {
            return Err(Error::new("the picture has no halves: neither an error nor a time was to end it")
                .hint("leave --half out"));
        }
        (true, _) => {
            let end = known.stopping.ends.get(half).ok_or_else(|| {
                Error::new("it does not say how many samples each of its halves has")
                    .hint("give --sample N, or --seed, --block and --block-size without --from")
            })?;
            end.samples_per_pixel
        }
    };
    let seed = arguments.seed.unwrap_or_else(|| budget.seed_of(half));
    Ok((seed, size_of_block(&budget, samples, arguments.block)))
}

/// A sample that was not finite.
fn non_finite(arguments: &Arguments, known: &Known) -> Result<SampleName> {
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

fn leaving(arguments: &Arguments, known: &Known) -> Leaving {
    arguments.leaving.unwrap_or_else(|| known.leaving())
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
    let integrator = integrator(arguments, known)?;
    // Of another algorithm than the render's, all strategies.
    let is_known = known.integrator.as_deref() == Some(integrator.name());
    let groups = known.groups.as_deref().filter(|_| is_known).map(Groups::named).transpose()?;
    let strategies = Selection { integrator, groups }.strategies();
    let plan = Plan::under(scene, &view.sensor, strategies, &leaving(arguments, known));
    Ok(Plan { most_bounces: known.max_bounces, ..plan })
}

fn pixel(text: &str) -> std::result::Result<[u32; 2], String> {
    let place = |part: &str| part.trim().parse::<u32>().ok();
    let both = text.split_once(',').and_then(|(x, y)| Some([place(x)?, place(y)?]));
    both.ok_or_else(|| "give column and row as in 12,34".to_owned())
}
