//! Rays meet what they should, and nothing else.
#![expect(clippy::unwrap_used, reason = "a set-up that fails is a test that fails")]

use etalon::geometry::{
    Geometry, GeometryBuilder, Mesh, PreciseRay, Primitive, Ray, Shape, ShapeError, Transform, icosphere,
    specimens,
};
use glam::{DVec3, Vec3A};
use std::f64::consts::TAU;

/// PCG-XSH-RR 64/32 (O'Neill 2014).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        let mixed = ((self.0 >> 18) ^ self.0) >> 27;
        (mixed as u32).rotate_right((self.0 >> 59) as u32)
    }

    /// Uniform in [0, 1).
    fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / (1 << 24) as f32
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    fn direction(&mut self) -> Vec3A {
        let z = 1.0 - 2.0 * f64::from(self.unit());
        let (sin, cos) = (TAU * f64::from(self.unit())).sin_cos();
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * cos, across * sin, z).as_vec3a()
    }

    fn in_box(&mut self, low: Vec3A, high: Vec3A) -> Vec3A {
        low + (high - low) * Vec3A::new(self.unit(), self.unit(), self.unit())
    }
}

fn build(shapes: &[(Shape, Transform)]) -> Geometry {
    let mut builder = GeometryBuilder::new();
    for (shape, to_world) in shapes {
        builder.add_object(shape, to_world).expect("a valid shape");
    }
    builder.build().expect("a valid scene")
}

/// A turn and a shift that leave nothing aligned with anything.
fn askew() -> Transform {
    Transform::in_order(&[
        Transform::rotate(DVec3::new(0.3, -1.0, 0.7), 37.0).unwrap(),
        Transform::translate(DVec3::new(0.37, -0.21, 0.83)).unwrap(),
    ])
    .unwrap()
}

fn mirror() -> Transform {
    Transform::scale(DVec3::new(-1.0, 1.0, 1.0)).unwrap()
}

/// Height of a level square, in metres, for tests that need a plain floor.
fn level_square(height: f64) -> Shape {
    let corner = |x, y| DVec3::new(x, y, height);
    Shape::Quad { vertices: [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)] }
}

fn radius_of(primitive: &Primitive) -> Option<f32> {
    match primitive {
        Primitive::Sphere(sphere) => Some(sphere.radius()),
        Primitive::Cylinder(cylinder) => Some(cylinder.radius()),
        _ => None,
    }
}

/// Rays per specimen and placement in the self-hit test.
const SELF_HIT_RAYS: u32 = 500_000;
/// Nearer to grazing, rounding decides which side of a surface a ray leaves to.
const LEAST_COSINE: f32 = 5e-7;

#[test]
fn rays_from_a_surface_never_meet_it_again() {
    let slivers = ("sliver box", Shape::Mesh(sliver_box()));
    for (name, shape) in specimens().into_iter().chain([slivers]) {
        for to_world in [Transform::IDENTITY, askew()] {
            let geometry = build(&[(shape.clone(), to_world)]);
            let mut random = Random(1);
            for i in 0..SELF_HIT_RAYS {
                let id = random.bits() % geometry.primitive_count();
                let mut point = geometry.primitive(id).sample_area([random.unit(), random.unit()]);
                let mut start = id;
                if i % 2 == 1 {
                    // Arrive by a ray instead of by sampling.
                    let away = random.direction() * 3.0;
                    let towards = (point.position - away).normalize();
                    let Some(hit) = geometry.intersect(&Ray::new(away, towards)) else {
                        continue;
                    };
                    (point, start) = (hit.point, hit.primitive);
                }
                // Cosines down to 1e-6, as many in each decade.
                let cosine = 10f32.powf(-6.0 * random.unit()).copysign(random.unit() - 0.5);
                let tangent = point.normal.cross(random.direction()).normalize_or_zero();
                let sine = (1.0 - cosine * cosine).sqrt();
                let direction = (point.normal * cosine + tangent * sine).normalize();
                // What rounding has made of the cosine.
                let cosine = point.normal.as_dvec3().dot(direction.as_dvec3()) as f32;
                if cosine.abs() < LEAST_COSINE {
                    continue;
                }
                let Some(hit) = geometry.intersect(&point.ray_along(direction)) else {
                    continue;
                };
                // Turned, slivers as narrow as a few roundings are no longer flat together.
                let outward = cosine > 0.0 && name != "sliver box";
                assert!(!outward, "{name}: convex, but met from outside: {hit:?} {cosine}");
                if hit.primitive == start {
                    let radius = radius_of(geometry.primitive(start));
                    let radius = radius.unwrap_or_else(|| panic!("{name}: {hit:?} {cosine}"));
                    assert!(hit.t >= radius * -cosine, "{name}: {hit:?} {cosine}");
                }
            }
        }
    }
}

