//! What a path is worth: contribution, and density by every strategy, from its vertices alone.

use super::grow::{SURE_VERTICES, SURVIVAL, lobe_number};
use super::path::{End, Logarithms, Path, Scattering, ln_sum};
use super::world::World;
use crate::geometry::SurfacePoint;
use crate::light::Light;
use crate::material::{BsdfSample, Quantity};
use crate::path::{Kind, Media, transmittance};
use crate::spectrum::{LANES, Spectrum};

impl Path {
    /// Whether the eye sees the light straight or over smooth surfaces, or sees there a surface
    /// that the light shines on straight: what is left to standard sampling.
    fn is_direct(&self) -> bool {
        let rough = (1..self.count() - 1).filter(|index| !self.is_delta(*index));
        let meets = matches!(self.nodes[0].kind, Kind::Light { primitive: Some(_), .. }) || self.count() == 2;
        let mut rough = rough.peekable();
        match rough.next() {
            None => meets,
            Some(first) => first == 1 && rough.peek().is_none(),
        }
    }

    /// Judges the path; false where a chain has nothing to do with it: it carries nothing, is
    /// direct light, or cannot be made afresh.
    pub fn judge(&mut self, world: &World<'_>) -> bool {
        self.ln_target = f64::NEG_INFINITY;
        let most_vertices = world.plan.most_bounces.map_or(usize::MAX, |most| most as usize + 2);
        if self.count() < 3 || self.count() > most_vertices || self.is_direct() {
            return false;
        }
        self.measure(world);
        let last = self.count() - 1;
        let sight = world.eye.sees(&self.nodes[last].point, self.direction(last, End::Light));
        let Some(sight) = sight else { return false };
        self.position = sight.position;
        let lanes = world.lanes();
        if !self.scatter() {
            return false;
        }
        let Some((value, ln_value)) = self.value(world, sight.pdf_solid_angle) else { return false };
        self.densities(world, sight.pdf_solid_angle, lanes);
        self.combine(world, lanes);
        let fresh = &self.strategies_together(world, lanes);
        let mean = mean(&fresh[..lanes]);
        self.ln_fresh = fresh[0];
        // All wavelengths of a path count, weighed by the density that each would have made the
        // path with (Wilkie et al. 2014): the rest is what one fresh path estimates.
        self.channels.clear();
        let mut total = 0.0;
        let channels = &mut self.channels;
        world.sensor.record(value, &self.wavelengths, |channel, recorded| {
            total += recorded.abs() * world.weights[channel];
            channels.push(recorded);
        });
        self.ln_target = total.ln() + ln_value + fresh[0] - mean;
        self.channels.iter_mut().for_each(|channel| *channel /= total);
        self.is_faulty |= self.ln_target.is_nan() || self.ln_target == f64::INFINITY;
        self.ln_target.is_finite() && self.ln_fresh.is_finite()
    }

    /// Lengths and directions between the vertices.
    fn measure(&mut self, world: &World<'_>) {
        self.directions.clear();
        self.per_area.clear();
        let last = self.count() - 1;
        for (index, pair) in self.nodes.windows(2).enumerate() {
            let [from, to] = [pair[0].point, pair[1].point];
            let span = to.position.as_dvec3() - from.position.as_dvec3();
            let squared = span.length_squared();
            let direction = span / squared.sqrt();
            let cosine = |point: &SurfacePoint| point.normal.as_dvec3().dot(direction).abs() / squared;
            let meets_light = index > 0 || matches!(pair[0].kind, Kind::Light { primitive: Some(_), .. });
            let meets_eye = index + 1 < last || world.eye.has_aperture();
            let or_zero = |meets: bool, value: f64| if meets { value } else { 0.0 };
            self.per_area.push([or_zero(meets_light, cosine(&from)), or_zero(meets_eye, cosine(&to))]);
            self.directions.push(direction.as_vec3a());
        }
    }

    /// Scattering at every vertex between the ends; false where one of them is black.
    fn scatter(&mut self) -> bool {
        self.scatterings.clear();
        self.scatterings.push(None);
        for index in 1..self.count() - 1 {
            let Some(scattering) = self.scattering(index) else { return false };
            if scattering.value.is_black() {
                return false;
            }
            self.scatterings.push(Some(scattering));
        }
        self.scatterings.push(None);
        true
    }

