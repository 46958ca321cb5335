//! Points of lights, and directions in which light leaves them.

use crate::support::{Map, ROUNDING, Tally, direction, number, pair};
use etalon::geometry::{Geometry, GeometryBuilder, Ray, Shape, SurfacePoint, Transform, specimens};
use etalon::light::{AreaLight, Distribution, Light, PointLight, Profile};
use etalon::spectrum::{Dense, Emission, WavelengthSampler};
use glam::{DVec3, Vec3A};

fn emission() -> Emission {
    Emission::new(Dense::from_values(&[1.0; 471]), Vec::new())
}

/// Every shape as a light with one side and with two.
fn lights() -> Vec<(String, Geometry, Light)> {
    let turn = Transform::rotate(DVec3::new(0.3, -1.0, 0.7), 37.0).expect("a rotation");
    let mut all = Vec::new();
    for (name, shape) in specimens() {
        for two_sided in [false, true] {
            let mut builder = GeometryBuilder::new();
            // Another object first, so that primitives are not numbered from zero.
            let other = Shape::Sphere { center: DVec3::splat(-1.0), radius: 0.1 };
            builder.add_object(&other, &Transform::IDENTITY).expect("a shape");
            builder.add_object(&shape, &turn).expect("a shape");
            let geometry = builder.build().expect("a geometry");
            let light = AreaLight::new(&geometry, 1, emission(), two_sided);
            all.push((format!("{name}, two-sided: {two_sided}"), geometry, Light::Area(light)));
        }
    }
    all
}

/// A step of the numbers that mostly stays on one of the light's primitives.
fn step_on(geometry: &Geometry) -> f32 {
    if geometry.primitive_count() > 50 { 3e-4 } else { 0.01 }
}

fn places() -> Vec<SurfacePoint> {
    let place = |name| {
        let position = direction(name).as_vec3a() * (0.2 + number(name));
        SurfacePoint { position, error: Vec3A::ZERO, normal: direction(name + 1).as_vec3a() }
    };
    (20..26).map(place).collect()
}

/// Two roundings of each coordinate, up to two in size.
const POSITION_ROUNDING: f64 = 7.0 * ROUNDING;

#[test]
fn points_towards_give_back_their_numbers() {
    let wavelengths = WavelengthSampler::even().sample(0.3);
    for (name, geometry, light) in lights() {
        let mut all = Tally::default();
        for (seed, from) in places().iter().enumerate() {
            let sample = |u| light.sample_towards(&geometry, from, u, &wavelengths);
            let draw = |u| sample(u).map(|s| (s.primitive.expect("a surface"), s.point.position.as_dvec3()));
            let name = format!("{name}, from {}", from.position);
            let map = Map { name, draw: &draw, rounding: &|_| POSITION_ROUNDING, step: step_on(&geometry) };
            let tally = map.inverts(seed as u64, |u| {
                let drawn = sample(u)?;
                light.invert_towards(&geometry, from, &drawn.point, drawn.primitive)
            });
            all.add(&tally);
        }
        all.assert_telling(&name, if name.starts_with("icosphere") { 0.1 } else { 0.6 });
    }
}

/// First where each ray starts, then where it goes from there.
#[test]
fn emitted_rays_give_back_their_numbers() {
    for (seed, (name, geometry, light)) in lights().into_iter().enumerate() {
        let seed = seed as u64;
        let invert = |u_point, u_direction| {
            let drawn = light.emit(&geometry, u_point, u_direction)?;
            light.invert_emission(&geometry, &drawn.point, drawn.primitive, drawn.ray.direction)
        };
        let straight = [0.2, 0.1];
        let draw = |u| {
            let drawn = light.emit(&geometry, u, straight)?;
            Some((drawn.primitive.expect("a surface"), drawn.point.position.as_dvec3()))
        };
        let starts = Map {
            name: format!("{name}, start"),
            draw: &draw,
            rounding: &|_| POSITION_ROUNDING,
            step: step_on(&geometry),
        };
        let told = if name.starts_with("icosphere") { 0.1 } else { 0.6 };
        starts.inverts(seed, |u| invert(u, straight).map(|back| back.0)).assert_telling(&name, told);

        let start = [0.37, 0.81];
        let (from, _) = invert(start, straight).expect("numbers");
        let draw = |u| light.emit(&geometry, from, u).map(|drawn| (0, drawn.ray.direction.as_dvec3()));
        // Rounding of the frame, of the direction in it and of the direction in the world, on
        // three coordinates, when asked for and when drawn.
        let rounding = |_| 16.0 * ROUNDING;
        let headings = Map { name: format!("{name}, heading"), draw: &draw, rounding: &rounding, step: 0.01 };
        headings.inverts(seed, |u| invert(from, u).map(|back| back.1)).assert_telling(&name, 0.5);
    }
}

