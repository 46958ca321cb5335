//! Lists the tables of `spectra/` for the program to carry, hashes what it is built from (a
//! checkpoint is gone on with by the same program alone), and finds out which commit that is:
//! from git in a working copy, from what `cargo package` has written down in a published one;
//! elsewhere none is known, and the build goes on without.

use std::fmt::Write as _;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

fn main() {
    let root = PathBuf::from(env::var("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    if let Some(commit) = commit_of_working_copy(&root).or_else(|| commit_of_package(&root)) {
        println!("cargo::rustc-env=ETALON_COMMIT={commit}");
    }
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

/// The commit that is checked out, with `-changed` where sources differ from it; `None` outside
/// the project's own repository, such as in a copy within another one.
fn commit_of_working_copy(root: &Path) -> Option<String> {
    /// All that the program is made of.
    const SOURCES: [&str; 5] = ["src", "spectra", "build.rs", "Cargo.toml", "Cargo.lock"];
    let top = git(root, &["rev-parse", "--show-toplevel"])?;
    if fs::canonicalize(top).ok()? != fs::canonicalize(root).ok()? {
        return None;
    }
    // The log of HEAD grows with every commit and checkout.
    for file in ["logs/HEAD", "HEAD"] {
        let path = root.join(git(root, &["rev-parse", "--git-path", file])?);
        if path.exists() {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    SOURCES.iter().for_each(|source| println!("cargo::rerun-if-changed={}", root.join(source).display()));
    let commit = git(root, &["rev-parse", "HEAD"])?;
    let mut status = vec!["status", "--porcelain", "--"];
    status.extend(SOURCES);
    let changed = !git(root, &status)?.is_empty();
    Some(if changed { commit + "-changed" } else { commit })
}

fn git(root: &Path, arguments: &[&str]) -> Option<String> {
    // Looking must not refresh the index while another program works on it.
    let output =
        Command::new("git").args(arguments).current_dir(root).env("GIT_OPTIONAL_LOCKS", "0").output();
    let output = output.ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}

/// The commit that a package was made from, out of the file that `cargo package` adds to it.
fn commit_of_package(root: &Path) -> Option<String> {
    let file = root.join(".cargo_vcs_info.json");
    let text = fs::read_to_string(file).ok()?;
    let (_, rest) = text.split_once("\"sha1\"")?;
    let commit = rest.split('"').nth(1)?;
    let changed = text.contains("\"dirty\": true");
    let is_hash = commit.len() >= 40 && commit.chars().all(|c| c.is_ascii_hexdigit());
    is_hash.then(|| if changed { format!("{commit}-changed") } else { commit.to_owned() })
}
