//! Path tracing with next-event estimation and multiple importance sampling.
//!
//! A path carries all its wavelengths at once. Directions are drawn by the hero wavelength
//! (lane 0); the other lanes would have drawn them with other densities, and the balance
//! heuristic over which lane is the hero divides by the mean of all (Wilkie et al. 2014).
//! With P_k the density of a path under lane k, relative to the hero's, a contribution is
//! f / mean(P). Where a lane cannot follow (smooth refraction with dispersion) its P is zero
//! from there on, which weighs the hero accordingly: nothing else has to be done.
//!
//! Between drawing a light and meeting it by chance the power heuristic decides (Veach 1997,
//! equation 9.13), with each side's density averaged over the lanes.

use super::media::Media;
use crate::geometry::{Frame, Hit, Ray, SurfacePoint};
use crate::light::Light;
use crate::material::{Bsdf, BsdfSample, Lambertian, Quantity};
use crate::sampler::{Sampler, Stream};
use crate::scene::{Plan, Scene};
use crate::spectrum::{Dense, Spectrum, Wavelengths};
use glam::Vec3A;

/// Bounces before a path may be ended at random.
const SURE_BOUNCES: u32 = 3;
/// Bounces after which light counts as trapped, as by total reflection in clear glass.
const TRAPPED_BOUNCES: u32 = 1000;
/// Probability that trapped light is followed on, however much it carries: paths end, and the
/// variance stays finite wherever a bounce keeps less than 99.95 %.
const TRAPPED_SURVIVAL: f32 = 0.999;

/// Estimates radiance along rays and irradiance at points.
#[derive(Clone, Copy)]
pub struct PathTracer<'a> {
    scene: &'a Scene,
    plan: &'a Plan,
    /// What rays start in.
    start: Media<'a>,
}

/// A path on its way from the camera.
struct Walk<'a> {
    ray: Ray,
    /// f cos / pdf of the hero, multiplied up.
    throughput: Spectrum,
    /// P_k: density of the path so far under each lane, relative to the hero's.
    lane_density: Spectrum,
    /// Radiance gathered so far.
    gathered: Spectrum,
    bounce: u32,
    /// How the ray was drawn: what meeting a light needs to weigh itself.
    origin: Origin,
    /// What the ray travels through; kept only where something absorbs.
    media: Media<'a>,
    /// Product of the n^2 factors that the throughput holds.
    radiance_scale: f32,
}

/// Where the current ray comes from.
enum Origin {
    /// The camera or a delta: no light could have been drawn instead.
    Sole,
    /// A surface that also asked the lights.
    Shared {
        point: SurfacePoint,
        /// Mean over lanes of P_k before the surface over the hero's density there.
        density_before: f32,
    },
}

/// A place where light is scattered.
struct Vertex<'a> {
    point: SurfacePoint,
    shading: Frame,
    bsdf: Bsdf,
    wo: Vec3A,
    object: u32,
    absorption: Option<&'a Dense>,
}

impl<'a> PathTracer<'a> {
    /// A tracer for a scene under its plan.
    pub const fn new(scene: &'a Scene, plan: &'a Plan) -> Self {
        Self { scene, plan, start: Media::NONE }
    }

    /// The same tracer for rays that start at a position, which may be inside a medium.
    #[must_use]
    pub fn starting_at(mut self, position: Vec3A) -> Self {
        if self.plan.tracks_media {
            self.start = Media::around(self.scene, position);
        }
        self
    }

    /// Radiance arriving against a ray, in W sr^-1 m^-2 nm^-1 at each wavelength: a sample
    /// whose mean over lanes and draws is the truth.
    pub fn radiance(&self, ray: Ray, wavelengths: &Wavelengths, sampler: &Sampler) -> Spectrum {
        let mut walk = Walk::start(ray, self.start);
        self.follow(&mut walk, wavelengths, sampler);
        walk.gathered
    }

    /// Irradiance in W m^-2 nm^-1 on the side that the point's normal faces.
    ///
    /// It is pi times what a perfectly white matte surface would send out.
    pub fn irradiance(&self, point: SurfacePoint, wavelengths: &Wavelengths, sampler: &Sampler) -> Spectrum {
        let white = Lambertian { reflectance: Spectrum::ONE, two_sided: false };
        let vertex = Vertex {
            point,
            shading: Frame::around(point.normal),
            bsdf: Bsdf::Lambertian(white),
            wo: point.normal,
            object: u32::MAX,
            absorption: None,
        };
        let mut walk = Walk::start(Ray::new(point.position, point.normal), self.start);
        if self.scatter(&mut walk, &vertex, wavelengths, sampler) {
            self.follow(&mut walk, wavelengths, sampler);
        }
        walk.gathered * std::f32::consts::PI
    }

