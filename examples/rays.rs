//! How fast rays are answered on one core, in millions per CPU second:
//! `cargo run --release --example rays -- SCENE.json` or, for a closed mesh of about so many
//! triangles seen from inside, `... --example rays -- 100000`.
//!
//! Three kinds: *camera* (nearest surface, neighbours side by side), *bounce* (nearest surface,
//! from where camera rays end into any direction of the half space) and *shadow* (whether
//! anything is met, from there to places anywhere in the scene). `--ply FILE` writes the mesh;
//! `--dump FILE` writes triangles and rays for another program to answer, see
//! `validation/performance/embree.cpp`. What is printed is the best of five rounds, and a sum
//! over what was met, which changes only with the answers.

use cpu_time::ThreadTime;
use etalon::error::{Error, Result};
use etalon::geometry::{Geometry, GeometryBuilder, Mesh, Primitive, Ray, Shape, Transform};
use etalon::scene::Scene;
use glam::{DVec3, Vec3A};
use std::hint::black_box;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Side of the picture in rays.
const SIDE: u32 = 512;
const ROUNDS: u32 = 5;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let usage = || Error::new("a scene file or a number of triangles is needed").hint("rays 100000");
    let what = arguments.first().ok_or_else(usage)?;
    let option = |name: &str| arguments.iter().skip_while(|a| *a != name).nth(1);
    let (geometry, camera) = match what.parse() {
        Ok(triangles) => {
            let mesh = bumpy_ball(triangles);
            if let Some(file) = option("--ply") {
                return write_ply(file, &mesh).map_err(|e| Error::new(e.to_string()));
            }
            (built(mesh)?, None)
        }
        Err(_) => {
            let scene = Scene::load(Path::new(what))?;
            let camera = scene.view()?.camera.with_resolution([SIDE, SIDE]);
            (scene.geometry, Some(camera))
        }
    };
    let camera_rays: Vec<Ray> = (0..SIDE * SIDE)
        .map(|i| {
            let (x, y) = (f64::from(i % SIDE) + 0.5, f64::from(i / SIDE) + 0.5);
            match &camera {
                Some(camera) => camera.ray([x, y], [0.5, 0.5]),
                None => inside_ray([x, y].map(|c| (c / f64::from(SIDE)) as f32)),
            }
        })
        .collect();
    let [bounces, shadows] = from_hits(&geometry, &camera_rays);
    if let Some(file) = option("--dump") {
        return dump(file, &geometry, [&camera_rays, &bounces, &shadows])
            .map_err(|e| Error::new(e.to_string()));
    }
    let nearest = |ray: &Ray| geometry.intersect(ray).map_or(0.0, |hit| f64::from(hit.t));
    let any = |ray: &Ray| f64::from(u8::from(geometry.occluded(ray)));
    println!("{} primitives", geometry.primitive_count());
    report("camera", &camera_rays, nearest);
    report("bounce", &bounces, nearest);
    report("shadow", &shadows, any);
    Ok(())
}

