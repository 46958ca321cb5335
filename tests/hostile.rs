//! Files that are made to cost more than they are worth: each is refused in one line, within a
//! second, in an address space that has room for little more than the program.
#![cfg(target_os = "linux")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A fault in a small file is reported within this time.
const PROMPT: Duration = Duration::from_secs(1);

/// Address space of the program and its threads' stacks and arenas, without any file, in KiB.
const PROGRAM_KIB: u64 = 600 << 10;

/// Bytes that may be held for each byte of a file.
const MOST_PER_BYTE: u64 = 64;

/// An empty folder for one test.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("hostile-{test}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    folder
}

/// Runs `etalon` with two threads in an address space of so many KiB.
fn within(kib: u64, arguments: &[&str]) -> Output {
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!("ulimit -v {kib}; exec \"$0\" \"$@\""), env!("CARGO_BIN_EXE_etalon")]);
    shell.args(arguments).env("RAYON_NUM_THREADS", "2").stdin(Stdio::null());
    shell.output().expect("the program starts")
}

/// What `etalon check` says of a scene that it must refuse, having held no more than its files
/// allow.
fn refused(scene: &Path, bytes: u64) -> String {
    let scene = scene.to_str().expect("UTF-8");
    let started = Instant::now();
    let output = within(PROGRAM_KIB + MOST_PER_BYTE * bytes / 1024, &["check", scene]);
    let elapsed = started.elapsed();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{message:.500}");
    assert!(message.starts_with("error: ") && message.matches('\n').count() == 1, "{message:.500}");
    assert!(message.len() < 2000, "{} bytes: {message:.200}", message.len());
    assert!(elapsed < PROMPT || bytes > 1 << 20, "{elapsed:?}: {message:.200}");
    message
}

const CAMERA_AND_LAMP: &str = r#""camera": {"position": [0, 1, -5], "look_at": [0, 1, 0], "up": [0, 1, 0],
  "focal_length_mm": 50, "sensor_mm": [36, 24], "resolution": [36, 24], "f_stop": 8, "shutter_s": 0.01, "iso": 100}"#;

/// A scene with the given entries beside its name, material and camera.
fn scene(folder: &Path, entries: &str) -> (PathBuf, u64) {
    let text = format!(
        "{{\"name\": \"hostile\", \"length_unit\": \"m\",\n\"materials\": {{\"white\": {{\"lambertian\": \
         {{\"reflectance\": 0.5}}}}}},\n{entries},\n{CAMERA_AND_LAMP}}}"
    );
    let file = folder.join("scene.json");
    std::fs::write(&file, &text).expect("written");
    (file, text.len() as u64)
}

