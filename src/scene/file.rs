//! What a scene's JSON says, key by key; it can be wrong, and nothing is resolved yet.
//!
//! Keys carry their unit. Alternatives are externally tagged (`{"sphere": {...}}`), which
//! lets every fault be reported at its line and column. Building turns this into a
//! [`super::Scene`], which cannot be wrong.

use crate::units::{Candelas, CandelasPerSquareMeter, Lumens, Watts};
use serde::Deserialize;
use std::collections::BTreeMap;

pub use super::file_camera::{
    Anchor, CameraFile, DevelopmentFile, ElectronicsFile, NoiseFile, VignettingFile,
};
pub use super::file_spectrum::{
    DetectorFile, IndexDescription, IndexFile, LineFile, MetalFile, SensorDescription, SensorFile,
    SpectrumDescription, SpectrumFile,
};

/// A point or direction: x, y, z.
pub type Vector = [f64; 3];

/// A scene in physical units.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// JSON Schema that an editor may use; ignored.
    #[serde(default, rename = "$schema")]
    pub schema: Option<String>,
    /// Name of the scene, for reports.
    pub name: String,
    /// What the scene is and where its numbers come from.
    #[serde(default)]
    pub description: String,
    /// Unit of all positions, radii and distances of this file, camera optics apart.
    pub length_unit: LengthUnit,
    /// Spectra of this scene by name; they hide built-in ones of the same name.
    #[serde(default)]
    pub spectra: BTreeMap<String, SpectrumFile>,
    /// Materials by name.
    #[serde(default)]
    pub materials: BTreeMap<String, MaterialFile>,
    /// Everything that has a surface.
    #[serde(default)]
    pub objects: Vec<ObjectFile>,
    /// Lights without a surface.
    #[serde(default)]
    pub lights: Vec<LightFile>,
    /// The camera; a scene that is only measured needs none.
    #[serde(default)]
    pub camera: Option<CameraFile>,
    /// Illuminance and luminance meters.
    #[serde(default)]
    pub meters: Vec<MeterFile>,
}

/// Unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum LengthUnit {
    /// Metres.
    #[serde(rename = "m")]
    Meters,
    /// Centimetres.
    #[serde(rename = "cm")]
    Centimeters,
    /// Millimetres.
    #[serde(rename = "mm")]
    Millimeters,
}

/// What a surface does with light.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum MaterialFile {
    /// Diffuse reflection, the same in every direction.
    Lambertian {
        /// Reflectance, 0 to 1.
        reflectance: SpectrumFile,
        /// Whether the back reflects as well; otherwise it is black. Default true.
        #[serde(default = "yes")]
        two_sided: bool,
    },
    /// Ideal mirror.
    Mirror {
        /// Reflectance at every angle, 0 to 1.
        reflectance: SpectrumFile,
        /// Whether the back reflects as well; otherwise it is black. Default true.
        #[serde(default = "yes")]
        two_sided: bool,
    },
    /// Transparent medium behind a smooth or rough surface; closed shapes bound it.
    Dielectric {
        /// Refractive index inside.
        index: IndexFile,
        /// Refractive index outside; vacuum (1) if left out.
        #[serde(default)]
        outside_index: Option<IndexFile>,
        /// GGX roughness alpha, 0 (smooth) to 1.
        #[serde(default)]
        roughness_alpha: f64,
        /// Absorption coefficient inside, per metre (natural logarithm).
        #[serde(default)]
        absorption_per_m: Option<SpectrumFile>,
    },
    /// Metal.
    Conductor {
        /// Complex refractive index.
        metal: MetalFile,
        /// GGX roughness alpha, 0 (smooth) to 1.
        #[serde(default)]
        roughness_alpha: f64,
        /// Whether the back reflects as well; otherwise it is black. Default true.
        #[serde(default = "yes")]
        two_sided: bool,
    },
}

const fn yes() -> bool {
    true
}

/// A surface with its material and, perhaps, its light.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ObjectFile {
    /// Name, for messages and reports.
    #[serde(default)]
    pub name: String,
    /// The surface.
    pub shape: ShapeFile,
    /// Name of its material.
    pub material: String,
    /// Light that it gives off.
    #[serde(default)]
    pub emission: Option<EmissionFile>,
    /// Transformations, applied in order.
    #[serde(default)]
    pub transform: Vec<TransformFile>,
}

/// A surface.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ShapeFile {
    /// Sphere, facing outwards.
    Sphere {
        /// Centre.
        center: Vector,
        /// Radius.
        radius: f64,
    },
    /// Circular cylinder, facing outwards.
    Cylinder {
        /// Centre of one end.
        from: Vector,
        /// Centre of the other end.
        to: Vector,
        /// Radius.
        radius: f64,
        /// Whether disks close the ends. Default true.
        #[serde(default = "yes")]
        capped: bool,
    },
    /// Flat disk, facing along its normal.
    Disk {
        /// Centre.
        center: Vector,
        /// Direction that it faces, of any length.
        normal: Vector,
        /// Radius.
        radius: f64,
    },
    /// Four corners; it faces the side from which they run counter-clockwise.
    Quad {
        /// Corners in order around the quad.
        vertices: [Vector; 4],
    },
    /// Box along the axes, facing outwards.
    Box {
        /// Smallest coordinates.
        min: Vector,
        /// Largest coordinates.
        max: Vector,
    },
    /// Triangles written out.
    Mesh {
        /// Vertex positions.
        vertices: Vec<Vector>,
        /// Vertex normals for smooth shading, one per vertex, or none.
        #[serde(default)]
        normals: Vec<Vector>,
        /// Corners of each triangle as vertex numbers from 0, counter-clockwise seen from
        /// the side that it faces.
        triangles: Vec<[u32; 3]>,
    },
    /// Mesh in a PLY file.
    Ply {
        /// Path, relative to the scene file.
        file: String,
    },
    /// Mesh in a Wavefront OBJ file.
    Obj {
        /// Path, relative to the scene file.
        file: String,
    },
}