    fn scattering(&self, index: usize) -> Option<Scattering> {
        let node = &self.nodes[index];
        let surface = node.surface()?;
        let (light, eye) = (self.direction(index, End::Light), self.direction(index, End::Eye));
        if !surface.sides_agree(&node.point, light) || !surface.sides_agree(&node.point, eye) {
            return None;
        }
        let (light, eye) = (surface.shading.to_local(light), surface.shading.to_local(eye));
        if !node.is_delta {
            let both = surface.bsdf.evaluate(eye, light, Quantity::Radiance);
            let to_eye = surface.bsdf.pdf(light, eye, Quantity::Importance);
            return Some(Scattering { value: both.value, to_light: both.pdf, to_eye, measure: [1.0; 2] });
        }
        let crosses = light.z * eye.z < 0.0;
        let u_lobe = lobe_number(crosses);
        let drawn = surface.bsdf.sample(eye, u_lobe, [0.5; 2], Quantity::Radiance)?;
        let back = surface.bsdf.sample(light, u_lobe, [0.5; 2], Quantity::Importance)?;
        let measure = [light, eye].map(|w| f64::from(surface.bsdf.delta_measure(w)));
        let is_this = |drawn: &BsdfSample| drawn.is_delta && drawn.is_transmission == crosses;
        (is_this(&drawn) && is_this(&back)).then_some(Scattering {
            value: drawn.value,
            to_light: drawn.pdf,
            to_eye: back.pdf,
            measure,
        })
    }

    /// Radiance in the world's unit times the eye's response along the path, over a factor of
    /// which the logarithm comes with it; `None` where it is nothing. What is no number is handed
    /// on as it is.
    fn value(&self, world: &World<'_>, sight_pdf: f64) -> Option<(Spectrum, f64)> {
        let last = self.count() - 1;
        let Kind::Light { light, .. } = self.nodes[0].kind else { return None };
        let light = world.scene.lights.get(light);
        let share = match light {
            Light::Point(point) => f64::from(point.distribution.towards(self.directions[0])),
            Light::Area(area) => {
                f64::from(u8::from(area.shines(self.nodes[0].point.normal, self.directions[0])))
            }
        };
        let mut value = light.emission(&self.wavelengths) * (1.0 / world.light_unit);
        let mut ln = (share * f64::from(world.eye.response()) * sight_pdf * world.eye.pdf_area()).ln();
        let mut media = world.eye_media;
        for index in (1..=last).rev() {
            let squared = self.squared_distance(index - 1);
            if world.plan.tracks_media {
                if let Some(absorption) = media.absorption(world.scene) {
                    value *= transmittance(absorption, squared.sqrt() as f32, &self.wavelengths);
                }
                self.enter(index - 1, &mut media);
            }
            let mut geometry = self.per_area[index - 1][0];
            if index == 1 && !light.has_surface() {
                geometry = 1.0 / squared;
            }
            if let Some(scattering) = &self.scatterings[index] {
                value *= scattering.value;
                geometry *= scattering.measure[0];
            }
            if !value.is_finite() {
                return Some((value, ln));
            }
            // Kept near one: long paths and small solid angles leave the range of numbers.
            let largest = value.max();
            if largest <= 0.0 {
                return None;
            }
            value *= 1.0 / largest;
            ln += (geometry * f64::from(largest)).ln();
        }
        (ln != f64::NEG_INFINITY).then_some((value, ln))
    }

    fn squared_distance(&self, index: usize) -> f64 {
        let [a, b] = [index, index + 1].map(|i| self.nodes[i].point.position.as_dvec3());
        (b - a).length_squared()
    }

    /// Follows a walk from the eye through the surface at a vertex.
    fn enter(&self, index: usize, media: &mut Media) {
        let Some(surface) = self.nodes[index].surface() else { return };
        if index == 0 || !surface.bsdf.transmits() {
            return;
        }
        let normal = self.nodes[index].point.normal;
        let towards = normal.dot(self.direction(index, End::Light));
        if towards * normal.dot(self.direction(index, End::Eye)) < 0.0 {
            media.cross(surface.object, towards < 0.0);
        }
    }

