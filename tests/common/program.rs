//! The program as a user meets it.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What a run of the program left.
pub struct Run {
    /// Exit code.
    pub code: Option<i32>,
    /// Standard output.
    pub output: String,
    /// Standard error.
    pub errors: String,
}

/// Runs the program in the project's folder.
pub fn run<S: AsRef<std::ffi::OsStr>>(arguments: impl IntoIterator<Item = S>) -> Run {
    let mut command = Command::new(env!("CARGO_BIN_EXE_etalon"));
    let output = command.current_dir(env!("CARGO_MANIFEST_DIR")).args(arguments).output();
    let output = output.expect("the program starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("the program writes UTF-8");
    Run { code: output.status.code(), output: text(output.stdout), errors: text(output.stderr) }
}

/// An empty folder of a name.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    folder
}

/// Renders a scene with options; its picture is `out.exr` in the folder, its report `out.json`.
pub fn render(scene: &Value, folder: &Path, options: &str) -> Run {
    let file = folder.join("scene.json");
    std::fs::write(&file, scene.to_string()).expect("written");
    let (picture, report) = (folder.join("out.exr"), folder.join("out.json"));
    let fixed = ["render".as_ref(), file.as_os_str(), "-o".as_ref(), picture.as_os_str()];
    let report = ["--report".as_ref(), report.as_os_str()];
    run(fixed.into_iter().chain(report).chain(options.split_whitespace().map(AsRef::as_ref)))
}
