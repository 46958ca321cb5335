//! The program as it is run, its end, and what it leaves.

use exr::prelude::{FlatSamples, ReadChannels as _, ReadLayers as _};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Longer than any step of a test takes, on whatever machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// An empty folder for one case.
pub fn folder(case: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("extremes-{case}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    folder
}

/// A render of a scene into a file, with options in one line, in a folder that what they name is
/// in.
pub fn command(folder: &Path, scene: &str, output: &str, options: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_etalon"));
    command.current_dir(folder).args(["render", scene, "-o", output]).args(options.split_whitespace());
    command
}

/// Runs such a render to its end.
pub fn render(folder: &Path, scene: &str, output: &str, options: &str) -> Output {
    command(folder, scene, output, options).output().expect("the program starts")
}

/// What a run said on standard error.
pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Begins such a render and waits until it has written a file for the second time.
pub fn begin_until(folder: &Path, scene: &str, output: &str, options: &str, file: &str) -> Child {
    let mut command = command(folder, scene, output, options);
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program starts");
    let file = folder.join(file);
    let written = || file.metadata().ok().and_then(|found| found.modified().ok());
    let first = wait(written);
    wait(|| written().filter(|latest| *latest > first));
    child
}

fn wait<T>(mut found: impl FnMut() -> Option<T>) -> T {
    let started = Instant::now();
    loop {
        match found() {
            Some(found) => return found,
            None => assert!(started.elapsed() < PATIENCE, "nothing comes"),
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Kills a run as nothing can be prepared for; whether it was still on its way.
pub fn kill(mut child: Child) -> bool {
    child.kill().expect("the system lets go of it");
    let status = child.wait().expect("it ends");
    status.code().is_none()
}

/// The samples of an EXR by channel, as bits, and its facts.
pub fn picture(file: &Path) -> (BTreeMap<String, Vec<u32>>, Value) {
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level();
    let image = reader.all_channels().first_valid_layer().all_attributes().from_file(file);
    let image = image.unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let samples = image.layer_data.channel_data.list.iter().map(|channel| {
        let FlatSamples::F32(values) = &channel.sample_data else {
            panic!("{} has not 32 bits", channel.name)
        };
        (channel.name.to_string(), values.iter().map(|value| value.to_bits()).collect())
    });
    let facts = &image.layer_data.attributes.other[&exr::prelude::Text::from("etalon")];
    let exr::prelude::AttributeValue::Text(facts) = facts else { panic!("the facts are a text") };
    (samples.collect(), serde_json::from_str(&facts.to_string()).expect("the facts are JSON"))
}

/// Copies the scene that the cases render, with a mesh and a table of its own.
pub fn write_scene(folder: &Path) {
    let scene = serde_json::json!({
        "name": "lit wall", "length_unit": "m",
        "spectra": { "grey": { "csv": { "file": "grey.csv" } } },
        "materials": { "grey": { "lambertian": { "reflectance": "grey" } },
            "glass": { "dielectric": { "index": 1.5 } } },
        "objects": [
            { "shape": { "obj": { "file": "wall.obj" } }, "material": "grey" },
            { "shape": { "sphere": { "center": [0.2, 0.1, 1.2], "radius": 0.3 } }, "material": "glass" },
            { "shape": { "sphere": { "center": [0, 1.2, 1], "radius": 0.1 } }, "material": "grey",
              "emission": { "spectrum": "d65", "level": { "flux_lm": 400 } } },
        ],
        "camera": { "position": [0, 0, 0], "look_at": [0, 0, 1], "up": [0, 1, 0], "focal_length_mm": 36,
            "sensor_mm": [36, 27], "resolution": [32, 24], "iso": 100, "shutter_s": 0.01, "f_stop": 8 },
    });
    write(folder, "scene.json", &format!("{scene:#}\n"));
    write(folder, "grey.csv", "wavelength_nm,value\n360,0.5\n830,0.6\n");
    write(folder, "wall.obj", "v -2 -2 2\nv -2 2 2\nv 2 2 2\nv 2 -2 2\nf 1 2 3 4\n");
}

/// Writes a text into a folder.
pub fn write(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).expect("the folder is ours");
}
