//! A replayed sample in words and numbers: every vertex, every strategy, and where the first
//! number is that is none.

use super::chain::ReplayedPath;
use super::sample::Replayed;
use crate::geometry::SurfacePoint;
use crate::path::{Contribution, Kind, Surface, Vertex};
use crate::scene::Scene;
use crate::spectrum::Spectrum;
use std::fmt::Write as _;

/// The sample on several lines. Positions in metres, densities per steradian or square metre,
/// contributions in W sr^-1 m^-2 nm^-1 times the eye's response.
pub fn explain(scene: &Scene, sample: &Replayed) -> String {
    let mut text = String::new();
    let paths = &sample.paths;
    line(&mut text, "wavelengths", &format!("nm {}", lanes(sample.wavelengths.nm)));
    let mut faults = Vec::new();
    for (name, walk) in [("light", &paths.light), ("eye", &paths.eye)] {
        for (index, vertex) in walk.iter().enumerate() {
            let place = format!("{name} {index}");
            describe(&mut text, scene, &place, walk, index);
            if let Some(what) = first_fault(vertex) {
                faults.push(format!("{what} at vertex {place}, {}", what_is_at(scene, &vertex.kind)));
            }
        }
    }
    if !paths.light.is_empty() {
        line(&mut text, "emitted", &lanes(paths.emitted));
    }
    for found in &sample.contributions {
        line(&mut text, "strategy", &contribution(found));
    }
    let own: Vec<String> = sample.own.iter().map(|value| format!("{value:e}")).collect();
    line(&mut text, "recorded", &format!("channels {}", own.join(" ")));
    for (pixel, values) in &sample.splats {
        let values: Vec<String> = values.iter().map(|value| format!("{value:e}")).collect();
        line(&mut text, "recorded", &format!("at pixel number {pixel}: channels {}", values.join(" ")));
    }
    let verdict = if sample.non_finite == 0 {
        "finite".to_owned()
    } else {
        format!("not finite, {} time(s): {}", sample.non_finite, where_first(scene, sample, &faults))
    };
    line(&mut text, "verdict", &verdict);
    text
}

/// Where a sample first stops being finite.
fn where_first(scene: &Scene, sample: &Replayed, faults: &[String]) -> String {
    if let Some(first) = faults.first() {
        return format!("first in the {first}");
    }
    let broken = sample.contributions.iter().find(|found| !(found.estimate * found.weight).is_finite());
    let Some(found) = broken else { return "first in the sum over strategies or over lanes".to_owned() };
    let last = |walk: &[Vertex], count: usize| {
        let vertex = walk.get(count.checked_sub(1)?)?;
        Some(what_is_at(scene, &vertex.kind))
    };
    let ends: Vec<String> = [last(&sample.paths.light, found.s), last(&sample.paths.eye, found.t)]
        .into_iter()
        .flatten()
        .collect();
    format!("first in strategy ({}, {}), between {}", found.s, found.t, ends.join(" and "))
}

fn line(text: &mut String, what: &str, value: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{what:<12} {value}");
}

fn lanes(spectrum: Spectrum) -> String {
    if spectrum.is_flat() {
        return format!("{:?}", spectrum.hero());
    }
    let each: Vec<String> = spectrum.0.iter().map(|value| format!("{value:?}")).collect();
    format!("[{}]", each.join(" "))
}

fn describe(text: &mut String, scene: &Scene, place: &str, walk: &[Vertex], index: usize) {
    let vertex = &walk[index];
    line(text, place, &format!("{} at {}", what_is_at(scene, &vertex.kind), position(scene, &vertex.point)));
    let normal = vertex.point.normal;
    line(text, "", &format!("normal {} {} {}", normal.x, normal.y, normal.z));
    if let Kind::Surface(surface) = &vertex.kind {
        let back = vertex.to_previous;
        let cosine = surface.shading.normal.dot(back);
        line(text, "", &format!("came from {} {} {} (cosine {cosine})", back.x, back.y, back.z));
    }
    if let Some(next) = walk.get(index + 1) {
        let onward = -next.to_previous;
        let how = if vertex.is_delta { "by a delta" } else { "by a density" };
        line(text, "", &format!("goes on to {} {} {} {how}", onward.x, onward.y, onward.z));
    }
    line(text, "", &format!("throughput {}", lanes(vertex.throughput)));
    let per_square_metre = scene.geometry.metres_per_unit().powi(-2);
    let [forward, reverse] =
        [vertex.forward, vertex.reverse].map(|density| density.hero() * per_square_metre);
    line(
        text,
        "",
        &format!(
            "pdf per m2: reached {forward:e}, from the other end {reverse:e}; lanes {}; survival {}",
            lanes(vertex.lanes),
            vertex.survival
        ),
    );
}

