//! Names, files and formulas of a scene's spectra, resolved to curves.

use super::file::{IndexDescription, IndexFile, MetalFile, SpectrumDescription, SpectrumFile};
use crate::camera::uncovered_share;
use crate::error::{Error, Result};
use crate::spectrum::library::{self, Purpose};
use crate::spectrum::{CsvTable, Curve, Dense, Outside, RefractiveIndex, Table, grid_nm};
use crate::units::Kelvin;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Spectra may name one another; a longer chain than this is a circle.
const DEEPEST: usize = 32;

/// Resolves what a scene says about spectra, and notes what a user should know.
pub(super) struct Spectra<'a> {
    folder: &'a Path,
    own: &'a BTreeMap<String, SpectrumFile>,
    /// Remarks on coverage and the like, for the report.
    pub notes: Vec<String>,
    /// Text of the files that were read, for the scene's hash.
    pub files_read: Vec<(PathBuf, String)>,
}

impl<'a> Spectra<'a> {
    pub fn new(folder: &'a Path, own: &'a BTreeMap<String, SpectrumFile>) -> Self {
        Self { folder, own, notes: Vec::new(), files_read: Vec::new() }
    }

    /// A curve for a purpose, with a note where a table leaves part of the eye's response
    /// uncovered.
    pub fn curve(&mut self, spectrum: &SpectrumFile, purpose: Purpose) -> Result<Curve> {
        let curve = self.resolve(spectrum, purpose, 0)?;
        if let Some(range) = curve.range_nm() {
            let share = uncovered_share(range);
            if share > 1e-6 {
                let rule = match purpose {
                    Purpose::Reflectance => "its end values are held",
                    Purpose::Emission => "it counts as zero",
                };
                let name = match spectrum {
                    SpectrumFile::Name(name) => format!("\"{name}\""),
                    _ => "a spectrum".to_owned(),
                };
                self.note(format!(
                    "{name} is known from {} to {} nm; outside, with {:.2} % of the luminous response, {rule}",
                    range.0,
                    range.1,
                    100.0 * share
                ));
            }
        }
        Ok(curve)
    }

    /// A reflectance: 0 to 1 everywhere.
    pub fn reflectance(&mut self, spectrum: &SpectrumFile) -> Result<Dense> {
        let curve = self.curve(spectrum, Purpose::Reflectance)?;
        let (low, high) = curve.extremes();
        if low < 0.0 || !low.is_finite() {
            return Err(Error::new(format!("a reflectance of {low} is negative"))
                .hint("a reflectance lies between 0 and 1; measured noise below zero is clipped in the table"));
        }
        if high > 1.0 {
            return Err(Error::new(format!("a reflectance of {high} is above 1"))
                .hint("a reflectance lies between 0 and 1; use \"factor\": 0.01 for a table in per cent"));
        }
        Ok(Dense::from_fn(|nm| curve.at(nm)))
    }

    /// Something that is not negative: an absorption coefficient, part of a metal's index.
    pub fn not_negative(&mut self, spectrum: &SpectrumFile, what: &str) -> Result<Dense> {
        let curve = self.curve(spectrum, Purpose::Reflectance)?;
        let (low, high) = curve.extremes();
        if low < 0.0 || !low.is_finite() || !high.is_finite() {
            return Err(Error::new(format!("{what} of {low} is not a finite number from 0 up")));
        }
        Ok(Dense::from_fn(|nm| curve.at(nm)))
    }

    /// The shape of an emission: not negative.
    pub fn emission(&mut self, spectrum: &SpectrumFile) -> Result<Curve> {
        let curve = self.curve(spectrum, Purpose::Emission)?;
        let (low, high) = curve.extremes();
        if low < 0.0 || !low.is_finite() || !high.is_finite() {
            return Err(Error::new(format!("an emission of {low} is not a finite number from 0 up"))
                .hint("clip measured noise below zero in the table"));
        }
        Ok(curve)
    }

    /// Real and imaginary part of a metal's index.
    pub fn metal(&mut self, metal: &MetalFile) -> Result<(Dense, Dense)> {
        match metal {
            MetalFile::Described(d) => Ok((
                self.not_negative(&d.n, "a real part n").map_err(|e| e.under("n"))?,
                self.not_negative(&d.k, "an imaginary part k").map_err(|e| e.under("k"))?,
            )),
            MetalFile::Name(name) => {
                let metals = || library::entries().filter(|e| e.kind == "metal").map(|e| e.name);
                if !metals().any(|known| known == name) {
                    return Err(Error::unknown_name("metal", name, metals()));
                }
                let table = library::table(name)?;
                let part = |column| {
                    let curve = library::curve(&table, Some(column), Purpose::Reflectance)?;
                    Ok(Dense::from_fn(|nm| curve.at(nm)))
                };
                Ok((part("n")?, part("k")?))
            }
        }
    }

    /// A refractive index.
    pub fn index(&mut self, index: &IndexFile) -> Result<RefractiveIndex> {
        match index {
            IndexFile::Value(n) => Ok(RefractiveIndex::Constant(*n)),
            IndexFile::Name(name) => {
                let glasses = || library::entries().filter(|e| e.kind == "glass").map(|e| e.name);
                if !glasses().any(|known| known == name) {
                    return Err(Error::unknown_name("glass", name, glasses()));
                }
                library::refractive_index(&library::table(name)?)
            }
            IndexFile::Described(described) => self.described_index(described),
        }
    }