    /// Density of every vertex for walks from both ends.
    fn densities(&mut self, world: &World<'_>, sight_pdf: f64, lanes: usize) {
        let last = self.count() - 1;
        let Kind::Light { light: index, primitive } = self.nodes[0].kind else { return };
        let lights = &world.scene.lights;
        let light = lights.get(index);
        let start = &self.nodes[0].point;
        let same = |density: f64| [density.ln(); LANES];
        self.from_light.clear();
        self.from_light.push(same(lights.probability_emitting(index) * light.pdf_area()));
        let emitted = light.pdf_emission(start.normal, self.directions[0]);
        self.from_light.push(same(emitted * self.per_area[0][1]));
        self.from_eye.clear();
        for at in 1..=last {
            let each = |pdf: &Spectrum, factor: f64| {
                let mut logarithms = [0.0; LANES];
                for (lane, logarithm) in logarithms.iter_mut().enumerate().take(lanes) {
                    *logarithm = (f64::from(pdf[lane]) * factor).ln();
                }
                logarithms
            };
            if let Some(scattering) = &self.scatterings[at] {
                let [to_light, to_eye] = scattering.measure;
                self.from_eye.push(each(&scattering.to_light, to_light * self.per_area[at - 1][0]));
                self.from_light.push(each(&scattering.to_eye, to_eye * self.per_area[at][1]));
            }
        }
        self.from_eye.push(same(sight_pdf * self.per_area[last - 1][0]));
        self.from_eye.push(same(world.eye.pdf_area()));
        for index in SURE_VERTICES..=last {
            let survival = SURVIVAL.ln();
            self.from_light[index].iter_mut().for_each(|ln| *ln += survival);
            self.from_eye[last - index].iter_mut().for_each(|ln| *ln += survival);
        }
        let lit = &self.nodes[1].point;
        let probability = lights.probability_towards(lit.position, index);
        self.asked = match primitive {
            None => probability.ln(),
            Some(primitive) => {
                let towards = light.pdf_towards(&world.scene.geometry, lit, start, primitive);
                (probability * f64::from(towards) * self.per_area[0][0]).ln()
            }
        };
    }

    /// Density of every strategy, from the sums over both walks.
    fn combine(&mut self, world: &World<'_>, lanes: usize) {
        let count = self.count();
        self.counted.clear();
        self.counted.push(0);
        for node in &self.nodes {
            self.counted.push(self.counted[self.counted.len() - 1] + usize::from(node.counts()));
        }
        self.strategies.clear();
        self.strategies.resize(count + 1, [0.0; LANES]);
        for lane in 0..lanes {
            let mut sum = 0.0;
            for s in 0..=count {
                let start = if s == 1 { self.asked } else { sum };
                self.strategies[s][lane] = start;
                if s < count {
                    sum += self.from_light[s][lane];
                }
            }
            let mut sum = 0.0;
            for s in (0..=count).rev() {
                if s < count {
                    sum += self.from_eye[s][lane];
                }
                self.strategies[s][lane] += sum;
            }
        }
        for s in 0..=count {
            if !self.joins(s) || !world.plan.strategies.plans(s, count - s) {
                self.strategies[s] = [f64::NEG_INFINITY; LANES];
            }
        }
    }

    /// Density with which a fresh path is this one, for each lane.
    fn strategies_together(&self, world: &World<'_>, lanes: usize) -> Logarithms {
        let count = self.count();
        let mut together = [f64::NEG_INFINITY; LANES];
        for (lane, ln) in together.iter_mut().enumerate().take(lanes) {
            let terms = (0..=count).map(|s| {
                let (all, from_light) = self.counted(s);
                world.lengths.probability(all, from_light).ln() + self.strategies[s][lane]
            });
            *ln = ln_sum(terms);
        }
        together
    }
}

/// Logarithm of the mean over lanes.
fn mean(logarithms: &[f64]) -> f64 {
    ln_sum(logarithms.iter().copied()) - (logarithms.len() as f64).ln()
}