fn what_is_at(scene: &Scene, kind: &Kind) -> String {
    match kind {
        Kind::Eye { has_area: true } => "lens".to_owned(),
        Kind::Eye { has_area: false } => "eye".to_owned(),
        Kind::Light { light, .. } => {
            let name = scene.emitters.get(*light as usize).map_or("?", |emitter| emitter.name.as_str());
            format!("light {light} ({name})")
        }
        Kind::Surface(Surface { object, light, .. }) => {
            let described = &scene.objects[*object as usize];
            let shines = if light.is_some() { ", which shines" } else { "" };
            let material = &scene.materials[described.material as usize];
            let name = &scene.material_names[described.material as usize];
            format!("{} (material {name}, {}{shines})", described.name, material.kind())
        }
    }
}

fn position(scene: &Scene, point: &SurfacePoint) -> String {
    let metres = point.position.as_dvec3() * scene.geometry.metres_per_unit();
    format!("{} {} {} m", metres.x, metres.y, metres.z)
}

/// What of a vertex is no number.
fn first_fault(vertex: &Vertex) -> Option<&'static str> {
    let point = &vertex.point;
    if !(point.position.is_finite() && point.normal.is_finite()) {
        Some("position or normal")
    } else if !vertex.throughput.is_finite() {
        Some("throughput")
    } else if !vertex.lanes.is_finite() || !vertex.forward.hero().is_finite() {
        Some("density")
    } else {
        None
    }
}

fn contribution(found: &Contribution) -> String {
    let Contribution { s, t, estimate, weight, position, .. } = found;
    let elsewhere = position.map_or_else(String::new, |[x, y]| format!(" at {x:.3},{y:.3} px"));
    let finite = if (*estimate * *weight).is_finite() { "" } else { "   <- not finite" };
    format!("({s}, {t}){elsewhere}: estimate {}, weight {weight}{finite}", lanes(*estimate))
}

/// The same of a chain's path.
pub fn explain_path(scene: &Scene, replayed: &ReplayedPath) -> String {
    let mut text = String::new();
    let path = &replayed.path;
    line(&mut text, "wavelengths", &format!("nm {}", lanes(path.wavelengths.nm)));
    for (index, node) in path.nodes.iter().enumerate() {
        let how = if node.is_delta { ", goes on by a delta" } else { "" };
        let what = what_is_at(scene, &node.kind);
        line(
            &mut text,
            &format!("vertex {index}"),
            &format!("{what} at {}{how}", position(scene, &node.point)),
        );
        if let Some(value) = path.scattering_value(index) {
            line(&mut text, "", &format!("scatters {}", lanes(value)));
        }
    }
    line(
        &mut text,
        "target",
        &format!("ln {}, density of a fresh path ln {}", path.ln_target, path.ln_fresh),
    );
    let verdict = if replayed.is_valid { "finite".to_owned() } else { broken_at(scene, replayed) };
    line(&mut text, "verdict", &verdict);
    text
}

/// Where a chain's path first stops being finite, if it is that which is wrong with it.
fn broken_at(scene: &Scene, replayed: &ReplayedPath) -> String {
    let path = &replayed.path;
    let is_broken = |index: &usize| path.scattering_value(*index).is_some_and(|value| !value.is_finite());
    match (0..path.count()).find(is_broken) {
        Some(index) => {
            format!("not finite: first at vertex {index}, {}", what_is_at(scene, &path.nodes[index].kind))
        }
        None if path.ln_target.is_nan() || path.ln_target == f64::INFINITY => {
            "not finite: its worth, though all that is scattered is".to_owned()
        }
        None => {
            "no chain may be at it: it carries nothing, is direct light or cannot be made afresh".to_owned()
        }
    }
}