#[test]
fn the_true_point_lies_in_the_error_box() {
    for (name, shape) in specimens() {
        let geometry = build(&[(shape, askew())]);
        let mut random = Random(2);
        for _ in 0..100_000 {
            let away = random.direction() * 2.0;
            let target = geometry.bounds().center() + random.direction() * 0.3;
            let ray = Ray::new(away, (target - away).normalize());
            let Some(hit) = geometry.intersect(&ray) else {
                continue;
            };
            let position = hit.point.position.as_dvec3();
            let off = match geometry.primitive(hit.primitive) {
                Primitive::Sphere(sphere) => {
                    position.distance(sphere.center().as_dvec3()) - f64::from(sphere.radius())
                }
                Primitive::Triangle(triangle) => {
                    let [a, b, c] = triangle.vertices().map(|v| v.as_dvec3());
                    (b - a).cross(c - a).normalize().dot(position - a)
                }
                Primitive::Parallelogram(parallelogram) => {
                    let [a, b, _, d] = parallelogram.corners().map(|v| v.as_dvec3());
                    (b - a).cross(d - a).normalize().dot(position - a)
                }
                Primitive::Disk(disk) => disk.normal().dot(position - disk.center().as_dvec3()),
                Primitive::Cylinder(_) => continue,
            };
            let bound = f64::from(hit.point.normal.abs().dot(hit.point.error)) * (1.0 + 1e-6);
            assert!(off.abs() <= bound, "{name}: off by {off:e}, bound {bound:e}");
        }
    }
}

#[test]
fn inside_a_convex_body_every_point_sees_every_other() {
    for (name, shape) in specimens() {
        if !matches!(name, "sphere" | "box" | "capped cylinder" | "icosphere") {
            continue;
        }
        let geometry = build(&[(shape, askew())]);
        let mut random = Random(3);
        for _ in 0..200_000 {
            let mut sample = || {
                let id = random.bits() % geometry.primitive_count();
                (id, geometry.primitive(id).sample_area([random.unit(), random.unit()]))
            };
            let ((first, from), (second, to)) = (sample(), sample());
            if first == second && radius_of(geometry.primitive(first)).is_none() {
                continue;
            }
            let Some(ray) = from.ray_to(&to) else {
                continue;
            };
            // Within rounding of grazing, which side a ray leaves to is not defined.
            if from.normal.dot(ray.direction) > -1e-5 || to.normal.dot(ray.direction) < 1e-5 {
                continue;
            }
            assert!(!geometry.occluded(&ray), "{name}: {from:?} to {to:?}");
        }
    }
}

/// A closed unit box cut along every axis at 0, 1e-6, 1e-5, ..., 1: slivers of aspect 1e6
/// along its edges.
fn sliver_box() -> Mesh {
    let cuts = [0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0];
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for high in [false, true] {
            let corner = |i: usize, j: usize| {
                let mut p = DVec3::ZERO;
                p[axis] = if high { 1.0 } else { 0.0 };
                p[(axis + 1) % 3] = cuts[i];
                p[(axis + 2) % 3] = cuts[j];
                p
            };
            for i in 0..7 {
                for j in 0..7 {
                    let first = mesh.positions.len() as u32;
                    let around = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
                    mesh.positions.extend(around.map(|(i, j)| corner(i, j)));
                    let fan = if high { [0, 1, 2, 3] } else { [0, 3, 2, 1] }.map(|k| first + k);
                    mesh.triangles.push([fan[0], fan[1], fan[2]]);
                    mesh.triangles.push([fan[0], fan[2], fan[3]]);
                }
            }
        }
    }
    mesh
}

