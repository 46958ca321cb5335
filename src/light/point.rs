//! Light from a single point.

use super::cluster::Cluster;
use super::cone::Cone;
use super::profile::Profile;
use super::{EmittedRay, LightSample};
use crate::geometry::{Bounds, SurfacePoint};
use crate::sampler::inverse::{turn, unit};
use crate::spectrum::{Emission, Wavelengths};
use glam::{DVec3, Vec3A};
use std::f64::consts::{PI, TAU};

/// How intensity depends on direction, relative to its largest value.
#[derive(Clone, Debug, PartialEq)]
pub enum Distribution {
    /// The same in every direction.
    Isotropic,
    /// The cosine from a unit axis, dark behind.
    Cosine(Vec3A),
    /// Tabulated over the angle from an axis.
    Profile(Profile),
}

impl Distribution {
    /// Flux over largest intensity, in sr.
    pub fn solid_angle_sr(&self) -> f64 {
        match self {
            Self::Isotropic => 4.0 * PI,
            Self::Cosine(_) => PI,
            Self::Profile(profile) => profile.solid_angle_sr(),
        }
    }

    /// Intensity in a direction relative to the largest.
    pub fn towards(&self, direction: Vec3A) -> f32 {
        match self {
            Self::Isotropic => 1.0,
            Self::Cosine(axis) => axis.dot(direction).max(0.0),
            Self::Profile(profile) => profile.towards(direction),
        }
    }

    /// A direction with density in proportion to the intensity, from two numbers in [0, 1).
    fn sample(&self, [u, v]: [f32; 2]) -> Vec3A {
        let around = |height: f64| [height, ((1.0 - height) * (1.0 + height)).max(0.0).sqrt()];
        let (axis, [height, across]) = match self {
            Self::Isotropic => (DVec3::Z, around(1.0 - 2.0 * f64::from(u))),
            Self::Cosine(axis) => (axis.as_dvec3(), around((1.0 - f64::from(u)).sqrt())),
            Self::Profile(profile) => {
                let (sin, cos) = profile.angle_at(f64::from(u)).sin_cos();
                (profile.axis(), [cos, sin])
            }
        };
        let (tangent, bitangent) = axis.any_orthonormal_pair();
        let (sin, cos) = (TAU * f64::from(v)).sin_cos();
        (axis * height + (tangent * cos + bitangent * sin) * across).normalize().as_vec3a()
    }

    /// The numbers with which `sample` draws a direction; `None` where it is dark.
    pub(super) fn invert(&self, direction: Vec3A) -> Option<[f32; 2]> {
        let axis = match self {
            Self::Isotropic => DVec3::Z,
            Self::Cosine(axis) => axis.as_dvec3(),
            Self::Profile(profile) => profile.axis(),
        };
        let (tangent, bitangent) = axis.any_orthonormal_pair();
        let u_profile =
            if let Self::Profile(profile) = self { profile.share_within(direction)? } else { 0.0 };
        let direction = direction.as_dvec3().normalize();
        let (x, y, height) = (direction.dot(tangent), direction.dot(bitangent), direction.dot(axis));
        let across2 = x * x + y * y;
        let u = match self {
            // (1 - height) / 2, without cancellation about the pole.
            Self::Isotropic if height > 0.0 => 0.5 * across2 / (1.0 + height),
            Self::Isotropic => 0.5 * (1.0 - height),
            Self::Cosine(_) if height > 0.0 => across2,
            Self::Cosine(_) => return None,
            Self::Profile(_) => u_profile,
        };
        Some([unit(u), unit(turn(x, y))])
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
    /// The position as a point that rays leave; without extent, error or normal.
    pub(super) const fn point(&self) -> SurfacePoint {
        SurfacePoint { position: self.position, error: Vec3A::ZERO, normal: Vec3A::ZERO }
    }

    pub(super) fn sample_towards(
        &self,
        from: &SurfacePoint,
        wavelengths: &Wavelengths,
    ) -> Option<LightSample> {
        let shadow_ray = from.ray_to_position(self.position)?;
        let span = self.position - from.position;
        let share = self.distribution.towards(-shadow_ray.direction);
        (share > 0.0).then(|| LightSample {
            point: self.point(),
            primitive: None,
            shadow_ray,
            radiance: self.intensity.at(wavelengths) * (share / span.length_squared()),
            pdf_solid_angle: 1.0,
            is_delta: true,
        })
    }

    pub(super) fn emit(&self, u_direction: [f32; 2]) -> EmittedRay {
        let direction = self.distribution.sample(u_direction);
        let point = self.point();
        let share = self.distribution.towards(direction);
        EmittedRay { point, primitive: None, ray: point.ray_along(direction), share }
    }

    /// Density of `emit` in sr^-1.
    pub(super) fn pdf_emission(&self, direction: Vec3A) -> f64 {
        f64::from(self.distribution.towards(direction)) / self.distribution.solid_angle_sr()
    }

    /// What the hierarchy of lights knows of this light with its power.
    pub(super) fn cluster(&self, power: f64) -> Cluster {
        Cluster {
            bounds: Bounds { min: self.position, max: self.position },
            normals: match &self.distribution {
                // A cone of normals stands for a cosine about each; a profile need not fall so.
                Distribution::Isotropic | Distribution::Profile(_) => Cone::ALL,
                Distribution::Cosine(axis) => Cone::along(axis.as_dvec3(), false),
            },
            intensity: power / self.distribution.solid_angle_sr(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of 1/p over directions drawn with density p is the solid angle that is lit.
    #[test]
    fn directions_fall_as_densely_as_they_say() {
        let profile = Profile::new(DVec3::X, &[0.0, 40.0, 100.0], &[0.2, 1.0, 0.1]).expect("a sound profile");
        let lit = TAU * (1.0 - f64::to_radians(100.0).cos());
        for (distribution, truth) in [
            (Distribution::Isotropic, 4.0 * PI),
            (Distribution::Cosine(Vec3A::Y), TAU),
            (Distribution::Profile(profile), lit),
        ] {
            let intensity = Emission::new(crate::spectrum::Dense::Flat(1.0), vec![]);
            let light = PointLight { position: Vec3A::ZERO, distribution, intensity };
            const STEPS: u16 = 300;
            let place = |i: u16| (f32::from(i) + 0.5) / f32::from(STEPS);
            let draws = (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| [place(i), place(j)]));
            let sum: f64 = draws.map(|u| 1.0 / light.pdf_emission(light.emit(u).ray.direction)).sum();
            let mean = sum / f64::from(STEPS).powi(2);
            // The cosine's 1/p is integrable and unbounded at the horizon.
            assert!((mean / truth - 1.0).abs() < 0.02, "{mean} against {truth}");
        }
    }
}
