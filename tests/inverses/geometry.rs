//! Points on surfaces.

use crate::support::{Map, ROUNDING, Tally, direction, number, pair};
use etalon::geometry::primitive::{Cylinder, Disk, Parallelogram, Sphere, Triangle};
use etalon::geometry::{GeometryBuilder, Primitive, Ray, SurfacePoint, Transform, specimens};
use glam::{DVec3, Vec3, Vec3A};

/// The primitives of all shapes (a few of a mesh), and awkward ones.
fn primitives() -> Vec<(String, Primitive)> {
    let mut all = Vec::new();
    for (name, shape) in specimens() {
        let mut builder = GeometryBuilder::new();
        let turn = Transform::rotate(DVec3::new(0.3, -1.0, 0.7), 37.0).expect("a rotation");
        builder.add_object(&shape, &turn).expect("a shape");
        let geometry = builder.build().expect("a geometry");
        all.extend(
            (0..geometry.primitive_count().min(8))
                .map(|id| (format!("{name} {id}"), *geometry.primitive(id))),
        );
    }
    let p = Vec3::new;
    let sliver = Triangle::new([p(0.1, 0.2, 0.3), p(1.1, 0.2, 0.3), p(0.7, 0.201, 0.3)]);
    let tiny = Triangle::new([p(1e-4, 0.0, 0.0), p(0.0, 1e-4, 0.0), p(0.0, 0.0, 1e-4)]);
    let far = Parallelogram::from_edges(p(0.9, -0.8, 0.7), p(0.0, 1e-3, 0.0), p(2e-3, 1e-3, 1e-3));
    all.extend([
        ("sliver".into(), Primitive::Triangle(sliver.expect("area"))),
        ("tiny triangle".into(), Primitive::Triangle(tiny.expect("area"))),
        ("small skew parallelogram".into(), Primitive::Parallelogram(far.expect("area"))),
        ("small sphere".into(), Primitive::Sphere(Sphere::new(p(0.9, 0.8, -0.7), 1e-3).expect("radius"))),
        (
            "wire".into(),
            Primitive::Cylinder(Cylinder::new(p(0.2, 0.1, -0.5), p(0.2, 0.1, 0.5), 1e-3).expect("size")),
        ),
        ("level disk".into(), Primitive::Disk(Disk::new(p(0.5, 0.0, 0.1), -DVec3::Z, 0.01).expect("size"))),
    ]);
    all
}

/// Positions are exact but for their own rounding: half a spacing along each axis for the
/// point asked for, and another for the point drawn. Beyond the edge of a sliver, the point
/// with the nearest numbers is further off, by up to its length over its width.
fn position_rounding(primitive: &Primitive) -> f64 {
    let bounds = primitive.bounds();
    let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
    let slenderness = match primitive {
        Primitive::Triangle(triangle) => {
            let [a, b, c] = triangle.vertices();
            let longest2 =
                (a - b).length_squared().max((b - c).length_squared()).max((c - a).length_squared());
            0.5 * longest2 / triangle.area()
        }
        _ => 1.0,
    };
    2.0 * 3f64.sqrt() * ROUNDING * f64::from(reach * slenderness)
}

#[test]
fn points_give_back_the_numbers_that_draw_them() {
    for (seed, (name, primitive)) in primitives().into_iter().enumerate() {
        let draw = |u| Some((0, primitive.sample_area(u).position.as_dvec3()));
        let map = Map { name, draw: &draw, rounding: &|_| position_rounding(&primitive), step: 0.01 };
        let tally =
            map.inverts(seed as u64, |u| Some(primitive.invert_area(primitive.sample_area(u).position)));
        let sliver = map.name == "sliver";
        tally.assert_telling(&map.name, if sliver { 0.0 } else { 0.6 });
    }
}

/// Rays find points that no numbers name exactly.
#[test]
fn points_that_rays_meet_are_drawn_again() {
    for (seed, (name, primitive)) in primitives().into_iter().enumerate() {
        let draw = |u| Some((0, primitive.sample_area(u).position.as_dvec3()));
        let map = Map { name, draw: &draw, rounding: &|_| position_rounding(&primitive), step: 0.01 };
        let mut tally = Tally::default();
        for index in 0..2_000 {
            let target = primitive.sample_area(pair(seed as u64, index)).position;
            let towards = direction(index ^ 0x5eed).as_vec3a();
            let ray = etalon::geometry::PreciseRay::new(&Ray::new(target - towards, towards));
            let Some(meeting) = primitive.intersect(&ray) else { continue };
            let met = primitive.point(&ray, &meeting).position;
            map.redraws((0, met.as_dvec3()), primitive.invert_area(met), &mut tally);
        }
        tally.assert_telling(&map.name, 0.0);
    }
}

#[test]
fn points_of_a_seen_sphere_give_back_their_numbers() {
    let spheres = [(Vec3::new(0.1, -0.2, 0.3), 0.25), (Vec3::ZERO, 1e-3), (Vec3::new(0.9, -0.8, 0.7), 0.01)];
    // In radii from the centre: inside, close to the surface, and far.
    let places = [0.0, 0.4, 0.99, 1.001, 1.1, 2.0, 30.0];
    for (index, (center, radius)) in spheres.into_iter().enumerate() {
        let sphere = Sphere::new(center, radius).expect("a sphere");
        for (place, distance) in places.into_iter().enumerate() {
            let seed = (index * places.len() + place) as u64;
            let from = Vec3A::from(center) + direction(seed).as_vec3a() * (radius * distance);
            let point = |u| sphere.sample_solid_angle(from, u).map(|(point, _)| point);
            // Where it is on the sphere, by the normal, whose three coordinates are rounded
            // when asked for and when drawn.
            let draw = |u| point(u).map(|point| (0, point.normal.as_dvec3()));
            let name = format!("sphere {index} from {distance}");
            let map = Map { name, draw: &draw, rounding: &|_| 2.0 * 3f64.sqrt() * ROUNDING, step: 0.01 };
            let tally = map.inverts(seed, |u| sphere.invert_solid_angle(from, &point(u)?));
            tally.assert_telling(&map.name, 0.6);
        }
    }
}

#[test]
fn the_far_side_of_a_sphere_has_no_numbers() {
    let sphere = Sphere::new(Vec3::new(0.1, -0.2, 0.3), 0.25).expect("a sphere");
    let from = Vec3A::new(0.1, -0.2, 1.3);
    // The horizon is at cosine 0.25 from the axis.
    for index in 0..1_000 {
        let normal = direction(index).as_vec3a();
        let position = Vec3A::from(sphere.center()) + normal * sphere.radius();
        let point = SurfacePoint { position, error: Vec3A::ZERO, normal };
        let numbers = sphere.invert_solid_angle(from, &point);
        assert!((normal.z - 0.25).abs() < 1e-5 || numbers.is_some() == (normal.z > 0.25), "{normal}");
    }
}

/// Points off the surface by more than a rounding still give numbers, those of a point near.
#[test]
fn numbers_stay_in_range_for_points_beyond_an_edge() {
    for (name, primitive) in primitives() {
        for index in 0..500 {
            let off = direction(index).as_vec3a() * (1e-3 * number(index));
            let numbers = primitive.invert_area(primitive.sample_area(pair(9, index)).position + off);
            assert!(numbers.iter().all(|v| (0.0..1.0).contains(v)), "{name}: {numbers:?}");
        }
    }
}
