//! `validation/extremes.md`: what the cases expect and measure, as a page.

use crate::case::{Case, Group};
use crate::record::{Line, Record};
use crate::{CATALOGUE, GROUPS, all_cases};
use libtest_mimic::Failed;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::{Arc, Mutex};

/// Where the page is to be written, if at all.
const WANTED: &str = "ETALON_EXTREMES_PAGE";

/// The page in the repository.
const COMMITTED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/validation/extremes.md");

type Entry = (&'static Group, &'static Case, Record);

/// What the cases of this run have left.
#[derive(Clone, Default)]
pub struct Page {
    entries: Arc<Mutex<Vec<Entry>>>,
}

impl Page {
    /// Adds what a case has left.
    pub fn add(&self, group: &'static Group, case: &'static Case, record: Record) {
        self.entries.lock().expect("no thread panics while it adds").push((group, case, record));
    }

    /// Writes the page where it is asked for; all cases must have run.
    pub fn write(&self) -> Result<(), String> {
        let Ok(file) = std::env::var(WANTED) else { return Ok(()) };
        let mut entries = self.entries.lock().map_err(|_| "a case panicked".to_owned())?;
        let expected = all_cases().count();
        if entries.len() != expected {
            return Err(format!("{WANTED}: {} of {expected} cases ran; run all of them", entries.len()));
        }
        entries.sort_by_key(|(_, case, _)| (case.number, case.name));
        std::fs::write(&file, text(&entries)).map_err(|error| format!("{file}: {error}"))
    }
}

const HEAD: &str = "# Stiff and extreme cases

What breaks spectral, bidirectional and Metropolis renderers, what is right, and what Etalon
does. The page is written by the tests themselves, with the figures that they measured:

```sh
ETALON_EXTREMES_PAGE=validation/extremes.md cargo test --release --test extremes
```

*Used* is the share of the allowed deviation that was used; 100 % is the limit, and a test fails
beyond it. Statistical cases run with a fixed seed; with fresh seeds and 16 times the samples they
run by `cargo test --release --test extremes -- --ignored` (`ETALON_SEED=N` repeats a run).
A comparison within five standard errors gives a false alarm once in 1.7 million.
";

fn text(entries: &[Entry]) -> String {
    let mut text = HEAD.to_owned();
    let lines = entries.iter().map(|(_, _, record)| record.lines.len()).sum::<usize>();
    let numbers = (1..=CATALOGUE).filter(|n| entries.iter().any(|(_, case, _)| case.number == *n)).count();
    let _ = writeln!(text, "\n{numbers} cases, {} tests, {lines} quantities.", entries.len());
    summary(&mut text, entries);
    for group in &GROUPS {
        let _ = writeln!(text, "\n## {}", group.title);
        for (_, case, record) in entries.iter().filter(|(of, ..)| of.name == group.name) {
            entry(&mut text, case, record);
        }
    }
    text
}

/// Group by group, how near to its limit the nearest quantity came.
fn summary(text: &mut String, entries: &[Entry]) {
    let _ =
        writeln!(text, "\n| group | tests | quantities | with a bound | most of a bound used | by case |");
    let _ = writeln!(text, "|---|---|---|---|---|---|");
    for group in &GROUPS {
        let of_group = || entries.iter().filter(|(of, ..)| of.name == group.name);
        let lines =
            || of_group().flat_map(|(_, case, record)| record.lines.iter().map(move |line| (case, line)));
        let used = || lines().filter_map(|(case, line)| Some((line.used?, case.number)));
        let (most, number) = used().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default();
        let counts = [of_group().count(), lines().count(), used().count()];
        let [tests, quantities, bounded] = counts.map(|count| count.to_string());
        let cells = [
            group.title,
            &tests,
            &quantities,
            &bounded,
            &format!("{:.0} %", 100.0 * most),
            &number.to_string(),
        ];
        let _ = writeln!(text, "| {} |", cells.join(" | "));
    }
}

fn entry(text: &mut String, case: &Case, record: &Record) {
    let _ = writeln!(text, "\n### {}. {}\n", case.number, sentence(case));
    for note in &record.notes {
        let _ = writeln!(text, "{note}\n");
    }
    let _ = writeln!(text, "| quantity | expected | measured | bound | used |\n|---|---|---|---|---|");
    for Line { what, expected, measured, bound, used, holds } in &record.lines {
        let used = match (used, holds) {
            (_, false) => "**missed**".to_owned(),
            (Some(used), _) => format!("{:.0} %", 100.0 * used),
            (None, _) => String::new(),
        };
        let cells =
            [what, expected, measured, bound, &used].map(|cell| cell.replace('|', "\\|").replace('\n', " "));
        let _ = writeln!(text, "| {} |", cells.join(" | "));
    }
}

/// Words that a name in Rust cannot spell.
const SPELLINGS: [(&str, &str); 11] = [
    ("another run s", "another run's"),
    ("brewsters", "Brewster's"),
    ("boltzmann", "Boltzmann"),
    ("d65", "D65"),
    ("iso", "ISO"),
    ("jeans", "Jeans"),
    ("nan", "NaN"),
    ("planckian", "Planckian"),
    ("rayleigh", "Rayleigh"),
    ("rgb", "RGB"),
    ("stefan", "Stefan"),
];

/// The name of a case as a sentence.
fn sentence(case: &Case) -> String {
    let words = format!(" {} ", case.name.replace('_', " "));
    let words = SPELLINGS
        .iter()
        .fold(words, |words, (plain, right)| words.replace(&format!(" {plain} "), &format!(" {right} ")));
    let mut letters = words.trim().chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The page in the repository has every case; its figures are those of its last writing.
pub fn names_every_case() -> Result<(), Failed> {
    if std::env::var_os(WANTED).is_some() {
        return Ok(()); // it is just being written
    }
    let page =
        std::fs::read_to_string(Path::new(COMMITTED)).map_err(|error| format!("{COMMITTED}: {error}"))?;
    let missing = all_cases()
        .map(|case| format!("### {}. {}\n", case.number, sentence(case)))
        .find(|title| !page.contains(title));
    match missing {
        Some(title) => {
            Err(format!("validation/extremes.md lacks {title:?}; write it anew as its head says").into())
        }
        None if page.contains("**missed**") => Err("validation/extremes.md shows a missed case".into()),
        None => Ok(()),
    }
}