    fn follow(&self, walk: &mut Walk<'a>, wavelengths: &Wavelengths, sampler: &Sampler) {
        while let Some(hit) = self.scene.geometry.intersect(&walk.ray) {
            if let Some(absorption) = walk.media.absorption() {
                walk.throughput *= transmittance(absorption, hit.t, wavelengths);
            }
            self.gather_emission(walk, &hit, wavelengths);
            let vertex = self.vertex(walk, &hit, wavelengths);
            if !self.scatter(walk, &vertex, wavelengths, sampler) {
                break;
            }
        }
    }

    fn vertex(&self, walk: &Walk<'_>, hit: &Hit, wavelengths: &Wavelengths) -> Vertex<'a> {
        let object = &self.scene.objects[hit.object as usize];
        let material = &self.scene.materials[object.material as usize];
        Vertex {
            point: hit.point,
            shading: hit.shading,
            bsdf: material.at(wavelengths),
            wo: -walk.ray.direction,
            object: hit.object,
            absorption: material.absorption(),
        }
    }

    /// Adds what a surface itself gives off, weighed against having drawn it.
    fn gather_emission(&self, walk: &mut Walk<'_>, hit: &Hit, wavelengths: &Wavelengths) {
        let object = &self.scene.objects[hit.object as usize];
        let Some(index) = object.light else { return };
        let light = self.scene.lights.get(index);
        let Light::Area(area) = light else { return };
        if !area.shines(hit.point.normal, -walk.ray.direction) {
            return;
        }
        let density = walk.lane_density.mean();
        let weight = match &walk.origin {
            Origin::Sole => 1.0,
            Origin::Shared { point, density_before } => {
                let drawn = self.scene.lights.probability_towards(point.position, index) as f32
                    * light.pdf_towards(&self.scene.geometry, point, &walk.ray, hit);
                power_heuristic(density, density_before * drawn)
            }
        };
        walk.gathered += walk.throughput * area.radiance().at(wavelengths) * (weight / density);
    }

    /// Asks the lights, draws where the path goes on, and decides whether it does.
    fn scatter(
        &self,
        walk: &mut Walk<'a>,
        vertex: &Vertex<'a>,
        wavelengths: &Wavelengths,
        sampler: &Sampler,
    ) -> bool {
        let shared = !vertex.bsdf.is_delta();
        if shared {
            self.gather_direct(walk, vertex, wavelengths, sampler);
        }
        let wo = vertex.shading.to_local(vertex.wo);
        let u = sampler.pair(Stream::Direction, walk.bounce);
        let u_lobe = if vertex.bsdf.transmits() { sampler.single(Stream::Lobe, walk.bounce) } else { 0.0 };
        let Some(drawn) = vertex.bsdf.sample(wo, u_lobe, u, Quantity::Radiance) else { return false };
        if !walk.leave(vertex, &drawn, shared, self.plan.tracks_media) {
            return false;
        }
        walk.survives(sampler)
    }

    /// Next-event estimation: one light, one point on it.
    fn gather_direct(
        &self,
        walk: &mut Walk<'_>,
        vertex: &Vertex<'_>,
        wavelengths: &Wavelengths,
        sampler: &Sampler,
    ) {
        let geometry = &self.scene.geometry;
        let choice = sampler.fine(Stream::LightChoice, walk.bounce);
        let from = vertex.point.position;
        let Some((index, probability)) = self.scene.lights.choose_towards(from, choice) else { return };
        let light = self.scene.lights.get(index);
        let u = sampler.pair(Stream::LightPoint, walk.bounce);
        let Some(sample) = light.sample_towards(geometry, &vertex.point, u, wavelengths) else { return };
        let direction = sample.shadow_ray.direction;
        if !vertex.sides_agree(vertex.wo, direction) {
            return;
        }
        let (wo, wi) = (vertex.shading.to_local(vertex.wo), vertex.shading.to_local(direction));
        let scattered = vertex.bsdf.evaluate(wo, wi, Quantity::Radiance);
        if scattered.value.is_black() || geometry.occluded(&sample.shadow_ray) {
            return;
        }
        let drawn = walk.lane_density.mean() * probability as f32 * sample.pdf_solid_angle;
        let by_chance = (walk.lane_density * scattered.pdf).mean();
        let weight = if sample.is_delta { 1.0 } else { power_heuristic(drawn, by_chance) };
        let mut light = sample.radiance;
        // Light reaches the vertex through the medium on its own side of the surface.
        if let Some(absorption) = vertex.media_towards(direction, walk.media).absorption() {
            light *= transmittance(absorption, sample.shadow_ray.t_max, wavelengths);
        }
        walk.gathered += walk.throughput * scattered.value * light * (weight / drawn);
    }
}

impl<'a> Vertex<'a> {
    /// Whether both directions lie on the sides of the true surface that the shading frame
    /// says they do; light does not leak through where the two normals disagree.
    fn sides_agree(&self, wo: Vec3A, wi: Vec3A) -> bool {
        let agrees = |w: Vec3A| self.point.normal.dot(w) * self.shading.normal.dot(w) > 0.0;
        agrees(wo) && agrees(wi)
    }

