//! Names, files and formulas of a scene's spectra, resolved to curves.

use super::file::{IndexDescription, IndexFile, LineFile, MetalFile, SpectrumDescription, SpectrumFile};
use super::files::{Files, Kind};
use crate::camera::uncovered_share;
use crate::error::{Error, Result};
use crate::input;
use crate::spectrum::library::{self, Purpose};
use crate::spectrum::{
    CsvTable, Curve, Dense, FIRST_NM, LAST_NM, LampSpectrum, Line, Outside, RefractiveIndex, Table, grid_nm,
};
use crate::units::Kelvin;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::rc::Rc;

/// Spectra may name one another, through at most this many names and factors.
const DEEPEST: usize = 32;

/// What transport can hold: its numbers have 32 bits.
const LARGEST: f64 = f32::MAX as f64;

/// Resolves what a scene says about spectra, and notes what a user should know.
pub(super) struct Spectra<'a> {
    files: &'a Files<'a>,
    own: &'a BTreeMap<String, SpectrumFile>,
    /// Remarks for the report.
    notes: Vec<String>,
    /// Names of spectra by what is to be said of their coverage.
    coverage: BTreeMap<String, Vec<String>>,
    /// The files that were read, as often as they are named, for the scene's hash.
    pub files_read: Vec<Rc<Vec<u8>>>,
}

impl<'a> Spectra<'a> {
    pub fn new(files: &'a Files<'a>, own: &'a BTreeMap<String, SpectrumFile>) -> Self {
        Self { files, own, notes: Vec::new(), coverage: BTreeMap::new(), files_read: Vec::new() }
    }

    /// Something that surfaces and media have: a curve without lines.
    fn curve(&mut self, spectrum: &SpectrumFile) -> Result<Curve> {
        without_lines(self.light(spectrum, Purpose::Reflectance)?)
    }

    /// A spectrum for a purpose, with a note where a table leaves part of the eye's response
    /// uncovered.
    fn light(&mut self, spectrum: &SpectrumFile, purpose: Purpose) -> Result<LampSpectrum> {
        let light = self.resolve(spectrum, purpose, 0)?;
        if let Some(range) = light.continuum().range_nm() {
            let share = uncovered_share(range);
            if share > 1e-6 {
                let rule = match purpose {
                    Purpose::Reflectance => "its end values are held",
                    Purpose::Emission => "it counts as zero",
                };
                let name = match spectrum {
                    SpectrumFile::Name(name) => format!("\"{name}\""),
                    _ => "a spectrum described in the scene".to_owned(),
                };
                let remark = format!(
                    "known from {} to {} nm; outside, with {:.4} % of the luminous response, {rule}",
                    range.0,
                    range.1,
                    100.0 * share
                );
                let names = self.coverage.entry(remark).or_default();
                if !names.contains(&name) {
                    names.push(name);
                }
            }
        }
        Ok(light)
    }

    /// Reads a spectrum for its faults alone.
    fn check(&self, spectrum: &SpectrumFile) -> Result<()> {
        Self::new(self.files, self.own).light(spectrum, Purpose::Emission).map(|_| ())
    }

    /// A transmission: 0 to 1 everywhere.
    pub fn transmission(&mut self, spectrum: &SpectrumFile) -> Result<Curve> {
        let curve = self.curve(spectrum)?;
        let place = |fault| self.pointed(spectrum, fault, &|value| !(0.0..=1.0).contains(&value));
        check_extremes(&curve, "a transmission", f64::MAX).map_err(place)?;
        let (_, high) = curve.extremes();
        if high <= 1.0 {
            return Ok(curve);
        }
        Err(place(
            Error::new(format!("a transmission of {} is above 1", short(high)))
                .hint("a transmission lies between 0 and 1; use \"factor\": 0.01 for a table in per cent"),
        ))
    }

    /// A detector's response: not negative, zero outside a table.
    pub fn response(&mut self, spectrum: &SpectrumFile) -> Result<Curve> {
        let curve = without_lines(self.light(spectrum, Purpose::Emission)?)?;
        check_extremes(&curve, "a response", LARGEST)?;
        Ok(curve)
    }

