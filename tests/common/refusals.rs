//! Faulty scenes as the program answers them.

use std::path::Path;
use std::process::Command;

/// What `etalon check` says about a scene: exit code, standard output, standard error.
pub fn check(name: &str, scene: &str) -> (Option<i32>, String, String) {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.json"));
    std::fs::write(&file, scene).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    let mut program = Command::new(env!("CARGO_BIN_EXE_etalon"));
    let output = program.arg("check").arg(&file).output().expect("the program starts");
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

/// The place that an error must name: file, line and column of the first `part` of a scene.
pub fn place(name: &str, scene: &str, part: &str) -> String {
    let at = scene.find(part).unwrap_or_else(|| panic!("no {part} in {scene}"));
    let line = scene[..at].matches('\n').count() + 1;
    let column = scene[..at].rsplit('\n').next().map_or(0, |text| text.chars().count()) + 1;
    format!("{name}.json:{line}:{column}")
}
