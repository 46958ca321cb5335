//! One case: rendered, then handed to the harness together with what it is held against.

use super::Arguments;
use super::cases::{Against, Case};
use super::{peers, photographs};
use crate::cli::arguments::Algorithm;
use crate::cli::auto;
use crate::cli::print;
use crate::cli::render::{Files, render_to_files};
use etalon::error::{Error, Result};
use etalon::image::Layers;
use etalon::integrator::Stopwatch;
use etalon::python::{Environment, PEERS, VALIDATION, project_root};
use etalon::scene::{Leaving, Scene};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// What a reader opens in the folder of a case.
const REPORT: &str = "report.html";

/// Where the pictures of a case are, and how they were made.
struct Rendered {
    case: PathBuf,
    output: PathBuf,
    exr: PathBuf,
    samples_per_pixel: u64,
}

pub fn run(case: &Case, arguments: &Arguments) -> anyhow::Result<ExitCode> {
    if arguments.photos.is_some() {
        return Err(Error::new("--photos goes with all").hint("give --photo FILE").into());
    }
    if let Against::Another(cases) = case.against {
        return predict(case, cases, arguments);
    }
    let photo = photographs::of_one(case, &arguments.photo)?;
    let bands = bands(case, arguments)?;
    arguments.effort.start_threads()?;
    let rendered = render(case, arguments)?;
    let words = match case.against {
        Against::Photograph | Against::Another(_) => {
            let mut words = optional("--photo", photo.as_deref());
            words.extend(arguments.force_registration.then(|| "--force-registration".into()));
            words
        }
        Against::Bands => {
            let mut words = optional("--bands", bands.as_deref());
            words.extend(optional("--points", arguments.points.as_deref()));
            words
        }
        Against::Exposure => vec!["--threads".into(), rayon::current_num_threads().to_string().into()],
        Against::Peer => peers::words(rendered.samples_per_pixel)?,
    };
    let passes = judge(case, &rendered, words)?;
    if case.against == Against::Peer {
        // Pictures that differ, or are too noisy, do not keep anybody from seeing how fast they are.
        peers::converge(&rendered.case, &rendered.output, arguments.budget)?;
    }
    print(&format!("report: {}", rendered.output.join(REPORT).display()));
    if !passes {
        eprintln!("error: agreement with the peer is not shown; the report says why");
        return Ok(ExitCode::FAILURE);
    }
    Ok(ExitCode::SUCCESS)
}

/// Lets the harness fit what is unknown on one photograph and predict another: it renders the
/// scenes itself, under each basis function of the lamp, with this program.
fn predict(case: &Case, cases: [&str; 2], arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let effort = &arguments.effort;
    let is_open = effort.time.is_some() || effort.error.is_some();
    if effort.resolution.is_some()
        || is_open
        || effort.integrator.is_some()
        || effort.seed != 0
        || effort.leaving != Leaving::all()
    {
        return Err(Error::new("a prediction takes --spp and --threads alone")
            .hint("leave --resolution, --error, --time, --integrator, --plan and --seed out")
            .into());
    }
    let photos = photographs::of_two(cases, &arguments.photo)?;
    let plan = project_root()?.join("reference").join(case.folder).join("cross.json");
    let spp = effort.spp.unwrap_or(case.samples_per_pixel).to_string();
    let mut words: Vec<OsString> = vec!["--plan".into(), plan.into()];
    words.extend(["--program".into(), std::env::current_exe()?.into(), "--spp".into(), spp.into()]);
    words.extend(effort.threads.iter().flat_map(|n| ["--threads".into(), n.to_string().into()]));
    if !photos.is_empty() {
        words.push("--photo".into());
        words.extend(photos.into_iter().map(OsString::from));
    }
    let output = arguments.folder();
    words.extend(["-o".into(), output.clone().into()]);
    environment(case)?.run_module("cross-predict", &words, None)?;
    print(&format!("report: {}", output.join(REPORT).display()));
    Ok(ExitCode::SUCCESS)
}

/// The band images, where the case needs them.
fn bands(case: &Case, arguments: &Arguments) -> Result<Option<PathBuf>> {
    match (&arguments.bands, case.against == Against::Bands) {
        (None, true) => Err(Error::new("the seven band images of Cornell's CCD are not part of this project")
            .hint("get box_exr.zip from the page Cornell Box Comparison, www.graphics.cornell.edu, and give it or its folder as --bands")),
        (Some(_), false) => {
            Err(Error::new(format!("the case {} has no bands", case.name)).hint("leave out --bands"))
        }
        (Some(bands), true) if !bands.exists() => {
            Err(Error::new("the band images cannot be found").hint("check the path").in_file(bands))
        }
        (bands, _) => Ok(bands.clone()),
    }
}

fn optional(option: &str, value: Option<&Path>) -> Vec<OsString> {
    value.map_or_else(Vec::new, |value| vec![option.into(), value.into()])
}

fn environment(case: &Case) -> Result<Environment> {
    Environment::prepare(if case.against == Against::Peer { &PEERS } else { &VALIDATION })
}

fn render(case: &Case, arguments: &Arguments) -> anyhow::Result<Rendered> {
    let folder = project_root()?.join("reference").join(case.folder);
    let output = arguments.folder();
    std::fs::create_dir_all(&output).map_err(|e| Error::io(&output, "make the folder", &e))?;
    // Before rendering: an environment that cannot be made should not cost a render.
    environment(case)?;
    let since = Stopwatch::start();
    let scene = Scene::load(&folder.join("scene.json"))?;
    let mut effort = arguments.effort.clone();
    effort.integrator.get_or_insert(Algorithm::Named(case.integrator));
    if case.against == Against::Peer {
        effort.resolution.get_or_insert(peers::RESOLUTION);
    }
    let view = effort.resize(scene.view()?);
    let (exr, png) = (output.join("render.exr"), output.join("render.png"));
    let spp = case.samples_per_pixel;
    let (effort, choice) = auto::settle(&scene, &view, &effort, spp, None)?;
    let files = Files { exr: &exr, png: Some(&png), layers: Layers::default(), since, keeping: None, choice };
    let facts = render_to_files(&scene, &view, &effort, spp, &files)?;
    let samples_per_pixel = facts.samples_per_pixel;
    print(&format!(
        "rendered {} with {samples_per_pixel} samples per pixel in {:.1} s",
        scene.name, facts.seconds
    ));
    Ok(Rendered { case: folder, output, exr, samples_per_pixel })
}

/// Lets the harness write the report; whether it comes to no verdict or to one that passes.
fn judge(case: &Case, rendered: &Rendered, more: Vec<OsString>) -> anyhow::Result<bool> {
    let mut words: Vec<OsString> =
        vec!["--case".into(), (&rendered.case).into(), "--render".into(), (&rendered.exr).into()];
    words.extend(["-o".into(), (&rendered.output).into()]);
    words.extend(more);
    let command = match case.against {
        Against::Photograph => "score",
        Against::Another(_) => "cross-predict",
        Against::Bands => "bands",
        Against::Exposure => "exposure",
        Against::Peer => "peers",
    };
    let environment = environment(case)?;
    if case.against == Against::Peer {
        return environment.judge_module(command, &words);
    }
    environment.run_module(command, &words, None).map(|()| true)
}
