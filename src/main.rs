//! The program `etalon`: prints errors and picks exit codes; the work is in `cli`.
//!
//! Exit codes: 0 done, 1 something failed, 2 something that the user gave is wrong, 3 the
//! picture would miss light, has samples that were not finite or shows radiance that has no finite
//! value, and `--strict` was asked for, or two pictures compare otherwise than `--require` asks,
//! 4 no light was found where there may be some.

mod cli;

use etalon::error::Error;
use std::process::ExitCode;

fn main() -> ExitCode {
    match cli::run() {
        Ok(code) => code,
        Err(error) if error.is::<Error>() => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
        Err(error) if error.is::<cli::NothingFound>() => {
            eprintln!("error: {error}");
            ExitCode::from(4)
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
