//! Multiplexed primary-sample-space mutation (Kelemen et al. 2002; Hachisuka, Kaplanyan and
//! Dachsbacher 2014) of a path that may come from any other mutation.
//!
//! A strategy is drawn in proportion to its share in the density of a fresh path; the numbers
//! that it makes this path from are found by inverting the samplers (Otsu et al. 2017;
//! Bitterli et al. 2018), move a little, and make the new path. With i the strategy, drawn
//! with its share w_i, path and numbers have the density f w_i |dx/du|, and with balanced
//! shares that is the target over the density of a fresh path, times the probability of
//! drawing the strategy. Choices among few things (which light, reflection or transmission) are
//! kept, so their probabilities, unlike densities, stay in the ratio.

use super::{Mutator, PRIMARY_STEPS};
use crate::material::Quantity;
use crate::metropolis::grow::lobe_number;
use crate::metropolis::node::Node;
use crate::metropolis::numbers::Numbers;
use crate::metropolis::path::{End, Path};
use crate::path::Kind;

impl Mutator<'_, '_> {
    pub(super) fn primary(&mut self, x: &Path, y: &mut Path, numbers: &mut Numbers) -> Option<f64> {
        let world = self.world;
        let count = x.count();
        let share = |s: usize| {
            let (all, from_light) = x.counted(s);
            let probability = world.lengths.probability(all, from_light);
            if probability > 0.0 { (probability.ln() + x.ln_strategy(s) - x.ln_fresh).exp() } else { 0.0 }
        };
        let s = numbers.choose((0..=count).map(share))?;
        y.copy_nodes(x);
        y.u_wavelength = PRIMARY_STEPS.along_unit(x.u_wavelength, numbers);
        y.wavelengths = world.plan.wavelengths.sample(y.u_wavelength);
        self.remake(x, y, s, numbers)?;
        if !y.judge(world) || !y.ln_strategy(s).is_finite() {
            return None;
        }
        let choices = |path: &Path| self.ln_choices(path, s);
        Some(y.ln_estimate() + choices(y) - x.ln_estimate() - choices(x))
    }

    /// Makes `y` by strategy `s` from numbers near those that make `x`.
    fn remake(&self, x: &Path, y: &mut Path, s: usize, numbers: &mut Numbers) -> Option<()> {
        let world = self.world;
        let count = x.count();
        let last = count - 1;
        // From the eye.
        if s < count {
            if world.eye.has_aperture() {
                let u_lens = moved(world.eye.invert_lens(x.nodes[last].point.position), numbers);
                y.nodes[last] = Node::eye(world.eye.point(u_lens)?, true);
            }
            for index in (s.max(1)..last).rev() {
                self.step_from_eye(x, y, index, numbers)?;
            }
            if s == 0 {
                let node = self.step_from_eye_to(x, y, 0, numbers)?;
                y.nodes[0] = node.as_light()?;
            }
        }
        // From the light.
        let Kind::Light { light: index, primitive } = x.nodes[0].kind else { return None };
        let light = world.scene.lights.get(index);
        let geometry = &world.scene.geometry;
        if s == 1 {
            let (lit, start) = (&x.nodes[1].point, &x.nodes[0].point);
            let u = moved(light.invert_towards(geometry, lit, start, primitive)?, numbers);
            let sample = light.sample_towards(geometry, &y.nodes[1].point, u, &y.wavelengths)?;
            y.nodes[0] = Node::light(sample.point, index, sample.primitive);
        } else if s > 1 {
            let direction = x.direction(0, End::Eye);
            let (u_point, u_direction) =
                light.invert_emission(geometry, &x.nodes[0].point, primitive, direction)?;
            let (u_point, u_direction) = (moved(u_point, numbers), moved(u_direction, numbers));
            let emitted = light.emit(geometry, u_point, u_direction)?;
            y.nodes[0] = Node::light(emitted.point, index, emitted.primitive);
            let mut ray = emitted.ray;
            for at in 1..s.min(last) {
                y.nodes[at] = world.meet(&ray, &y.wavelengths)?;
                let ends = at + 1 == s && s < count;
                if !ends {
                    ray = self.scattered(x, y, at, End::Eye, numbers)?;
                }
            }
            if s == count {
                let (point, distance) = world.eye.meet(&ray)?;
                if world.scene.geometry.intersect(&ray).is_some_and(|hit| hit.t <= distance) {
                    return None;
                }
                y.nodes[last] = Node::eye(point, true);
            }
        }
        if s == 0 || s == count {
            return Some(());
        }
        let [a, b] = [&y.nodes[s - 1], &y.nodes[s]];
        (!a.is_mirror() && !b.is_mirror() && world.sees(a, b)).then_some(())
    }

