//! Surfaces that are hit again, have no area, are slivers, lie in one place or are mirrored.

use crate::record::Record;
use etalon::geometry::{Geometry, GeometryBuilder, Mesh, Ray, Shape, Transform};
use etalon::metropolis::Numbers;
use glam::{DVec3, Vec3A};
use std::f64::consts::TAU;

pub fn build(shapes: &[Shape]) -> Geometry {
    let mut builder = GeometryBuilder::new();
    for shape in shapes {
        builder.add_object(shape, &Transform::IDENTITY).expect("a sound shape");
    }
    builder.build().expect("a sound scene")
}

pub fn direction(numbers: &mut Numbers) -> Vec3A {
    let height = 2.0 * numbers.fine() - 1.0;
    let (sin, cos) = (TAU * numbers.fine()).sin_cos();
    let across = (1.0 - height * height).sqrt();
    DVec3::new(across * cos, across * sin, height).as_vec3a()
}

/// A square of 2 m, level but for a tilt, that is moved by `offset` metres.
fn square(offset: f64) -> Shape {
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.3 * x - 0.2 * y) + DVec3::splat(offset);
    Shape::Quad { vertices: [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)] }
}

// Case 50.
pub fn spheres_a_hair_apart_are_both_found(record: &mut Record) {
    let sphere = |radius| Shape::Sphere { center: DVec3::ZERO, radius };
    let geometry = build(&[sphere(1.0), sphere(1.0 + 4e-5)]);
    let mut numbers = Numbers::of(&[record.seed(), 50]);
    let (mut met, mut both) = (0_u64, 0_u64);
    for _ in 0..record.samples(100_000) {
        let from = direction(&mut numbers) * 3.0;
        let towards = (direction(&mut numbers) * 0.4 - from).normalize();
        // At the rim a ray may pass between the two.
        let outer = geometry.intersect(&Ray::new(from, towards));
        let Some(outer) = outer.filter(|hit| hit.point.normal.dot(towards) < -0.02) else { continue };
        let inner = geometry.intersect(&outer.point.ray_along(towards));
        met += 1;
        both += u64::from(outer.object == 1 && inner.is_some_and(|hit| hit.object == 0));
    }
    record.at_least("rays that meet the outer sphere", met as f64, 50_000.0);
    record.exactly("of them those that meet the inner one behind it", both, met);
    record.note(
        "By day 100 000 rays are traced, by night 16 times as many. Those that meet the outer sphere at a cosine \
         below 0.02 are left out: at the rim a ray may pass between the two.",
    );
}

// Case 50.
pub fn shadow_rays_from_a_plane_never_meet_it(record: &mut Record) {
    let rays = record.samples(4_000_000);
    for offset in [0.0, 1e6] {
        let geometry = build(&[square(offset)]);
        let mut numbers = Numbers::of(&[record.seed(), 51]);
        let plane = geometry.primitive(0);
        let mut hits = 0_u64;
        for _ in 0..rays {
            let point = plane.sample_area(numbers.pair());
            let towards = direction(&mut numbers);
            // Within rounding of grazing, which side a ray leaves to is not defined.
            if point.normal.dot(towards).abs() > 1e-5 {
                hits += u64::from(geometry.occluded(&point.ray_along(towards)));
            }
        }
        record.exactly(format!("self-hits of {rays} rays, {offset:e} m from the origin"), hits, 0);
    }
    record.note(
        "The catalogue asks for 1e8 rays: by day 4e6 are traced at each place, by night 6.4e7. Rays with |cos| up to \
         1e-5 to the plane are left out, one in 100 000: within rounding, the side to which they leave is not defined.",
    );
}

// Case 50.
pub fn a_scene_far_from_its_origin_says_what_it_loses(record: &mut Record) {
    let near = build(&[square(0.0)]);
    let far = build(&[square(1e6)]);
    record.exactly("spacing of positions 1e6 m away, m", far.spacing_metres(), 0.0625);
    record.at_most("spacing of positions at the origin, m", near.spacing_metres(), 1.2e-7);
    let scene = |offset: f64| {
        let Shape::Quad { vertices } = square(offset) else { unreachable!("a quad") };
        crate::common::metered(
            serde_json::json!({ "grey": { "lambertian": { "reflectance": 0.5 } } }),
            serde_json::json!([{ "shape": { "quad": { "vertices": vertices.map(|v| v.to_array()) } }, "material": "grey" }]),
            serde_json::json!([]),
            serde_json::json!([]),
        )
    };
    record.says("the remark on loading", &scene(1e6).notes.join("; "), "positions are rounded to 6.25e-2 m");
    record.exactly("remarks on the scene at the origin", scene(0.0).notes.len(), 0);
    record.note("Positions are not recentred: a scene far away is told how coarse they are.");
}