    fn described_index(&mut self, described: &IndexDescription) -> Result<RefractiveIndex> {
        match described {
            IndexDescription::Cauchy { a, b_um2 } => Ok(RefractiveIndex::Cauchy { a: *a, b_um2: *b_um2 }),
            IndexDescription::Sellmeier { b, c_um2, range_nm } => {
                if b.len() != c_um2.len() {
                    return Err(Error::new(format!("{} coefficients b but {} c_um2", b.len(), c_um2.len()))
                        .hint("give one c_um2 for each b"));
                }
                let terms = b.iter().zip(c_um2).map(|(b, c)| [*b, *c]).collect();
                Ok(RefractiveIndex::Sellmeier { terms, range_nm: (range_nm[0], range_nm[1]) })
            }
            IndexDescription::Abbe { nd, vd } => RefractiveIndex::from_abbe(*nd, *vd),
            IndexDescription::Table { wavelengths_nm, n } => {
                Ok(RefractiveIndex::Table(Table::new(wavelengths_nm.clone(), n.clone(), Outside::Hold)?))
            }
            IndexDescription::Csv { file } => library::refractive_index(&self.read_csv(file)?),
        }
    }

    /// The relative index of a boundary minus one, over the grid.
    ///
    /// A formula is followed beyond the wavelengths it was fitted for, with a note; a table
    /// is not.
    pub fn excess_index(&mut self, inside: &RefractiveIndex, outside: &RefractiveIndex) -> Result<Dense> {
        let mut excess = Vec::new();
        for nm in grid_nm() {
            let (n_inside, n_outside) = (inside.at(nm)?, outside.at(nm)?);
            excess.push(((n_inside - n_outside) / n_outside) as f32);
        }
        for index in [inside, outside] {
            if let Some(range) = index.fitted_range_nm().filter(|r| uncovered_share(*r) > 0.0) {
                self.note(format!(
                    "a dispersion formula fitted for {} to {} nm is followed beyond, with {:.4} % of the luminous response",
                    range.0,
                    range.1,
                    100.0 * uncovered_share(range)
                ));
            }
        }
        Ok(Dense::from_values(&excess))
    }

    /// Notes a remark once.
    pub fn note(&mut self, remark: String) {
        if !self.notes.contains(&remark) {
            self.notes.push(remark);
        }
    }

    fn resolve(&mut self, spectrum: &SpectrumFile, purpose: Purpose, depth: usize) -> Result<Curve> {
        if depth > DEEPEST {
            return Err(Error::new("spectra name one another in a circle"));
        }
        match spectrum {
            SpectrumFile::Value(value) => Ok(Curve::Constant(*value)),
            SpectrumFile::Name(name) => match self.own.get(name) {
                Some(own) => self.resolve(own, purpose, depth + 1),
                None => self.built_in(name, purpose),
            },
            SpectrumFile::Described(SpectrumDescription::Blackbody { temperature_k: Kelvin(kelvin) }) => {
                if !(*kelvin > 0.0 && kelvin.is_finite()) {
                    return Err(Error::new(format!("a temperature of {kelvin} K is not positive"))
                        .hint("give the absolute temperature in kelvin")
                        .under("temperature_k")
                        .under("blackbody"));
                }
                Ok(Curve::Blackbody(Kelvin(*kelvin)))
            }
            SpectrumFile::Described(SpectrumDescription::Table { wavelengths_nm, values }) => {
                let table = Table::new(wavelengths_nm.clone(), values.clone(), outside(purpose));
                table.map(Curve::Table).map_err(|e| e.under("table"))
            }
            SpectrumFile::Described(SpectrumDescription::Csv { file, column, factor }) => {
                let table = self.read_csv(file).map_err(|e| e.under("file").under("csv"))?;
                let curve = library::curve(&table, column.as_deref(), purpose).map_err(|e| e.under("csv"))?;
                Ok(if *factor == 1.0 { curve } else { Curve::Scaled(Box::new(curve), *factor) })
            }
            SpectrumFile::Described(SpectrumDescription::Scaled { spectrum, factor }) => {
                let curve = self.resolve(spectrum, purpose, depth + 1);
                let curve = curve.map_err(|e| e.under("spectrum").under("scaled"))?;
                Ok(Curve::Scaled(Box::new(curve), *factor))
            }
        }
    }

    fn built_in(&self, name: &str, purpose: Purpose) -> Result<Curve> {
        let known = || {
            let own = self.own.keys().map(String::as_str);
            own.chain(library::entries().filter(|e| is_curve(e.kind)).map(|e| e.name))
        };
        if !known().any(|k| k == name) {
            return Err(Error::unknown_name("spectrum", name, known()));
        }
        library::curve(&library::table(name)?, None, purpose)
    }

    fn read_csv(&mut self, file: &str) -> Result<CsvTable> {
        let path = self.folder.join(file);
        let table = CsvTable::read(&path)?;
        let text = std::fs::read_to_string(&path).map_err(|e| Error::io(&path, "read the table", &e))?;
        self.files_read.push((path, text));
        Ok(table)
    }
}

fn outside(purpose: Purpose) -> Outside {
    match purpose {
        Purpose::Reflectance => Outside::Hold,
        Purpose::Emission => Outside::Zero,
    }
}

/// Kinds of built-in tables that are one curve of values.
fn is_curve(kind: &str) -> bool {
    matches!(kind, "illuminant" | "emission" | "reflectance" | "transmission")
}