/// Corners of flat primitives and, for curved ones, points on them.
fn outline(primitive: &Primitive, random: &mut Random) -> Vec<Vec3A> {
    match primitive {
        Primitive::Triangle(triangle) => triangle.vertices().map(Vec3A::from).to_vec(),
        Primitive::Parallelogram(it) => it.corners().map(Vec3A::from).to_vec(),
        curved => vec![curved.sample_area([random.unit(), random.unit()]).position; 3],
    }
}

#[test]
fn closed_bodies_leak_no_ray() {
    let unit_box = Shape::Box { min: DVec3::ZERO, max: DVec3::ONE };
    let from_dyadic = Shape::Box { min: DVec3::splat(-0.5), max: DVec3::splat(0.5) };
    let capped = specimens().into_iter().find(|s| s.0 == "capped cylinder").unwrap().1;
    let bodies = [
        ("box", unit_box, Vec3A::splat(0.5)),
        ("centred box", from_dyadic, Vec3A::ZERO),
        ("icosphere", Shape::Mesh(icosphere(3)), Vec3A::ZERO),
        ("sliver box", Shape::Mesh(sliver_box()), Vec3A::splat(0.5)),
        ("capped cylinder", capped, Vec3A::new(0.1, 0.25, -0.05)),
    ];
    for (name, shape, inside) in bodies {
        for to_world in [Transform::IDENTITY, askew()] {
            let geometry = build(&[(shape.clone(), to_world)]);
            let inside = geometry.to_scene(to_world.point(inside.as_dvec3()));
            let mut random = Random(4);
            for i in 0..400_000u32 {
                let id = i % geometry.primitive_count();
                let corners = outline(geometry.primitive(id), &mut random);
                let (a, b) = (corners[(i % 3) as usize], corners[((i + 1) % 3) as usize]);
                let target = match i % 5 {
                    0 | 1 => a,
                    2 => (a + b) * 0.5,
                    _ => a + (b - a) * random.unit(),
                };
                let origin = if i % 2 == 0 { inside } else { inside + random.direction() * 0.05 };
                // Not of unit length: normalising would spoil the aim.
                let aimed = Ray::new(origin, target - origin);
                assert!(geometry.intersect(&aimed).is_some(), "{name}: {aimed:?}");
                let ray = Ray::new(origin, (target - origin).normalize());
                assert!(geometry.intersect(&ray).is_some(), "{name}: {ray:?}");
                assert!(geometry.occluded(&ray), "{name}: {ray:?}");
                let anywhere = Ray::new(origin, random.direction());
                assert!(geometry.intersect(&anywhere).is_some(), "{name}: {anywhere:?}");
            }
        }
    }
}

/// Every kind of shape, many times, over one another.
fn mixed_scene() -> Geometry {
    let mut builder = GeometryBuilder::new();
    let mut random = Random(5);
    for _ in 0..20 {
        for (_, shape) in specimens() {
            let size = f64::from(random.between(0.02, 0.3));
            let place = Transform::in_order(&[
                Transform::scale(DVec3::splat(size)).unwrap(),
                Transform::rotate(random.direction().as_dvec3(), f64::from(random.between(0.0, 360.0)))
                    .unwrap(),
                Transform::translate(random.direction().as_dvec3()).unwrap(),
            ]);
            builder.add_object(&shape, &place.unwrap()).unwrap();
        }
    }
    builder.build().unwrap()
}

/// Distance and number of the nearest primitive, by asking every one.
fn nearest_of_all(geometry: &Geometry, ray: &Ray) -> Option<(f64, u32)> {
    let precise = PreciseRay::new(ray);
    (0..geometry.primitive_count())
        .filter_map(|id| Some((geometry.primitive(id).intersect(&precise)?.t, id)))
        .min_by(|a, b| a.partial_cmp(b).unwrap())
}