/// A closed unit box cut along every axis at 0, 1e-6, 1e-5, ..., 1: slivers of aspect 1e6
/// along its edges.
fn sliver_box() -> Mesh {
    let cuts = [0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0];
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for high in [false, true] {
            for cell in 0..49 {
                let (i, j) = (cell / 7, cell % 7);
                let first = mesh.positions.len() as u32;
                for (i, j) in [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)] {
                    let mut p = DVec3::ZERO;
                    p[axis] = f64::from(u8::from(high));
                    p[(axis + 1) % 3] = cuts[i];
                    p[(axis + 2) % 3] = cuts[j];
                    mesh.positions.push(p);
                }
                let [a, b, c, d] = if high { [0, 1, 2, 3] } else { [0, 3, 2, 1] }.map(|k| first + k);
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    mesh
}

// Case 52.
pub fn a_closed_box_of_slivers_leaks_no_ray(record: &mut Record) {
    let geometry = build(&[Shape::Mesh(sliver_box())]);
    let rays = record.samples(3_000_000);
    let mut numbers = Numbers::of(&[record.seed(), 52]);
    let mut leaks = [0_u64; 2];
    for i in 0..rays {
        let from = Vec3A::from_array([0; 3].map(|_| 0.05 + 0.9 * numbers.single()));
        let target = if i % 2 == 0 {
            from + direction(&mut numbers)
        } else {
            // Along the edges that slivers share.
            let id = numbers.index(geometry.primitive_count() as usize) as u32;
            let u = numbers.single();
            geometry.primitive(id).sample_area([1.0 - f32::EPSILON, u]).position
        };
        let ray = Ray::new(from, (target - from).normalize());
        leaks[0] += u64::from(geometry.intersect(&ray).is_none());
        leaks[1] += u64::from(!geometry.occluded(&ray));
    }
    record.exactly(format!("leaks of {rays} rays, half of them at shared edges"), leaks[0], 0);
    record.exactly("leaks of as many shadow rays", leaks[1], 0);
    record.note("The catalogue asks for 1e9 rays: a run by night takes 5e7, of which half aim at edges, where leaks would be.");
}

// Case 53.
pub fn of_coincident_faces_the_first_is_met_whatever_the_tree(record: &mut Record) {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.3));
    let mesh = |triangles: Vec<[u32; 3]>| {
        Shape::Mesh(Mesh { positions: corners.to_vec(), normals: Vec::new(), triangles })
    };
    let quad = Shape::Quad { vertices: corners };
    let halves = mesh(vec![[0, 1, 2], [0, 2, 3]]);
    let others = mesh(vec![[1, 2, 3], [1, 3, 0]]);
    let clutter = |count: u32| {
        (0..count).map(|i| Shape::Sphere {
            center: DVec3::new(f64::from(i % 7) - 3.0, f64::from(i % 5) - 2.0, -3.0 - f64::from(i)),
            radius: 0.4,
        })
    };
    let mut numbers = Numbers::of(&[53]);
    let targets: Vec<Vec3A> = (0..20_000)
        .map(|_| Vec3A::new(1.8 * numbers.single() - 0.9, 1.8 * numbers.single() - 0.9, 0.3))
        .collect();
    let mut wrong = 0_u64;
    for order in [[&quad, &halves, &others], [&others, &quad, &halves], [&halves, &others, &quad]] {
        // Other things in the scene make another tree.
        for count in [0, 1, 40, 300] {
            let shapes: Vec<Shape> = order.into_iter().cloned().chain(clutter(count)).collect();
            let geometry = build(&shapes);
            for threads in [1, 7] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
                wrong += pool.install(|| count_not_first(&geometry, &targets));
            }
        }
    }
    record.exactly("rays that meet another than the first, 12 trees, 1 and 7 threads", wrong, 0);
    let geometry = build(&[quad, halves, others]);
    record.exactly("faces told to lie in the place of others", geometry.coincident_faces().len(), 5);
    let apart = build(&[square(0.0), square(1e-5)]);
    record.exactly("faces told of that are 0.01 mm apart", apart.coincident_faces().len(), 0);
    record.note(
        "Flat faces alone are counted: curved ones in one place, as spheres or cylinders, are not told of.",
    );
}

fn count_not_first(geometry: &Geometry, targets: &[Vec3A]) -> u64 {
    use rayon::prelude::*;
    let unit = geometry.metres_per_unit() as f32;
    let origin = Vec3A::new(0.21, -0.17, 1.1);
    let is_first = |target: &Vec3A| {
        let ray = Ray::new(origin / unit, (*target - origin).normalize());
        geometry.intersect(&ray).is_some_and(|hit| hit.object == 0)
    };
    targets.par_iter().filter(|target| !is_first(target)).count() as u64
}
