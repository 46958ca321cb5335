//! Objects, lights and meters of a scene, brought to scene units.

use super::file::{
    BandFile, DistributionFile, EmissionFile, LengthUnit, LightFile, MaterialFile, MeterFile, ObjectFile,
    SceneFile, ShapeFile, TransformFile, Vector,
};
use super::files::{Files, Kind};
use super::spectra::Spectra;
use super::{Meter, MeterKind, SceneObject};
use crate::error::{Error, Result};
use crate::geometry::{
    Geometry, GeometryBuilder, Mesh, MeshFileError, Primitive, Shape, ShapeError, SurfacePoint, Transform,
};
use crate::light::power::{self, EmitterShape};
use crate::light::{AreaLight, Distribution, EmitterFacts, Light, Lights, PointLight, Profile};
use crate::spectrum::Emission;
use glam::{DVec3, Vec3A};
use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;

/// The largest length in metres: transport's numbers have 32 bits.
const FARTHEST_M: f64 = f32::MAX as f64;

/// Reads a mesh file's bytes; `None` where the build has no reader.
type MeshParser = Option<fn(&Path, &[u8]) -> std::result::Result<Mesh, MeshFileError>>;

#[cfg(feature = "meshes")]
const PARSE_PLY: MeshParser = Some(crate::geometry::parse_ply);
#[cfg(feature = "meshes")]
const PARSE_OBJ: MeshParser = Some(crate::geometry::parse_obj);
#[cfg(not(feature = "meshes"))]
const PARSE_PLY: MeshParser = None;
#[cfg(not(feature = "meshes"))]
const PARSE_OBJ: MeshParser = None;

/// Geometry while it is being put up.
pub(super) struct Stage<'a> {
    unit: LengthUnit,
    files: &'a Files<'a>,
    builder: GeometryBuilder,
    mesh_bytes: Vec<Rc<Vec<u8>>>,
    notes: Vec<String>,
}

/// Geometry that stands, and the way from the file's lengths to its own.
pub(super) struct Built {
    unit: LengthUnit,
    pub geometry: Geometry,
    /// The mesh files read, for the scene's hash.
    pub mesh_bytes: Vec<Rc<Vec<u8>>>,
    /// Remarks for the report.
    pub notes: Vec<String>,
}

impl<'a> Stage<'a> {
    pub fn new(unit: LengthUnit, files: &'a Files<'a>) -> Self {
        Self { unit, files, builder: GeometryBuilder::new(), mesh_bytes: Vec::new(), notes: Vec::new() }
    }

    /// Adds all objects; checks that their materials exist.
    pub fn place_objects(
        &mut self,
        objects: &[ObjectFile],
        materials: &BTreeMap<String, MaterialFile>,
    ) -> Result<()> {
        for (index, object) in objects.iter().enumerate() {
            let at = |e: Error| e.under(index).under("objects");
            if !materials.contains_key(&object.material) {
                let known = materials.keys().map(String::as_str);
                return Err(at(Error::unknown_name("material", &object.material, known).under("material")));
            }
            let kind = object.shape.key();
            let shape = self.shape(&object.shape).map_err(|e| at(e.under(kind).under("shape")))?;
            if let Shape::Mesh(mesh) = &shape {
                self.note_normals(index, object, mesh);
            }
            let transform = self.transform(&object.transform).map_err(|e| at(e.under("transform")))?;
            let added = self.builder.add_object(&shape, &transform);
            added.map_err(|e| at(placed_shape_error(&e, &object.shape)))?;
        }
        Ok(())
    }

    /// Builds the acceleration structure.
    pub fn build(self) -> Result<Built> {
        let geometry = self.builder.build().map_err(|e| match e {
            ShapeError::Vanishes { object } => shape_error(&e).under("shape").under(object).under("objects"),
            _ => shape_error(&e).under("objects"),
        })?;
        Ok(Built { unit: self.unit, geometry, mesh_bytes: self.mesh_bytes, notes: self.notes })
    }

    fn metres(&self, point: Vector) -> DVec3 {
        DVec3::from_array(point.map(|c| self.unit.metres(c)))
    }

