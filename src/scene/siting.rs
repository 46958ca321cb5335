//! How bodies stand to one another and to the origin: what can be told from geometry alone.
//!
//! Faces in the place of others and a scene far from its origin are remarks. Bodies of glass
//! that overlap without one being inside the other are an error: what light is in there, and
//! which index it leaves for, has no answer.

use super::SceneObject;
use crate::error::{Error, Result};
use crate::geometry::{Geometry, Ray};
use crate::material::Material;
use glam::Vec3A;

/// A scene is far from its origin where this many times its own size fits between.
const FAR: f32 = 8.0;
/// Rays through each transparent body, and surfaces that one of them crosses at most.
const PROBES: u32 = 64;
const MOST_CROSSINGS: u32 = 10_000;

/// What a user should know of where things are.
pub(super) fn remarks(geometry: &Geometry, objects: &[SceneObject]) -> Vec<String> {
    let mut remarks = Vec::new();
    let coincident = geometry.coincident_faces();
    if let Some((face, other)) = coincident.first() {
        let name = |primitive: u32| &objects[geometry.object_of(primitive) as usize].name;
        let faces = if coincident.len() == 1 { "face lies" } else { "faces lie" };
        remarks.push(format!(
            "{} {faces} in the place of another, the first of {} on {}: of faces in one place that of the first object is met",
            coincident.len(),
            name(*face),
            name(*other)
        ));
    }
    let bounds = geometry.bounds();
    if !bounds.is_empty() {
        let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
        let extent = (bounds.max - bounds.min).max_element();
        if reach > FAR * extent {
            remarks.push(format!(
                "all objects are {:.0} times their own size away from the origin: positions are rounded to {:e} m; move them nearer to it",
                reach / extent,
                geometry.spacing_metres()
            ));
        }
    }
    remarks
}

/// Refuses transparent bodies that reach into one another.
pub(super) fn check_bodies(
    geometry: &Geometry,
    objects: &[SceneObject],
    materials: &[Material],
) -> Result<()> {
    let is_glass = |object: u32| materials[objects[object as usize].material as usize].is_transparent();
    let glasses: Vec<u32> = (0..geometry.object_count()).filter(|object| is_glass(*object)).collect();
    if glasses.len() < 2 {
        return Ok(());
    }
    for glass in glasses {
        for probe in 0..PROBES {
            let Some((inner, outer, at)) = crossed(geometry, &probe_ray(geometry, glass, probe), is_glass)
            else {
                continue;
            };
            let name = |object: u32| &objects[object as usize].name;
            let at = at.as_dvec3() * geometry.metres_per_unit();
            return Err(Error::new(format!(
                "the transparent bodies {} and {} overlap at ({:.4}, {:.4}, {:.4}) m",
                name(outer),
                name(inner),
                at.x,
                at.y,
                at.z
            ))
            .hint("let one be wholly inside the other, or leave a gap between them")
            .under(inner.max(outer))
            .under("objects"));
        }
    }
    Ok(())
}

/// A ray from outside the scene through a point of a body.
fn probe_ray(geometry: &Geometry, object: u32, probe: u32) -> Ray {
    /// Steps of a sequence that fills a cube evenly: powers of the inverse of the real root of
    /// x^4 = x + 1, which is 1.2207.
    const STEPS: [f64; 4] = [0.819_172_5, 0.671_043_6, 0.549_700_5, 0.450_299_5];
    let [which, u, v, turn] = STEPS.map(|step| (step * f64::from(probe + 1)).fract());
    let primitives = geometry.primitives_of(object);
    let count = f64::from(primitives.end - primitives.start);
    let point =
        geometry.primitive(primitives.start + (which * count) as u32).sample_area([u as f32, v as f32]);
    let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
    let height = 2.0 * u - 1.0;
    let across = (1.0 - height * height).sqrt();
    let direction = Vec3A::new((across * cos) as f32, (across * sin) as f32, height as f32).normalize();
    let bounds = geometry.bounds();
    let away = 2.0 * bounds.radius() + (point.position - bounds.center()).length();
    Ray::new(point.position - direction * away, direction)
}

/// Where a ray leaves a body that it is in, of which another one that it entered later is not
/// left: the later one, the other and the place.
///
/// A surface that is left without having been entered is of an open body, or hidden by another
/// in the same place: such a ray tells nothing.
fn crossed(geometry: &Geometry, ray: &Ray, is_glass: impl Fn(u32) -> bool) -> Option<(u32, u32, Vec3A)> {
    let mut inside: Vec<u32> = Vec::new();
    let mut ray = *ray;
    let mut found = None;
    for _ in 0..MOST_CROSSINGS {
        let Some(hit) = geometry.intersect(&ray) else { break };
        ray = hit.point.ray_along(ray.direction);
        if !is_glass(hit.object) {
            continue;
        }
        if hit.point.normal.dot(ray.direction) < 0.0 {
            inside.push(hit.object);
            continue;
        }
        let place = inside.iter().rposition(|object| *object == hit.object)?;
        if place + 1 < inside.len() {
            found = found.or_else(|| Some((*inside.last()?, hit.object, hit.point.position)));
        }
        inside.remove(place);
    }
    if inside.is_empty() { found } else { None }
}
