//! Path tracing that keeps no vertices, for pictures of which nobody asks how they came about.
//!
//! The estimates are those of the general loop under the same list of strategies: a subpath from
//! the eye meets lights and asks them, and nothing else is joined. There the next vertex needs the
//! last one alone, and of densities only that of the direction just drawn; copies of vertices and
//! what joints need are left out. `tests/paths.rs` holds the two loops against each other.

use super::contribution::{Contribution, End};
use super::eye::{Eye, EyeRay};
use super::fate::Fate;
use super::media::Media;
use super::strategies::Strategies;
use super::vertex::{Place, Surface};
use super::walk::{Heading, Walker, transmittance};
use crate::geometry::SurfacePoint;
use crate::light::Light;
use crate::material::Quantity;
use crate::sampler::Stream;
use crate::scene::Plan;

/// Whether a plan's paths can be traced without keeping them.
pub fn needs_no_vertices(plan: &Plan) -> bool {
    let Strategies { meets_lights, asks_lights, .. } = plan.strategies;
    plan.strategies == Strategies { meets_lights, asks_lights, ..Strategies::PATH } && !plan.lanes_differ
}

/// Where a subpath comes from.
struct From {
    point: SurfacePoint,
    /// Whether lights were asked there, so that a light met may have been found that way too.
    asked: bool,
    /// Vertices of the subpath so far.
    count: usize,
}

impl Walker<'_, '_> {
    /// Traces a path from the eye and hands on what it finds; what became of the walk comes back.
    pub fn trace_forgetfully(
        &self,
        (eye, media): (&Eye<'_>, Media),
        drawn: &EyeRay,
        mut put: impl FnMut(&Contribution),
    ) -> Fate {
        let strategies = &self.plan.strategies;
        let mut heading = Heading::from_eye(eye, drawn, media);
        let mut from = From { point: drawn.point, asked: false, count: 1 };
        let mut scattered = false;
        while let Some(hit) = self.meet(&mut heading) {
            let count = from.count + 1;
            let surface = Surface::of(self.scene, &hit, self.wavelengths);
            // What the ray has travelled through: the heading's own is about to change.
            let media = if self.plan.tracks_media { heading.media } else { Media::NONE };
            let to_previous = -heading.ray.direction;
            let place = Place { point: &hit.point, surface: &surface, to_previous, media: &media };
            if strategies.meets_lights && surface.light.is_some() {
                self.meets_light(&place, &from, &heading, &mut put);
            }
            if self.plan.direct_only && scattered {
                break;
            }
            if strategies.asks_lights && !surface.bsdf.is_delta() {
                self.asks_light(&place, count, &heading, &mut put);
            }
            let goes_on = self.draw(&place, &mut heading).is_some_and(|(drawn, direction)| {
                self.turn(&place, &drawn, direction, &mut heading);
                from = From { point: hit.point, asked: strategies.asks_lights && !drawn.is_delta, count };
                // By what happened there, not by what may: some glass does both.
                scattered |= !drawn.is_delta;
                heading.is_finite() && self.survives(&mut heading)
            });
            if !goes_on {
                if !heading.is_finite() {
                    put(&Contribution::lost(0, count));
                }
                break;
            }
        }
        heading.fate
    }

    /// The subpath has met a surface that may shine.
    #[inline]
    fn meets_light(
        &self,
        last: &Place<'_>,
        from: &From,
        heading: &Heading,
        put: &mut impl FnMut(&Contribution),
    ) {
        let lights = &self.scene.lights;
        let Some(index) = last.surface.light else { return };
        let light = lights.get(index);
        let Light::Area(area) = light else { return };
        if !area.shines(last.point.normal, last.to_previous) {
            return;
        }
        let asked = if from.asked {
            let towards =
                light.pdf_towards(&self.scene.geometry, &from.point, last.point, last.surface.primitive);
            lights.probability_towards(from.point.position, index) * f64::from(towards)
        } else {
            0.0
        };
        let estimate = heading.throughput * light.emission(self.wavelengths);
        let weight = power_heuristic(f64::from(heading.pdf.hero()), asked);
        put(&Contribution { weight, ..Contribution::of_path(0, from.count + 1, estimate) });
    }

    /// The last vertex asks a light.
    #[inline]
    fn asks_light(
        &self,
        last: &Place<'_>,
        count: usize,
        heading: &Heading,
        put: &mut impl FnMut(&Contribution),
    ) {
        let (scene, name) = (self.scene, count as u32 - 1);
        let choice = if self.plan.chooses_lamps { self.sampler.fine(Stream::LightChoice, name) } else { 0.0 };
        let Some((index, probability)) = scene.lights.choose_towards(last.point.position, choice) else {
            return;
        };
        let u = self.sampler.pair(Stream::LightPoint, name);
        let light = scene.lights.get(index);
        let Some(sample) = light.sample_towards(&scene.geometry, last.point, u, self.wavelengths) else {
            return;
        };
        let direction = sample.shadow_ray.direction;
        let scattered = last.scatter(direction, Quantity::Radiance);
        if scattered.value.is_black() || scene.geometry.occluded(&sample.shadow_ray) {
            return;
        }
        let asked = probability * f64::from(sample.pdf_solid_angle);
        let mut estimate = heading.throughput * scattered.value * (sample.radiance * (1.0 / asked) as f32);
        // Light reaches the vertex through the medium on its own side of the surface.
        if self.plan.tracks_media
            && let Some(absorption) = last.media_towards(direction).absorption(scene)
        {
            estimate *= transmittance(absorption, sample.shadow_ray.t_max, self.wavelengths);
        }
        // No ray meets a point light.
        let is_met = self.plan.strategies.meets_lights && sample.primitive.is_some();
        let met = if is_met { f64::from(scattered.pdf.hero()) } else { 0.0 };
        let end = Some(End { point: sample.point, light: Some((index, sample.primitive)) });
        let weight = power_heuristic(asked, met);
        put(&Contribution { weight, end, ..Contribution::of_path(1, count, estimate) });
    }
}

/// Weight of a direction drawn with one density that another strategy draws with another (Veach
/// 1997, equation 9.13); the first is above zero.
#[inline]
fn power_heuristic(own: f64, other: f64) -> f32 {
    let ratio = other / own;
    (1.0 / (1.0 + ratio * ratio)) as f32
}
