//! Surfaces that shine: the same radiance from every point in every direction.

use super::cluster::Cluster;
use super::cone::Cone;
use super::near_rectangle::NearRectangle;
use super::{EmittedRay, LightSample};
use crate::geometry::{Bounds, Frame, Geometry, Primitive, SurfacePoint};
use crate::sampler::inverse::{BELOW_ONE, turn, unit};
use crate::spectrum::{Emission, Wavelengths};
use glam::{DVec3, Vec3A};
use std::f64::consts::PI;

/// A Lambertian emitter made of the primitives of one object.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// The primitives, and for each the share of area up to and including it.
    primitives: Vec<(u32, f32)>,
    /// Area of one side in square scene units.
    area: f32,
    radiance: Emission,
    two_sided: bool,
}

/// Share of its area that a convex closed surface shows, on average over directions (Cauchy).
const SEEN_OF_CLOSED: f64 = 0.25;

/// The largest number that chooses the first of two sides.
const BELOW_HALF: f32 = 0.5 - f32::EPSILON / 4.0;

impl AreaLight {
    /// A light from the primitives of an object; radiance in W sr^-1 m^-2 nm^-1.
    pub fn new(geometry: &Geometry, object: u32, radiance: Emission, two_sided: bool) -> Self {
        let areas: Vec<(u32, f64)> =
            geometry.primitives_of(object).map(|id| (id, f64::from(geometry.area_of(id)))).collect();
        let area: f64 = areas.iter().map(|(_, a)| a).sum();
        let mut sum = 0.0;
        let primitives = areas
            .iter()
            .map(|(id, a)| {
                sum += a;
                (*id, (sum / area) as f32)
            })
            .collect();
        Self { primitives, area: area as f32, radiance, two_sided }
    }

    /// Spectral radiance of the shining sides.
    pub const fn radiance(&self) -> &Emission {
        &self.radiance
    }

    /// Whether the surface shines towards a direction, given its normal there.
    #[inline]
    pub fn shines(&self, normal: Vec3A, towards: Vec3A) -> bool {
        self.two_sided || normal.dot(towards) > 0.0
    }

    pub(super) fn sample_towards(
        &self,
        geometry: &Geometry,
        from: &SurfacePoint,
        u: [f32; 2],
        wavelengths: &Wavelengths,
    ) -> Option<LightSample> {
        let (id, u) = self.choose(u);
        let (point, pdf_solid_angle) = match geometry.primitive(id) {
            Primitive::Sphere(sphere) => {
                let (point, pdf) = sphere.sample_solid_angle(from.position, u)?;
                (point, pdf * self.share_of(geometry, id))
            }
            primitive => match near(primitive, from) {
                Some(near) => (near.sample(u), near.pdf() * self.share_of(geometry, id)),
                None => {
                    let point = primitive.sample_area(u);
                    (point, self.pdf_by_area(from, &point))
                }
            },
        };
        let shadow_ray = from.ray_to(&point)?;
        let visible = self.shines(point.normal, -shadow_ray.direction);
        (visible && pdf_solid_angle > 0.0 && pdf_solid_angle.is_finite()).then(|| LightSample {
            point,
            primitive: Some(id),
            shadow_ray,
            radiance: self.radiance.at(wavelengths),
            pdf_solid_angle,
            is_delta: false,
        })
    }

    pub(super) fn pdf_towards(
        &self,
        geometry: &Geometry,
        from: &SurfacePoint,
        point: &SurfacePoint,
        primitive: u32,
    ) -> f32 {
        match geometry.primitive(primitive) {
            Primitive::Sphere(sphere) => {
                sphere.pdf_solid_angle(from.position, point) * self.share_of(geometry, primitive)
            }
            surface => match near(surface, from) {
                Some(near) => near.pdf() * self.share_of(geometry, primitive),
                None => self.pdf_by_area(from, point),
            },
        }
    }

    /// A point uniform over the area, and a direction in proportion to the cosine from the
    /// normal on a side that shines.
    pub(super) fn emit(
        &self,
        geometry: &Geometry,
        u_point: [f32; 2],
        u_direction: [f32; 2],
    ) -> Option<EmittedRay> {
        let (id, u_point) = self.choose(u_point);
        let point = geometry.primitive(id).sample_area(u_point);
        let direction = self.direction_from(point.normal, u_direction);
        let share = point.normal.dot(direction).abs();
        (share > 0.0).then(|| EmittedRay {
            point,
            primitive: Some(id),
            ray: point.ray_along(direction),
            share,
        })
    }

    /// A direction in proportion to the cosine from the normal on a side that shines.
    pub(super) fn direction_from(&self, normal: Vec3A, [u, v]: [f32; 2]) -> Vec3A {
        let (side, u) = match (self.two_sided, u < 0.5) {
            (false, _) => (1.0, u),
            (true, true) => (1.0, 2.0 * u),
            (true, false) => (-1.0, 2.0 * u - 1.0),
        };
        let frame = Frame::around(normal * side);
        let height = (1.0 - u).sqrt();
        let (sin, cos) = (std::f32::consts::TAU * v).sin_cos();
        let across = u.sqrt();
        frame.to_world(Vec3A::new(across * cos, across * sin, height)).normalize()
    }