    /// A position in metres; an error names the key, or the place in a list.
    fn point(&self, point: Vector, key: impl std::fmt::Display) -> Result<DVec3> {
        let metres = self.metres(point);
        match (0..3).find(|&axis| metres[axis].abs() > FARTHEST_M) {
            None => Ok(metres),
            Some(axis) => Err(too_far(point[axis]).under(axis).under(key)),
        }
    }

    fn points(&self, points: &[Vector], key: &str) -> Result<Vec<DVec3>> {
        let numbered = points.iter().enumerate();
        numbered.map(|(index, point)| self.point(*point, index).map_err(|e| e.under(key))).collect()
    }

    fn radius(&self, radius: f64) -> Result<f64> {
        if radius > 0.0 && self.unit.metres(radius) <= FARTHEST_M {
            return Ok(self.unit.metres(radius));
        }
        let fault = if radius > 0.0 {
            too_far(radius)
        } else {
            Error::new(format!("a radius of {radius} is not positive"))
                .hint("give a radius above 0, in the scene's length unit")
        };
        Err(fault.under("radius"))
    }

    /// The shape that a file describes, every number checked where it stands; the error's
    /// pointer starts below the kind of shape.
    fn shape(&mut self, file: &ShapeFile) -> Result<Shape> {
        Ok(match file {
            ShapeFile::Sphere { center, radius } => {
                Shape::Sphere { center: self.point(*center, "center")?, radius: self.radius(*radius)? }
            }
            ShapeFile::Cylinder { from, to, radius, capped } => Shape::Cylinder {
                from: self.point(*from, "from")?,
                to: self.point(*to, "to")?,
                radius: self.radius(*radius)?,
                capped: *capped,
            },
            ShapeFile::Disk { center, normal, radius } => Shape::Disk {
                center: self.point(*center, "center")?,
                normal: unit_vector(*normal, "normal")?,
                radius: self.radius(*radius)?,
            },
            ShapeFile::Quad { vertices } => {
                let vertices = self.points(vertices, "vertices")?;
                Shape::Quad { vertices: vertices.try_into().expect("four in, four out") }
            }
            ShapeFile::Box { min, max } => {
                for axis in 0..3 {
                    if max[axis] <= min[axis] {
                        let name = ["x", "y", "z"][axis];
                        return Err(Error::new(format!(
                            "the box reaches from {} to {} along {name}",
                            min[axis], max[axis]
                        ))
                        .hint("give a larger number in max than in min, along every axis")
                        .under(axis)
                        .under("max"));
                    }
                }
                Shape::Box { min: self.point(*min, "min")?, max: self.point(*max, "max")? }
            }
            ShapeFile::Mesh { vertices, normals, triangles } => {
                if let Some(index) = normals.iter().position(|normal| *normal == [0.0; 3]) {
                    return Err(Error::new("a normal of zero length points nowhere")
                        .hint("give a direction, such as [0, 0, 1], or leave all normals out")
                        .under(index)
                        .under("normals"));
                }
                Shape::Mesh(Mesh {
                    positions: self.points(vertices, "vertices")?,
                    normals: normals.iter().map(|n| DVec3::from_array(*n)).collect(),
                    triangles: triangles.clone(),
                })
            }
            ShapeFile::Ply { file } => self.mesh_file(file, PARSE_PLY).map_err(|e| e.under("file"))?,
            ShapeFile::Obj { file } => self.mesh_file(file, PARSE_OBJ).map_err(|e| e.under("file"))?,
        })
    }

    /// A mesh from its file; the mesh's faults stand there, that it cannot be read in the scene.
    fn mesh_file(&mut self, file: &str, parser: MeshParser) -> Result<Shape> {
        let Some(parse) = parser else { return Err(Error::not_built("mesh files", "meshes")) };
        let bytes = self.files.read(file, Kind::Mesh)?;
        let path = self.files.path_of(file);
        let mut mesh = parse(&path, &bytes).map_err(|fault| {
            let error = Error::new(fault.what.to_string()).hint(fault.what.remedy()).in_file(&path);
            match fault.line {
                Some(line) => error.at(line, fault.column),
                None => error,
            }
        })?;
        self.mesh_bytes.push(bytes);
        for position in &mut mesh.positions {
            let largest = position.abs().max_element();
            *position = self.metres(position.to_array());
            if position.abs().max_element() > FARTHEST_M {
                let fault = too_far(largest);
                return Err(Error { message: format!("\"{file}\": {}", fault.message), ..fault });
            }
        }
        Ok(Shape::Mesh(mesh))
    }