/// One transformation.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum TransformFile {
    /// Shift.
    Translate(Vector),
    /// Rotation about an axis through the origin, by the right-hand rule.
    Rotate {
        /// Axis, of any length.
        axis: Vector,
        /// Angle in degrees.
        degrees: f64,
    },
    /// Scale factors along x, y and z.
    Scale(Vector),
    /// Affine map: three rows of four numbers.
    Matrix([[f64; 4]; 3]),
}

/// Light that something gives off: the shape of its spectrum, and its level.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct EmissionFile {
    /// Shape of the spectrum.
    pub spectrum: SpectrumFile,
    /// How much there is.
    pub level: LevelFile,
    /// Whether both sides of the surface shine. Default false.
    #[serde(default)]
    pub two_sided: bool,
}

/// How much light: one quantity, converted through the real geometry and spectrum.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LevelFile {
    /// Luminous flux in lumen.
    FluxLm(Lumens),
    /// Radiant flux within a band.
    RadiantPower {
        /// Power in watts.
        power_w: Watts,
        /// The band that is meant: `[360, 830]`, or `"all"`.
        band_nm: BandFile,
    },
    /// Electrical power and the lamp's efficacy.
    ElectricalPower {
        /// Power that the lamp takes from the mains, in watts.
        power_w: Watts,
        /// Luminous flux per electrical watt.
        efficacy_lm_per_w: f64,
    },
    /// Luminous intensity: of a point light, or of a flat or spherical lamp along its axis.
    IntensityCd(Candelas),
    /// Luminance of the surface.
    LuminanceCdM2(CandelasPerSquareMeter),
    /// Radiance of the surface within a band.
    Radiance {
        /// Radiance in W sr^-1 m^-2.
        radiance_w_sr_m2: f64,
        /// The band that is meant.
        band_nm: BandFile,
    },
    /// The spectrum is spectral radiance itself: factor from its values to
    /// W sr^-1 m^-2 nm^-1.
    SpectralRadianceFactor(f64),
}

/// The wavelengths over which a radiant quantity is counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BandFile {
    /// From one wavelength to another, nm.
    Range([f64; 2]),
    /// All wavelengths.
    All,
}

/// The key that an alternative is written with, for the pointers of errors.
macro_rules! keys {
    ($($type:ident { $($variant:ident: $key:literal,)* })*) => {$(
        impl $type {
            /// The key that this alternative is written with.
            pub const fn key(&self) -> &'static str {
                match self {
                    $(Self::$variant { .. } => $key,)*
                }
            }
        }
    )*};
}

keys! {
    ShapeFile {
        Sphere: "sphere",
        Cylinder: "cylinder",
        Disk: "disk",
        Quad: "quad",
        Box: "box",
        Mesh: "mesh",
        Ply: "ply",
        Obj: "obj",
    }
    TransformFile {
        Translate: "translate",
        Rotate: "rotate",
        Scale: "scale",
        Matrix: "matrix",
    }
    LevelFile {
        FluxLm: "flux_lm",
        RadiantPower: "radiant_power",
        ElectricalPower: "electrical_power",
        IntensityCd: "intensity_cd",
        LuminanceCdM2: "luminance_cd_m2",
        Radiance: "radiance",
        SpectralRadianceFactor: "spectral_radiance_factor",
    }
}

impl LevelFile {
    /// The band that a radiant quantity is counted over.
    pub const fn band(&self) -> Option<BandFile> {
        match self {
            Self::RadiantPower { band_nm, .. } | Self::Radiance { band_nm, .. } => Some(*band_nm),
            _ => None,
        }
    }
}

/// A light without a surface.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LightFile {
    /// Light from one point.
    Point {
        /// Where it is.
        position: Vector,
        /// How its light spreads. Default isotropic.
        #[serde(default)]
        distribution: DistributionFile,
        /// Its light; `luminance_cd_m2`, `radiance` and `spectral_radiance_factor` need a
        /// surface and do not apply.
        emission: EmissionFile,
    },
}

/// How a point light's intensity depends on direction.
#[derive(Clone, Debug, Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DistributionFile {
    /// The same in every direction.
    #[default]
    Isotropic,
    /// Proportional to the cosine from an axis, dark behind: a small Lambertian source.
    Cosine {
        /// Axis, of any length.
        axis: Vector,
    },
    /// Measured about an axis: linear in the angle between the given ones, dark beyond them.
    /// `intensity_cd` is then the largest intensity.
    Profile {
        /// Axis, of any length.
        axis: Vector,
        /// Angles from the axis in degrees, rising from 0 to 180 at most.
        angles_deg: Vec<f64>,
        /// Intensity at each angle, on any scale.
        relative_intensity: Vec<f64>,
    },
}

/// An instrument in the scene.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum MeterFile {
    /// Illuminance on a plane.
    Illuminance {
        /// Name, for reports.
        name: String,
        /// Middle of the receiving plane.
        position: Vector,
        /// Direction that it faces, of any length.
        normal: Vector,
    },
    /// Luminance seen from a point in a direction.
    Luminance {
        /// Name, for reports.
        name: String,
        /// Eye point.
        position: Vector,
        /// Direction of view, of any length.
        direction: Vector,
    },
}