#[test]
fn the_tree_finds_what_asking_every_primitive_finds() {
    let geometry = mixed_scene();
    let bounds = geometry.bounds();
    let mut random = Random(6);
    let mut hits = 0;
    for i in 0..100_000usize {
        let origin = random.in_box(bounds.min * 1.5, bounds.max * 1.5);
        let mut direction = random.direction();
        if i % 4 == 0 {
            // Along a coordinate axis or nearly so.
            let tilt = if i % 8 == 0 { 0.0 } else { 1e-9 };
            direction = Vec3A::new(tilt, 1.0, -tilt).normalize();
        }
        let mut ray = Ray::new(origin, direction);
        if i % 5 == 0 {
            // From far away, at the corner of a box that holds a triangle.
            let primitive = geometry.primitive(random.bits() % geometry.primitive_count());
            let target = outline(primitive, &mut random)[i % 3];
            let far = random.direction() * 10f32.powf(random.between(0.0, 5.0));
            ray = Ray::new(far, target - far);
        } else if i % 3 == 0 {
            ray.t_max = random.unit();
        }
        let expected = nearest_of_all(&geometry, &ray);
        let found = geometry.intersect(&ray);
        assert_eq!(geometry.occluded(&ray), found.is_some());
        match (expected, found) {
            (None, None) => {}
            (Some((t, id)), Some(hit)) => {
                hits += 1;
                // At a shared corner any of the faces there may answer.
                let own = geometry.primitive(hit.primitive).intersect(&PreciseRay::new(&ray));
                let own = own.unwrap().t;
                let same = hit.primitive == id || own <= t * (1.0 + 1e-10);
                assert!(same && (f64::from(hit.t) - t).abs() <= 1e-7 * t, "{t} {id}: {hit:?}");
                assert!(geometry.primitives_of(hit.object).contains(&hit.primitive));
                assert_eq!(geometry.object_of(hit.primitive), hit.object);
            }
            other => panic!("{other:?} along {ray:?}"),
        }
    }
    assert!(hits > 10_000, "only {hits} hits: the test means nothing");
}

#[test]
fn scenes_of_none_one_and_two_primitives_answer() {
    let down = Ray::new(Vec3A::new(0.1, 0.2, 0.9), Vec3A::NEG_Z);
    assert!(build(&[]).intersect(&down).is_none());
    assert!(build(&[]).bounds().is_empty());
    let floor = (level_square(0.0), Transform::IDENTITY);
    assert_eq!(build(std::slice::from_ref(&floor)).intersect(&down).unwrap().t, 0.9);
    let upper = (level_square(0.5), Transform::IDENTITY);
    assert_eq!(build(&[floor, upper]).intersect(&down).unwrap().object, 1);
}

#[test]
fn very_near_hits_are_found() {
    let geometry = build(&[(level_square(0.0), Transform::IDENTITY)]);
    for distance in [1e-3, 1e-4, 9e-5, 1e-7, 1e-12, 1e-30] {
        let ray = Ray::new(Vec3A::new(0.3, 0.2, distance), Vec3A::NEG_Z);
        let hit = geometry.intersect(&ray);
        assert_eq!(hit.map(|hit| hit.t), Some(distance));
    }
}

#[test]
fn spheres_a_hair_apart_are_both_found() {
    let sphere = |radius| Shape::Sphere { center: DVec3::ZERO, radius };
    let geometry = build(&[(sphere(1.0), Transform::IDENTITY), (sphere(1.0 + 4e-5), Transform::IDENTITY)]);
    let mut random = Random(7);
    for _ in 0..100_000 {
        let outer = geometry.intersect(&Ray::new(random.direction() * 3.0, Vec3A::X));
        let Some(outer) = outer else { continue };
        if outer.point.normal.x > -0.02 {
            continue;
        }
        assert_eq!(outer.object, 1);
        let inner = geometry.intersect(&outer.point.ray_along(Vec3A::X)).unwrap();
        assert_eq!(inner.object, 0, "{outer:?} then {inner:?}");
    }
}

#[test]
fn a_tiny_sphere_far_away_is_met_where_it_is() {
    let radius = 1e-6;
    let geometry = build(&[
        (Shape::Sphere { center: DVec3::ZERO, radius }, Transform::IDENTITY),
        (Shape::Sphere { center: DVec3::new(0.0, 9.0, 0.0), radius: 1.0 }, Transform::IDENTITY),
    ]);
    let unit = geometry.metres_per_unit() as f32;
    for offset in [-0.99e-6, -0.5e-6, 0.0, 0.9e-6] {
        let origin = Vec3A::new(1e6, offset, 0.0) / unit;
        assert!(geometry.occluded(&Ray::new(origin, Vec3A::NEG_X)), "{offset}");
    }
    for offset in [-1.01e-6, 1.1e-6] {
        let origin = Vec3A::new(1e6, offset, 0.0) / unit;
        assert!(!geometry.occluded(&Ray::new(origin, Vec3A::NEG_X)), "{offset}");
    }
}