fn object(shape: &str) -> String {
    format!(r#""objects": [{{"shape": {shape}, "material": "white"}}]"#)
}

/// A scene that names a mesh, and what is said of it.
fn refused_mesh(test: &str, kind: &str, mesh: &[u8]) -> String {
    let folder = folder(test);
    std::fs::write(folder.join("mesh"), mesh).expect("written");
    let (file, bytes) = scene(&folder, &object(&format!(r#"{{"{kind}": {{"file": "mesh"}}}}"#)));
    refused(&file, bytes + mesh.len() as u64)
}

fn ply_header(vertices: &str, faces: &str, list: &str) -> String {
    format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
         property float z\nelement face {faces}\nproperty list {list} vertex_indices\nend_header\n"
    )
}

/// Without this, the other tests here would show nothing.
#[test]
fn the_address_space_is_enough_for_a_sound_scene_and_little_else() {
    let sound = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/files/sound.json");
    assert_eq!(within(PROGRAM_KIB, &["check", sound]).status.code(), Some(0));
    assert_ne!(within(PROGRAM_KIB / 100, &["check", sound]).status.code(), Some(0));
}

#[test]
fn brackets_by_the_hundred_thousand_exhaust_no_stack() {
    for open in ["[", "{\"a\":"] {
        let folder = folder("brackets");
        let (file, bytes) = scene(&folder, &format!("\"objects\": {}", open.repeat(100_000)));
        refused(&file, bytes);
        let (file, bytes) = scene(&folder, &format!("\"name2\": 1, \"objects\": {}", open.repeat(100_000)));
        refused(&file, bytes);
    }
    let nested = "{\"scaled\": {\"factor\": 1, \"spectrum\": ".repeat(100_000);
    let (file, bytes) = scene(&folder("spectra"), &format!("\"spectra\": {{\"grey\": {nested}"));
    assert!(refused(&file, bytes).contains("127 deep"));
}

#[test]
fn a_word_of_a_million_letters_is_shortened_in_the_message() {
    let word = "é".repeat(1_000_000);
    let folder = folder("word");
    let (file, bytes) = scene(&folder, &format!("\"{word}\": 1"));
    assert!(refused(&file, bytes).contains(" … "));
    let spectra = format!(
        "\"spectra\": {{\"{word}\": 0.5, \"b\": {{\"scaled\": {{\"spectrum\": \"{word}a\", \"factor\": 1}}}}}}"
    );
    let (file, bytes) = scene(&folder, &spectra);
    assert!(refused(&file, bytes).contains("unknown spectrum"));
    assert!(refused_mesh("obj-word", "obj", format!("v 0 0 {word}\n").as_bytes()).contains("mesh:1:7 "));
}

#[test]
fn long_names_are_not_multiplied_by_what_stands_under_them() {
    let lines: Vec<String> = (0..20_000)
        .map(|i| format!("{{\"wavelength_nm\": {}, \"power\": 1}}", 400.0 + f64::from(i) / 100.0))
        .collect();
    let spectrum = format!("{{\"lines\": {{\"lines\": [{}]}}}}", lines.join(","));
    let (file, bytes) =
        scene(&folder("names"), &format!("\"spectra\": {{\"{}\": {spectrum}}}", "n".repeat(500_000)));
    assert!(refused(&file, bytes).contains("20000 lines, more than 10000"));
}

#[test]
fn counts_that_are_announced_cost_nothing() {
    let header = ply_header("4000000000", "1", "uchar int");
    assert!(refused_mesh("ply-vertices", "ply", header.as_bytes()).contains("4000000000 items"));
    let body = [0_u8; 36];
    let with = |header: String, rest: &[u8]| [header.as_bytes(), &body, rest].concat();
    let faces = with(ply_header("3", "4000000000", "uchar int"), &[0; 64]);
    assert!(refused_mesh("ply-faces", "ply", &faces).contains("4000000000 items"));
    let list = with(ply_header("3", "1", "uint int"), &[255; 16]);
    assert!(refused_mesh("ply-list", "ply", &list).contains("the file ends within an item"));
    let obj = b"v 0 0 0\nf 1 4294967297 9223372036854775807\n";
    assert!(refused_mesh("obj-index", "obj", obj).contains("mesh:2:5 "));
}

#[test]
fn elements_that_carry_no_mesh_are_not_kept() {
    let mut mesh =
        b"ply\nformat binary_little_endian 1.0\nelement point 4000000\nproperty uchar a\nend_header\n"
            .to_vec();
    mesh.resize(mesh.len() + 4_000_000, 1);
    assert!(refused_mesh("ply-points", "ply", &mesh).contains("holds no face"));
}

#[test]
fn lines_of_a_million_characters_are_read_or_refused() {
    let folder = folder("lines");
    let spectrum = r#""spectra": {"grey": {"csv": {"file": "table.csv"}}}"#;
    for (table, says) in [
        (format!("wavelength_nm,value\n400,{}\n", "9".repeat(1_000_000)), "is not a finite number"),
        (format!("wavelength_nm{}\n", ",a".repeat(500_000)), "two columns are called"),
        (format!("wavelength_nm,value\n400{}\n", ",1".repeat(500_000)), "the row has 500001 cells"),
    ] {
        std::fs::write(folder.join("table.csv"), &table).expect("written");
        let (file, bytes) = scene(&folder, spectrum);
        let message = refused(&file, bytes + table.len() as u64);
        assert!(message.contains(says), "{message}");
    }
    let polygon = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf{} 4\n", " 1".repeat(500_000));
    assert!(refused_mesh("polygon", "obj", polygon.as_bytes()).contains("names vertex 4"));
}

/// Files without blocks on the disk stand for files of gigabytes.
#[test]
fn files_of_gigabytes_are_refused_unread() {
    let folder = folder("gigabytes");
    let sparse = |name: &str, bytes: u64| {
        let file = std::fs::File::create(folder.join(name)).expect("made");
        file.set_len(bytes).expect("a file may have holes");
    };
    sparse("table.csv", 1 << 30);
    sparse("mesh.ply", 5 << 30);
    let (file, bytes) = scene(&folder, r#""spectra": {"grey": {"csv": {"file": "table.csv"}}}"#);
    assert!(refused(&file, bytes).contains("it has 1024 MiB, more than 16"));
    let (file, bytes) = scene(&folder, &object(r#"{"ply": {"file": "mesh.ply"}}"#));
    assert!(refused(&file, bytes).contains("it has 5120 MiB, more than 4096"));
    sparse("scene.json", 1 << 30);
    assert!(refused(&folder.join("scene.json"), 0).contains("move meshes into PLY files"));
}

#[test]
fn pipes_are_not_waited_for_where_a_scene_names_them() {
    let folder = folder("pipe");
    let made = Command::new("mkfifo").arg(folder.join("mesh")).status().expect("mkfifo is there");
    assert!(made.success());
    let (file, bytes) = scene(&folder, &object(r#"{"obj": {"file": "mesh"}}"#));
    assert!(refused(&file, bytes).contains("it is a device, not a file"));
}

#[test]
fn a_scene_may_come_through_a_pipe() {
    let sound = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/files/sound.json");
    let line = format!("cat {sound} | {} check /dev/stdin", env!("CARGO_BIN_EXE_etalon"));
    let output = Command::new("sh").args(["-c", &line]).output().expect("the shell runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn byte_order_marks_and_line_ends_of_other_systems_are_taken() {
    let folder = folder("systems");
    std::fs::write(folder.join("table.csv"), "\u{feff}wavelength_nm,value\r\n400,0.4\r\n700,0.5\r\n")
        .expect("written");
    std::fs::write(
        folder.join("mesh"),
        "\u{feff}v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nvn 0 0 2\r\nf 1//1 2//1 3//1\r\n",
    )
    .expect("written");
    let entries = format!(
        "\"spectra\": {{\"grey\": {{\"csv\": {{\"file\": \"table.csv\"}}}}}}, {}",
        object(r#"{"obj": {"file": "mesh"}}"#)
    );
    let (file, _) = scene(&folder, &entries);
    let text = std::fs::read_to_string(&file).expect("just written").replace('\n', "\r\n");
    std::fs::write(&file, format!("\u{feff}{text}")).expect("written");
    let output = within(PROGRAM_KIB, &["check", file.to_str().expect("UTF-8")]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(
        said.contains("3 of 3 normals of object 0 are not of unit length; their directions are taken"),
        "{said}"
    );
}

#[test]
fn a_picture_whose_header_announces_more_than_it_holds_is_refused() {
    let folder = folder("exr");
    let render = folder.join("out.exr");
    let sound = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/files/sound.json");
    let output = render.to_str().expect("UTF-8");
    assert!(within(PROGRAM_KIB, &["render", sound, "--spp", "64", "-o", output]).status.success());
    let mut bytes = std::fs::read(&render).expect("rendered");
    // Behind the attribute's name, type and size: four numbers of 32 bits, the last pixel included.
    let name = b"dataWindow\0box2i\0\x10\0\0\0";
    let place =
        name.len() + bytes.windows(name.len()).position(|part| part == name).expect("there is a data window");
    let huge: Vec<u8> = [0_i32, 0, 35, 1_000_000_000].iter().flat_map(|n| n.to_le_bytes()).collect();
    bytes[place..place + 16].copy_from_slice(&huge);
    std::fs::write(&render, &bytes).expect("written");
    let png = folder.join("out.png");
    let developed = within(PROGRAM_KIB, &["develop", output, "-o", png.to_str().expect("UTF-8")]);
    let message = String::from_utf8_lossy(&developed.stderr);
    assert_eq!(developed.status.code(), Some(2), "{message}");
    assert!(message.matches('\n').count() == 1 && message.contains("out.exr: "), "{message}");
}

#[test]
fn a_picture_that_no_machine_holds_is_refused_before_it_is_begun() {
    let folder = folder("picture");
    let (file, _) = scene(&folder, r#""objects": []"#);
    let out = folder.join("out.exr");
    let [file, out] = [&file, &out].map(|path| path.to_str().expect("UTF-8"));
    let size = ["--resolution", "16384x16384", "--spectral-layers", "470", "--spp", "1"];
    let words = [&["render", file, "-o", out], &size[..]].concat();
    let started = Instant::now();
    let output = within(PROGRAM_KIB, &words);
    assert!(started.elapsed() < PROMPT);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    let last = message.lines().last().unwrap_or_default();
    assert!(last.starts_with("error: a film of 16384 x 16384 pixels with 473 channels takes "), "{message}");
}
