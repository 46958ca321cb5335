//! Disks that are full, and folders that go away.

use super::program::{begin_until, command, folder, render, said, write_scene};
use crate::record::Record;
use std::path::Path;
use std::process::{Command, Output};

/// Runs a render that cannot write more than so many blocks of 512 or 1024 bytes to any file: what
/// a full disk is to a program, without the rights to make one.
fn on_a_full_disk(blocks: u32, folder: &Path, options: &str) -> Output {
    let render = command(folder, "scene.json", "out.exr", options);
    let limit = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    let mut shell = Command::new("sh");
    shell.current_dir(folder).args(["-c", &limit]).arg(render.get_program()).args(render.get_args());
    shell.output().expect("a shell starts")
}

fn names(folder: &Path) -> String {
    let entries = std::fs::read_dir(folder).expect("it is there");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names.join(" ")
}

// Case 75.
pub fn a_full_disk_costs_nothing_that_was_saved(record: &mut Record) {
    let folder = folder("full-disk");
    write_scene(&folder);
    let outputs = "--png out.png --report out.json --checkpoint kept --resume";
    let options = format!("--spp 64 {outputs}");
    let first = render(&folder, "scene.json", "out.exr", &options);
    record.says("it renders", &said(&first), "kept: no checkpoint yet, the run begins");
    let files = ["out.exr", "out.png", "out.json", "kept"];
    let read = || files.map(|name| read_if(&folder, name));
    let (before, listed) = (read(), names(&folder));
    let unchanged = |record: &mut Record, what: &str| {
        record.holds(format!("{what}: every file is as before"), read() == before);
        record.exactly(format!("{what}: nothing is left over"), names(&folder), listed.clone());
    };
    // Not even the first few bytes of the picture.
    let full = on_a_full_disk(1, &folder, &options);
    record.says(
        "full at once",
        &said(&full),
        "error: out.exr: cannot write the picture: File too large; check",
    );
    record.says("full at once", &said(&full), "the render is kept in kept: repeat the command with --resume");
    record.exactly("full at once: exit code", format!("{:?}", full.status.code()), "Some(2)".to_owned());
    unchanged(record, "full at once");
    let again = render(&folder, "scene.json", "out.exr", &options);
    record.says("with room again", &said(&again), "kept: going on from 64 samples per pixel");
    std::fs::remove_file(folder.join("kept")).expect("it is there");
    // Another picture, of some 25 kB, for which there is room, but not for its checkpoint of 180 kB.
    let half = on_a_full_disk(100, &folder, "--integrator mlt --spp 8 --checkpoint kept");
    record.says(
        "no room for the checkpoint",
        &said(&half),
        "warning: kept: cannot write the checkpoint: File too large",
    );
    record.exactly(
        "no room for the checkpoint: exit code",
        format!("{:?}", half.status.code()),
        "Some(0)".to_owned(),
    );
    record
        .holds("no room for the checkpoint: the picture is there", read_if(&folder, "out.exr") != before[0]);
    record.note("A limit on the size of files stands for a disk that fills up within a file: tests may not mount one.");
}

fn read_if(folder: &Path, name: &str) -> Option<Vec<u8>> {
    std::fs::read(folder.join(name)).ok()
}

// Case 75.
pub fn a_picture_that_cannot_be_written_is_not_lost(record: &mut Record) {
    let folder = folder("lost-folder");
    write_scene(&folder);
    let pictures = folder.join("pictures");
    std::fs::create_dir(&pictures).expect("the folder is ours");
    let options = "--spp 1500 --checkpoint kept";
    let often = format!("{options} --checkpoint-interval 0");
    let child = begin_until(&folder, "scene.json", "pictures/out.exr", &often, "kept");
    std::fs::remove_dir_all(&pictures).expect("it is there");
    let output = child.wait_with_output().expect("it ends");
    let message = said(&output);
    record.says(
        "its folder is gone",
        &message,
        "error: pictures/out.exr: cannot write the picture: No such file",
    );
    record.says(
        "its folder is gone",
        &message,
        "the render is kept in kept: repeat the command with --resume",
    );
    std::fs::create_dir(&pictures).expect("the folder is ours");
    let again = render(&folder, "scene.json", "pictures/out.exr", &format!("{options} --resume"));
    record.says("its folder is back", &said(&again), "kept: going on from 1500 samples per pixel");
    record.holds("the picture is there", pictures.join("out.exr").is_file());
}