    /// A reflectance: 0 to 1 everywhere.
    pub fn reflectance(&mut self, spectrum: &SpectrumFile) -> Result<Dense> {
        let curve = self.curve(spectrum)?;
        let (low, high) = curve.extremes();
        if low < 0.0 {
            let fault = Error::new(format!("a reflectance of {} is negative", short(low))).hint(
                "a reflectance lies between 0 and 1; measured noise below zero is clipped in the table",
            );
            return Err(self.pointed(spectrum, fault, &|value| value == low));
        }
        if high.is_nan() || high > 1.0 {
            let fault = Error::new(format!("a reflectance of {} is above 1", short(high)))
                .hint("a reflectance lies between 0 and 1; use \"factor\": 0.01 for a table in per cent");
            return Err(self.pointed(spectrum, fault, &|value| value == high));
        }
        Ok(Dense::from_fn(|nm| curve.at(nm)))
    }

    /// Something that is not negative: an absorption coefficient, part of a metal's index.
    pub fn not_negative(&mut self, spectrum: &SpectrumFile, what: &str) -> Result<Dense> {
        let curve = self.curve(spectrum)?;
        check_extremes(&curve, what, LARGEST)
            .map_err(|fault| self.pointed(spectrum, fault, &|value| !(0.0..=LARGEST).contains(&value)))?;
        Ok(Dense::from_fn(|nm| curve.at(nm)))
    }

    /// Leads a fault to the number at fault, which `bad` knows: in the CSV file, or in the table
    /// that is written out where the fault is. The table of another name stays unnamed: only the
    /// entry that asked for it is known to be wrong.
    fn pointed(&self, spectrum: &SpectrumFile, fault: Error, bad: &dyn Fn(f64) -> bool) -> Error {
        match spectrum {
            SpectrumFile::Name(name) => match self.own.get(name) {
                Some(own) => Error { pointer: None, ..self.pointed(own, fault, bad) },
                None => fault,
            },
            SpectrumFile::Described(SpectrumDescription::Table { values, .. }) => {
                match values.iter().position(|value| bad(*value)) {
                    Some(index) => fault.under(index).under("values").under("table"),
                    None => fault,
                }
            }
            SpectrumFile::Described(SpectrumDescription::Scaled { spectrum, factor }) => {
                let inner = self.pointed(spectrum, fault, &|value| bad(value * factor));
                match inner.pointer {
                    Some(_) => inner.under("spectrum").under("scaled"),
                    None => inner,
                }
            }
            SpectrumFile::Described(SpectrumDescription::Csv { file, column, factor }) => {
                match self.place_in_csv(file, column.as_deref(), &|value| bad(value * factor)) {
                    Some((line, column)) => fault.in_file(&self.files.path_of(file)).at(line, Some(column)),
                    None => fault,
                }
            }
            SpectrumFile::Value(_) | SpectrumFile::Described(_) => fault,
        }
    }

    fn place_in_csv(
        &self,
        file: &str,
        column: Option<&str>,
        bad: &dyn Fn(f64) -> bool,
    ) -> Option<(usize, usize)> {
        let bytes = self.files.read(file, Kind::Table).ok()?;
        let text = input::text_of(&bytes).ok()?;
        let table = CsvTable::parse(text).ok()?;
        let column = column.or_else(|| table.columns.get(1).map(String::as_str))?;
        table.place_of(text, column, bad)
    }

    /// The shape of an emission: not negative.
    pub fn emission(&mut self, spectrum: &SpectrumFile) -> Result<LampSpectrum> {
        let light = self.light(spectrum, Purpose::Emission)?;
        check_extremes(light.continuum(), "an emission", f64::MAX)
            .map_err(|fault| self.pointed(spectrum, fault, &|value| !(0.0..=f64::MAX).contains(&value)))?;
        for Line { nm, power } in light.lines() {
            check_extremes(&Curve::Constant(*power), "an emission", f64::MAX)?;
            if !(FIRST_NM..=LAST_NM).contains(nm) {
                self.note(format!(
                    "the line at {nm} nm lies outside {FIRST_NM} to {LAST_NM} nm: it counts in radiant levels whose band holds it, and is not rendered"
                ));
            }
        }
        Ok(light)
    }