    pub(super) fn invert_towards(
        &self,
        geometry: &Geometry,
        from: &SurfacePoint,
        point: &SurfacePoint,
        id: u32,
    ) -> Option<[f32; 2]> {
        let shadow_ray = from.ray_to(point)?;
        if !self.shines(point.normal, -shadow_ray.direction) {
            return None;
        }
        let u = match geometry.primitive(id) {
            Primitive::Sphere(sphere) => sphere.invert_solid_angle(from.position, point)?,
            primitive => match near(primitive, from) {
                Some(near) => near.invert(point),
                None => primitive.invert_area(point.position),
            },
        };
        self.invert_choice(id, u)
    }

    pub(super) fn invert_emission(
        &self,
        geometry: &Geometry,
        point: &SurfacePoint,
        id: u32,
        direction: Vec3A,
    ) -> Option<([f32; 2], [f32; 2])> {
        let surface = geometry.primitive(id);
        let u_point = self.invert_choice(id, surface.invert_area(point.position))?;
        // The normal that `emit` will find: a frame may turn over between two that differ by a
        // rounding.
        let normal = surface.sample_area(self.choose(u_point).1).normal;
        let side = normal.dot(direction);
        if side == 0.0 || !self.shines(normal, direction) {
            return None;
        }
        let local = Frame::around(normal * side.signum()).to_local(direction).as_dvec3().normalize();
        let across2 = local.x * local.x + local.y * local.y;
        let u = match (self.two_sided, side > 0.0) {
            (false, _) => unit(across2),
            (true, true) => unit(0.5 * across2).min(BELOW_HALF),
            (true, false) => unit(0.5 + 0.5 * across2),
        };
        Some((u_point, [u, unit(turn(local.x, local.y))]))
    }

    /// Density of the direction of `emit` in sr^-1.
    pub(super) fn pdf_emission(&self, normal: Vec3A, direction: Vec3A) -> f64 {
        let sides = if self.two_sided { 2.0 } else { 1.0 };
        if self.shines(normal, direction) {
            f64::from(normal.dot(direction).abs()) / (sides * std::f64::consts::PI)
        } else {
            0.0
        }
    }

    /// Density of the point of `emit` per square scene unit.
    pub(super) fn pdf_area(&self) -> f64 {
        1.0 / f64::from(self.area)
    }

    /// What the hierarchy of lights knows of this light with its power.
    pub(super) fn cluster(&self, geometry: &Geometry, power: f64) -> Cluster {
        let mut bounds = Bounds::EMPTY;
        let mut normals: Option<Cone> = None;
        let mut seen = DVec3::ZERO;
        for (id, _) in &self.primitives {
            let primitive = geometry.primitive(*id);
            let normal = primitive.flat_normal().map(|normal| normal.as_dvec3());
            let cone = normal.map_or(Cone::ALL, |normal| Cone::along(normal, self.two_sided));
            bounds = bounds.union(&primitive.bounds());
            normals = Some(normals.map_or(cone, |normals| normals.union(&cone)));
            seen += normal.unwrap_or(DVec3::ZERO) * f64::from(primitive.area());
        }
        let share_seen = (seen.length() / f64::from(self.area)).max(SEEN_OF_CLOSED);
        let sides = if self.two_sided { 2.0 } else { 1.0 };
        Cluster {
            bounds,
            normals: normals.unwrap_or(Cone::ALL),
            intensity: power * share_seen / (PI * sides),
        }
    }

    /// Probability of choosing a primitive: its share of the area.
    fn share_of(&self, geometry: &Geometry, id: u32) -> f32 {
        if self.primitives.len() == 1 { 1.0 } else { geometry.area_of(id) / self.area }
    }

    /// Uniform over the area: density per solid angle is d^2 / (cos A).
    fn pdf_by_area(&self, from: &SurfacePoint, point: &SurfacePoint) -> f32 {
        let span = point.position - from.position;
        let squared = span.length_squared();
        let cosine = point.normal.dot(span).abs() / squared.sqrt();
        squared / (cosine * self.area)
    }

    /// Picks a primitive by area with the first number, and stretches what is left of it
    /// back to [0, 1).
    fn choose(&self, [u, v]: [f32; 2]) -> (u32, [f32; 2]) {
        if let [(id, _)] = self.primitives[..] {
            return (id, [u, v]);
        }
        let index = self.primitives.partition_point(|(_, upto)| *upto <= u).min(self.primitives.len() - 1);
        let (id, upto) = self.primitives[index];
        let before = if index == 0 { 0.0 } else { self.primitives[index - 1].1 };
        (id, [((u - before) / (upto - before)).clamp(0.0, BELOW_ONE), v])
    }

    /// The numbers with which `choose` picks a primitive and leaves `u` and `v`; `None` for a
    /// primitive of another light or without a share that `f32` can tell.
    fn invert_choice(&self, id: u32, [u, v]: [f32; 2]) -> Option<[f32; 2]> {
        let index = self.primitives.binary_search_by_key(&id, |(id, _)| *id).ok()?;
        if self.primitives.len() == 1 {
            return Some([u, v]);
        }
        let upto = self.primitives[index].1;
        let before = if index == 0 { 0.0 } else { self.primitives[index - 1].1 };
        let within = f64::from(before) + f64::from(u) * (f64::from(upto) - f64::from(before));
        // Rounding must not reach the next primitive.
        (upto > before).then(|| [(within as f32).clamp(before, upto.next_down()), v])
    }
}

/// A rectangle that is near enough to be drawn from by what it fills of the view.
#[inline]
fn near<'p>(primitive: &'p Primitive, from: &SurfacePoint) -> Option<NearRectangle<'p>> {
    match primitive {
        Primitive::Parallelogram(quad) => NearRectangle::new(quad, from),
        _ => None,
    }
}
