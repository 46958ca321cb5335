//! `etalon measure`: what the scene's instruments read.

use super::faults;
use clap::Args;
use etalon::error::Error;
use etalon::integrator::{Integrator, Reading, instrument_plan_under, read_meters_under};
use etalon::scene::{Leaving, Meter, MeterKind, Plan, Scene, unreachable_by_instrument};
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;

/// Paths per meter where nothing is said.
pub(super) const DEFAULT_SAMPLES: u64 = 1 << 18;

#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene file with meters
    scene: PathBuf,
    /// Paths per meter
    #[arg(long, value_name = "N", default_value_t = DEFAULT_SAMPLES, value_parser = clap::value_parser!(u64).range(1..=1 << 28))]
    samples: u64,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Threads; all processors if left out
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Algorithm: path, light or bdpt
    #[arg(long, value_name = "NAME", default_value = "path", value_parser = super::arguments::integrator)]
    integrator: Integrator,
    /// Cut paths off after this many bounces and say what that loses [default: no limit]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1 << 30))]
    max_bounces: Option<u32>,
    /// What the readings leave out: lean (all that the scene does not need), full (nothing), or
    /// keep=NAME,... (all but these); the expected readings are the same
    #[arg(long = "plan", value_name = "WHAT", default_value_t = Leaving::all(), value_parser = super::arguments::leaving)]
    leaving: Leaving,
    /// Exit with code 3 where a reading is not what it should be: without reading, where meters
    /// miss light of some paths; else after printing, where samples were not finite or radiance
    /// has no finite value
    #[arg(long)]
    strict: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let threads = arguments.threads.map_or(0, usize::from);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    let scene = Scene::load(&arguments.scene)?;
    if scene.meters.is_empty() {
        let hint = "add for example \"meters\": [{\"illuminance\": {\"name\": \"desk\", \"position\": [0, 0, 0], \"normal\": [0, 0, 1]}}]";
        return Err(Error::new("the scene has no meters").hint(hint).in_file(&arguments.scene).into());
    }
    let looks = |meter: &Meter| matches!(meter.kind, MeterKind::Luminance { .. });
    if arguments.integrator == Integrator::Light && scene.meters.iter().any(looks) {
        return Err(Error::new("light tracing cannot read a luminance meter: no light hits its one ray")
            .hint("use --integrator path or bdpt")
            .in_file(&arguments.scene)
            .into());
    }
    if arguments.integrator == Integrator::Mlt {
        return Err(Error::new("chains of paths make pictures; a meter is one number")
            .hint("use --integrator bdpt")
            .in_file(&arguments.scene)
            .into());
    }
    let strategies = arguments.integrator.strategies().for_instruments();
    let mut misses = false;
    for is_open in [true, false] {
        let missing = unreachable_by_instrument(&scene, &strategies, is_open);
        if !missing.is_empty() && scene.meters.iter().any(|meter| looks(meter) != is_open) {
            let kind = if is_open { "illuminance" } else { "luminance" };
            let classes: Vec<&str> = missing.iter().map(|class| class.word).collect();
            let hint = match arguments.integrator {
                Integrator::Bdpt => "give a point light its real size",
                _ => "give a point light its real size, or use --integrator bdpt",
            };
            let word = if arguments.strict { "error" } else { "warning" };
            eprintln!("{word}: {kind} meters miss light on the way {}; {hint}", classes.join(", "));
            misses = true;
        }
    }
    if arguments.strict && misses {
        return Ok(ExitCode::from(3));
    }
    let plan = instrument_plan_under(&scene, arguments.integrator, &arguments.leaving);
    let plan = Plan { most_bounces: arguments.max_bounces, ..plan };
    let readings = read_meters_under(&scene, &plan, arguments.samples, arguments.seed);
    if arguments.json {
        super::print(&serde_json::to_string_pretty(&as_json(&scene, arguments, &readings))?);
    } else {
        readings.iter().for_each(|reading| super::print(&as_text(reading)));
    }
    let mut is_sound = true;
    for reading in &readings {
        is_sound &= faults::tell_reading(reading, &arguments.scene, arguments.strict);
    }
    Ok(if arguments.strict && !is_sound { ExitCode::from(3) } else { ExitCode::SUCCESS })
}

/// Photometric and radiant unit of a reading.
fn units(reading: &Reading) -> [&'static str; 2] {
    if reading.is_illuminance { ["lx", "W/m2"] } else { ["cd/m2", "W/(sr m2)"] }
}

fn as_text(reading: &Reading) -> String {
    let [photometric, radiant] = units(reading);
    if reading.truncation.divergence.is_some() {
        // What was cut off is missing: an interval would say that the value lies within.
        return format!(
            "{:<20} at least {:.6} {photometric}   at least {:.6} {radiant} (360-830 nm)   paths cut off",
            reading.name, reading.photometric.mean, reading.radiant.mean
        );
    }
    format!(
        "{:<20} {:>12.6} +- {:.6} {photometric}   {:>12.6} +- {:.6} {radiant} (360-830 nm)   95 %",
        reading.name,
        reading.photometric.mean,
        reading.photometric.half_width_95(),
        reading.radiant.mean,
        reading.radiant.half_width_95(),
    )
}

fn as_json(scene: &Scene, arguments: &Arguments, readings: &[Reading]) -> serde_json::Value {
    let meters: Vec<_> = readings
        .iter()
        .map(|reading| {
            let [photometric, radiant] = units(reading);
            json!({
                "name": reading.name,
                "kind": if reading.is_illuminance { "illuminance" } else { "luminance" },
                "unit": photometric,
                "value": reading.photometric.mean,
                "half_width_95": reading.photometric.half_width_95(),
                "radiant_unit": radiant,
                "radiant_band_nm": [360, 830],
                "radiant_value": reading.radiant.mean,
                "radiant_half_width_95": reading.radiant.half_width_95(),
                "xyz": reading.xyz,
                "non_finite_samples": reading.faults.count,
                "non_finite": reading.faults.named,
                "truncation": reading.truncation,
            })
        })
        .collect();
    json!({
        "scene": scene.name,
        "scene_hash": scene.hash,
        "samples": arguments.samples,
        "seed": arguments.seed,
        "integrator": arguments.integrator.name(),
        "max_bounces": arguments.max_bounces,
        "plan_setting": arguments.leaving.to_string(),
        "version": env!("CARGO_PKG_VERSION"),
        "meters": meters,
    })
}