    /// Says how many normals of a mesh count by their direction alone. A zero one, which stands
    /// for a corner that an OBJ file gives none, is no normal.
    fn note_normals(&mut self, index: usize, object: &ObjectFile, mesh: &Mesh) {
        /// What rounding to three decimals leaves.
        const SLACK: f64 = 2e-3;
        let off = |normal: &&DVec3| **normal != DVec3::ZERO && (normal.length() - 1.0).abs() > SLACK;
        let count = mesh.normals.iter().filter(off).count();
        if count > 0 {
            let name = name_of(index, object);
            self.notes.push(format!(
                "{count} of {} normals of {name} are not of unit length; their directions are taken",
                mesh.normals.len()
            ));
        }
    }

    fn transform(&self, list: &[TransformFile]) -> Result<Transform> {
        let steps = list.iter().enumerate().map(|(index, step)| {
            match step {
                TransformFile::Translate(offset) => Transform::translate(self.metres(*offset)),
                TransformFile::Rotate { axis, degrees } => {
                    Transform::rotate(DVec3::from_array(*axis), *degrees)
                }
                TransformFile::Scale(factors) => Transform::scale(DVec3::from_array(*factors)),
                TransformFile::Matrix(rows) => {
                    let offset = |row: &[f64; 4]| [row[0], row[1], row[2], self.unit.metres(row[3])];
                    Transform::matrix(rows.each_ref().map(offset))
                }
            }
            .map_err(|e| shape_error(&e).under(step.key()).under(index))
        });
        let steps: Vec<Transform> = steps.collect::<Result<_>>()?;
        Transform::in_order(&steps).map_err(|e| shape_error(&e))
    }
}

impl Built {
    /// A position of the file in scene units.
    pub fn position(&self, point: Vector, key: &str) -> Result<DVec3> {
        let metres = DVec3::from_array(point.map(|c| self.unit.metres(c)));
        let units = metres / self.geometry.metres_per_unit();
        let held = |axis: &usize| metres[*axis].abs() <= FARTHEST_M && (units[*axis] as f32).is_finite();
        match (0..3).find(|axis| !held(axis)) {
            None => Ok(units),
            Some(axis) => Err(too_far(point[axis]).under(axis).under(key)),
        }
    }

    /// A length of the file in scene units.
    pub fn length(&self, length: f64) -> f64 {
        self.unit.metres(length) / self.geometry.metres_per_unit()
    }

    /// What positions in the scene are uncertain by, in scene units.
    fn rounding(&self) -> f32 {
        let bounds = self.geometry.bounds();
        if bounds.is_empty() {
            0.0
        } else {
            4.0 * f32::EPSILON * bounds.min.abs().max(bounds.max.abs()).max_element()
        }
    }

    /// A length in metres in scene units.
    pub fn length_of_metres(&self, metres: f64) -> f64 {
        metres / self.geometry.metres_per_unit()
    }
}

/// A unit vector from a direction of any length.
pub(super) fn unit_vector(direction: Vector, key: &str) -> Result<DVec3> {
    // Scaled first, so that neither tiny nor huge vectors leave the range when squared.
    let vector = DVec3::from_array(direction);
    let largest = vector.abs().max_element();
    let unit = (vector / largest).normalize();
    if largest > 0.0 && unit.is_finite() {
        return Ok(unit);
    }
    Err(Error::new("a direction must be finite and not zero")
        .hint("give a vector such as [0, 0, 1]")
        .under(key))
}

fn too_far(length: f64) -> Error {
    Error::new(format!("a length of {length:e} is too large to be held"))
        .hint("check the number and the scene's length unit")
}

