//! `etalon spectra`: what is built in, and one spectrum described or drawn.

use crate::cli::print;
use clap::Args;
use etalon::error::{Error, Result};
use etalon::python::Environment;
use etalon::spectrum::colour::{
    adapt, colour_temperature, srgb_encode, xy_of, xyz_of, xyz_of_grid, xyz_to_linear_srgb,
};
use etalon::spectrum::library::{self, Entry, Purpose};
use etalon::spectrum::{Curve, D_NM, LampSpectrum, grid_nm};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The white of sRGB, Y = 1 (IEC 61966-2-1).
const D65_WHITE_XYZ: [f64; 3] = [0.950_456, 1.0, 1.089_058];

#[derive(Debug, Args)]
pub struct Arguments {
    /// Spectrum to describe; all are listed if left out
    name: Option<String>,
    /// Draw it to this SVG or PNG file
    #[arg(long, value_name = "FILE.svg", requires = "name")]
    plot: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let Some(name) = &arguments.name else {
        list();
        return Ok(ExitCode::SUCCESS);
    };
    let entry = library::entries()
        .find(|entry| entry.name == name)
        .ok_or_else(|| Error::unknown_name("spectrum", name, library::entries().map(|e| e.name)))?;
    if let Some(plot) = &arguments.plot {
        check_plot(plot)?;
    }
    let description = describe(&entry)?;
    print(&description.join("\n"));
    if let Some(plot) = &arguments.plot {
        draw(&entry, &description, plot)?;
        print(&format!("drawn      {}", plot.display()));
    }
    Ok(ExitCode::SUCCESS)
}

fn list() {
    for entry in library::entries() {
        let table = entry.table();
        let title = table.facts.get("title").map_or("", String::as_str);
        print(&format!("{:<14} {:<26} {title}", entry.kind, entry.name));
    }
}

/// What a spectrum is, line by line.
fn describe(entry: &Entry) -> Result<Vec<String>> {
    let table = entry.table();
    let mut lines: Vec<String> = ["title", "unit", "source", "conditions"]
        .iter()
        .filter_map(|key| Some(format!("{key:<10} {}", table.facts.get(*key)?)))
        .collect();
    if table.columns[0] == "wavelength_nm" {
        let wavelengths = table.wavelengths_nm()?;
        let (first, last) = (wavelengths[0], wavelengths[wavelengths.len() - 1]);
        let what = if entry.kind == "line" { "lines" } else { "points" };
        lines.push(format!("range      {first} to {last} nm, {} {what}", wavelengths.len()));
    }
    match entry.kind {
        "illuminant" | "emission" | "line" => {
            lines.extend(of_lamp(&library::light(&table, None, Purpose::Emission)?));
        }
        "reflectance" | "transmission" => {
            lines.extend(under_equal_energy(&library::curve(&table, None, Purpose::Reflectance)?));
        }
        "glass" => {
            let index = library::refractive_index(&table)?;
            lines.push(format!(
                "index      nd = {:.6}, Abbe number {:.3}",
                index.at(D_NM)?,
                index.abbe_number()?
            ));
        }
        _ => {}
    }
    Ok(lines)
}

fn of_lamp(lamp: &LampSpectrum) -> Vec<String> {
    let Some(xy) = xy_of(lamp.xyz_of_shape()) else { return vec!["colour     black".to_owned()] };
    let mut lines = vec![format!("colour     xy ({:.6}, {:.6})", xy[0], xy[1])];
    match colour_temperature(xy) {
        Some(cct) => lines.push(format!("CCT        {:.1} K, Duv {:+.5}", cct.kelvin.0, cct.duv)),
        None => lines.push("CCT        not defined: too far from the Planckian locus".to_owned()),
    }
    if let Some(efficacy) = lamp.efficacy_lm_per_w() {
        lines.push(format!("efficacy   {efficacy:.3} lm per radiant watt (360-830 nm)"));
    }
    lines
}

/// Colour of a reflectance or transmission under equal energy; its display colour keeps a
/// perfect diffuser white.
fn under_equal_energy(curve: &Curve) -> Vec<String> {
    let white = xyz_of_grid(&vec![1.0; grid_nm().len()]);
    let xyz = xyz_of(curve).map(|c| c / white[1]);
    let relative_white = white.map(|c| c / white[1]);
    let srgb = xyz_to_linear_srgb(adapt(xyz, relative_white, D65_WHITE_XYZ))
        .map(|c| (255.0 * srgb_encode(c)).round());
    let hex: String = srgb.iter().map(|c| format!("{:02x}", *c as u8)).collect();
    vec![format!(
        "colour     X {:.5}, Y {:.5}, Z {:.5} under equal energy; on a display about #{hex}",
        xyz[0], xyz[1], xyz[2]
    )]
}

/// Refuses a file that cannot be drawn to, before anything is computed.
fn check_plot(file: &Path) -> Result<()> {
    let ending = file.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
    if !["svg", "png"].contains(&ending.as_str()) {
        let hint = "end the file's name with .svg or .png";
        return Err(Error::new("cannot draw to this kind of file").hint(hint).in_file(file));
    }
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    match folder.filter(|folder| !folder.is_dir()) {
        Some(folder) => Err(Error::new("no such folder").hint("make it first").in_file(folder)),
        None => Ok(()),
    }
}

fn draw(entry: &Entry, description: &[String], file: &Path) -> anyhow::Result<()> {
    let request = serde_json::json!({
        "name": entry.name,
        "kind": entry.kind,
        "csv": entry.text(),
        "description": description,
    });
    let environment = Environment::prepare(&etalon::python::VALIDATION)?;
    let path = std::path::absolute(file)?;
    environment.run_module("plot-spectrum", &[path.as_os_str()], Some(&request.to_string()))
}
