//! Scenes: what the file says ([`mod@file`]), what it means ([`Scene`]), what it needs ([`Plan`]).

mod build;
mod chain;
mod closure;
pub mod conditions;
pub mod file;
mod file_camera;
mod file_spectrum;
mod files;
mod locate;
mod objects;
pub mod plan;
mod reach;
mod read;
mod siting;
mod spectra;
mod view;

pub use chain::{Chain, check_white, equal_energy, white_named};
pub use closure::{Closure, closure};
pub use files::Files;
pub use plan::{
    Decision, ITEMS as PLAN_ITEMS, Item as PlanItem, Leaving, NOTHING_SHINES, Plan, Saving,
    savings as plan_savings,
};
pub use reach::{Unreachable, unreachable, unreachable_by_instrument};
pub use view::CameraFacts;

use crate::camera::{Camera, Exposure, Sensor};
use crate::error::{Error, Result};
use crate::geometry::{Geometry, SurfacePoint};
use crate::light::{EmitterFacts, Lights};
use crate::material::Material;
use crate::spectrum::colour::Xyz;
use glam::Vec3A;
use std::path::Path;

/// A scene with everything resolved: names, units, tables, the acceleration structure.
///
/// Lengths are in scene units ([`Geometry::metres_per_unit`]), radiance in
/// W sr^-1 m^-2 nm^-1.
pub struct Scene {
    /// Name, from the file.
    pub name: String,
    /// All surfaces.
    pub geometry: Geometry,
    /// All materials.
    pub materials: Vec<Material>,
    /// Their names, from the file.
    pub material_names: Vec<String>,
    /// What each object is made of and whether it shines, by object number.
    pub objects: Vec<SceneObject>,
    /// All lights.
    pub lights: Lights,
    /// The lights in numbers, in the order of `lights`.
    pub emitters: Vec<EmitterFacts>,
    /// Wavelengths in nm of all spectral lines that lamps give off, each once: the list that
    /// [`crate::spectrum::Emission`] and [`crate::spectrum::Wavelengths`] count lines in.
    pub lines_nm: Vec<f64>,
    /// The camera, if the scene has one.
    pub view: Option<View>,
    /// Illuminance and luminance meters.
    pub meters: Vec<Meter>,
    /// Remarks that a user should know: coverage of tables, dropped triangles.
    pub notes: Vec<String>,
    /// Hash of the scene's text and of every file that it names, as 16 hexadecimal digits.
    pub hash: String,
}

/// An object by its number in the geometry.
#[derive(Clone, Debug)]
pub struct SceneObject {
    /// Name, from the file.
    pub name: String,
    /// Index in [`Scene::materials`].
    pub material: u32,
    /// Index in [`Scene::lights`], for an object that shines.
    pub light: Option<u32>,
}

/// A camera with its exposure and sensor.
#[derive(Clone, Debug)]
pub struct View {
    /// Rays through the picture.
    pub camera: Camera,
    /// ISO, shutter, f-stop.
    pub exposure: Exposure,
    /// Channels of the film.
    pub sensor: Sensor,
    /// Focal length in mm.
    pub focal_length_mm: f64,
    /// Distance of the image behind the lens in mm.
    pub image_distance_mm: f64,
    /// Metres in one scene unit.
    pub metres_per_unit: f64,
    /// Tristimulus values that the development makes white.
    pub white: Option<Xyz>,
    /// What happens to the film's values after the render.
    pub chain: Chain,
}

/// An instrument.
#[derive(Clone, Debug)]
pub struct Meter {
    /// Name, from the file.
    pub name: String,
    /// What it measures.
    pub kind: MeterKind,
}

/// What an instrument measures, in scene units.
#[derive(Clone, Copy, Debug)]
pub enum MeterKind {
    /// Illuminance on the side that the point's normal faces.
    Illuminance(SurfacePoint),
    /// Luminance from a point in a direction.
    Luminance {
        /// Eye point.
        position: Vec3A,
        /// Unit direction of view.
        direction: Vec3A,
    },
}

impl Scene {
    /// Reads, checks and resolves a scene file.
    pub fn load(file: &Path) -> Result<Self> {
        let text = read::read_text(file)?;
        let folder = file.parent().unwrap_or_else(|| Path::new("."));
        Self::from_text(&text, folder).map_err(|e| e.in_file(file))
    }

    /// Resolves a scene from its text; paths in it are relative to `folder`.
    pub fn from_text(text: &str, folder: &Path) -> Result<Self> {
        Self::from_files(text, &Files::in_folder(folder))
    }

    /// Resolves a scene from its text, with the files that it may name.
    pub fn from_files(text: &str, files: &Files<'_>) -> Result<Self> {
        let parsed = read::parse(text)?;
        build::build(text, &parsed, files).map_err(|e| read::place(text, e))
    }

    /// The materials that objects are made of.
    pub fn used_materials(&self) -> impl Iterator<Item = &Material> {
        self.objects.iter().map(|object| &self.materials[object.material as usize])
    }

    /// The camera, or an error that says how to add one.
    pub fn view(&self) -> Result<&View> {
        self.view.as_ref().ok_or_else(|| {
            Error::new(format!("the scene \"{}\" has no camera", self.name))
                .hint("add a \"camera\", or use `etalon measure` with meters")
        })
    }
}