/// Why a transform or the whole of the objects is wrong.
fn shape_error(error: &ShapeError) -> Error {
    let hint = match error {
        ShapeError::NotFinite { .. } => "check the numbers and the scene's length unit",
        ShapeError::NotPositive { .. } => "give a size above 0",
        ShapeError::NoExtent { .. } => "spread its points, or give a vector that is not zero",
        ShapeError::CrossedQuad => "exchange two vertices that follow each other",
        ShapeError::NotASimilarity { .. } => "scale by the same factor along x, y and z",
        ShapeError::Singular => "leave out factors of 0",
        ShapeError::NoSuchVertex { .. } => "vertices are numbered from 0",
        ShapeError::NormalCount { .. } => "give one normal per vertex, or none",
        ShapeError::Vanishes { .. } => "check its size and unit, and those of the largest object",
        ShapeError::TooMany => "leave out objects, or split the scene",
    };
    Error::new(error.to_string()).hint(hint)
}

/// Why an object cannot stand as described, below the object's own pointer.
fn placed_shape_error(error: &ShapeError, shape: &ShapeFile) -> Error {
    let fault = shape_error(error);
    let inside = |fault: Error| fault.under(shape.key()).under("shape");
    match error {
        ShapeError::NotASimilarity { .. } => fault.under("transform"),
        ShapeError::NoSuchVertex { triangle, .. } => inside(fault.under(triangle).under("triangles")),
        ShapeError::NormalCount { .. } => inside(fault.under("normals")),
        ShapeError::NoExtent { what: "the mesh" } => inside(fault.under("triangles")),
        _ => inside(fault),
    }
}

/// What an object is called in messages and reports.
fn name_of(index: usize, object: &ObjectFile) -> String {
    if object.name.is_empty() { format!("object {index}") } else { object.name.clone() }
}

/// Names and materials of all objects.
pub(super) fn describe(objects: &[ObjectFile], materials: &BTreeMap<&str, u32>) -> Vec<SceneObject> {
    objects
        .iter()
        .enumerate()
        .map(|(index, object)| SceneObject {
            name: name_of(index, object),
            material: materials[object.material.as_str()],
            light: None,
        })
        .collect()
}

/// All lights: those of objects first, in their order, then those without a surface. Their
/// lines join `lines_nm`.
pub(super) fn lights(
    file: &SceneFile,
    built: &Built,
    mut objects: Vec<SceneObject>,
    spectra: &mut Spectra<'_>,
    lines_nm: &mut Vec<f64>,
) -> Result<(Vec<SceneObject>, Lights, Vec<EmitterFacts>)> {
    let mut list = Vec::new();
    let mut facts = Vec::new();
    for (index, (described, object)) in file.objects.iter().zip(&mut objects).enumerate() {
        let Some(emission) = &described.emission else { continue };
        let at = |e: Error| e.under("emission").under(index).under("objects");
        let shape = surface_shape(&built.geometry, index as u32, emission.two_sided);
        let radiance = resolve(emission, shape, spectra, lines_nm).map_err(at)?;
        object.light = Some(list.len() as u32);
        facts.push(EmitterFacts::new(object.name.clone(), shape, &radiance, lines_nm));
        list.push(Light::Area(AreaLight::new(&built.geometry, index as u32, radiance, emission.two_sided)));
    }
    for (index, light) in file.lights.iter().enumerate() {
        let LightFile::Point { position, distribution, emission } = light;
        let at = |e: Error| e.under("point").under(index).under("lights");
        let distribution = match distribution {
            DistributionFile::Isotropic => Distribution::Isotropic,
            DistributionFile::Cosine { axis } => {
                let axis =
                    unit_vector(*axis, "axis").map_err(|e| at(e.under("cosine").under("distribution")))?;
                Distribution::Cosine(axis.as_vec3a())
            }
            DistributionFile::Profile { axis, angles_deg, relative_intensity } => {
                let profile = unit_vector(*axis, "axis")
                    .and_then(|axis| Profile::new(axis, angles_deg, relative_intensity));
                Distribution::Profile(profile.map_err(|e| at(e.under("profile").under("distribution")))?)
            }
        };
        if emission.two_sided {
            return Err(at(Error::new("a point light has no sides")
                .hint("leave two_sided out")
                .under("two_sided")
                .under("emission")));
        }
        let shape = EmitterShape::Point { solid_angle_sr: distribution.solid_angle_sr() };
        let intensity = resolve(emission, shape, spectra, lines_nm).map_err(|e| at(e.under("emission")))?;
        facts.push(EmitterFacts::new(format!("point light {index}"), shape, &intensity, lines_nm));
        list.push(Light::Point(PointLight {
            position: built.position(*position, "position").map_err(at)?.as_vec3a(),
            distribution,
            intensity: intensity.scaled(built.geometry.metres_per_unit().powi(-2)),
        }));
    }
    let weights: Vec<f64> = facts.iter().map(EmitterFacts::weight).collect();
    let lights = Lights::new(&built.geometry, list.into_iter().zip(weights).collect());
    Ok((objects, lights, facts))
}

