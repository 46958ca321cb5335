//! Stiff and extreme cases: each has a number in the catalogue, a test, and a line of
//! `validation/extremes.md` that says what was expected and what was measured.
//!
//! Cases run with fixed seeds. The statistical ones run again under `--ignored`, with fresh
//! seeds and larger samples; `ETALON_SEED` repeats such a run. With `ETALON_EXTREMES_PAGE=FILE`
//! the page is written anew from what this run measures.

mod accumulation;
mod bidirectional;
mod case;
#[path = "../common/mod.rs"]
mod common;
mod dispersion;
mod files;
mod interfaces;
mod metropolis;
mod microfacets;
mod page;
mod paths;
mod record;
mod scale;
mod spectra;

use case::{Case, Group, trials};
use libtest_mimic::{Arguments, Trial};
use page::Page;
use std::process::ExitCode;

/// Cases of the catalogue, numbered from one.
const CATALOGUE: u32 = 81;

/// The groups of the catalogue, in its order.
const GROUPS: [Group; 10] = [
    Group { name: "spectra", title: "Spectra", cases: spectra::CASES },
    Group { name: "dispersion", title: "Dispersion", cases: dispersion::CASES },
    Group { name: "interfaces", title: "Interfaces", cases: interfaces::CASES },
    Group { name: "microfacets", title: "Microfacets", cases: microfacets::CASES },
    Group { name: "paths", title: "Long and short paths", cases: paths::CASES },
    Group { name: "scale", title: "Scale and geometry", cases: scale::CASES },
    Group { name: "bidirectional", title: "Bidirectional strategies", cases: bidirectional::CASES },
    Group { name: "metropolis", title: "Metropolis", cases: metropolis::CASES },
    Group { name: "accumulation", title: "Accumulation, threads, resuming", cases: accumulation::CASES },
    Group { name: "files", title: "Output and input", cases: files::CASES },
];

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let page = Page::default();
    let mut all: Vec<Trial> = GROUPS.iter().flat_map(|group| trials(group, &page)).collect();
    all.push(Trial::test("every_case_of_the_catalogue_has_a_test", || {
        let missing: Vec<u32> =
            (1..=CATALOGUE).filter(|number| !all_cases().any(|c| c.number == *number)).collect();
        if missing.is_empty() { Ok(()) } else { Err(format!("no test for {missing:?}").into()) }
    }));
    all.push(Trial::test("the_page_names_every_case", page::names_every_case));
    let conclusion = libtest_mimic::run(&arguments, all);
    let failed = conclusion.has_failed();
    match page.write() {
        Ok(()) if !failed => ExitCode::SUCCESS,
        Ok(()) => conclusion.exit_code(),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// The cases of all groups.
fn all_cases() -> impl Iterator<Item = &'static Case> {
    GROUPS.iter().flat_map(|group| group.cases)
}
