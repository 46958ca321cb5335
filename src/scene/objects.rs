//! Objects, lights and meters of a scene, brought to scene units.

use super::file::{
    DistributionFile, EmissionFile, LengthUnit, LightFile, MaterialFile, MeterFile, ObjectFile, SceneFile,
    ShapeFile, TransformFile, Vector,
};
use super::spectra::Spectra;
use super::{Meter, MeterKind, SceneObject};
use crate::error::{Error, Result};
use crate::geometry::{Geometry, GeometryBuilder, Mesh, Primitive, Shape, ShapeError, SurfacePoint, Transform};
use crate::light::power::{self, EmitterShape};
use crate::light::{AreaLight, Distribution, EmitterFacts, Light, Lights, PointLight};
use glam::{DVec3, Vec3A};
use std::collections::BTreeMap;
use std::path::Path;

/// Geometry while it is being put up.
pub(super) struct Stage<'a> {
    unit: LengthUnit,
    folder: &'a Path,
    builder: GeometryBuilder,
    mesh_bytes: Vec<u64>,
}

/// Geometry that stands, and the way from the file's lengths to its own.
pub(super) struct Built {
    unit: LengthUnit,
    pub geometry: Geometry,
    /// Sizes of the mesh files read, for the scene's hash.
    pub mesh_bytes: Vec<u64>,
}

