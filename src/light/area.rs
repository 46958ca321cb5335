//! Surfaces that shine: the same radiance from every point in every direction.

use super::LightSample;
use crate::geometry::{Geometry, Hit, Primitive, Ray, SurfacePoint};
use crate::spectrum::{Emission, Wavelengths};
use glam::Vec3A;

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
            primitive => {
                let point = primitive.sample_area(u);
                (point, self.pdf_by_area(from, &point))
            }
        };
        let shadow_ray = from.ray_to(&point)?;
        let visible = self.shines(point.normal, -shadow_ray.direction);
        (visible && pdf_solid_angle > 0.0 && pdf_solid_angle.is_finite()).then(|| LightSample {
            shadow_ray,
            radiance: self.radiance.at(wavelengths),
            pdf_solid_angle,
            is_delta: false,
        })
    }

    pub(super) fn pdf_towards(&self, geometry: &Geometry, from: &SurfacePoint, ray: &Ray, hit: &Hit) -> f32 {
        match geometry.primitive(hit.primitive) {
            Primitive::Sphere(sphere) => {
                sphere.pdf_solid_angle(from.position, &hit.point) * self.share_of(geometry, hit.primitive)
            }
            _ => {
                let cosine = hit.point.normal.dot(ray.direction).abs();
                hit.t * hit.t / (cosine * self.area)
            }
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
        /// Largest f32 below one.
        const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;
        if let [(id, _)] = self.primitives[..] {
            return (id, [u, v]);
        }
        let index = self.primitives.partition_point(|(_, upto)| *upto <= u).min(self.primitives.len() - 1);
        let (id, upto) = self.primitives[index];
        let before = if index == 0 { 0.0 } else { self.primitives[index - 1].1 };
        (id, [((u - before) / (upto - before)).clamp(0.0, BELOW_ONE), v])
    }
}
