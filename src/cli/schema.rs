//! `etalon schema`: the JSON Schema of the scene format.

use etalon::scene::file::SceneFile;
use std::process::ExitCode;

pub fn run() -> anyhow::Result<ExitCode> {
    let schema = schemars::schema_for!(SceneFile);
    super::print(&serde_json::to_string_pretty(&schema)?);
    Ok(ExitCode::SUCCESS)
}