impl<'a> Stage<'a> {
    pub fn new(unit: LengthUnit, folder: &'a Path) -> Self {
        Self { unit, folder, builder: GeometryBuilder::new(), mesh_bytes: Vec::new() }
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
            let shape = self.shape(&object.shape).map_err(|e| at(e.under("shape")))?;
            let transform = self.transform(&object.transform).map_err(|e| at(e.under("transform")))?;
            let added = self.builder.add_object(&shape, &transform);
            added.map_err(|e| at(shape_error(&e).under("shape")))?;
        }
        Ok(())
    }

    /// Builds the acceleration structure.
    pub fn build(self) -> Result<Built> {
        let geometry = self.builder.build().map_err(|e| match e {
            ShapeError::Vanishes { object } => shape_error(&e).under("shape").under(object).under("objects"),
            _ => shape_error(&e).under("objects"),
        })?;
        Ok(Built { unit: self.unit, geometry, mesh_bytes: self.mesh_bytes })
    }

    fn metres(&self, point: Vector) -> DVec3 {
        DVec3::from_array(point.map(|c| self.unit.metres(c)))
    }

    fn shape(&mut self, file: &ShapeFile) -> Result<Shape> {
        let metres = |length: f64| self.unit.metres(length);
        Ok(match file {
            ShapeFile::Sphere { center, radius } => {
                Shape::Sphere { center: self.metres(*center), radius: metres(*radius) }
            }
            ShapeFile::Cylinder { from, to, radius, capped } => Shape::Cylinder {
                from: self.metres(*from),
                to: self.metres(*to),
                radius: metres(*radius),
                capped: *capped,
            },
            ShapeFile::Disk { center, normal, radius } => Shape::Disk {
                center: self.metres(*center),
                normal: DVec3::from_array(*normal),
                radius: metres(*radius),
            },
            ShapeFile::Quad { vertices } => Shape::Quad { vertices: vertices.map(|v| self.metres(v)) },
            ShapeFile::Box { min, max } => Shape::Box { min: self.metres(*min), max: self.metres(*max) },
            ShapeFile::Mesh { vertices, normals, triangles } => Shape::Mesh(Mesh {
                positions: vertices.iter().map(|v| self.metres(*v)).collect(),
                normals: normals.iter().map(|n| DVec3::from_array(*n)).collect(),
                triangles: triangles.clone(),
            }),
            ShapeFile::Ply { file } => self.mesh_file(file, crate::geometry::read_ply).map_err(|e| e.under("file").under("ply"))?,
            ShapeFile::Obj { file } => self.mesh_file(file, crate::geometry::read_obj).map_err(|e| e.under("file").under("obj"))?,
        })
    }

    fn mesh_file(
        &mut self,
        file: &str,
        read: impl Fn(&Path) -> std::result::Result<Mesh, crate::geometry::MeshFileError>,
    ) -> Result<Shape> {
        let path = self.folder.join(file);
        let mut mesh = read(&path).map_err(|fault| {
            let error = Error::new(fault.what.to_string()).in_file(&fault.file);
            match fault.line {
                Some(line) => error.at(line, None),
                None => error,
            }
            .hint("check the mesh file")
        })?;
        self.mesh_bytes.push(std::fs::metadata(&path).map_or(0, |m| m.len()));
        mesh.positions.iter_mut().for_each(|p| *p = self.metres(p.to_array()));
        Ok(Shape::Mesh(mesh))
    }

    fn transform(&self, list: &[TransformFile]) -> Result<Transform> {
        let steps = list.iter().enumerate().map(|(index, step)| {
            match step {
                TransformFile::Translate(offset) => Transform::translate(self.metres(*offset)),
                TransformFile::Rotate { axis, degrees } => Transform::rotate(DVec3::from_array(*axis), *degrees),
                TransformFile::Scale(factors) => Transform::scale(DVec3::from_array(*factors)),
                TransformFile::Matrix(rows) => {
                    let offset = |row: &[f64; 4]| [row[0], row[1], row[2], self.unit.metres(row[3])];
                    Transform::matrix(rows.each_ref().map(offset))
                }
            }
            .map_err(|e| shape_error(&e).under(index))
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
        if units.as_vec3().is_finite() {
            return Ok(units);
        }
        Err(Error::new("a position must be finite").under(key))
    }

    /// A length of the file in scene units.
    pub fn length(&self, length: f64) -> f64 {
        self.unit.metres(length) / self.geometry.metres_per_unit()
    }

    /// What positions in the scene are uncertain by, in scene units.
    fn rounding(&self) -> f32 {
        let bounds = self.geometry.bounds();
        if bounds.is_empty() { 0.0 } else { 4.0 * f32::EPSILON * bounds.min.abs().max(bounds.max.abs()).max_element() }
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
    Err(Error::new("a direction must be finite and not zero").hint("give a vector such as [0, 0, 1]").under(key))
}

fn shape_error(error: &ShapeError) -> Error {
    Error::new(error.to_string())
}

/// Names and materials of all objects.
pub(super) fn describe(objects: &[ObjectFile], materials: &BTreeMap<&str, u32>) -> Vec<SceneObject> {
    objects
        .iter()
        .enumerate()
        .map(|(index, object)| SceneObject {
            name: if object.name.is_empty() { format!("object {index}") } else { object.name.clone() },
            material: materials[object.material.as_str()],
            light: None,
        })
        .collect()
}

/// All lights: those of objects first, in their order, then those without a surface.
pub(super) fn lights(
    file: &SceneFile,
    built: &Built,
    mut objects: Vec<SceneObject>,
    spectra: &mut Spectra<'_>,
) -> Result<(Vec<SceneObject>, Lights, Vec<EmitterFacts>)> {
    let mut list = Vec::new();
    let mut facts = Vec::new();
    for (index, (described, object)) in file.objects.iter().zip(&mut objects).enumerate() {
        let Some(emission) = &described.emission else { continue };
        let at = |e: Error| e.under("emission").under(index).under("objects");
        let shape = surface_shape(&built.geometry, index as u32, emission.two_sided);
        let radiance = resolve(emission, shape, spectra).map_err(at)?;
        object.light = Some(list.len() as u32);
        facts.push(EmitterFacts::new(object.name.clone(), shape, &radiance));
        list.push(Light::Area(AreaLight::new(&built.geometry, index as u32, radiance, emission.two_sided)));
    }
    for (index, light) in file.lights.iter().enumerate() {
        let LightFile::Point { position, distribution, emission } = light;
        let at = |e: Error| e.under("point").under(index).under("lights");
        let distribution = match distribution {
            DistributionFile::Isotropic => Distribution::Isotropic,
            DistributionFile::Cosine { axis } => {
                let axis = unit_vector(*axis, "axis").map_err(|e| at(e.under("cosine").under("distribution")))?;
                Distribution::Cosine(axis.as_vec3a())
            }
        };
        let shape = EmitterShape::Point { solid_angle_sr: distribution.solid_angle_sr() };
        let intensity = resolve(emission, shape, spectra).map_err(|e| at(e.under("emission")))?;
        facts.push(EmitterFacts::new(format!("point light {index}"), shape, &intensity));
        list.push(Light::Point(PointLight {
            position: built.position(*position, "position").map_err(at)?.as_vec3a(),
            distribution,
            intensity: intensity.scaled(built.geometry.metres_per_unit().powi(-2)),
        }));
    }
    let weights: Vec<f64> = facts.iter().map(EmitterFacts::weight).collect();
    Ok((objects, Lights::new(list.into_iter().zip(weights).collect()), facts))
}

fn resolve(
    emission: &EmissionFile,
    shape: EmitterShape,
    spectra: &mut Spectra<'_>,
) -> Result<crate::spectrum::Dense> {
    let spectrum = spectra.emission(&emission.spectrum).map_err(|e| e.under("spectrum"))?;
    power::check_level(&emission.level).map_err(|e| e.under("level"))?;
    power::resolve(&spectrum, &emission.level, shape).map_err(|e| e.under("level"))
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