    /// One part of a metal's index, which must be known wherever transport looks.
    fn index_part(&mut self, spectrum: &SpectrumFile, what: &str) -> Result<Dense> {
        let range = self.resolve(spectrum, Purpose::Reflectance, 0)?.continuum().range_nm();
        if let Some((first, last)) = range.filter(|(first, last)| *first > FIRST_NM || *last < LAST_NM) {
            return Err(Error::new(format!("the refractive index is known from {first} to {last} nm only"))
                .hint("an index cannot be continued; use a table that covers 360 to 830 nm"));
        }
        self.not_negative(spectrum, what)
    }

    /// Real and imaginary part of a metal's index.
    pub fn metal(&mut self, metal: &MetalFile) -> Result<(Dense, Dense)> {
        match metal {
            MetalFile::Described(d) => Ok((
                self.index_part(&d.n, "a real part n").map_err(|e| e.under("n"))?,
                self.index_part(&d.k, "an imaginary part k").map_err(|e| e.under("k"))?,
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
                        .hint("give one c_um2 for each b")
                        .under("c_um2")
                        .under("sellmeier"));
                }
                if !(range_nm[0] > 0.0 && range_nm[1] > range_nm[0]) {
                    return Err(Error::new(format!(
                        "the range from {} to {} nm is empty",
                        range_nm[0], range_nm[1]
                    ))
                    .hint("give two rising wavelengths, such as [310, 2500]")
                    .under("range_nm")
                    .under("sellmeier"));
                }
                let terms = b.iter().zip(c_um2).map(|(b, c)| [*b, *c]).collect();
                Ok(RefractiveIndex::Sellmeier { terms, range_nm: (range_nm[0], range_nm[1]) })
            }
            IndexDescription::Abbe { nd, vd } => {
                RefractiveIndex::from_abbe(*nd, *vd).map_err(|e| e.under("abbe"))
            }
            IndexDescription::Table { wavelengths_nm, n } => {
                let table = table_of(wavelengths_nm, n, "n", Outside::Hold);
                table.map(RefractiveIndex::Table).map_err(|e| e.under("table"))
            }
            IndexDescription::Csv { file } => {
                let at = |e: Error| e.under("file").under("csv");
                let (path, table) = self.read_csv(file).map_err(at)?;
                if table.column("n").is_some() {
                    table.wavelengths_nm().map_err(|e| at(e.in_file(&path)))?;
                }
                library::refractive_index(&table).map_err(at)
            }
        }
    }

    /// The relative index of a boundary minus one, over the grid. An error carries the key of
    /// the index at fault.
    ///
    /// A formula is followed beyond the wavelengths it was fitted for, with a note; a table
    /// is not.
    pub fn excess_index(&mut self, inside: &RefractiveIndex, outside: &RefractiveIndex) -> Result<Dense> {
        let n_inside = index_over_grid(inside).map_err(|e| e.under("index"))?;
        let n_outside = index_over_grid(outside).map_err(|e| e.under("outside_index"))?;
        let excess: Vec<f32> = n_inside.iter().zip(&n_outside).map(|(i, o)| ((i - o) / o) as f32).collect();
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

    /// All remarks, spectra of equal coverage together.
    pub fn remarks(&self) -> Vec<String> {
        let coverage = self.coverage.iter().map(|(remark, names)| format!("{}: {remark}", names.join(", ")));
        self.notes.iter().cloned().chain(coverage).collect()
    }

    /// Notes a remark once.
    pub fn note(&mut self, remark: String) {
        if !self.notes.contains(&remark) {
            self.notes.push(remark);
        }
    }

    /// Reads one of the scene's own spectra, after those that it names: a fault is reported
    /// where it stands, even where nothing uses the spectrum.
    pub fn check_own(
        &self,
        name: &'a str,
        named_by: &mut Vec<&'a str>,
        sound: &mut BTreeSet<&'a str>,
    ) -> Result<()> {
        if sound.contains(name) {
            return Ok(());
        }
        let spectrum = &self.own[name];
        named_by.push(name);
        if let (Some(next), pointer) = named_in(spectrum)
            && self.own.contains_key(next)
        {
            let at = |e: Error| Error { pointer: Some(pointer.clone()), ..e }.under(name).under("spectra");
            if let Some(first) = named_by.iter().position(|earlier| *earlier == next) {
                let circle =
                    named_by[first..].iter().chain([&next]).map(|n| format!("\"{n}\"")).collect::<Vec<_>>();
                return Err(at(Error::new(format!(
                    "spectra name one another in a circle: {}",
                    circle.join(", ")
                ))
                .hint("let one of them be a number, a table or a built-in spectrum of another name")));
            }
            if named_by.len() > DEEPEST {
                return Err(at(too_deep()));
            }
            self.check_own(next, named_by, sound)?;
        }
        named_by.pop();
        self.check(spectrum).map_err(|e| e.under(name).under("spectra"))?;
        sound.insert(name);
        Ok(())
    }

    fn resolve(&mut self, spectrum: &SpectrumFile, purpose: Purpose, depth: usize) -> Result<LampSpectrum> {
        if depth > DEEPEST {
            return Err(too_deep());
        }
        match spectrum {
            SpectrumFile::Value(value) => Ok(Curve::Constant(*value).into()),
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
                Ok(Curve::Blackbody(Kelvin(*kelvin)).into())
            }
            SpectrumFile::Described(SpectrumDescription::Table { wavelengths_nm, values }) => {
                let table = table_of(wavelengths_nm, values, "values", outside(purpose));
                table.map(|t| Curve::Table(t).into()).map_err(|e| e.under("table"))
            }
            SpectrumFile::Described(SpectrumDescription::Csv { file, column, factor }) => {
                let (path, table) = self.read_csv(file).map_err(|e| e.under("file").under("csv"))?;
                table.wavelengths_nm().map_err(|e| e.in_file(&path).under("file").under("csv"))?;
                let light = library::light(&table, column.as_deref(), purpose)
                    .map_err(|e| if column.is_some() { e.under("column") } else { e }.under("csv"))?;
                Ok(if *factor == 1.0 { light } else { light.scaled(*factor) })
            }
            SpectrumFile::Described(SpectrumDescription::Lines { lines, continuum }) => {
                let continuum = match continuum {
                    None => Ok(Curve::Constant(0.0)),
                    Some(spectrum) => self.resolve(spectrum, purpose, depth + 1).and_then(only_continuum),
                };
                let continuum = continuum.map_err(|e| e.under("continuum").under("lines"))?;
                let line = |line: &LineFile| Line { nm: line.wavelength_nm, power: line.power };
                LampSpectrum::new(continuum, lines.iter().map(line).collect())
                    .map_err(|e| e.under("lines").under("lines"))
            }
            SpectrumFile::Described(SpectrumDescription::Scaled { spectrum, factor }) => {
                let light = self.resolve(spectrum, purpose, depth + 1);
                Ok(light.map_err(|e| e.under("spectrum").under("scaled"))?.scaled(*factor))
            }
        }
    }

    fn built_in(&self, name: &str, purpose: Purpose) -> Result<LampSpectrum> {
        let known = || {
            let own = self.own.keys().map(String::as_str);
            own.chain(library::entries().filter(|e| is_spectrum(e.kind)).map(|e| e.name))
        };
        if !known().any(|k| k == name) {
            return Err(Error::unknown_name("spectrum", name, known()));
        }
        library::light(&library::table(name)?, None, purpose)
    }

    /// Reads a file that the scene names, and where it lies.
    pub fn read_file(&mut self, file: &str, kind: Kind) -> Result<(PathBuf, Rc<Vec<u8>>)> {
        let bytes = self.files.read(file, kind)?;
        self.files_read.push(Rc::clone(&bytes));
        Ok((self.files.path_of(file), bytes))
    }

    /// Reads a table; its own faults stand in its file, that it cannot be read in the scene.
    pub fn read_csv(&mut self, file: &str) -> Result<(PathBuf, CsvTable)> {
        let (path, bytes) = self.read_file(file, Kind::Table)?;
        let table = input::text_of(&bytes).and_then(CsvTable::parse).map_err(|e| e.in_file(&path))?;
        Ok((path, table))
    }
}

