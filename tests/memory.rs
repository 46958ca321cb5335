//! What a render holds at most grows with its picture, not with the samples that are taken nor with
//! the threads that take them.

mod common;

use common::program::{etalon, folder, json_file};
use std::path::Path;

/// Difference that is let pass between peaks of the same picture: what the allocator keeps for each
/// thread is not exact.
const LIKE: f64 = 0.05;

/// Bytes that a render of the Cornell box holds at most, by its own report.
fn peak(folder: &Path, options: &str) -> f64 {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/cornell/scene.json");
    let (picture, report) = (folder.join("out.exr"), folder.join("out.json"));
    let fixed = ["render".as_ref(), scene.as_os_str(), "-o".as_ref(), picture.as_os_str()];
    let report_to = ["--report".as_ref(), report.as_os_str()];
    let run = etalon(fixed.into_iter().chain(report_to).chain(options.split_whitespace().map(AsRef::as_ref)));
    assert_eq!(run.code, 0, "{}", run.err);
    json_file(&report)["memory"]["peak_resident_bytes"].as_f64().expect("Linux tells")
}

/// From 512 samples per pixel on, the batches that tell how sure an error is are as many as they get:
/// what comes after leaves nothing. Of 24 x 16 pixels, 1920 more are 740 thousand: a byte left by each
/// of them would be more than 5 % of some 12 MB. Of chains, what they leave between two looks at the
/// film grows up to a fixed number of mutations, of which so small a picture takes too few to tell.
#[test]
#[cfg(target_os = "linux")]
fn memory_does_not_grow_with_samples() {
    let folder = folder("memory-samples");
    for integrator in ["path", "bdpt"] {
        let at = |spp: u32| {
            let options = "--resolution 24x16 --threads 2";
            peak(&folder, &format!("--integrator {integrator} {options} --spp {spp}"))
        };
        let [few, many] = [512, 2432].map(at);
        assert!(many <= few * (1.0 + LIKE), "{integrator}: {few} bytes with 512 spp, {many} with 2432");
    }
}

/// Splats wait until the rows before theirs have come. With one thread none wait; eight may hold
/// eight rows each, of 1536: next to nothing of what half of the picture would be.
#[test]
#[cfg(target_os = "linux")]
fn memory_hardly_grows_with_threads() {
    let folder = folder("memory-threads");
    let at = |threads: u32| {
        peak(&folder, &format!("--integrator bdpt --resolution 16x1536 --spp 16 --threads {threads}"))
    };
    let [one, eight] = [1, 8].map(at);
    // A thread itself has a stack of which it touches little, and an arena of the allocator.
    const PER_THREAD: f64 = 256.0 * 1024.0;
    assert!(eight <= one * (1.0 + LIKE) + 7.0 * PER_THREAD, "{one} bytes by one thread, {eight} by eight");
}

/// What is reported is what the process held: a picture of a million more pixels is in it.
#[test]
#[cfg(target_os = "linux")]
fn memory_grows_with_the_picture() {
    let folder = folder("memory-pixels");
    let at = |size: &str| peak(&folder, &format!("--integrator path --resolution {size} --spp 1"));
    let [small, large] = ["32x24", "1024x512"].map(at);
    // Sums and squares of X, Y and Z at each pixel more.
    let film = f64::from(1024 * 512 - 32 * 24) * 3.0 * 16.0;
    assert!(large - small >= film, "{small} bytes, then {large}; the film alone takes {film}");
}