#[test]
fn of_coincident_faces_the_first_is_met() {
    let [a, b, c, d] =
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.3));
    let mesh = |triangles: Vec<[u32; 3]>| {
        Shape::Mesh(Mesh { positions: vec![a, b, c, d], normals: Vec::new(), triangles })
    };
    let quad = Shape::Quad { vertices: [a, b, c, d] };
    let halves = mesh(vec![[0, 1, 2], [0, 2, 3]]);
    let others = mesh(vec![[1, 2, 3], [1, 3, 0]]);
    for order in [[&quad, &halves, &others], [&others, &quad, &halves], [&halves, &others, &quad]] {
        let placed = order.map(|shape| (shape.clone(), Transform::IDENTITY));
        let geometry = build(&placed);
        let mut random = Random(8);
        for _ in 0..100_000 {
            let target = Vec3A::new(random.between(-0.9, 0.9), random.between(-0.9, 0.9), 0.3);
            let origin = Vec3A::new(0.21, -0.17, 1.1);
            let hit = geometry.intersect(&Ray::new(origin, (target - origin).normalize()));
            assert_eq!(hit.expect("the faces are there").object, 0);
        }
    }
}

#[test]
fn a_mirror_keeps_the_side_that_faces() {
    for (name, shape) in specimens() {
        let plain = build(&[(shape.clone(), askew())]);
        let reflected = askew().then(&mirror()).unwrap();
        let mirrored = build(&[(shape, reflected)]);
        let flip = Vec3A::new(-1.0, 1.0, 1.0);
        let mut random = Random(9);
        let mut hits = 0;
        for _ in 0..20_000 {
            let origin = random.direction() * 2.0;
            let target = plain.bounds().center() + random.direction() * 0.3;
            let ray = Ray::new(origin, (target - origin).normalize());
            let image = Ray::new(ray.origin * flip, ray.direction * flip);
            let (Some(hit), Some(seen)) = (plain.intersect(&ray), mirrored.intersect(&image)) else {
                continue;
            };
            // At an edge the two may fall on different faces.
            if hit.primitive != seen.primitive {
                continue;
            }
            hits += 1;
            let gap = (hit.point.normal * flip - seen.point.normal).length();
            assert!(gap < 1e-4, "{name}: {hit:?} against {seen:?}");
            let gap = (hit.shading.normal * flip - seen.shading.normal).length();
            assert!(gap < 1e-3, "{name}: {hit:?} against {seen:?}");
        }
        assert!(hits > 1_000, "{name}: only {hits} hits");
    }
}

#[test]
fn closed_bodies_face_outward() {
    for (name, shape) in specimens() {
        if !matches!(name, "sphere" | "box" | "capped cylinder" | "icosphere") {
            continue;
        }
        for to_world in [askew(), mirror()] {
            let geometry = build(&[(shape.clone(), to_world)]);
            let mut random = Random(10);
            for _ in 0..10_000 {
                let origin = geometry.bounds().center() + random.direction() * 3.0;
                let target = geometry.bounds().center() + random.direction() * 0.05;
                let ray = Ray::new(origin, (target - origin).normalize());
                let hit = geometry.intersect(&ray).expect("aimed at the middle");
                assert!(hit.point.normal.dot(ray.direction) < 0.0, "{name}: {hit:?}");
                assert!(hit.shading.normal.dot(hit.point.normal) > 0.0, "{name}: {hit:?}");
            }
        }
    }
}

#[test]
fn vertex_normals_are_blended_and_kept_on_the_geometric_side() {
    let mesh = Mesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
        normals: vec![DVec3::new(1.0, 0.0, -1.0), DVec3::NEG_Z, DVec3::NEG_Z],
        triangles: vec![[0, 1, 2]],
    };
    let geometry = build(&[(Shape::Mesh(mesh), Transform::IDENTITY)]);
    let ray = Ray::new(Vec3A::new(0.25, 0.25, 1.0), Vec3A::NEG_Z);
    let hit = geometry.intersect(&ray).unwrap();
    assert_eq!(hit.point.normal, Vec3A::Z);
    let blend = Vec3A::new(0.5 / 2f32.sqrt(), 0.0, -0.5 - 0.5 / 2f32.sqrt()).normalize();
    assert!((hit.shading.normal + blend).length() < 1e-6, "{:?}", hit.shading.normal);
}

