//! Every reader takes every input that its fuzz target has kept, and every finding, as the
//! fuzz targets do; no tool is needed beside the ordinary one.

#[path = "../fuzz/src/lib.rs"]
mod readers;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A hang, for an input of a few kilobytes.
const HANG: Duration = Duration::from_secs(1);

fn feed(target: &str, ending: &str, read: fn(&[u8])) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let seeds = root.join("fuzz/seeds").join(target);
    let fixtures = files(&root.join("tests/files"));
    let fixtures = fixtures.into_iter().filter(|file| file.extension().is_some_and(|e| e == ending));
    let inputs: Vec<PathBuf> = files(&seeds).into_iter().chain(fixtures).collect();
    assert!(inputs.len() > 1, "{} inputs of {target}", inputs.len());
    for input in inputs {
        let bytes = std::fs::read(&input).unwrap_or_else(|e| panic!("{}: {e}", input.display()));
        let started = Instant::now();
        let read = std::panic::catch_unwind(|| read(&bytes));
        assert!(read.is_ok(), "{} makes the reader panic", input.display());
        let elapsed = started.elapsed();
        assert!(elapsed < HANG, "{} takes {elapsed:?}", input.display());
    }
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    entries.map(|entry| entry.expect("readable").path()).collect()
}

#[test]
fn scenes() {
    feed("scene", "json", readers::scene);
}

#[test]
fn ply_meshes() {
    feed("ply", "ply", readers::ply);
}

#[test]
fn obj_meshes() {
    feed("obj", "obj", readers::obj);
}

#[test]
fn tables() {
    feed("csv", "csv", readers::csv);
}

#[test]
fn pictures() {
    feed("exr", "exr", readers::exr);
}

#[test]
fn checkpoints() {
    feed("checkpoint", "checkpoint", readers::checkpoint::read);
}
