//! Two files as typed, then as they can be compared: one size, one unit, pixels that count.
//!
//! A pixel that is not finite in either picture, or has no finite standard error where others
//! have, is left out of everything and named: one such pixel must not hide what all others say,
//! and nobody must overlook it.

use super::{Arguments, Units};
use etalon::error::{Error, Result};
use etalon::image::{LuminancePicture, Unit, read_luminance};
use etalon::statistics::{Estimate, Noise};
use std::path::Path;

/// Blocks behind standard errors of which nothing says how many there are.
const ASSUMED_BLOCKS: f64 = 16.0;
/// Pixels that are named one by one.
const NAMED: usize = 5;

/// What is compared.
pub struct Pair {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// The files.
    pub files: [String; 2],
    /// What they hold.
    pub pictures: [LuminancePicture; 2],
    /// Luminances with their noise.
    pub estimates: [Estimate; 2],
    /// Pixels that count, in rows.
    pub counted: Vec<bool>,
    /// Whether both may be of the same random numbers: then their noise does not add up.
    pub shares_numbers: bool,
    /// What was assumed or left out, in words.
    pub notes: Vec<String>,
}

impl Pair {
    /// Reads and checks both files.
    pub fn read(arguments: &Arguments) -> Result<Self> {
        let files = [&arguments.a, &arguments.b];
        let a = read_luminance(files[0], arguments.layer_a.as_deref(), arguments.scale_a)?;
        let b = read_luminance(files[1], arguments.layer_b.as_deref(), arguments.scale_b)?;
        check_sizes(&a, &b, files.map(|file| file.as_path()))?;
        if arguments.units == Units::Absolute {
            for (picture, file, name) in [(&a, files[0], "a"), (&b, files[1], "b")] {
                check_unit(picture, name).map_err(|e| e.in_file(file))?;
            }
        }
        let mut notes = Vec::new();
        for (picture, name) in [(&a, "A"), (&b, "B")] {
            notes.extend(picture.notes.iter().map(|note| format!("{name}: {note}")));
        }
        if a.position != b.position {
            notes.push(format!(
                "upper left pixels lie at {:?} and {:?} of their frames, and are taken for the same",
                a.position, b.position
            ));
        }
        let shares_numbers = share_random_numbers(&a, &b);
        if shares_numbers {
            notes.push(
                "A and B are of one scene and seed: they share random numbers and are not independent; figures without noise are left out, and tests may miss differences"
                    .to_owned(),
            );
        }
        let mut estimates = Vec::new();
        for (picture, file, name) in [(&a, files[0], "A"), (&b, files[1], "B")] {
            estimates.push(estimate(picture, name, &mut notes).map_err(|e| e.in_file(file))?);
        }
        let estimates: [Estimate; 2] = estimates.try_into().expect("two files make two estimates");
        let pictures = [a, b];
        let counted = counted(&pictures, &estimates, &mut notes);
        if !counted.contains(&true) {
            return Err(Error::new("no pixel is finite in both pictures").hint("render them again"));
        }
        if arguments.units == Units::Relative {
            for (estimate, file) in estimates.iter().zip(files) {
                check_level(estimate, &counted).map_err(|e| e.in_file(file))?;
            }
        }
        let files = files.map(|file| file.display().to_string());
        Ok(Self { size: pictures[0].size, files, pictures, estimates, counted, shares_numbers, notes })
    }

    /// How many pixels were left out.
    pub fn excluded(&self) -> usize {
        self.counted.iter().filter(|counted| !**counted).count()
    }
}

fn check_sizes(a: &LuminancePicture, b: &LuminancePicture, files: [&Path; 2]) -> Result<()> {
    if a.size == b.size {
        return Ok(());
    }
    let ([wide, high], [width, height]) = (a.size, b.size);
    Err(Error::new(format!(
        "it has {width} x {height} pixels, and {} has {wide} x {high}",
        files[0].display()
    ))
    .hint("render both at one size")
    .in_file(files[1]))
}

