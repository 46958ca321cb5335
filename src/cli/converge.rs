//! `etalon converge`: error against run time, by the Python harness, which runs this program.
//!
//! Every run is a process of its own, so that what it costs is what a user pays.

use super::arguments::resolution;
use clap::Args;
use etalon::error::Error;
use etalon::integrator::Integrator;
use etalon::python::{Environment, VALIDATION};
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

/// What chooses among the others.
const AUTO: &str = "auto";

#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene files; with --baseline the reference scenes where none is named
    #[arg(value_name = "SCENE.json")]
    scenes: Vec<PathBuf>,
    /// Algorithms, separated by commas
    #[arg(long, value_name = "NAMES", default_value = "path,bdpt,mlt", value_delimiter = ',', value_parser = integrator)]
    integrators: Vec<String>,
    /// Processor seconds of the largest runs; half of it, a quarter and so on for the others [default: 16; 2 with --baseline]
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    budget: Option<f64>,
    /// Doubling budgets
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=16))]
    points: u32,
    /// Independent runs of each budget; with --baseline pairs of runs
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(5..=1000))]
    repeats: u32,
    /// Picture of the scene with little noise, an EXR whose unit is known; without it each run is
    /// judged by the others
    #[arg(long, value_name = "REF.exr", conflicts_with = "baseline")]
    reference: Option<PathBuf>,
    /// Size of the pictures instead of the reference's or the scene's, as WIDTHxHEIGHT
    #[arg(long, value_name = "WxH", value_parser = resolution)]
    resolution: Option<[u32; 2]>,
    /// Threads of each run; all processors if left out
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Another renderer's pictures of the scene: a table with the columns cpu_seconds,file; as often
    /// as there are others
    #[arg(long, value_name = "NAME=FILE.csv", conflicts_with = "baseline")]
    peer: Vec<String>,
    /// cd/m2 per unit of a peer's files, where they do not say it
    #[arg(long, value_name = "NAME=K", requires = "peer")]
    peer_scale: Vec<String>,
    /// A peer's own converged picture, which it is judged against
    #[arg(long, value_name = "NAME=REF.exr", requires = "peer")]
    peer_reference: Vec<String>,
    /// Program built from an earlier commit: exit with code 1 where efficiency fell since then, or
    /// where the pictures differ beyond noise
    #[arg(long, value_name = "FILE")]
    baseline: Option<PathBuf>,
    /// By how much efficiency may fall, with --baseline [default: 1.1]
    #[arg(long, value_name = "FACTOR", requires = "baseline", value_parser = factor)]
    factor: Option<f64>,
    /// Pictures may differ from the baseline's, as after a fault was mended
    #[arg(long, requires = "baseline")]
    allow_difference: bool,
    /// Folder for tables, JSON and plots
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    if arguments.scenes.is_empty() && arguments.baseline.is_none() {
        return Err(Error::new("no scene is named")
            .hint("give one or more, as in: etalon converge reference/cornell/scene.json -o out/converge")
            .into());
    }
    let holds = Environment::prepare(&VALIDATION)?.judge_module("converge", &words(arguments)?)?;
    Ok(if holds { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// The arguments as the harness takes them.
fn words(arguments: &Arguments) -> anyhow::Result<Vec<OsString>> {
    let mut words: Vec<OsString> = arguments.scenes.iter().map(OsString::from).collect();
    let size = arguments.resolution.map(|[width, height]| format!("{width}x{height}").into());
    let given: [(&str, Option<OsString>); 11] = [
        ("--program", Some(std::env::current_exe()?.into())),
        ("--integrators", Some(arguments.integrators.join(",").into())),
        ("--budget", arguments.budget.map(|seconds| seconds.to_string().into())),
        ("--points", Some(arguments.points.to_string().into())),
        ("--repeats", Some(arguments.repeats.to_string().into())),
        ("--reference", arguments.reference.as_ref().map(Into::into)),
        ("--resolution", size),
        ("--threads", arguments.threads.map(|threads| threads.to_string().into())),
        ("--baseline", arguments.baseline.as_ref().map(Into::into)),
        ("--factor", arguments.factor.map(|factor| factor.to_string().into())),
        ("-o", Some(arguments.output.clone().into())),
    ];
    for (option, value) in given {
        words.extend(value.into_iter().flat_map(|value| [option.into(), value]));
    }
    if arguments.allow_difference {
        words.push("--allow-difference".into());
    }
    let peers = [
        ("--peer", &arguments.peer),
        ("--peer-scale", &arguments.peer_scale),
        ("--peer-reference", &arguments.peer_reference),
    ];
    for (option, values) in peers {
        words.extend(values.iter().flat_map(|value| [option.into(), value.into()]));
    }
    Ok(words)
}

fn integrator(name: &str) -> Result<String, String> {
    let known = || Integrator::ALL.iter().map(|i| i.name()).chain([AUTO]);
    let found = known().find(|known| *known == name).map(ToOwned::to_owned);
    found.ok_or_else(|| Error::unknown_name("integrator", name, known()).to_string())
}

fn positive(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|value| *value > 0.0 && value.is_finite());
    value.ok_or_else(|| "give a number above zero".to_owned())
}

fn factor(text: &str) -> Result<f64, String> {
    let value = positive(text).ok().filter(|value| *value > 1.0);
    value.ok_or_else(|| "give a number above 1, such as 1.1".to_owned())
}
