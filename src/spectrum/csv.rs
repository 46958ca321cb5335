//! Curve tables as text: `# key: value` lines, one header row, then numbers.
//!
//! The built-in tables of `spectra/` and the tables that a scene names have the same form.
//! A fault gives line and column; nothing is guessed or repaired.

use crate::error::{Error, Result};
use std::collections::BTreeMap;
use std::path::Path;

/// A table of numbers with named columns and what is known about it.
#[derive(Clone, Debug)]
pub struct CsvTable {
    /// The `# key: value` lines: title, quantity, unit, source, conditions.
    pub facts: BTreeMap<String, String>,
    /// Column names of the header row.
    pub columns: Vec<String>,
    /// Row by row, each as long as `columns`; all finite.
    pub rows: Vec<Vec<f64>>,
    /// The line that each row stands in, from 1.
    lines: Vec<usize>,
}

/// More rows than any measured curve has; a longer file is something else.
const MOST_ROWS: usize = 100_000;

impl CsvTable {
    /// Reads a table from a file.
    pub fn read(file: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(file).map_err(|e| Error::io(file, "read the table", &e))?;
        Self::parse(&text).map_err(|e| e.in_file(file))
    }

    /// Reads a table from text; errors carry line and column.
    pub fn parse(text: &str) -> Result<Self> {
        let mut table =
            Self { facts: BTreeMap::new(), columns: Vec::new(), rows: Vec::new(), lines: Vec::new() };
        for (index, line) in text.lines().enumerate() {
            let line_number = index + 1;
            if let Some(comment) = line.trim_start().strip_prefix('#') {
                if let Some((key, value)) = comment.split_once(':') {
                    table.facts.insert(key.trim().to_owned(), value.trim().to_owned());
                }
            } else if line.trim().is_empty() {
                continue;
            } else if table.columns.is_empty() {
                table.columns = line.split(',').map(|name| name.trim().to_owned()).collect();
                table.check_header(line_number)?;
            } else {
                table.push_row(line, line_number)?;
            }
        }
        if table.rows.is_empty() {
            return Err(Error::new("the table holds no numbers")
                .hint("write a header row such as wavelength_nm,value and at least one row below it"));
        }
        Ok(table)
    }

    /// The values of a column by name.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let index = self.columns.iter().position(|c| c == name)?;
        Some(self.rows.iter().map(|row| row[index]).collect())
    }

    /// The line of the file that a row stands in, from 1.
    pub fn line_of(&self, row: usize) -> usize {
        self.lines[row]
    }

    /// The first column, checked to rise strictly: the wavelengths in nm. An error carries
    /// line and column.
    pub fn wavelengths_nm(&self) -> Result<Vec<f64>> {
        let wavelengths: Vec<f64> = self.rows.iter().map(|row| row[0]).collect();
        match wavelengths.windows(2).position(|pair| pair[1] <= pair[0]) {
            None => Ok(wavelengths),
            Some(row) => Err(Error::new(format!(
                "wavelengths must rise from row to row, but {} nm comes after {} nm",
                wavelengths[row + 1],
                wavelengths[row]
            ))
            .hint("sort the rows and leave out repeated wavelengths")
            .at(self.lines[row + 1], Some(1))),
        }
    }

    fn check_header(&self, line_number: usize) -> Result<()> {
        if self.columns.len() < 2 {
            return Err(Error::new("the table has a single column")
                .hint("write wavelengths in the first column, values in the next, commas between them")
                .at(line_number, Some(1)));
        }
        if self.columns.iter().all(|name| name.parse::<f64>().is_err()) {
            return Ok(());
        }
        Err(Error::new("the first row must name the columns")
            .hint("write a header row such as wavelength_nm,value above the numbers")
            .at(line_number, Some(1)))
    }

    fn push_row(&mut self, line: &str, line_number: usize) -> Result<()> {
        let mut row = Vec::with_capacity(self.columns.len());
        let mut column = 1;
        for cell in line.split(',') {
            match cell.trim().parse::<f64>() {
                Ok(value) if value.is_finite() => row.push(value),
                _ => {
                    let blanks = cell.chars().take_while(|c| c.is_whitespace()).count();
                    return Err(Error::new(format!("\"{}\" is not a finite number", cell.trim()))
                        .hint("write numbers with a decimal point, commas between columns")
                        .at(line_number, Some(column + blanks)));
                }
            }
            column += cell.chars().count() + 1;
        }
        if row.len() != self.columns.len() {
            return Err(Error::new(format!(
                "the row has {} cells, the header {}",
                row.len(),
                self.columns.len()
            ))
            .hint("give every row one cell per column")
            .at(line_number, Some(1)));
        }
        if self.rows.len() == MOST_ROWS {
            return Err(Error::new(format!("more than {MOST_ROWS} rows"))
                .hint("a measured curve has fewer; check that this is the right file")
                .at(line_number, Some(1)));
        }
        self.rows.push(row);
        self.lines.push(line_number);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_found_at_line_and_column() {
        let place = |text: &str| {
            let error = CsvTable::parse(text).expect_err("the text is faulty");
            (error.line, error.column)
        };
        assert_eq!(place("# a: b\nwavelength_nm,value\n400,0.1\n500,x\n"), (Some(4), Some(5)));
        assert_eq!(place("wavelength_nm,value\n400,nan\n"), (Some(2), Some(5)));
        assert_eq!(place("400,1\n500,2\n"), (Some(1), Some(1)));
        assert_eq!(place("wavelength_nm,value\n400, nan\n"), (Some(2), Some(6)));
        assert_eq!(place("wavelength_nm,value\n400\n"), (Some(2), Some(1)));
        assert_eq!(place("value\n400\n"), (Some(1), Some(1)));
    }

    #[test]
    fn wavelengths_must_rise() {
        let table = CsvTable::parse("wavelength_nm,value\n400,1\n400,2\n").expect("well formed");
        let error = table.wavelengths_nm().expect_err("a wavelength is repeated");
        assert_eq!((error.line, error.column), (Some(3), Some(1)));
    }
}
