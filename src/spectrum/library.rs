//! The tables of `spectra/`, built into the program so that it runs from any folder.
//!
//! A new spectrum is a new file there and no code.

use super::csv::CsvTable;
use super::curve::{Curve, Outside, Table};
use super::index::RefractiveIndex;
use super::lamp::{LampSpectrum, Line};
use crate::error::{Error, Result};

include!(concat!(env!("OUT_DIR"), "/spectra.rs"));

/// A built-in table.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The name that scenes use: the file's stem.
    pub name: &'static str,
    /// The folder: illuminant, reflectance, glass …
    pub kind: &'static str,
    /// The file's text.
    text: &'static str,
}

impl Entry {
    /// The file's text.
    pub const fn text(&self) -> &'static str {
        self.text
    }

    /// The parsed table.
    pub fn table(&self) -> CsvTable {
        CsvTable::parse(self.text).expect("the test below reads every built-in table")
    }
}

/// All built-in tables, in order of kind and name.
pub fn entries() -> impl Iterator<Item = Entry> {
    BUILT_IN.iter().map(|&(kind, name, text)| Entry { name, kind, text })
}

/// The built-in table of a name.
pub fn table(name: &str) -> Result<CsvTable> {
    entries()
        .find(|entry| entry.name == name)
        .map(|entry| entry.table())
        .ok_or_else(|| Error::unknown_name("spectrum", name, entries().map(|e| e.name)))
}

/// What a curve is needed for; it decides what holds outside a table's range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A reflectance or transmission: its end values are held.
    Reflectance,
    /// An emission or sensitivity: zero outside.
    Emission,
}

impl Purpose {
    const fn outside(self) -> Outside {
        match self {
            Self::Reflectance => Outside::Hold,
            Self::Emission => Outside::Zero,
        }
    }
}

/// One column of a table as a curve.
pub fn curve(table: &CsvTable, column: Option<&str>, purpose: Purpose) -> Result<Curve> {
    let others = || table.columns.iter().skip(1).map(String::as_str);
    let name = match column {
        Some(name) => name,
        None if table.columns.len() == 2 => table.columns[1].as_str(),
        None => {
            return Err(Error::new("the table has more than one curve")
                .hint(format!("name a column: {}", others().collect::<Vec<_>>().join(", "))));
        }
    };
    let values = table.column(name).ok_or_else(|| Error::unknown_name("column", name, others()))?;
    Ok(Curve::Table(Table::new(table.wavelengths_nm()?, values, purpose.outside())?))
}

/// A table as light: spectral lines where its quantity is `lines`, else a column as a curve.
pub fn light(table: &CsvTable, column: Option<&str>, purpose: Purpose) -> Result<LampSpectrum> {
    if table.facts.get("quantity").is_none_or(|quantity| quantity != "lines") {
        return curve(table, column, purpose).map(LampSpectrum::from);
    }
    let power = table.column("power").ok_or_else(|| {
        Error::new("the table of lines has no column \"power\"").hint("name the columns wavelength_nm,power")
    })?;
    let lines = table.wavelengths_nm()?.into_iter().zip(power).map(|(nm, power)| Line { nm, power });
    // The table has rows and columns; the fault's place among the lines says nothing there.
    LampSpectrum::new(Curve::Constant(0.0), lines.collect()).map_err(|e| Error { pointer: None, ..e })
}

/// A refractive index from a table with a column `n`, or of Sellmeier coefficients.
pub fn refractive_index(table: &CsvTable) -> Result<RefractiveIndex> {
    if table.columns == ["b", "c_um2"] {
        let range = table.facts.get("range_nm").and_then(|text| {
            let (first, last) = text.split_once('-')?;
            Some((first.trim().parse().ok()?, last.trim().parse().ok()?))
        });
        let range_nm = range.ok_or_else(|| {
            Error::new("Sellmeier coefficients without a range")
                .hint("add a line such as \"# range_nm: 310-2500\" above the header row")
        })?;
        return Ok(RefractiveIndex::Sellmeier {
            terms: table.rows.iter().map(|r| [r[0], r[1]]).collect(),
            range_nm,
        });
    }
    match table.column("n") {
        Some(n) => Ok(RefractiveIndex::Table(Table::new(table.wavelengths_nm()?, n, Outside::Hold)?)),
        None => Err(Error::new("this spectrum is not a refractive index")
            .hint("an index table has a column n, or columns b and c_um2 for Sellmeier's formula")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_table_can_be_read_and_says_where_it_comes_from() {
        for entry in entries() {
            let table = CsvTable::parse(entry.text).unwrap_or_else(|e| panic!("{}: {e}", entry.name));
            for fact in ["title", "quantity", "source"] {
                assert!(table.facts.contains_key(fact), "{}: no # {fact}", entry.name);
            }
            if table.columns != ["b", "c_um2"] {
                table.wavelengths_nm().unwrap_or_else(|e| panic!("{}: {e}", entry.name));
            }
        }
    }

    #[test]
    fn names_are_unique() {
        let mut names: Vec<_> = entries().map(|e| e.name).collect();
        names.sort_unstable();
        let count = names.len();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
