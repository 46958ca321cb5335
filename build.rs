//! Lists the tables of `spectra/` for the program to carry, and hashes what it is built from: a
//! checkpoint is gone on with by the same program alone.

use std::fmt::Write as _;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    let root = PathBuf::from(env::var("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let spectra = root.join("spectra");
    println!("cargo::rerun-if-changed={}", spectra.display());
    let mut hash = DefaultHasher::new();
    for part in ["Cargo.lock", "src", "spectra"] {
        println!("cargo::rerun-if-changed={}", root.join(part).display());
        hash_all(&root.join(part), &mut hash);
    }
    println!("cargo::rustc-env=ETALON_SOURCES={:016x}", hash.finish());
    let mut list = String::from("static BUILT_IN: &[(&str, &str, &str)] = &[\n");
    for folder in sorted(&spectra).iter().filter(|p| p.is_dir()) {
        println!("cargo::rerun-if-changed={}", folder.display());
        for file in sorted(folder).iter().filter(|p| p.extension().is_some_and(|e| e == "csv")) {
            let (kind, name) = (stem(folder), stem(file));
            writeln!(list, "    ({kind:?}, {name:?}, include_str!({:?})),", file.display().to_string())
                .expect("writing to a string cannot fail");
        }
    }
    list.push_str("];\n");
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets it")).join("spectra.rs");
    fs::write(out, list).expect("the build folder can be written");
}

/// Adds a file, or all files below a folder, by name and content.
fn hash_all(path: &Path, hash: &mut DefaultHasher) {
    if path.is_dir() {
        sorted(path).iter().for_each(|path| hash_all(path, hash));
    } else if let Ok(content) = fs::read(path) {
        (path.file_name(), content).hash(hash);
    }
}

fn sorted(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    paths
}

fn stem(path: &Path) -> String {
    path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default()
}
