//! `etalon validate`: a reference scene rendered and scored by the Python harness.

use super::arguments::Effort;
use super::print;
use super::render::render_to_files;
use super::self_test;
use clap::Args;
use etalon::error::Error;
use etalon::image::Layers;
use etalon::python::{Environment, PEERS, VALIDATION, project_root};
use etalon::scene::Scene;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// A case that can be named, its folder in `reference/`, and samples per pixel that keep it
/// under two minutes on two cores.
const CASES: [(&str, &str, u64); 5] = [
    ("cornell", "cornell-photo", 512),
    ("yale-grey", "yale-grey", 512),
    ("yale-brown", "yale-brown", 512),
    ("stanford", "stanford", 512),
    ("peers", "cornell", 8192),
];

/// Size of the picture that is compared with a peer: 8x8 blocks are averaged.
const PEERS_RESOLUTION: [u32; 2] = [128, 128];

#[derive(Debug, Args)]
pub struct Arguments {
    /// Case: cornell, yale-grey, yale-brown, stanford, peers (against Mitsuba 3), or self-test (a
    /// synthetic photograph with a known answer)
    case: String,
    /// The photograph; without it the region table measured on it is used
    #[arg(long, value_name = "FILE")]
    photo: Option<PathBuf>,
    /// Folder for the report and the images [default: out/validate-CASE]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    effort: Effort,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    if arguments.case == self_test::NAME {
        return self_test::run(arguments.photo.as_deref(), arguments.output.as_deref(), &arguments.effort);
    }
    let names = || CASES.iter().map(|(name, ..)| *name).chain([self_test::NAME]);
    let (name, folder, spp) = CASES
        .into_iter()
        .find(|(name, ..)| *name == arguments.case)
        .ok_or_else(|| Error::unknown_name("case", &arguments.case, names()))?;
    let is_peers = name == "peers";
    if let Some(photo) = arguments.photo.as_ref().filter(|photo| !photo.is_file()) {
        return Err(Error::new("the photograph cannot be found")
            .hint("check the path")
            .in_file(photo)
            .into());
    }
    arguments.effort.start_threads()?;
    let case = project_root()?.join("reference").join(folder);
    let output = arguments.output.clone().unwrap_or_else(|| PathBuf::from(format!("out/validate-{name}")));
    std::fs::create_dir_all(&output).map_err(|e| Error::io(&output, "make the folder", &e))?;
    let environment = Environment::prepare(if is_peers { &PEERS } else { &VALIDATION })?;

    let scene = Scene::load(&case.join("scene.json"))?;
    let mut effort = arguments.effort.clone();
    if is_peers && effort.resolution.is_none() {
        effort.resolution = Some(PEERS_RESOLUTION);
    }
    let view = effort.resize(scene.view()?);
    let exr = output.join("render.exr");
    let png = output.join("render.png");
    let facts = render_to_files(&scene, &view, &effort, spp, Layers::default(), &exr, Some(&png))?;
    print(&format!(
        "rendered {} with {} samples per pixel in {:.1} s",
        scene.name, facts.samples_per_pixel, facts.seconds
    ));

    let mut words: Vec<&OsStr> =
        vec!["--case".as_ref(), case.as_os_str(), "--render".as_ref(), exr.as_os_str()];
    if let Some(photo) = &arguments.photo {
        words.extend([OsStr::new("--photo"), photo.as_os_str()]);
    }
    words.extend([OsStr::new("-o"), output.as_os_str()]);
    let as_many = facts.samples_per_pixel.to_string();
    let spectra = project_root()?.join("spectra");
    if is_peers {
        words.extend([
            OsStr::new("--spp"),
            OsStr::new(&as_many),
            OsStr::new("--spectra"),
            spectra.as_os_str(),
        ]);
    }
    environment.run_module(if is_peers { "peers" } else { "score" }, &words, None)?;
    announce(&output, is_peers);
    Ok(ExitCode::SUCCESS)
}

fn announce(output: &Path, is_peers: bool) {
    let report = output.join(if is_peers { "peers.json" } else { "report.html" });
    print(&format!("report: {}", report.display()));
}
