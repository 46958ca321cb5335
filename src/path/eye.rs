//! The far end of a path: a camera, or an instrument.
//!
//! What an eye records is an integral of radiance weighted with its importance W. The product
//! of W, the cosine and the area is stated as a response times the density with which the eye
//! draws its own rays, so that one number serves both ends.

use crate::camera::Camera;
use crate::geometry::{Frame, Ray, SurfacePoint};
use crate::sampler::inverse::ANY;
use glam::Vec3A;
use std::f64::consts::{PI, TAU};

/// What light is gathered for.
#[derive(Clone, Copy, Debug)]
pub enum Eye<'a> {
    /// A picture: positions are those of its pixels.
    Camera(&'a Camera),
    /// Irradiance on the side that the point's normal faces.
    Irradiance(SurfacePoint),
    /// Radiance against one ray.
    Radiance(Ray),
}

/// A ray that an eye sends out.
#[derive(Clone, Copy, Debug)]
pub struct EyeRay {
    /// Where it starts.
    pub point: SurfacePoint,
    /// The ray.
    pub ray: Ray,
    /// Density of its direction in sr^-1 over the whole picture; 1 for the only ray.
    pub pdf_solid_angle: f64,
}

/// How an eye sees light that arrives at one of its points.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    /// Density in sr^-1 with which the eye draws this direction itself.
    pub pdf_solid_angle: f64,
    /// Where it is recorded, in pixels from the top left corner.
    pub position: [f64; 2],
}

impl Eye<'_> {
    /// The ray at a position of the picture, through the point of the lens that `u_lens`
    /// names. Instruments take both numbers of the position from [0, 1).
    pub fn ray(&self, position: [f64; 2], u_lens: [f32; 2]) -> EyeRay {
        match self {
            Self::Camera(camera) => {
                let ray = camera.ray(position, u_lens);
                let pdf_solid_angle = camera.pdf_solid_angle(ray.direction);
                EyeRay { point: camera.point_at(ray.origin), ray, pdf_solid_angle }
            }
            Self::Irradiance(point) => {
                let height = (1.0 - position[0]).sqrt();
                let (sin, cos) = (TAU * position[1]).sin_cos();
                let across = position[0].sqrt();
                let local = Vec3A::new((across * cos) as f32, (across * sin) as f32, height as f32);
                let ray = point.ray_along(Frame::around(point.normal).to_world(local).normalize());
                EyeRay { point: *point, ray, pdf_solid_angle: irradiance_pdf(point, ray.direction) }
            }
            Self::Radiance(ray) => {
                let point = SurfacePoint { position: ray.origin, error: Vec3A::ZERO, normal: ray.direction };
                EyeRay { point, ray: *ray, pdf_solid_angle: 1.0 }
            }
        }
    }

    /// The ray from a point of a camera's lens that is recorded at a position of the picture;
    /// `None` for instruments.
    pub fn ray_from(&self, point: &SurfacePoint, position: [f64; 2]) -> Option<Ray> {
        match self {
            Self::Camera(camera) => Some(camera.ray_from(point.position, position)),
            Self::Irradiance(_) | Self::Radiance(_) => None,
        }
    }

    /// What one of the eye's own rays counts.
    pub const fn response(&self) -> f32 {
        match self {
            Self::Camera(_) | Self::Radiance(_) => 1.0,
            Self::Irradiance(_) => std::f32::consts::PI,
        }
    }

    /// A point of the eye for light to be joined to; `None` where the eye looks in one
    /// direction only.
    pub fn point(&self, u_lens: [f32; 2]) -> Option<SurfacePoint> {
        match self {
            Self::Camera(camera) => Some(camera.lens_point(u_lens)),
            Self::Irradiance(point) => Some(*point),
            Self::Radiance(_) => None,
        }
    }

    /// The numbers `u_lens` that name a point of the eye, in scene units; 0.5 where there is
    /// one point only.
    pub fn invert_lens(&self, point: Vec3A) -> [f32; 2] {
        match self {
            Self::Camera(camera) => camera.invert_lens(point),
            Self::Irradiance(_) | Self::Radiance(_) => [ANY; 2],
        }
    }

    /// Whether light can be joined to a point of the eye.
    pub const fn is_open(&self) -> bool {
        !matches!(self, Self::Radiance(_))
    }

    /// Whether points of the eye differ.
    pub const fn has_aperture(&self) -> bool {
        matches!(self, Self::Camera(camera) if camera.has_aperture())
    }

    /// Density of a point of the eye per square scene unit; 1 where there is one only.
    pub fn pdf_area(&self) -> f64 {
        match self {
            Self::Camera(camera) => camera.pdf_lens_area().unwrap_or(1.0),
            Self::Irradiance(_) | Self::Radiance(_) => 1.0,
        }
    }

    /// How light is seen that arrives at a point of the eye from `direction`, which points
    /// into the scene; `None` where it is not.
    pub fn sees(&self, point: &SurfacePoint, direction: Vec3A) -> Option<Sight> {
        let (pdf_solid_angle, position) = match self {
            Self::Camera(camera) => {
                let position = camera.picture_position(point.position, direction)?;
                (camera.pdf_solid_angle(direction), position)
            }
            Self::Irradiance(point) => (irradiance_pdf(point, direction), [0.0; 2]),
            Self::Radiance(_) => return None,
        };
        (pdf_solid_angle > 0.0).then_some(Sight { pdf_solid_angle, position })
    }

    /// Where a ray meets the eye by itself, and how far away.
    pub fn meet(&self, ray: &Ray) -> Option<(SurfacePoint, f32)> {
        match self {
            Self::Camera(camera) => camera.meet_lens(ray),
            Self::Irradiance(_) | Self::Radiance(_) => None,
        }
    }
}

fn irradiance_pdf(point: &SurfacePoint, direction: Vec3A) -> f64 {
    f64::from(point.normal.dot(direction)).max(0.0) / PI
}