/// An index at every grid point. A pole of Sellmeier's formula within the grid's range is an
/// error even where no grid point meets it.
fn index_over_grid(index: &RefractiveIndex) -> Result<Vec<f64>> {
    /// Nearer than this to a pole a formula says nothing about a glass.
    const CLEARANCE_NM: f64 = 1.0;
    if let RefractiveIndex::Sellmeier { terms, .. } = index {
        let poles = terms.iter().filter(|[b, _]| *b != 0.0).map(|[_, c_um2]| 1000.0 * c_um2.max(0.0).sqrt());
        let near = FIRST_NM - CLEARANCE_NM..=LAST_NM + CLEARANCE_NM;
        if let Some(pole) = poles.into_iter().find(|pole| near.contains(pole)) {
            return Err(Error::new(format!("Sellmeier's formula has a pole at {pole:.2} nm")).hint(
                "coefficients c_um2 are squares of wavelengths in um, outside 360 to 830 nm; check the unit",
            ));
        }
    }
    grid_nm().map(|nm| index.at(nm)).collect()
}

/// The curve of something that is no light.
fn without_lines(spectrum: LampSpectrum) -> Result<Curve> {
    spectrum.into_continuum().ok_or_else(|| {
        Error::new("spectral lines where no light is given off")
            .hint("lines belong in an emission; give a number, a table or the name of a reflectance")
    })
}