fn report(kind: &str, rays: &[Ray], answer: impl Fn(&Ray) -> f64) {
    let (mut best, mut sum) = (f64::INFINITY, 0.0);
    for _ in 0..ROUNDS {
        let start = ThreadTime::now();
        sum = black_box(rays).iter().map(&answer).sum();
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!("{kind} {:.3} Mrays/s, {} rays, sum {sum:.6}", rays.len() as f64 / best * 1e-6, rays.len());
}

/// A cube of `n` by `n` squares a face, blown up to a ball and dented: closed, since points
/// that faces share are computed alike.
fn bumpy_ball(triangles: u32) -> Mesh {
    let n = ((f64::from(triangles) / 12.0).sqrt().round() as u32).max(1);
    let mut mesh = Mesh::default();
    let grid = |i: u32| 2.0 * f64::from(i) / f64::from(n) - 1.0;
    for face in 0..6 {
        let first = mesh.positions.len() as u32;
        let (axis, side) = (face % 3, if face < 3 { 1.0 } else { -1.0 });
        for (i, j) in (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j))) {
            let mut on_cube = DVec3::ZERO;
            on_cube[axis] = side;
            on_cube[(axis + 1) % 3] = side * grid(i);
            on_cube[(axis + 2) % 3] = grid(j);
            mesh.positions.push(bumped(on_cube));
        }
        for (i, j) in (0..n).flat_map(|j| (0..n).map(move |i| (i, j))) {
            let corner = first + j * (n + 1) + i;
            let [a, b, c, d] = [corner, corner + 1, corner + n + 2, corner + n + 1];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

fn bumped(on_cube: DVec3) -> DVec3 {
    let p = on_cube.normalize();
    let wave = |f: f64| (f * p.x + 1.0).sin() * (f * p.y + 2.0).sin() * (f * p.z + 3.0).sin();
    p * (0.7 + 0.15 * wave(7.0) + 0.05 * wave(31.0) + 0.01 * wave(97.0))
}

fn built(mesh: Mesh) -> Result<Geometry> {
    let wrong = |e: etalon::geometry::ShapeError| Error::new(e.to_string());
    let mut builder = GeometryBuilder::new();
    builder.add_object(&Shape::Mesh(mesh), &Transform::IDENTITY).map_err(wrong)?;
    builder.build().map_err(wrong)
}

/// A wide view from off the middle of the ball.
fn inside_ray([x, y]: [f32; 2]) -> Ray {
    Ray::new(Vec3A::new(0.1, -0.05, -0.3), Vec3A::new(2.0 * x - 1.0, 1.0 - 2.0 * y, 0.7).normalize())
}

/// Bounces and shadow rays from where `rays` end.
fn from_hits(geometry: &Geometry, rays: &[Ray]) -> [Vec<Ray>; 2] {
    let (mut bounces, mut shadows) = (Vec::new(), Vec::new());
    let mut state = 1;
    let mut signed = move || 2.0 * unit(&mut state) - 1.0;
    let (middle, half) = (geometry.bounds().center(), 0.5 * (geometry.bounds().max - geometry.bounds().min));
    for ray in rays {
        let Some(hit) = geometry.intersect(ray) else { continue };
        let side = hit.point.normal * -hit.point.normal.dot(ray.direction).signum();
        let ball = Vec3A::new(signed(), signed(), signed()).normalize_or(Vec3A::X);
        bounces.push(hit.point.ray_along((side + ball * 0.999).normalize()));
        let place = middle + 0.9 * half * Vec3A::new(signed(), signed(), signed());
        shadows.extend(hit.point.ray_to_position(place));
    }
    [bounces, shadows]
}

/// PCG-RXS-M-XS 32 (O'Neill 2014), in [0, 1).
fn unit(state: &mut u32) -> f32 {
    *state = state.wrapping_mul(747796405).wrapping_add(2891336453);
    let word = ((*state >> ((*state >> 28) + 4)) ^ *state).wrapping_mul(277803737);
    (((word >> 22) ^ word) >> 8) as f32 / (1 << 24) as f32
}

fn write_ply(file: &str, mesh: &Mesh) -> std::io::Result<()> {
    let mut out = BufWriter::new(std::fs::File::create(file)?);
    writeln!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {}", mesh.positions.len())?;
    writeln!(out, "property float x\nproperty float y\nproperty float z")?;
    writeln!(
        out,
        "element face {}\nproperty list uchar int vertex_indices\nend_header",
        mesh.triangles.len()
    )?;
    for position in &mesh.positions {
        put(&mut out, &position.as_vec3().to_array())?;
    }
    for triangle in &mesh.triangles {
        out.write_all(&[3])?;
        for index in triangle {
            out.write_all(&index.to_le_bytes())?;
        }
    }
    out.flush()
}

/// Number of triangles and three times nine floats each; then for each kind of rays their
/// number and origin, direction and greatest distance of each; counts in 32 bits.
fn dump(file: &str, geometry: &Geometry, kinds: [&[Ray]; 3]) -> std::io::Result<()> {
    let mut out = BufWriter::new(std::fs::File::create(file)?);
    let mut triangles = Vec::new();
    for id in 0..geometry.primitive_count() {
        match geometry.primitive(id) {
            Primitive::Triangle(triangle) => triangles.push(triangle.vertices()),
            Primitive::Parallelogram(it) => {
                let [a, b, c, d] = it.corners();
                triangles.extend([[a, b, c], [a, c, d]]);
            }
            _ => return Err(std::io::Error::other("only flat shapes can be dumped")),
        }
    }
    out.write_all(&(triangles.len() as u32).to_le_bytes())?;
    for corner in triangles.iter().flatten() {
        put(&mut out, &corner.to_array())?;
    }
    for rays in kinds {
        out.write_all(&(rays.len() as u32).to_le_bytes())?;
        for ray in rays {
            put(&mut out, &ray.origin.to_array())?;
            put(&mut out, &ray.direction.to_array())?;
            put(&mut out, &[ray.t_max])?;
        }
    }
    out.flush()
}

fn put(out: &mut impl Write, numbers: &[f32]) -> std::io::Result<()> {
    numbers.iter().try_for_each(|number| out.write_all(&number.to_le_bytes()))
}
