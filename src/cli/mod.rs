//! Subcommands, one file each: arguments as typed, then as meant.

mod arguments;
mod auto;
mod check;
mod checkpoint;
mod compare;
mod converge;
mod develop;
mod error_words;
mod faults;
mod measure;
mod memory;
mod progress;
mod render;
mod replay;
mod schema;
mod spectra;
mod strategies;
mod validate;

pub use render::NothingFound;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Spectral, physically based rendering for measured validation.
#[derive(Debug, Parser)]
#[command(name = "etalon", version, about)]
struct Typed {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Render a scene to an EXR in absolute units, and develop it as a camera would
    Render(render::Arguments),
    /// Develop a render again, with another exposure or development
    Develop(develop::Arguments),
    /// Explain a scene without rendering: every quantity in SI and photometric units
    Check(check::Arguments),
    /// Read a scene's illuminance and luminance meters
    Measure(measure::Arguments),
    /// Compare two EXRs of one view, of this or any renderer: errors, tests, and whether they are equal
    Compare(compare::Arguments),
    /// Measure error against run time for several algorithms, or efficiency against an earlier program
    Converge(converge::Arguments),
    /// Take one sample again and print its path vertex by vertex
    Replay(replay::Arguments),
    /// Print the JSON Schema of the scene format
    Schema,
    /// List the built-in spectra, or describe and draw one
    Spectra(spectra::Arguments),
    /// Render a reference scene and score it against its photograph, or against a peer
    Validate(validate::Arguments),
}

/// Runs what the command line asks for.
pub fn run() -> anyhow::Result<ExitCode> {
    match Typed::parse().command {
        Command::Render(arguments) => render::run(&arguments),
        Command::Develop(arguments) => develop::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Measure(arguments) => measure::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Converge(arguments) => converge::run(&arguments),
        Command::Replay(arguments) => replay::run(&arguments),
        Command::Schema => schema::run(),
        Command::Spectra(arguments) => spectra::run(&arguments),
        Command::Validate(arguments) => validate::run(&arguments),
    }
}

/// Prints a line to standard output; a reader that has gone away ends the program quietly, a
/// full disk does not.
fn print(line: &str) {
    use std::io::{ErrorKind, Write as _};
    match writeln!(std::io::stdout(), "{line}") {
        Ok(()) => {}
        Err(error) if error.kind() == ErrorKind::BrokenPipe => std::process::exit(0),
        Err(error) => {
            notice(&format!("error: cannot write to standard output: {error}"));
            std::process::exit(1);
        }
    }
}

/// Prints a line to standard error, in the middle of work that it must not end: where it cannot
/// be written, nobody reads it.
fn notice(line: &str) {
    use std::io::Write as _;
    let _ = writeln!(std::io::stderr(), "{line}");
}
