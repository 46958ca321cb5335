//! Light from a single point.

use super::LightSample;
use crate::geometry::SurfacePoint;
use crate::spectrum::{Emission, Wavelengths};
use glam::Vec3A;

/// How intensity depends on direction, relative to its largest value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// The same in every direction.
    Isotropic,
    /// The cosine from a unit axis, dark behind.
    Cosine(Vec3A),
}

impl Distribution {
    /// Flux over largest intensity, in sr.
    pub const fn solid_angle_sr(&self) -> f64 {
        match self {
            Self::Isotropic => 4.0 * std::f64::consts::PI,
            Self::Cosine(_) => std::f64::consts::PI,
        }
    }

    fn towards(&self, direction: Vec3A) -> f32 {
        match self {
            Self::Isotropic => 1.0,
            Self::Cosine(axis) => axis.dot(direction).max(0.0),
        }
    }
}

/// A light without extent.
#[derive(Clone, Debug)]
pub struct PointLight {
    /// Where it is, in scene units.
    pub position: Vec3A,
    /// How its light spreads.
    pub distribution: Distribution,
    /// Largest intensity in W sr^-1 nm^-1, divided by the square of the metres per scene
    /// unit: over a squared distance in scene units it gives W m^-2 nm^-1.
    pub intensity: Emission,
}

impl PointLight {
    pub(super) fn sample_towards(
        &self,
        from: &SurfacePoint,
        wavelengths: &Wavelengths,
    ) -> Option<LightSample> {
        let shadow_ray = from.ray_to_position(self.position)?;
        let span = self.position - from.position;
        let share = self.distribution.towards(-shadow_ray.direction);
        (share > 0.0).then(|| LightSample {
            shadow_ray,
            radiance: self.intensity.at(wavelengths) * (share / span.length_squared()),
            pdf_solid_angle: 1.0,
            is_delta: true,
        })
    }
}
