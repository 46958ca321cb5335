//! What `--integrator auto` would pick for a scene, as JSON, without rendering it:
//! `cargo run --release --example auto -- SCENE.json SECONDS [SEED]`.

use etalon::error::{Error, Result};
use etalon::integrator::Budget;
use etalon::pilot::choose;
use etalon::scene::{Leaving, Scene};
use std::path::Path;
use std::time::Duration;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let usage = || Error::new("a scene file and a number of seconds are needed").hint("auto SCENE.json 60");
    let [file, seconds, ..] = arguments.as_slice() else { return Err(usage()) };
    let seconds = seconds.parse().ok().and_then(|s| Duration::try_from_secs_f64(s).ok()).ok_or_else(usage)?;
    let seed = arguments.get(2).and_then(|seed| seed.parse().ok()).unwrap_or(0);
    let scene = Scene::load(Path::new(file))?;
    let budget = Budget { samples_per_pixel: u64::MAX, time: Some(seconds), error: None, seed };
    let choice = choose(&scene, scene.view()?, &budget, None, &Leaving::all());
    eprintln!("{}", choice.report);
    println!("{}", serde_json::to_string_pretty(&choice.report).map_err(|e| Error::new(e.to_string()))?);
    Ok(())
}
