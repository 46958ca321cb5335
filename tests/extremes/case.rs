//! A case as the groups list it, and the trials made of it.

use crate::page::Page;
use crate::record::{Effort, Record};
use libtest_mimic::{Failed, Trial};

/// A group of the catalogue.
pub struct Group {
    /// As in the names of trials.
    pub name: &'static str,
    /// As in the page.
    pub title: &'static str,
    pub cases: &'static [Case],
}

/// One case.
pub struct Case {
    /// Its number in the catalogue.
    pub number: u32,
    /// What it protects, as the name of its function.
    pub name: &'static str,
    /// Whether it draws random numbers, so that it is worth repeating with others.
    pub is_statistical: bool,
    pub run: fn(&mut Record),
}

/// The list of a group's cases: `fixed 3 => name_of_a_function`, or `statistical` where random
/// numbers are drawn.
#[macro_export]
macro_rules! cases {
    (@fixed) => { false };
    (@statistical) => { true };
    ($($kind:ident $number:literal => $run:ident),* $(,)?) => {
        &[$($crate::case::Case {
            number: $number,
            name: stringify!($run),
            is_statistical: $crate::cases!(@$kind),
            run: $run,
        }),*]
    };
}

/// The trials of a group: every case once, statistical ones also as `nightly::…`, which
/// only run when they are asked for.
pub fn trials(group: &'static Group, page: &Page) -> Vec<Trial> {
    let mut trials = Vec::new();
    for case in group.cases {
        let title = format!("{}::{:02}_{}", group.name, case.number, case.name);
        let entries = page.clone();
        trials.push(Trial::test(title.clone(), move || {
            let mut record = Record::new(Effort::Fixed);
            (case.run)(&mut record);
            let verdict = verdict(&record);
            entries.add(group, case, record);
            verdict
        }));
        if case.is_statistical {
            let nightly = move || {
                let mut record = Record::new(Effort::Nightly);
                (case.run)(&mut record);
                verdict(&record).map_err(|failed| {
                    let text = failed.message().unwrap_or_default().to_owned();
                    Failed::from(format!("{text}\nrepeat with ETALON_SEED={}", record.seed()))
                })
            };
            trials.push(Trial::test(format!("nightly::{title}"), nightly).with_ignored_flag(true));
        }
    }
    trials
}

fn verdict(record: &Record) -> Result<(), Failed> {
    let misses = record.misses();
    if record.is_empty() {
        return Err("the case measures nothing".into());
    }
    if misses.is_empty() { Ok(()) } else { Err(misses.join("\n").into()) }
}
