//! From what a file says to a scene that cannot be wrong. All errors end here.

use super::file::{LengthUnit, MaterialFile, SceneFile};
use super::objects::Stage;
use super::spectra::Spectra;
use super::{Files, Scene, view};
use crate::camera::Sensor;
use crate::error::{Error, Result};
use crate::material::Material;
use crate::spectrum::RefractiveIndex;
use std::collections::{BTreeMap, BTreeSet};

impl LengthUnit {
    /// Metres in one unit, as a ratio: division by a thousand rounds once, multiplication by
    /// 0.001 twice.
    pub(super) fn metres(self, length: f64) -> f64 {
        match self {
            Self::Meters => length,
            Self::Centimeters => length / 100.0,
            Self::Millimeters => length / 1000.0,
        }
    }
}

/// Resolves a parsed scene.
pub(super) fn build(text: &str, file: &SceneFile, files: &Files<'_>) -> Result<Scene> {
    let mut spectra = Spectra::new(files, &file.spectra);
    check_own_spectra(file, &spectra)?;
    let mut stage = Stage::new(file.length_unit, files);
    stage.place_objects(&file.objects, &file.materials)?;
    let stage = stage.build()?;
    let metres_per_unit = stage.geometry.metres_per_unit();
    let (materials, indices) = materials(file, &mut spectra, metres_per_unit)?;
    let objects = super::objects::describe(&file.objects, &indices);
    let mut lines_nm = Vec::new();
    let (objects, lights, emitters) =
        super::objects::lights(file, &stage, objects, &mut spectra, &mut lines_nm)?;
    let meters = super::objects::meters(file, &stage)?;
    let view = match &file.camera {
        Some(camera) => Some(view::build(camera, &stage, &mut spectra).map_err(|e| e.under("camera"))?),
        None => None,
    };
    stage.notes.iter().for_each(|note| spectra.note(note.clone()));
    let dropped = stage.geometry.degenerate_triangles();
    if dropped > 0 {
        spectra.note(format!("{dropped} triangles without area were left out"));
    }
    super::siting::remarks(&stage.geometry, &objects).into_iter().for_each(|remark| spectra.note(remark));
    super::siting::check_bodies(&stage.geometry, &objects, &materials)?;
    let sensor = view.as_ref().map_or_else(Sensor::cie, |view| view.sensor.clone());
    let mut hash = Fnv::default();
    hash.add(text.as_bytes());
    spectra.files_read.iter().for_each(|bytes| hash.add(bytes));
    stage.mesh_bytes.iter().for_each(|bytes| hash.add(bytes));
    Ok(Scene {
        name: file.name.clone(),
        geometry: stage.geometry,
        materials,
        material_names: file.materials.keys().cloned().collect(),
        objects,
        lights,
        emitters,
        lines_nm,
        view,
        meters,
        notes: spectra.remarks(&sensor),
        hash: format!("{:016x}", hash.0),
    })
}

/// Reads the scene's own spectra even where nothing uses them: a fault is a fault.
fn check_own_spectra<'a>(file: &'a SceneFile, spectra: &Spectra<'a>) -> Result<()> {
    let mut sound = BTreeSet::new();
    for name in file.spectra.keys() {
        spectra.check_own(name, &mut Vec::new(), &mut sound)?;
    }
    Ok(())
}

fn materials<'a>(
    file: &'a SceneFile,
    spectra: &mut Spectra<'_>,
    metres_per_unit: f64,
) -> Result<(Vec<Material>, BTreeMap<&'a str, u32>)> {
    let mut list = Vec::new();
    let mut indices = BTreeMap::new();
    for (name, described) in &file.materials {
        indices.insert(name.as_str(), list.len() as u32);
        let built = material(described, spectra, metres_per_unit);
        list.push(built.map_err(|e| e.under(name).under("materials"))?);
    }
    Ok((list, indices))
}

fn material(file: &MaterialFile, spectra: &mut Spectra<'_>, metres_per_unit: f64) -> Result<Material> {
    match file {
        MaterialFile::Lambertian { reflectance, two_sided } => {
            let reflectance =
                spectra.reflectance(reflectance).map_err(|e| e.under("reflectance").under("lambertian"))?;
            Ok(Material::Lambertian { reflectance, two_sided: *two_sided })
        }
        MaterialFile::Mirror { reflectance, two_sided } => {
            let reflectance =
                spectra.reflectance(reflectance).map_err(|e| e.under("reflectance").under("mirror"))?;
            Ok(Material::Mirror { reflectance, two_sided: *two_sided })
        }
        MaterialFile::Dielectric { index, outside_index, roughness_alpha, absorption_per_m } => {
            let at = |key: &'static str| move |e: Error| e.under(key).under("dielectric");
            let inside = spectra.index(index).map_err(at("index"))?;
            let outside = match outside_index {
                Some(index) => spectra.index(index).map_err(at("outside_index"))?,
                None => RefractiveIndex::Constant(1.0),
            };
            let excess_index = spectra.excess_index(&inside, &outside).map_err(|e| e.under("dielectric"))?;
            let absorption = match absorption_per_m {
                Some(spectrum) => {
                    let per_m =
                        spectra.not_negative(spectrum, "an absorption").map_err(at("absorption_per_m"))?;
                    Some(per_m.scaled(metres_per_unit)).filter(|a| !a.is_zero())
                }
                None => None,
            };
            let roughness_alpha = roughness(*roughness_alpha).map_err(at("roughness_alpha"))?;
            Ok(Material::Dielectric { excess_index, roughness_alpha, absorption })
        }
        MaterialFile::Conductor { metal, roughness_alpha, two_sided } => {
            let at = |key: &'static str| move |e: Error| e.under(key).under("conductor");
            let (n, k) = spectra.metal(metal).map_err(at("metal"))?;
            let roughness_alpha = roughness(*roughness_alpha).map_err(at("roughness_alpha"))?;
            Ok(Material::Conductor { n, k, roughness_alpha, two_sided: *two_sided })
        }
    }
}

fn roughness(alpha: f64) -> Result<f32> {
    if (0.0..=1.0).contains(&alpha) {
        return Ok(alpha as f32);
    }
    Err(Error::new(format!("a roughness alpha of {alpha} is outside 0 to 1"))
        .hint("0 is polished, 0.1 satin, 1 the roughest"))
}

/// The 64-bit FNV-1a hash: tells scenes apart, no more.
struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}