/// The same shape described in other numbers, all lengths times `k`.
fn scaled(shape: &Shape, k: f64) -> Shape {
    let mut shape = shape.clone();
    match &mut shape {
        Shape::Sphere { center, radius } | Shape::Disk { center, radius, .. } => {
            *center *= k;
            *radius *= k;
        }
        Shape::Cylinder { from, to, radius, .. } => {
            *from *= k;
            *to *= k;
            *radius *= k;
        }
        Shape::Quad { vertices } => vertices.iter_mut().for_each(|p| *p *= k),
        Shape::Box { min, max } => {
            *min *= k;
            *max *= k;
        }
        Shape::Mesh(mesh) => mesh.positions.iter_mut().for_each(|p| *p *= k),
    }
    shape
}

#[test]
fn scale_by_a_power_of_two_changes_no_bit() {
    let turn = Transform::rotate(DVec3::new(0.3, -1.0, 0.7), 37.0).unwrap();
    let placed = |exponent: i32| {
        let k = 2f64.powi(exponent);
        let shift = Transform::translate(DVec3::new(0.37, -0.21, 0.83) * k).unwrap();
        let place = turn.then(&shift).unwrap();
        let shapes: Vec<_> = specimens().iter().map(|(_, shape)| (scaled(shape, k), place)).collect();
        build(&shapes)
    };
    let plain = placed(0);
    for exponent in [-40, -20, -3, 1, 20, 40] {
        let scaled = placed(exponent);
        assert_eq!(scaled.metres_per_unit(), plain.metres_per_unit() * 2f64.powi(exponent));
        for id in 0..plain.primitive_count() {
            assert_eq!(plain.primitive(id), scaled.primitive(id));
        }
        let mut random = Random(11);
        for _ in 0..10_000 {
            let ray = Ray::new(random.direction(), random.direction());
            let show = |geometry: &Geometry| format!("{:?}", geometry.intersect(&ray));
            assert_eq!(show(&plain), show(&scaled));
        }
    }
}

#[test]
fn a_scene_far_from_its_origin_tells_what_it_loses() {
    let far = Transform::translate(DVec3::splat(1e6)).unwrap();
    let geometry = build(&[(level_square(0.0), far)]);
    assert_eq!(geometry.spacing_metres(), 0.0625);
}

#[test]
fn triangles_without_area_are_dropped_and_counted() {
    let mesh = Mesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X * 0.5],
        normals: Vec::new(),
        triangles: vec![[0, 1, 1], [0, 1, 2], [0, 3, 1], [2, 2, 2]],
    };
    let geometry = build(&[(Shape::Mesh(mesh.clone()), Transform::IDENTITY)]);
    assert_eq!((geometry.primitive_count(), geometry.degenerate_triangles()), (1, 3));
    assert_eq!(geometry.area_of(0), 0.5);
    let nothing = Mesh { triangles: vec![[0, 1, 1]], ..mesh };
    let mut builder = GeometryBuilder::new();
    builder.add_object(&Shape::Mesh(nothing), &Transform::IDENTITY).unwrap();
    assert_eq!(builder.build().err(), Some(ShapeError::Vanishes { object: 0 }));
}

#[test]
fn a_quad_is_one_parallelogram_or_two_triangles() {
    let count = |vertices: [[f64; 3]; 4]| {
        let shape = Shape::Quad { vertices: vertices.map(DVec3::from) };
        build(&[(shape, askew())]).primitive_count()
    };
    let (a, b, c) = ([0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.1 + 0.2, 0.3, 0.0]);
    assert_eq!(count([a, b, c, [0.2, 0.3, 0.0]]), 1);
    assert_eq!(count([a, b, c, [0.2, 0.31, 0.0]]), 2);
    // An arrowhead, its notch at each corner in turn: the cut must run through the notch.
    let mut arrow = [[0.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 2.0, 0.0], [1.0, 1.0, 0.0]];
    for _ in 0..4 {
        arrow.rotate_left(1);
        let shape = Shape::Quad { vertices: arrow.map(DVec3::from) };
        let geometry = build(&[(shape, Transform::IDENTITY)]);
        let unit = geometry.metres_per_unit() as f32;
        let area: f32 = (0..2).map(|id| geometry.area_of(id) * unit * unit).sum();
        assert!((area - 1.0).abs() < 1e-6, "{area}");
    }
}