fn resolve(
    emission: &EmissionFile,
    shape: EmitterShape,
    spectra: &mut Spectra<'_>,
    lines_nm: &mut Vec<f64>,
) -> Result<Emission> {
    let spectrum = spectra.emission(&emission.spectrum).map_err(|e| e.under("spectrum"))?;
    let level = &emission.level;
    let kind = level.key();
    let at = |e: Error| e.under(kind).under("level");
    let unfinished =
        |e: Error| Error { hint: e.hint.or_else(|| Some("give a number from 0 up".to_owned())), ..e };
    power::check_level(level).map_err(|e| at(unfinished(e)))?;
    if let Some(BandFile::Range([from, to])) = level.band()
        && !(from > 0.0 && to > from)
    {
        return Err(at(Error::new(format!("the band from {from} to {to} nm is empty"))
            .hint("give two rising wavelengths, such as [360, 830]")
            .under("band_nm")));
    }
    power::resolve(&spectrum, level, shape, lines_nm).map_err(at)
}

/// Area in square metres, and area as seen along the axis where the shape has one.
fn surface_shape(geometry: &Geometry, object: u32, two_sided: bool) -> EmitterShape {
    let square_metres = geometry.metres_per_unit().powi(2);
    let ids = geometry.primitives_of(object);
    let area: f64 = ids.clone().map(|id| f64::from(geometry.area_of(id))).sum::<f64>() * square_metres;
    let seen_area_m2 = match geometry.primitive(ids.start) {
        _ if ids.len() != 1 => None,
        Primitive::Sphere(_) => Some(area / 4.0),
        Primitive::Cylinder(_) => None,
        _ => Some(area),
    };
    EmitterShape::Surface { area_m2: if two_sided { 2.0 * area } else { area }, seen_area_m2 }
}

/// The scene's instruments.
pub(super) fn meters(file: &SceneFile, built: &Built) -> Result<Vec<Meter>> {
    let one = |(index, meter): (usize, &MeterFile)| {
        let at = |kind: &'static str| move |e: Error| e.under(kind).under(index).under("meters");
        match meter {
            MeterFile::Illuminance { name, position, normal } => {
                let point = SurfacePoint {
                    position: built.position(*position, "position").map_err(at("illuminance"))?.as_vec3a(),
                    // A meter may lie on a surface: it then looks out from it.
                    error: Vec3A::splat(built.rounding()),
                    normal: unit_vector(*normal, "normal").map_err(at("illuminance"))?.as_vec3a(),
                };
                Ok(Meter { name: name.clone(), kind: MeterKind::Illuminance(point) })
            }
            MeterFile::Luminance { name, position, direction } => Ok(Meter {
                name: name.clone(),
                kind: MeterKind::Luminance {
                    position: built.position(*position, "position").map_err(at("luminance"))?.as_vec3a(),
                    direction: unit_vector(*direction, "direction").map_err(at("luminance"))?.as_vec3a(),
                },
            }),
        }
    };
    file.meters.iter().enumerate().map(one).collect()
}
