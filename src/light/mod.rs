//! What gives off light.
//!
//! A [`Light`] answers two questions about a point that it may light: draw a direction
//! towards you ([`Light::sample_towards`]), and with what density would you have drawn this
//! direction ([`Light::pdf_towards`]); both are per solid angle at the lit point. It answers
//! the same two about light that leaves it: [`Light::emit`] draws a ray, [`Light::pdf_area`]
//! and [`Light::pdf_emission`] are the densities of its start and of its direction.
//! Levels are resolved in [`power`], once, when the scene is built. Which light is asked,
//! [`Lights`] decides.

mod area;
mod choose;
mod cluster;
mod cone;
mod hierarchy;
mod near_rectangle;
mod point;
pub mod power;
mod profile;
mod split;

pub use area::AreaLight;
pub use choose::Lights;
pub use point::{Distribution, PointLight};
pub use power::EmitterFacts;
pub use profile::Profile;

use self::cluster::Cluster;
use crate::geometry::{Geometry, Ray, SurfacePoint};
use crate::sampler::inverse::ANY;
use crate::spectrum::{Spectrum, Wavelengths};
use glam::Vec3A;

/// A source of light.
#[derive(Clone, Debug)]
pub enum Light {
    /// Light from one point.
    Point(PointLight),
    /// A surface that shines with the same radiance in all directions.
    Area(AreaLight),
}

/// A direction in which a light may be seen.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// The point of the light.
    pub point: SurfacePoint,
    /// Primitive in the geometry that it is on; `None` for a point light.
    pub primitive: Option<u32>,
    /// The stretch between the lit point and the light, to be tested for obstacles; its
    /// direction points to the light.
    pub shadow_ray: Ray,
    /// Radiance from there in W sr^-1 m^-2 nm^-1; for a point light its intensity over the
    /// squared distance, the coefficient of a delta.
    pub radiance: Spectrum,
    /// Density of the direction in sr^-1; 1 for a delta.
    pub pdf_solid_angle: f32,
    /// Whether this is the only direction in which the light can be seen.
    pub is_delta: bool,
}

/// A ray on its way out of a light.
#[derive(Clone, Copy, Debug)]
pub struct EmittedRay {
    /// Where it starts; a point light has no normal.
    pub point: SurfacePoint,
    /// Primitive in the geometry that it starts from; `None` for a point light.
    pub primitive: Option<u32>,
    /// The ray.
    pub ray: Ray,
    /// What goes this way, relative to [`Light::emission`]: the cosine from the normal, or
    /// the intensity relative to the largest.
    pub share: f32,
}

impl Light {
    /// Draws a direction from `from` towards the light; `None` where it cannot be seen.
    #[inline]
    pub fn sample_towards(
        &self,
        geometry: &Geometry,
        from: &SurfacePoint,
        u: [f32; 2],
        wavelengths: &Wavelengths,
    ) -> Option<LightSample> {
        match self {
            Self::Point(light) => light.sample_towards(from, wavelengths),
            Self::Area(light) => light.sample_towards(geometry, from, u, wavelengths),
        }
    }

    /// Density in sr^-1 with which `sample_towards` draws the direction from `from` to a point
    /// of one of the light's primitives; zero for lights that no ray can meet.
    #[inline]
    pub fn pdf_towards(
        &self,
        geometry: &Geometry,
        from: &SurfacePoint,
        point: &SurfacePoint,
        primitive: u32,
    ) -> f32 {
        match self {
            Self::Point(_) => 0.0,
            Self::Area(light) => light.pdf_towards(geometry, from, point, primitive),
        }
    }

    /// The numbers with which `sample_towards` draws a point of the light from `from`, the
    /// choice among its primitives included; `None` for a point that is never drawn: of
    /// another light, hidden or dark. 0.5 where they decide nothing.
    ///
    /// Among several primitives the first number has the resolution of `f32` in the whole
    /// light only.
    pub fn invert_towards(
        &self,
        geometry: &Geometry,
        from: &SurfacePoint,
        point: &SurfacePoint,
        primitive: Option<u32>,
    ) -> Option<[f32; 2]> {
        match self {
            Self::Point(_) => Some([ANY; 2]),
            Self::Area(light) => light.invert_towards(geometry, from, point, primitive?),
        }
    }

    /// Draws a ray of light; `None` for one that carries nothing.
    #[inline]
    pub fn emit(&self, geometry: &Geometry, u_point: [f32; 2], u_direction: [f32; 2]) -> Option<EmittedRay> {
        match self {
            Self::Point(light) => Some(light.emit(u_direction)),
            Self::Area(light) => light.emit(geometry, u_point, u_direction),
        }
    }

    /// The direction that `emit` draws for a point with this normal.
    #[inline]
    pub fn direction_from(&self, normal: Vec3A, u_direction: [f32; 2]) -> Vec3A {
        match self {
            Self::Point(light) => light.emit(u_direction).ray.direction,
            Self::Area(light) => light.direction_from(normal, u_direction),
        }
    }

    /// The numbers `u_point` and `u_direction` with which `emit` draws a ray from a point of
    /// the light along a unit vector; `None` for a ray that is never drawn: of another light,
    /// or dark. 0.5 where they decide nothing.
    pub fn invert_emission(
        &self,
        geometry: &Geometry,
        point: &SurfacePoint,
        primitive: Option<u32>,
        direction: Vec3A,
    ) -> Option<([f32; 2], [f32; 2])> {
        match self {
            Self::Point(light) => Some(([ANY; 2], light.distribution.invert(direction)?)),
            Self::Area(light) => light.invert_emission(geometry, point, primitive?, direction),
        }
    }

    /// Density with which `emit` draws each point, per square scene unit; 1 for a point light.
    #[inline]
    pub fn pdf_area(&self) -> f64 {
        match self {
            Self::Point(_) => 1.0,
            Self::Area(light) => light.pdf_area(),
        }
    }

    /// Density in sr^-1 with which `emit` draws a direction from a point with this normal.
    #[inline]
    pub fn pdf_emission(&self, normal: Vec3A, direction: Vec3A) -> f64 {
        match self {
            Self::Point(light) => light.pdf_emission(direction),
            Self::Area(light) => light.pdf_emission(normal, direction),
        }
    }

    /// Radiance in W sr^-1 m^-2 nm^-1 of the sides that shine, or the largest intensity of a
    /// point light (over square metres per square scene unit).
    #[inline]
    pub fn emission(&self, wavelengths: &Wavelengths) -> Spectrum {
        match self {
            Self::Point(light) => light.intensity.at(wavelengths),
            Self::Area(light) => light.radiance().at(wavelengths),
        }
    }

    /// Whether the light has a surface that rays can meet.
    pub const fn has_surface(&self) -> bool {
        matches!(self, Self::Area(_))
    }

    /// What the hierarchy of lights knows of a light with this power.
    fn cluster(&self, geometry: &Geometry, power: f64) -> Cluster {
        match self {
            Self::Point(light) => light.cluster(power),
            Self::Area(light) => light.cluster(geometry, power),
        }
    }
}
