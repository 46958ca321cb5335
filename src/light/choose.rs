//! Which light is asked: mostly in proportion to its power as the sensors see it, a little
//! all alike, since a weak lamp may be the only one that is not hidden.

use super::Light;
use glam::Vec3A;

/// All lights of a scene, and the probability of asking each.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    lights: Vec<Light>,
    /// Share of power up to and including each light.
    upto: Vec<f64>,
}

impl Lights {
    /// Share of the choice that all lights with power have alike.
    const EVEN_SHARE: f64 = 0.05;

    /// Lights with their powers; those without power are never asked.
    pub fn new(lights: Vec<(Light, f64)>) -> Self {
        let total: f64 = lights.iter().map(|(_, power)| power).sum();
        let shining = lights.iter().filter(|(_, power)| *power > 0.0).count() as f64;
        let mut sum = 0.0;
        let mut list = Self::default();
        for (light, power) in lights {
            if power > 0.0 {
                sum += (1.0 - Self::EVEN_SHARE) * power / total + Self::EVEN_SHARE / shining;
            }
            list.lights.push(light);
            list.upto.push(sum);
        }
        list
    }

    /// The light of an index, as objects name theirs.
    #[inline]
    pub fn get(&self, index: u32) -> &Light {
        &self.lights[index as usize]
    }

    /// Number of lights.
    pub fn len(&self) -> usize {
        self.lights.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// Picks a light by power with a number in [0, 1): its index and the probability of that
    /// choice. `None` where nothing shines.
    #[inline]
    pub fn choose_emitting(&self, u: f64) -> Option<(u32, f64)> {
        let index = self.upto.partition_point(|upto| *upto <= u);
        let index = index.min(self.lights.len().checked_sub(1)?) as u32;
        let probability = self.probability_emitting(index);
        (probability > 0.0).then_some((index, probability))
    }

    /// Probability that `choose_emitting` picks the light of an index.
    #[inline]
    pub fn probability_emitting(&self, index: u32) -> f64 {
        let index = index as usize;
        let before = if index == 0 { 0.0 } else { self.upto[index - 1] };
        self.upto[index] - before
    }

    /// Picks a light for a position that it may light.
    #[inline]
    pub fn choose_towards(&self, _from: Vec3A, u: f64) -> Option<(u32, f64)> {
        self.choose_emitting(u)
    }

    /// Probability that `choose_towards` picks the light of an index.
    #[inline]
    pub fn probability_towards(&self, _from: Vec3A, index: u32) -> f64 {
        self.probability_emitting(index)
    }
}
