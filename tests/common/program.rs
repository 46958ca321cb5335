//! The program as a user runs it: for what only its messages, files and exit codes show.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// What a run has left.
pub struct Ran {
    /// Exit code.
    pub code: i32,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// Runs the program in the project's folder.
pub fn etalon<S: AsRef<std::ffi::OsStr>>(arguments: impl IntoIterator<Item = S>) -> Ran {
    let started = Instant::now();
    let mut command = Command::new(env!("CARGO_BIN_EXE_etalon"));
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(arguments);
    let output = command.output().expect("the program starts");
    let text = |bytes| String::from_utf8(bytes).expect("the program writes UTF-8");
    let code = output.status.code().expect("the program exits by itself");
    let seconds = started.elapsed().as_secs_f64();
    Ran { code, out: text(output.stdout), err: text(output.stderr), seconds }
}

/// Renders a scene with options; its picture is `out.exr` in the folder, its report `out.json`.
pub fn render(scene: &Value, folder: &Path, options: &str) -> Ran {
    let file = scene_file(folder, scene);
    let (picture, report) = (folder.join("out.exr"), folder.join("out.json"));
    let fixed = ["render".as_ref(), file.as_os_str(), "-o".as_ref(), picture.as_os_str()];
    let report = ["--report".as_ref(), report.as_os_str()];
    etalon(fixed.into_iter().chain(report).chain(options.split_whitespace().map(AsRef::as_ref)))
}

/// An empty folder for one test.
pub fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    folder
}

/// A scene as a file in a folder.
pub fn scene_file(folder: &Path, scene: &Value) -> PathBuf {
    let file = folder.join("scene.json");
    std::fs::write(&file, scene.to_string()).expect("the folder can be written to");
    file
}

/// A JSON file that the program has written.
pub fn json_file(file: &Path) -> Value {
    let text = std::fs::read_to_string(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", file.display()))
}