    fn step_from_eye(&self, x: &Path, y: &mut Path, index: usize, numbers: &mut Numbers) -> Option<()> {
        y.nodes[index] = self.step_from_eye_to(x, y, index, numbers)?;
        Some(())
    }

    /// The vertex that the one after it, seen from the light, is left for.
    fn step_from_eye_to(&self, x: &Path, y: &mut Path, index: usize, numbers: &mut Numbers) -> Option<Node> {
        let world = self.world;
        let from = index + 1;
        let ray = if from == x.count() - 1 {
            let sides = world.resolution.map(f64::from);
            let u = [0, 1].map(|i| (x.position[i] / sides[i]) as f32);
            let u = moved(u, numbers);
            world.eye_ray(&y.nodes[from], [0, 1].map(|i| f64::from(u[i]) * sides[i]))?
        } else {
            self.scattered(x, y, from, End::Light, numbers)?
        };
        world.meet(&ray, &y.wavelengths)
    }

    /// A ray from a vertex of `y` by numbers near those by which `x` went on there.
    fn scattered(
        &self,
        x: &Path,
        y: &mut Path,
        index: usize,
        towards: End,
        numbers: &mut Numbers,
    ) -> Option<crate::geometry::Ray> {
        let (back, quantity) = match towards {
            End::Light => (End::Eye, Quantity::Radiance),
            End::Eye => (End::Light, Quantity::Importance),
        };
        let surface = x.nodes[index].surface()?;
        let wo = surface.shading.to_local(x.direction(index, back));
        let wi = surface.shading.to_local(x.direction(index, towards));
        let u = if x.is_delta(index) {
            numbers.pair()
        } else {
            moved(surface.bsdf.invert(wo, wi, quantity)?, numbers)
        };
        let crosses = wo.z * wi.z < 0.0;
        let from = y.nodes[if towards == End::Light { index + 1 } else { index - 1 }];
        let node = &mut y.nodes[index];
        let ray = self.world.scattered_ray(node, &from, (lobe_number(crosses), u), quantity)?;
        let normal = node.surface()?.shading.normal;
        let crossed = normal.dot(from.point.position - node.point.position) * normal.dot(ray.direction) < 0.0;
        (crossed == crosses).then_some(ray)
    }

    /// Logarithm of the probability of the choices among few things that a strategy makes.
    fn ln_choices(&self, path: &Path, s: usize) -> f64 {
        let count = path.count();
        let lobe = |index: usize, towards: End, quantity: Quantity| {
            let Some(surface) = path.nodes[index].surface() else { return 0.0 };
            let back = if towards == End::Light { End::Eye } else { End::Light };
            let wo = surface.shading.to_local(path.direction(index, back));
            let wi = surface.shading.to_local(path.direction(index, towards));
            surface.bsdf.lobe_probability(wo, wi, quantity).ln()
        };
        // Vertices that a walk goes on from: up to the one before its last.
        let by_eye: f64 = (s + 1..count - 1).map(|index| lobe(index, End::Light, Quantity::Radiance)).sum();
        let by_light: f64 =
            (1..s.saturating_sub(1)).map(|index| lobe(index, End::Eye, Quantity::Importance)).sum();
        let lit = match (s, path.nodes[0].kind) {
            (1, Kind::Light { light, .. }) => {
                self.world.scene.lights.probability_towards(path.nodes[1].point.position, light).ln()
            }
            _ => 0.0,
        };
        // Another number of mirrors is another strategy among fresh paths.
        let (all, from_light) = path.counted(s);
        by_eye + by_light + lit + self.world.lengths.probability(all, from_light).ln()
    }
}

/// Two numbers, each moved a little.
fn moved(u: [f32; 2], numbers: &mut Numbers) -> [f32; 2] {
    u.map(|u| PRIMARY_STEPS.along_unit(u, numbers))
}
