//! Points of lenses.

use crate::support::{Map, ROUNDING};
use etalon::camera::{Camera, CameraPlacement, LensAperture};
use etalon::geometry::{Ray, SurfacePoint};
use etalon::path::Eye;
use glam::{DVec3, Vec3A};

fn camera(radius: Option<f64>) -> Camera {
    let forward = DVec3::new(0.6, -0.48, 0.64);
    let (right, up) = forward.any_orthonormal_pair();
    let placement = CameraPlacement { position: DVec3::new(0.25, 0.5, -0.9), forward, right, up };
    let aperture = radius.map(|radius| LensAperture { radius, focus_distance: 2.0 });
    Camera::new(placement, [40, 20], [0.5, 0.25], [0.0, 0.0], aperture)
}

/// Two roundings of each coordinate, up to one in size: that of the point asked for and that
/// of the point drawn.
#[test]
fn points_of_a_lens_give_back_their_numbers() {
    for (seed, radius) in [0.3, 0.01, 1e-3, 1e-4].into_iter().enumerate() {
        let camera = camera(Some(radius));
        let eye = Eye::Camera(&camera);
        let point = |u| camera.lens_point(u).position;
        let draw = |u| Some((0, point(u).as_dvec3()));
        let rounding = 2.0 * 3f64.sqrt() * ROUNDING;
        let map = Map { name: format!("lens of {radius}"), draw: &draw, rounding: &|_| rounding, step: 0.01 };
        let tally = map.inverts(seed as u64, |u| {
            assert_eq!(camera.invert_lens(point(u)), eye.invert_lens(point(u)));
            Some(camera.invert_lens(point(u)))
        });
        tally.assert_telling(&map.name, 0.7);
        assert_eq!(camera.ray([3.0, 4.0], [0.3, 0.8]).origin, point([0.3, 0.8]));
    }
}

#[test]
fn without_a_lens_the_numbers_are_in_the_middle() {
    let camera = camera(None);
    let point = SurfacePoint { position: Vec3A::ZERO, error: Vec3A::ZERO, normal: Vec3A::Z };
    let ray = Ray::new(Vec3A::ZERO, Vec3A::Z);
    for eye in [Eye::Camera(&camera), Eye::Irradiance(point), Eye::Radiance(ray)] {
        assert_eq!(eye.invert_lens(eye.ray([0.3, 0.4], [0.1, 0.9]).point.position), [0.5; 2]);
    }
}