/// Normals of an upright tube lie in the plane z = 0, give or take a rounding, and frames
/// around them turn over with its sign.
#[test]
fn rays_from_points_met_on_an_upright_tube_are_emitted_again() {
    for two_sided in [false, true] {
        let mut builder = GeometryBuilder::new();
        let (from, to) = (DVec3::new(0.1, 0.2, -0.3), DVec3::new(0.1, 0.2, 0.7));
        let tube = Shape::Cylinder { from, to, radius: 0.3, capped: false };
        builder.add_object(&tube, &Transform::IDENTITY).expect("a shape");
        let geometry = builder.build().expect("a geometry");
        let light = Light::Area(AreaLight::new(&geometry, 0, emission(), two_sided));
        let mut emitted = 0;
        for index in 0..2_000 {
            let towards = direction(index).as_vec3a();
            let target = geometry.primitive(0).sample_area(pair(1, index)).position;
            let Some(hit) = geometry.intersect(&Ray::new(target - towards * 3.0, towards)) else { continue };
            let heading = direction(index ^ 0xabc).as_vec3a();
            let numbers = light.invert_emission(&geometry, &hit.point, Some(hit.primitive), heading);
            let dark = !two_sided && hit.point.normal.dot(heading) <= 0.0;
            if hit.point.normal.dot(heading).abs() > 1e-5 {
                assert_eq!(numbers.is_none(), dark, "{:?} along {heading}", hit.point);
            }
            let Some((u_point, u_direction)) = numbers else { continue };
            let again = light.emit(&geometry, u_point, u_direction).expect("a ray");
            let off = again.point.position.distance(hit.point.position);
            assert!(f64::from(off) < POSITION_ROUNDING, "{off:e}");
            // The last numbers before grazing, and those about the normal of the second side,
            // are 2^-23 apart in the squared sine.
            let squared = |w: Vec3A| w.dot(again.point.normal).powi(2);
            let fall = f64::from((squared(heading) - squared(again.ray.direction)).abs());
            let sine = f64::from(1.0 - squared(heading)).sqrt();
            let cosine = f64::from(squared(heading)).sqrt();
            let tolerance = 16.0 * ROUNDING * (1.0 + 1.0 / sine.min(cosine).max(1e-4));
            let turned = f64::from(again.ray.direction.distance(heading));
            assert!(fall < 16.0 * ROUNDING && turned < tolerance, "{heading}: {turned:e} of {tolerance:e}");
            emitted += 1;
        }
        assert!(emitted > 500, "{emitted}");
    }
}

#[test]
fn directions_of_point_lights_give_back_their_numbers() {
    let geometry = lights().remove(0).1;
    let axis = direction(4).as_vec3a();
    let angles_deg = [0.0, 20.0, 70.0, 110.0];
    let profile = Profile::new(direction(4), &angles_deg, &[0.4, 1.0, 0.3, 0.1]).expect("a sound profile");
    for distribution in [Distribution::Isotropic, Distribution::Cosine(axis), Distribution::Profile(profile)]
    {
        let position = Vec3A::new(0.3, -0.2, 0.1);
        let light =
            Light::Point(PointLight { position, distribution: distribution.clone(), intensity: emission() });
        let draw = |u| light.emit(&geometry, [0.5; 2], u).map(|drawn| (0, drawn.ray.direction.as_dvec3()));
        // Each of two directions is rounded in three coordinates.
        let rounding = |_| 2.0 * 3f64.sqrt() * ROUNDING;
        let map = Map { name: format!("{distribution:?}"), draw: &draw, rounding: &rounding, step: 0.01 };
        let invert = |u| {
            let drawn = light.emit(&geometry, [0.5; 2], u)?;
            light.invert_emission(&geometry, &drawn.point, drawn.primitive, drawn.ray.direction)
        };
        let tally = map.inverts(3, |u| {
            let (u_point, u_direction) = invert(u)?;
            assert_eq!(u_point, [0.5; 2]);
            Some(u_direction)
        });
        tally.assert_telling(&map.name, 0.6);
        let point = light.emit(&geometry, [0.5; 2], [0.5; 2]).expect("a ray").point;
        let behind = light.invert_emission(&geometry, &point, None, -axis);
        assert_eq!(behind.is_none(), !matches!(distribution, Distribution::Isotropic));
        assert_eq!(light.invert_towards(&geometry, &places()[0], &point, None), Some([0.5; 2]));
    }
}

#[test]
fn what_a_light_never_draws_has_no_numbers() {
    for (name, geometry, light) in lights() {
        let own = light.emit(&geometry, [0.3, 0.4], [0.2, 0.1]).expect("a ray");
        let from = SurfacePoint { position: own.ray.origin + own.ray.direction, ..own.point };
        let behind = SurfacePoint { position: own.ray.origin - own.ray.direction, ..own.point };
        let two_sided = name.ends_with("true");
        // A sphere hides its far side.
        let dark = !two_sided || name.starts_with("sphere");
        let towards = |from, primitive| light.invert_towards(&geometry, from, &own.point, primitive);
        assert!(towards(&from, own.primitive).is_some(), "{name}");
        assert_eq!(towards(&behind, own.primitive).is_none(), dark, "{name}");
        let numbers = |primitive, heading| light.invert_emission(&geometry, &own.point, primitive, heading);
        assert_eq!(numbers(own.primitive, -own.ray.direction).is_none(), !two_sided, "{name}");
        for other in [None, Some(0)] {
            assert!(towards(&from, other).is_none() && numbers(other, own.ray.direction).is_none(), "{name}");
        }
    }
}