/// The continuum beneath lines, which has none itself.
fn only_continuum(spectrum: LampSpectrum) -> Result<Curve> {
    spectrum
        .into_continuum()
        .ok_or_else(|| Error::new("the continuum has lines itself").hint("put all lines into one list"))
}

fn too_deep() -> Error {
    Error::new(format!("spectra name one another more than {DEEPEST} deep"))
        .hint("give the spectrum itself instead of one made of others")
}

/// The spectrum that a description names, if any, and the pointer inside it to the name.
fn named_in(spectrum: &SpectrumFile) -> (Option<&str>, String) {
    let mut pointer = String::new();
    let mut inner = spectrum;
    while let SpectrumFile::Described(described) = inner {
        let (key, next) = match described {
            SpectrumDescription::Scaled { spectrum, .. } => ("/scaled/spectrum", spectrum),
            SpectrumDescription::Lines { continuum: Some(spectrum), .. } => ("/lines/continuum", spectrum),
            _ => break,
        };
        pointer.push_str(key);
        inner = next;
    }
    match inner {
        SpectrumFile::Name(name) => (Some(name), pointer),
        _ => (None, pointer),
    }
}

/// A table written in the scene, with its faults at the entry that they stand in.
fn table_of(wavelengths_nm: &[f64], values: &[f64], values_key: &str, outside: Outside) -> Result<Table> {
    if wavelengths_nm.len() != values.len() {
        return Err(Error::new(format!("{} values for {} wavelengths", values.len(), wavelengths_nm.len()))
            .hint("give one value per wavelength")
            .under(values_key));
    }
    if let Some(index) = wavelengths_nm.windows(2).position(|pair| pair[1] <= pair[0]) {
        return Err(Error::new(format!(
            "{} nm comes after {} nm",
            wavelengths_nm[index + 1],
            wavelengths_nm[index]
        ))
        .hint("sort the points by wavelength and leave out repeated ones")
        .under(index + 1)
        .under("wavelengths_nm"));
    }
    Table::new(wavelengths_nm.to_vec(), values.to_vec(), outside)
}

/// A number as it may have been written, without a row of zeros.
fn short(value: f64) -> String {
    if (1e-4..1e7).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

/// Whether all values of a curve lie between 0 and `largest`.
fn check_extremes(curve: &Curve, what: &str, largest: f64) -> Result<()> {
    let (low, high) = curve.extremes();
    if low < 0.0 || low.is_nan() {
        return Err(Error::new(format!("{what} of {low} is negative"))
            .hint("give numbers from 0 up; measured noise below zero is clipped in the table"));
    }
    if high <= largest {
        return Ok(());
    }
    Err(Error::new(format!("{what} of {high:e} is too large to be held"))
        .hint(format!("give numbers below {largest:.1e}; check the unit")))
}

fn outside(purpose: Purpose) -> Outside {
    match purpose {
        Purpose::Reflectance => Outside::Hold,
        Purpose::Emission => Outside::Zero,
    }
}

/// Kinds of built-in tables that are a spectrum: one curve of values, or lines.
fn is_spectrum(kind: &str) -> bool {
    matches!(kind, "illuminant" | "emission" | "line" | "reflectance" | "transmission")
}
