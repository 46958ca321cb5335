//! What gives off light.
//!
//! A [`Light`] answers two questions about a point that it may light: draw a direction
//! towards you ([`Light::sample_towards`]), and with what density would you have drawn this
//! direction ([`Light::pdf_towards`]). Both are per solid angle at the lit point.
//! Levels are resolved in [`power`], once, when the scene is built. Which light is asked,
//! [`Lights`] decides.

mod area;
mod choose;
mod cluster;
mod cone;
mod hierarchy;
mod point;
pub mod power;
mod split;

pub use area::AreaLight;
pub use choose::Lights;
pub use point::{Distribution, PointLight};
pub use power::EmitterFacts;

use self::cluster::Cluster;
use crate::geometry::{Geometry, Hit, Ray, SurfacePoint};
use crate::spectrum::{Spectrum, Wavelengths};

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

    /// Density in sr^-1 with which `sample_towards` draws the direction from `from` that
    /// meets the light at `hit`; zero for lights that no ray can meet.
    #[inline]
    pub fn pdf_towards(&self, geometry: &Geometry, from: &SurfacePoint, ray: &Ray, hit: &Hit) -> f32 {
        match self {
            Self::Point(_) => 0.0,
            Self::Area(light) => light.pdf_towards(geometry, from, ray, hit),
        }
    }

    /// What the hierarchy of lights knows of a light with this power.
    fn cluster(&self, geometry: &Geometry, power: f64) -> Cluster {
        match self {
            Self::Point(light) => light.cluster(power),
            Self::Area(light) => light.cluster(geometry, power),
        }
    }
}
