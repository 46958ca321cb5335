//! Runs that are killed and go on, and checkpoints that they must not go on from.

use super::program::{begin_until, folder, kill, picture, render, said, write, write_scene};
use crate::record::Record;
use etalon::image::checkpoint;
use std::path::Path;

const KEPT: &str = "--checkpoint kept --checkpoint-interval 0";

/// Begins a run, kills it after some blocks, and leaves its checkpoint.
fn interrupt(record: &mut Record, folder: &Path, options: &str) {
    let child = begin_until(folder, "scene.json", "out.exr", &format!("{options} {KEPT}"), "kept");
    record.holds(format!("{options}: killed on its way"), kill(child));
    record.holds(format!("{options}: no picture yet"), !folder.join("out.exr").exists());
}

// Case 75.
pub fn a_killed_run_goes_on_to_the_same_bits(record: &mut Record) {
    for (integrator, spp) in [("path", 1500), ("light", 1000), ("bdpt", 500), ("mlt", 500)] {
        let folder = folder(&format!("resume-{integrator}"));
        write_scene(&folder);
        let options =
            format!("--integrator {integrator} --spp {spp} --seed {} --spectral-layers 3", record.seed());
        interrupt(record, &folder, &options);
        let bytes = std::fs::read(folder.join("kept")).expect("the checkpoint is there");
        let at_kill = checkpoint::read(&bytes).expect("it is whole").state;
        let resumed = render(&folder, "scene.json", "out.exr", &format!("{options} {KEPT} --resume"));
        record.says(format!("{integrator}: resumed"), &said(&resumed), "kept: going on from ");
        render(&folder, "scene.json", "straight.exr", &options);
        compare(record, integrator, &folder);
        let (_, facts) = picture(&folder.join("out.exr"));
        record.exactly(
            format!("{integrator}: samples per pixel"),
            facts["samples_per_pixel"].to_string(),
            spp.to_string(),
        );
        record.exactly(format!("{integrator}: parts"), facts["parts"].to_string(), "2".to_owned());
        let (before, all) = (at_kill.spent(), |key: &str| facts[key].as_f64().unwrap_or(f64::NAN));
        record.holds(format!("{integrator}: there were samples before"), at_kill.samples_per_pixel() > 0);
        record.holds(format!("{integrator}: seconds add"), all("seconds") > before.rendering.wall_s);
        let cpu_seconds = before.cpu_seconds.unwrap_or(f64::NAN);
        record.holds(format!("{integrator}: processor seconds add"), all("cpu_seconds") > cpu_seconds);
        // Asked once more, the run has nothing to do but to write its picture again.
        std::fs::remove_file(folder.join("out.exr")).expect("it is there");
        let again = render(&folder, "scene.json", "out.exr", &format!("{options} {KEPT} --resume"));
        let end = format!("going on from {spp} samples per pixel");
        record.says(format!("{integrator}: kept to the end"), &said(&again), &end);
        compare(record, integrator, &folder);
    }
    record.note(
        "Only times, what follows from them and the number of parts differ in the facts; blocks that were \
         not yet kept when the run was killed are taken again.",
    );
}

/// That a resumed picture has every bit of the one that was not interrupted, and its facts but
/// for time.
fn compare(record: &mut Record, integrator: &str, folder: &Path) {
    let [(resumed, mut facts), (straight, mut straight_facts)] =
        ["out.exr", "straight.exr"].map(|name| picture(&folder.join(name)));
    record.exactly(format!("{integrator}: channels"), resumed.len(), straight.len());
    let pairs = straight.iter().flat_map(|(name, values)| values.iter().zip(&resumed[name]));
    let differing = pairs.filter(|(a, b)| a != b).count();
    record.exactly(format!("{integrator}: values that differ"), differing, 0);
    for facts in [&mut facts, &mut straight_facts] {
        for of_time in ["seconds", "cpu_seconds", "parts", "times", "memory"] {
            facts[of_time].take();
        }
        facts["error"]["seconds_to"].take();
    }
    record.holds(format!("{integrator}: the facts are the same but for time"), facts == straight_facts);
}

