//! Which photograph belongs to which case: named on the command line, or found in a folder.

use super::cases::{Against, CASES, Case};
use etalon::error::{Error, Result};
use etalon::python::{Environment, project_root};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Photographs by the names of their cases.
pub type Photographs = BTreeMap<String, PathBuf>;

/// The case, where one is named, and the file of a `--photo` argument.
///
/// A file name may hold a `=`: only what stands before the first one and is the name of a case
/// names a case.
fn split(argument: &str) -> (Option<&str>, &Path) {
    match argument.split_once('=') {
        Some((name, file)) if Case::named(name).is_ok() => (Some(name), Path::new(file)),
        _ => (None, Path::new(argument)),
    }
}

/// The file, if there is one of that name.
fn existing(file: &Path) -> Result<PathBuf> {
    if file.is_file() {
        return Ok(file.to_owned());
    }
    Err(Error::new("the photograph cannot be found").hint("check the path").in_file(file))
}

/// Refuses a photograph of a case that has none.
fn expects_one(case: &Case) -> Result<()> {
    if case.against == Against::Photograph {
        return Ok(());
    }
    Err(Error::new(format!("the case {} is not held against a photograph", case.name))
        .hint("leave out --photo"))
}

/// The photograph of a single case.
pub fn of_one(case: &Case, arguments: &[String]) -> Result<Option<PathBuf>> {
    let [argument] = arguments else {
        return match arguments {
            [] => Ok(None),
            _ => Err(Error::new("a case has one photograph").hint("give --photo once")),
        };
    };
    expects_one(case)?;
    match split(argument) {
        (Some(name), _) if name != case.name => {
            Err(Error::new(format!("--photo names the case {name}, and {} is validated", case.name))
                .hint("give the photograph of this case"))
        }
        (_, file) => Ok(Some(existing(file)?)),
    }
}

/// Both photographs of a prediction, in the order of its cases, or none.
pub fn of_two(cases: [&str; 2], arguments: &[String]) -> Result<Vec<PathBuf>> {
    if arguments.is_empty() {
        return Ok(Vec::new());
    }
    let mut found = named(arguments)?;
    let both: Vec<PathBuf> = cases.iter().filter_map(|case| found.remove(*case)).collect();
    if both.len() == 2 && found.is_empty() {
        return Ok(both);
    }
    Err(Error::new(format!("a prediction needs the photographs of {} and {}", cases[0], cases[1]))
        .hint(format!("give --photo {}=FILE and --photo {}=FILE, or neither", cases[0], cases[1])))
}

/// The photographs named as `CASE=FILE`.
pub fn named(arguments: &[String]) -> Result<Photographs> {
    let mut found = Photographs::new();
    for argument in arguments {
        let (Some(name), file) = split(argument) else {
            let known: Vec<&str> =
                CASES.iter().filter(|c| c.against == Against::Photograph).map(|c| c.name).collect();
            return Err(Error::new(format!("--photo {argument} names no case"))
                .hint(format!("write CASE=FILE with one of {}", known.join(", "))));
        };
        expects_one(Case::named(name)?)?;
        if found.insert(name.to_owned(), existing(file)?).is_some() {
            return Err(Error::new(format!("two photographs of the case {name}")).hint("give one"));
        }
    }
    Ok(found)
}

/// The arguments that hand a case its photographs.
pub fn words(case: &Case, photos: &Photographs) -> Vec<OsString> {
    match case.against {
        Against::Another(cases) if cases.iter().all(|name| photos.contains_key(*name)) => cases
            .iter()
            .flat_map(|name| {
                let mut pair = OsString::from(format!("{name}="));
                pair.push(&photos[*name]);
                ["--photo".into(), pair]
            })
            .collect(),
        _ => photos.get(case.name).map_or_else(Vec::new, |file| vec!["--photo".into(), file.into()]),
    }
}

/// The photographs that a folder holds, known by SHA-256 or by name.
pub fn in_folder(folder: &Path, environment: &Environment) -> anyhow::Result<Photographs> {
    let reference = project_root()?.join("reference");
    let mut words: Vec<OsString> = vec!["--photos".into(), folder.into()];
    for case in CASES.iter().filter(|case| case.against == Against::Photograph) {
        let mut pair = OsString::from(format!("{}=", case.name));
        pair.push(reference.join(case.folder));
        words.extend(["--case".into(), pair]);
    }
    let answer = environment.ask_module("find-photographs", &words)?;
    Ok(serde_json::from_str(&answer)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_case_before_the_sign_is_a_case() {
        assert_eq!(split("cornell=a.png"), (Some("cornell"), Path::new("a.png")));
        assert_eq!(split("a=b.png"), (None, Path::new("a=b.png")));
        assert_eq!(split("yale-grey=a=b.exr"), (Some("yale-grey"), Path::new("a=b.exr")));
    }
}