#[test]
fn wrong_shapes_are_refused_with_a_reason() {
    let p = DVec3::new;
    let refused = |shape: Shape, to_world: &Transform| {
        let mut builder = GeometryBuilder::new();
        let error = builder.add_object(&shape, to_world).expect_err("a wrong shape");
        assert!(builder.bounds().min.x > builder.bounds().max.x, "nothing may be added");
        error
    };
    let stretch = Transform::scale(p(1.0, 1.0, 2.0)).unwrap();
    let ball = |radius| Shape::Sphere { center: DVec3::ZERO, radius };
    let plain = &Transform::IDENTITY;
    assert!(matches!(refused(ball(0.0), plain), ShapeError::NotPositive { value: 0.0, .. }));
    assert!(matches!(refused(ball(-1.0), plain), ShapeError::NotPositive { .. }));
    assert!(matches!(refused(ball(f64::NAN), plain), ShapeError::NotFinite { .. }));
    assert_eq!(refused(ball(1.0), &stretch), ShapeError::NotASimilarity { shape: "sphere" });
    let flat = Shape::Box { min: DVec3::ZERO, max: p(1.0, 0.0, 1.0) };
    assert!(matches!(refused(flat, plain), ShapeError::NotPositive { .. }));
    let line = Shape::Quad { vertices: [DVec3::ZERO, DVec3::X, DVec3::X * 3.0, DVec3::X * 2.0] };
    assert!(matches!(refused(line, plain), ShapeError::NoExtent { .. }));
    let bow = Shape::Quad { vertices: [p(0., 0., 0.), p(1., 1., 0.), p(1., 0., 0.), p(0., 1., 0.)] };
    assert_eq!(refused(bow, plain), ShapeError::CrossedQuad);
    let (from, to) = (DVec3::ONE, DVec3::ONE);
    let thin = Shape::Cylinder { from, to, radius: 1.0, capped: true };
    assert!(matches!(refused(thin, plain), ShapeError::NoExtent { .. }));
    let disk = Shape::Disk { center: DVec3::ZERO, normal: DVec3::ZERO, radius: 1.0 };
    assert!(matches!(refused(disk, plain), ShapeError::NoExtent { .. }));
    let mesh = Mesh { positions: vec![DVec3::ZERO], triangles: vec![[0, 0, 7]], ..Mesh::default() };
    assert!(matches!(refused(Shape::Mesh(mesh), plain), ShapeError::NoSuchVertex { .. }));
    assert!(Transform::scale(p(1.0, 0.0, 1.0)).is_err());
    assert!(Transform::rotate(DVec3::ZERO, 10.0).is_err());
}

#[test]
fn transforms_apply_in_the_order_of_the_list() {
    let turn = Transform::rotate(DVec3::Z, 90.0).unwrap();
    let shift = Transform::translate(DVec3::X).unwrap();
    let both = Transform::in_order(&[turn, shift]).unwrap();
    assert_eq!(both.point(DVec3::X), DVec3::new(1.0, 1.0, 0.0));
    let back = Transform::matrix([[2.0, 0.0, 0.0, 5.0], [0.0, 2.0, 0.0, 0.0], [0.0, 0.0, -2.0, 0.0]]);
    let back = back.unwrap();
    assert_eq!(back.point(DVec3::ONE), DVec3::new(7.0, 2.0, -2.0));
    assert_eq!((back.similarity(), back.mirrors()), (Some(2.0), true));
    assert!(askew().similarity().is_some_and(|scale| (scale - 1.0).abs() < 1e-12));
}

#[test]
fn a_heap_of_identical_faces_is_one_face() {
    let mesh = Mesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
        normals: Vec::new(),
        triangles: vec![[0, 1, 2]; 50_000],
    };
    let geometry = build(&[(Shape::Mesh(mesh), askew())]);
    let middle = geometry.primitive(7).sample_area([0.5, 0.5]);
    let ray = Ray::new(middle.position + middle.normal, -middle.normal);
    assert_eq!(geometry.intersect(&ray).unwrap().primitive, 0);
}
