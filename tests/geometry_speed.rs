//! How fast rays are answered; run with `cargo test --release --test geometry_speed --
//! --ignored --nocapture`.

use etalon::geometry::{Geometry, GeometryBuilder, Ray, Shape, Transform, icosphere};
use glam::{DVec3, Vec3A};
use std::hint::black_box;
use std::time::Instant;

/// A room with two blocks and a lamp: 30 parallelograms as five walls, blocks and more.
fn room() -> Geometry {
    let mut builder = GeometryBuilder::new();
    let walls = Shape::Box { min: DVec3::ZERO, max: DVec3::ONE };
    builder.add_object(&walls, &Transform::IDENTITY).expect("a room");
    for i in 0..4 {
        let corner = DVec3::new(0.15 + 0.4 * f64::from(i % 2), 0.0, 0.15 + 0.4 * f64::from(i / 2));
        let block = Shape::Box { min: corner, max: corner + DVec3::new(0.2, 0.3, 0.2) };
        builder.add_object(&block, &Transform::IDENTITY).expect("a block");
    }
    builder.build().expect("a room")
}

/// A ball of 81,920 triangles, pushed in and out, inside a larger one of 20,480.
fn ball() -> Geometry {
    let mut mesh = icosphere(6);
    for position in &mut mesh.positions {
        let wave = (9.0 * position.x).sin() * (8.0 * position.y).cos() * (7.0 * position.z).sin();
        *position *= 0.5 * (1.0 + 0.3 * wave);
    }
    let mut builder = GeometryBuilder::new();
    builder.add_object(&Shape::Mesh(mesh), &Transform::IDENTITY).expect("a ball");
    builder.add_object(&Shape::Mesh(icosphere(5)), &Transform::IDENTITY).expect("a shell");
    builder.build().expect("a ball")
}

fn unit(state: &mut u32) -> f32 {
    *state = state.wrapping_mul(747796405).wrapping_add(2891336453);
    let word = ((*state >> ((*state >> 28) + 4)) ^ *state).wrapping_mul(277803737);
    (((word >> 22) ^ word) >> 8) as f32 / (1 << 24) as f32
}

/// Camera rays row by row, and for each a ray that bounces off what it meets.
fn rays(geometry: &Geometry, eye: Vec3A) -> (Vec<Ray>, Vec<Ray>) {
    let (mut camera, mut bounced) = (Vec::new(), Vec::new());
    let mut state = 1;
    for i in 0..1 << 20 {
        let (x, y) = ((i & 1023) as f32 / 1024.0 - 0.5, (i >> 10) as f32 / 1024.0 - 0.5);
        let ray = Ray::new(eye, Vec3A::new(x, y, 0.8).normalize());
        camera.push(ray);
        if let Some(hit) = geometry.intersect(&ray) {
            let side = hit.point.normal * -hit.point.normal.dot(ray.direction).signum();
            let any = Vec3A::new(unit(&mut state), unit(&mut state), unit(&mut state)) * 2.0 - 1.0;
            let direction = (side + any.normalize_or(Vec3A::X) * 0.999).normalize();
            bounced.push(hit.point.ray_along(direction));
        }
    }
    (camera, bounced)
}

fn rate(rays: &[Ray], answer: impl Fn(&Ray) -> bool) -> f64 {
    let best = (0..3).map(|_| {
        let start = Instant::now();
        black_box(rays.iter().filter(|ray| answer(ray)).count());
        start.elapsed().as_secs_f64()
    });
    rays.len() as f64 / best.fold(f64::INFINITY, f64::min) * 1e-6
}

#[test]
#[ignore = "a measurement, not a claim"]
fn million_rays_per_second() {
    let (room, ball) = (room(), ball());
    for (geometry, eye) in [(&room, Vec3A::new(0.5, 0.6, 0.02)), (&ball, Vec3A::new(0.0, 0.0, -0.9))] {
        let (camera, bounced) = rays(geometry, eye);
        println!(
            "{} primitives: camera {:.2}, bounced {:.2}, any hit {:.2}",
            geometry.primitive_count(),
            rate(&camera, |ray| geometry.intersect(ray).is_some()),
            rate(&bounced, |ray| geometry.intersect(ray).is_some()),
            rate(&bounced, |ray| geometry.occluded(ray)),
        );
    }
}
