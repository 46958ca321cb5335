//! `etalon validate`: reference scenes rendered and scored by the Python harness, one case or
//! all of them with an index page.

mod all;
mod cases;
mod growth;
mod idle;
mod one;
mod peers;
mod performance;
mod photographs;
mod self_test;

use super::arguments::Effort;
use cases::Case;
use clap::Args;
use etalon::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub struct Arguments {
    /// Case: cornell, yale-grey, yale-brown, stanford, stanford-left, schoedl (exposure alone), cornell-ccd
    /// (seven bands), yale-cross, stanford-cross (predicted from another photograph), peers (against
    /// Mitsuba 3), self-test (a synthetic photograph with a known answer), growth (cost against pixels,
    /// triangles, lamps, depth, channels and threads); or all but the last three
    case: String,
    /// The photograph; without it the region table measured on it is used. With all: CASE=FILE,
    /// as often as there are photographs
    #[arg(long, value_name = "[CASE=]FILE")]
    photo: Vec<String>,
    /// With all: a folder of photographs, each known by its SHA-256 or by its name, as in
    /// cornell.png
    #[arg(long, value_name = "DIR")]
    photos: Option<PathBuf>,
    /// The seven band images of cornell-ccd: the folder of 400nm.exr to 700nm.exr, or the archive
    #[arg(long, value_name = "DIR|ZIP")]
    bands: Option<PathBuf>,
    /// Vertices picked in the band images, which the pose of their camera is fitted to
    #[arg(long, value_name = "FILE.csv", requires = "bands")]
    points: Option<PathBuf>,
    /// Score a photograph even where its registration fails, and mark every figure
    #[arg(long)]
    force_registration: bool,
    /// With peers: CPU seconds at equal error beside every peer that is there, in one paired session
    /// over several scenes, instead of the comparison with Mitsuba on one
    #[arg(long)]
    performance: bool,
    /// With --performance: reference scenes that every peer can be given [default:
    /// cornell,schoedl-2007,slit-room]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', requires = "performance")]
    scenes: Vec<String>,
    /// With --performance: peers, as mitsuba [default: all that are there]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', requires = "performance")]
    peers: Vec<String>,
    /// With peers: seconds of all runs that show error against run time together, the two converged
    /// pictures apart [default: 180]; with --performance seconds of all of it on an idle machine
    /// [default: 1500]; with growth: CPU seconds of all runs [default: 1000]
    #[arg(long, value_name = "SECONDS", value_parser = budget)]
    budget: Option<f64>,
    /// With growth: take every point, 10 million triangles and 3840 x 2160 pixels among them
    #[arg(long)]
    full: bool,
    /// Folder for reports and images [default: out/validate-CASE]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    effort: Effort,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    if arguments.case == growth::NAME {
        return growth::run(arguments);
    }
    if arguments.full {
        return Err(Error::new("--full goes with growth").hint("leave it out").into());
    }
    if arguments.budget.is_some() && arguments.case != peers::NAME {
        return Err(Error::new("--budget goes with peers and growth").hint("leave it out").into());
    }
    if arguments.performance {
        return performance::run(arguments);
    }
    if arguments.case == self_test::NAME {
        return self_test::run(arguments);
    }
    if arguments.case == "all" {
        return all::run(arguments);
    }
    one::run(Case::named(&arguments.case)?, arguments)
}

/// Wall seconds.
fn budget(text: &str) -> Result<f64, String> {
    let seconds = text.parse::<f64>().ok().filter(|seconds| seconds.is_finite() && *seconds > 0.0);
    seconds.ok_or_else(|| "give a positive number of seconds, such as 180".to_owned())
}

impl Arguments {
    /// The folder that everything is written into.
    fn folder(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| PathBuf::from(format!("out/validate-{}", self.case)))
    }
}
