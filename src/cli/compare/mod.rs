//! `etalon compare`: whether two pictures of one view are the same, and how far they are apart.
//!
//! It ends with code 0 whatever the verdict is, for a difference is a finding, not a failure;
//! scripts say what they need with `--require`, and get 3 where it is not so.

mod pictures;
mod report;

use super::arguments::error as share;
use clap::{Args, ValueEnum};
use etalon::image::write_z_map;
use etalon::statistics::{Comparison, MARGIN, Outcome, Subject};
use pictures::Pair;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub struct Arguments {
    /// EXR with channels X, Y, Z, or linear R, G, B, or Y
    a: PathBuf,
    /// EXR that it is compared with: the reference of relative measures
    b: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Relative difference of the means that counts as none, as 0.002 or 0.2%
    #[arg(long, value_name = "E", value_parser = share, default_value_t = MARGIN)]
    margin: f64,
    /// cd/m2 of the value one in A, where its file does not say; goes before what it says
    #[arg(long, value_name = "CD_M2", value_parser = super::develop::positive)]
    scale_a: Option<f64>,
    /// cd/m2 of the value one in B, where its file does not say; goes before what it says
    #[arg(long, value_name = "CD_M2", value_parser = super::develop::positive)]
    scale_b: Option<f64>,
    /// Compare luminances, or only how light is distributed: A is scaled to the mean of B
    #[arg(long, value_name = "UNITS", default_value = "absolute")]
    units: Units,
    /// Layer of A, where it has several pictures
    #[arg(long, value_name = "NAME")]
    layer_a: Option<String>,
    /// Layer of B, where it has several pictures
    #[arg(long, value_name = "NAME")]
    layer_b: Option<String>,
    /// Write the difference in standard errors of every pixel: blue where A is darker, red where it
    /// is brighter, grey where nothing can be said
    #[arg(long, value_name = "OUT.png")]
    map: Option<PathBuf>,
    /// End with code 3 unless the verdict is this
    #[arg(long, value_name = "VERDICT")]
    require: Option<Requirement>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Units {
    /// cd/m2
    Absolute,
    /// Of any unit
    Relative,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Requirement {
    /// Equal within the margin
    Equal,
    /// Equal or undecided
    NotDifferent,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    if let Some(map) = &arguments.map {
        super::render::check_output(map, &["png"], "the map is a PNG")?;
    }
    let pair = Pair::read(arguments)?;
    let subject = match arguments.units {
        Units::Absolute => Subject::Levels,
        Units::Relative => Subject::Shape,
    };
    let [a, b] = &pair.estimates;
    let comparison = Comparison::of(a, b, pair.size, &pair.counted, arguments.margin, subject);
    if let Some(map) = &arguments.map {
        write_z_map(map, pair.size, &comparison.z)?;
    }
    let report = report::Report::of(&pair, &comparison, arguments.margin, subject);
    let text = if arguments.json { report.json() } else { report.text(&comparison) };
    super::print(&text);
    let is_met = match arguments.require {
        None => true,
        Some(Requirement::Equal) => comparison.outcome == Outcome::Equal,
        Some(Requirement::NotDifferent) => comparison.outcome != Outcome::Different,
    };
    if !is_met {
        super::notice(&format!("error: the pictures are {}, and --require was given", report.verdict()));
        return Ok(ExitCode::from(3));
    }
    Ok(ExitCode::SUCCESS)
}