fn check_unit(picture: &LuminancePicture, name: &str) -> Result<()> {
    match picture.unit {
        Unit::CandelasPerSquareMetre => Ok(()),
        Unit::Unknown => Err(Error::new(
            "nothing says what unit its values have: no facts of a render in cd/m2, no whiteLuminance",
        )
        .hint(format!(
            "give the cd/m2 of the value one with --scale-{name}, or compare shapes with --units relative"
        ))),
    }
}

fn check_level(estimate: &Estimate, counted: &[bool]) -> Result<()> {
    let sum: f64 = estimate.mean.iter().zip(counted).filter(|(_, c)| **c).map(|(mean, _)| mean).sum();
    if sum > 0.0 && sum.is_finite() {
        return Ok(());
    }
    Err(Error::new("its mean is not above zero, and cannot be scaled").hint("leave out --units relative"))
}

/// Whatever the integrators: several draw the same camera paths from one seed.
fn share_random_numbers(a: &LuminancePicture, b: &LuminancePicture) -> bool {
    let name = |picture: &LuminancePicture| Some((picture.stated.scene_hash.clone()?, picture.stated.seed?));
    name(a).is_some() && name(a) == name(b)
}

/// A picture's luminance with what its file says of its noise.
fn estimate(picture: &LuminancePicture, name: &str, notes: &mut Vec<String>) -> Result<Estimate> {
    let mean = picture.xyz[1].clone();
    let Some(standard_error) = picture.standard_error.clone().filter(|errors| errors.iter().any(is_error))
    else {
        notes.push(format!(
            "{name}: no standard errors of Y (channel stderr.Y), or of one block of samples alone"
        ));
        return Ok(Estimate { mean, noise: None });
    };
    let blocks = match picture.stated.blocks() {
        Some((blocks, true)) => blocks,
        Some((blocks, false)) => {
            notes.push(format!("{name}: the number of blocks behind its standard errors is not stated; by its samples {blocks} are assumed"));
            blocks
        }
        None => {
            notes.push(format!("{name}: nothing says how many blocks are behind its standard errors; {ASSUMED_BLOCKS} are assumed"));
            ASSUMED_BLOCKS
        }
    };
    let independent = picture.stated.is_independent();
    let cells = picture.stated.cells(picture.size)?;
    if !independent && cells.is_empty() {
        notes.push(format!("{name}: its pixels may depend on one another, and no errors of cells are stated: only single pixels are judged"));
    }
    Ok(Estimate { mean, noise: Some(Noise { standard_error, blocks, independent, cells }) })
}

fn is_error(error: &f64) -> bool {
    error.is_finite() && *error >= 0.0
}

/// Which pixels count; the others are named in a note.
fn counted(
    pictures: &[LuminancePicture; 2],
    estimates: &[Estimate; 2],
    notes: &mut Vec<String>,
) -> Vec<bool> {
    let [width, height] = pictures[0].size;
    let mut counted = vec![true; width * height];
    for ((picture, estimate), name) in pictures.iter().zip(estimates).zip(["A", "B"]) {
        let is_finite =
            |pixel: usize| picture.xyz.iter().all(|c| c.get(pixel).is_none_or(|value| value.is_finite()));
        let has_error =
            |pixel: usize| estimate.noise.as_ref().is_none_or(|n| is_error(&n.standard_error[pixel]));
        for (what, is_right) in [
            ("not finite", &is_finite as &dyn Fn(usize) -> bool),
            ("without a standard error", &|pixel| has_error(pixel) || !is_finite(pixel)),
        ] {
            let wrong: Vec<usize> = (0..counted.len()).filter(|&pixel| !is_right(pixel)).collect();
            if wrong.is_empty() {
                continue;
            }
            let places: Vec<String> = wrong
                .iter()
                .take(NAMED)
                .map(|pixel| format!("({}, {})", pixel % width, pixel / width))
                .collect();
            let more = if wrong.len() > NAMED { ", ..." } else { "" };
            notes.push(format!(
                "{name}: {} pixels are {what} and left out: {}{more}",
                wrong.len(),
                places.join(", ")
            ));
            wrong.into_iter().for_each(|pixel| counted[pixel] = false);
        }
    }
    counted
}