    /// What light travels through on the way in a direction, given what it came through.
    fn media_towards(&self, direction: Vec3A, mut media: Media<'a>) -> Media<'a> {
        let (towards, from) = (self.point.normal.dot(direction), self.point.normal.dot(self.wo));
        if towards * from < 0.0 && self.bsdf.transmits() {
            media.cross(self.object, self.absorption, towards < 0.0);
        }
        media
    }
}

impl<'a> Walk<'a> {
    const fn start(ray: Ray, media: Media<'a>) -> Self {
        Self {
            ray,
            throughput: Spectrum::ONE,
            lane_density: Spectrum::ONE,
            gathered: Spectrum::ZERO,
            bounce: 0,
            origin: Origin::Sole,
            media,
            radiance_scale: 1.0,
        }
    }

    /// Follows a drawn direction; false where it carries nothing.
    fn leave(&mut self, vertex: &Vertex<'a>, drawn: &BsdfSample, shared: bool, tracks_media: bool) -> bool {
        let direction = vertex.shading.to_world(drawn.wi).normalize();
        let hero = drawn.pdf.hero();
        if drawn.value.is_black() || !vertex.sides_agree(vertex.wo, direction) {
            return false;
        }
        self.origin = if shared {
            Origin::Shared { point: vertex.point, density_before: self.lane_density.mean() / hero }
        } else {
            Origin::Sole
        };
        if tracks_media && drawn.is_transmission {
            self.media = vertex.media_towards(direction, self.media);
        }
        if drawn.is_transmission {
            self.radiance_scale *= vertex.bsdf.radiance_scale(drawn.wi);
        }
        // Divided, not multiplied by a reciprocal: the hero's own density stays exactly one.
        self.throughput *= drawn.value / Spectrum::splat(hero);
        self.lane_density *= drawn.pdf / Spectrum::splat(hero);
        self.ray = vertex.point.ray_along(direction);
        self.bounce += 1;
        true
    }

    /// Russian roulette on what the path still carries, n^2 factors aside: those come back
    /// when it leaves the medium.
    fn survives(&mut self, sampler: &Sampler) -> bool {
        if self.bounce <= SURE_BOUNCES {
            return true;
        }
        let carried = self.throughput.max() / (self.lane_density.mean() * self.radiance_scale);
        let most = if self.bounce < TRAPPED_BOUNCES { 1.0 } else { TRAPPED_SURVIVAL };
        if carried >= most && most == 1.0 {
            return true;
        }
        let survival = carried.min(most);
        let survives = sampler.single(Stream::Roulette, self.bounce) < survival;
        self.throughput *= 1.0 / survival;
        survives
    }
}

/// Beer-Lambert over a distance in scene units.
fn transmittance(absorption: &Dense, distance: f32, wavelengths: &Wavelengths) -> Spectrum {
    absorption.at(wavelengths).map(|a| (-a * distance).exp())
}

/// Weight of the first of two densities: a^2 / (a^2 + b^2), without leaving the range.
#[inline]
fn power_heuristic(a: f32, b: f32) -> f32 {
    if a > b {
        let ratio = b / a;
        1.0 / (1.0 + ratio * ratio)
    } else {
        let ratio = a / b;
        let squared = ratio * ratio;
        squared / (1.0 + squared)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heuristic_weights_sum_to_one_at_any_ratio() {
        for (a, b) in [(1.0, 1.0), (1e-30, 1e30), (3.0, 4.0), (f32::INFINITY, 1.0), (0.0, 1.0)] {
            let sum = power_heuristic(a, b) + power_heuristic(b, a);
            assert!((sum - 1.0).abs() < 1e-6, "{a} {b}: {sum}");
        }
    }
}
