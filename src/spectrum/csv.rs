//! Curve tables as text: `# key: value` lines, one header row, then numbers.
//!
//! The built-in tables of `spectra/` and the tables that a scene names have the same form.
//! A fault gives line and column; nothing is guessed or repaired. What is held is at most
//! 64 times the text's size.

use crate::error::{Error, Result};
use std::collections::BTreeMap;

/// A table of numbers with named columns and what is known about it.
#[derive(Clone, Debug)]
pub struct CsvTable {
    /// The `# key: value` lines: title, quantity, unit, source, conditions.
    pub facts: BTreeMap<String, String>,
    /// Column names of the header row.
    pub columns: Vec<String>,
    /// Row by row, each as long as `columns`; all finite.
    pub rows: Vec<Vec<f64>>,
    /// The line of the header row, from 1.
    header_line: usize,
    /// The line that each row stands in, from 1.
    lines: Vec<usize>,
}

/// More rows than any measured curve has; a longer file is something else.
const MOST_ROWS: usize = 100_000;

/// More curves than any table has.
const MOST_COLUMNS: usize = 1000;

/// The name of a column of wavelengths, which is the first.
const WAVELENGTHS: &str = "wavelength_nm";

impl CsvTable {
    /// Reads a table from text; errors carry line and column.
    pub fn parse(text: &str) -> Result<Self> {
        let mut table = Self {
            facts: BTreeMap::new(),
            columns: Vec::new(),
            rows: Vec::new(),
            header_line: 1,
            lines: Vec::new(),
        };
        for (index, line) in text.lines().enumerate() {
            let line_number = index + 1;
            if let Some(comment) = line.trim_start().strip_prefix('#') {
                if let Some((key, value)) = comment.split_once(':') {
                    table.facts.insert(key.trim().to_owned(), value.trim().to_owned());
                }
            } else if line.trim().is_empty() {
                continue;
            } else if table.columns.is_empty() {
                table.header_line = line_number;
                table.read_header(line)?;
            } else {
                table.push_row(line, line_number)?;
            }
        }
        if table.rows.is_empty() {
            return Err(Error::new("the table holds no numbers")
                .hint("write a header row such as wavelength_nm,value and at least one row below it")
                .at(table.header_line, Some(1)));
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

    /// The line of the header row, from 1.
    pub const fn header_line(&self) -> usize {
        self.header_line
    }

    /// Line and column of the first number of a column that is as `bad` says, in the text that
    /// the table was read from.
    pub fn place_of(&self, text: &str, column: &str, bad: impl Fn(f64) -> bool) -> Option<(usize, usize)> {
        let index = self.columns.iter().position(|c| c == column)?;
        let line_number = self.lines[self.rows.iter().position(|row| bad(row[index]))?];
        let line = text.lines().nth(line_number - 1)?;
        cells(line).nth(index).map(|(column, _)| (line_number, column))
    }

    /// The first column, checked to be called `wavelength_nm` and to rise strictly. An error
    /// carries line and column.
    pub fn wavelengths_nm(&self) -> Result<Vec<f64>> {
        if self.columns[0] != WAVELENGTHS {
            return Err(Error::new(format!("the first column is \"{}\"", self.columns[0]))
                .hint("write wavelengths in nanometres there and call it wavelength_nm")
                .at(self.header_line, Some(1)));
        }
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

    fn read_header(&mut self, line: &str) -> Result<()> {
        let at = |fault: Error, column: usize| Err(fault.at(self.header_line, Some(column)));
        for (index, (column, name)) in cells(line).enumerate() {
            if name.parse::<f64>().is_ok() {
                let fault = Error::new("the first row must name the columns");
                return at(
                    fault.hint("write a header row such as wavelength_nm,value above the numbers"),
                    column,
                );
            }
            if self.columns.iter().any(|earlier| earlier == name) {
                return at(
                    Error::new(format!("two columns are called \"{name}\"")).hint("rename one"),
                    column,
                );
            }
            if index == MOST_COLUMNS {
                let fault = Error::new(format!("more than {MOST_COLUMNS} columns"));
                return at(fault.hint("check that this is a table of curves"), column);
            }
            self.columns.push(name.to_owned());
        }
        if self.columns.len() >= 2 {
            return Ok(());
        }
        match line.find([';', '\t']) {
            Some(byte) => at(
                Error::new("the columns are not separated by commas")
                    .hint("write commas between columns, and decimals with a point"),
                line[..byte].chars().count() + 1,
            ),
            None => at(
                Error::new("the table has a single column")
                    .hint("write wavelengths in the first column, values in the next, commas between them"),
                1,
            ),
        }
    }

    fn push_row(&mut self, line: &str, line_number: usize) -> Result<()> {
        let mut row = Vec::with_capacity(self.columns.len());
        for (column, cell) in cells(line).take(self.columns.len()) {
            match cell.parse::<f64>() {
                Ok(value) if value.is_finite() => row.push(value),
                _ => {
                    return Err(Error::new(format!("\"{cell}\" is not a finite number"))
                        .hint("write numbers with a decimal point, commas between columns")
                        .at(line_number, Some(column)));
                }
            }
        }
        let found = cells(line).count();
        if found != self.columns.len() {
            return Err(Error::new(format!("the row has {found} cells, the header {}", self.columns.len()))
                .hint("give every row one cell per column, and write decimals with a point")
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

/// The cells of a line without the blanks around them, and the columns that they begin in.
fn cells(line: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut next = 1;
    line.split(',').map(move |cell| {
        let blanks = cell.chars().take_while(|c| c.is_whitespace()).count();
        let column = next + blanks;
        next += cell.chars().count() + 1;
        (column, cell.trim())
    })
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