// Case 75.
pub fn a_damaged_checkpoint_is_refused(record: &mut Record) {
    let folder = folder("damaged");
    write_scene(&folder);
    let options = "--integrator mlt --spp 32 --resolution 4x3";
    render(&folder, "scene.json", "out.exr", &format!("{options} {KEPT}"));
    let whole = std::fs::read(folder.join("kept")).expect("the checkpoint is there");
    record.holds("the whole file can be read", checkpoint::read(&whole).is_ok());
    let is_refused = |bytes: &[u8]| checkpoint::read(bytes).is_err();
    let short = (0..whole.len()).filter(|length| is_refused(&whole[..*length])).count();
    record.exactly("shorter files that are refused", short, whole.len());
    let flipped = (0..whole.len()).filter(|place| {
        let mut bytes = whole.clone();
        bytes[*place] ^= 1 << (place % 8);
        is_refused(&bytes)
    });
    record.exactly("files with one bit changed that are refused", flipped.count(), whole.len());
    // Content that claims more than there is, under a checksum that is right.
    let content = &whole[12..whole.len() - 12];
    let forged = (0..content.len()).filter(|place| {
        let mut bytes = content.to_vec();
        bytes.truncate(*place);
        bytes.extend([0xff; 9]);
        checkpoint::decode(&bytes).is_err()
    });
    record.exactly("contents of false lengths that are refused", forged.count(), content.len());
    for (name, bytes, what) in [
        ("cut short", &whole[..whole.len() / 2], "the checkpoint is cut short"),
        ("empty", &[][..], "it is no checkpoint; name another file"),
        ("a picture", b"v/1\x01 and so on", "it is no checkpoint; name another file"),
        ("changed", &changed(&whole), "the checkpoint has changed since it was written"),
    ] {
        std::fs::write(folder.join("kept"), bytes).expect("the folder is ours");
        let refused = render(&folder, "scene.json", "out.exr", &format!("{options} {KEPT} --resume"));
        record.says(name, &said(&refused), &format!("error: kept: {what}"));
        record.exactly(
            format!("{name}: exit code"),
            format!("{:?}", refused.status.code()),
            "Some(2)".to_owned(),
        );
    }
}

fn changed(whole: &[u8]) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    bytes[whole.len() / 2] ^= 0x10;
    bytes
}

// Case 75.
pub fn another_run_s_checkpoint_is_refused(record: &mut Record) {
    let folder = folder("another-run");
    write_scene(&folder);
    let options = "--integrator bdpt --spp 4 --seed 7 --resolution 8x6";
    let render = |options: &str| render(&folder, "scene.json", "out.exr", &format!("{options} {KEPT}"));
    let first = render(options);
    record.exactly("it renders", said(&first), String::new());
    let mut refuse = |what: &str, options: &str, part: &str| {
        let refused = render(options);
        record.says(what, &said(&refused), part);
        record.exactly(
            format!("{what}: exit code"),
            format!("{:?}", refused.status.code()),
            "Some(2)".to_owned(),
        );
    };
    refuse("no --resume", options, "there is a checkpoint already; add --resume to go on from it");
    for (from, to, part) in [
        ("--seed 7", "--seed 8", "seed 7 and 8"),
        ("--spp 4", "--spp 5", "samples per pixel 4 and 5"),
        ("--spp 4", "--spp 4 --error 1%", "error to be reached none and 0.01"),
        ("--spp 4", "--time 1", "time in seconds none and 1"),
        ("bdpt", "path", "integrator bdpt and path"),
        ("8x6", "6x8", "resolution 8x6 and 6x8"),
        ("--seed 7", "--seed 7 --spectral-layers 2", "channels 3 and 5"),
    ] {
        refuse(to, &format!("{} --resume", options.replace(from, to)), part);
    }
    let again = format!("{options} --resume");
    for name in ["scene.json", "grey.csv", "wall.obj"] {
        let file = folder.join(name);
        let text = std::fs::read_to_string(&file).expect("it is there");
        let change = match name {
            "scene.json" => text.replace("0.01", "0.02"),
            "grey.csv" => text.replace("0.6", "0.7"),
            _ => text.replace("v 2 2 2", "v 2 2.5 2"),
        };
        write(&folder, name, &change);
        refuse(&format!("{name} has changed"), &again, "of another run (there and here: scene \"lit wall\"");
        write(&folder, name, &text);
    }
    let accepted = render(&again);
    record.says("nothing has changed", &said(&accepted), "kept: going on from 4 samples per pixel");
}
