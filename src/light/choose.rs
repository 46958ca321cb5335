//! Which light is asked: by power alone where light sets out, and by what it may give to a
//! point where that point asks.

use super::Light;
use super::hierarchy::Hierarchy;
use super::split::Member;
use crate::geometry::Geometry;
use glam::Vec3A;

/// All lights of a scene, and the probability of asking each.
///
/// A light is named by its index, as objects name theirs. Those without power are never
/// chosen; every other has a probability above zero everywhere.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    lights: Vec<Light>,
    /// Probability of choosing by power any light up to and including each.
    upto: Vec<f64>,
    /// Absent where there is no choice.
    hierarchy: Option<Hierarchy>,
}

impl Lights {
    /// Share of the choice by power that all lights with power have alike: a weak lamp may be
    /// the only one that is not hidden.
    const EVEN_SHARE: f64 = 0.05;
    /// Share of the choice towards a point that is by power. The hierarchy does not see
    /// obstacles, and its bounds are loose; with this share no light weighs more than twenty
    /// times what it would by power alone.
    const POWER_SHARE: f64 = 0.05;

    /// Lights with their powers.
    pub fn new(geometry: &Geometry, lights: Vec<(Light, f64)>) -> Self {
        let powers: Vec<f64> = lights.iter().map(|(_, power)| *power).collect();
        let lights: Vec<Light> = lights.into_iter().map(|(light, _)| light).collect();
        let members: Vec<_> = (0..)
            .zip(lights.iter().zip(&powers))
            .filter(|(_, (_, power))| **power > 0.0)
            .map(|(index, (light, power))| Member::new(index, light.cluster(geometry, *power)))
            .collect();
        // From two lights on it pays: tests/many_lights.rs measures what it costs and saves.
        let hierarchy = if members.len() > 1 { Hierarchy::new(members, lights.len()) } else { None };
        Self { lights, upto: shares(&powers), hierarchy }
    }

    /// The light of an index.
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

    /// Picks a light by power, by a number in [0, 1); with it the probability of that choice.
    /// `None` where nothing shines.
    #[inline]
    pub fn choose_emitting(&self, u: f64) -> Option<(u32, f64)> {
        let index = self.upto.partition_point(|upto| *upto <= u);
        (index < self.upto.len()).then(|| (index as u32, self.probability_emitting(index as u32)))
    }

    /// Probability that `choose_emitting` picks the light of an index.
    #[inline]
    pub fn probability_emitting(&self, index: u32) -> f64 {
        let index = index as usize;
        let before = if index == 0 { 0.0 } else { self.upto[index - 1] };
        self.upto[index] - before
    }

    /// Picks a light for a lit position by a number in [0, 1); with it the probability of
    /// that choice. `None` where nothing shines.
    #[inline]
    pub fn choose_towards(&self, from: Vec3A, u: f64) -> Option<(u32, f64)> {
        let Some(hierarchy) = &self.hierarchy else { return self.choose_emitting(u) };
        if u < Self::POWER_SHARE {
            let (index, by_power) = self.choose_emitting(u / Self::POWER_SHARE)?;
            return Some((index, Self::mixed(by_power, hierarchy.probability(from, index))));
        }
        let (index, by_place) = hierarchy.choose(from, (u - Self::POWER_SHARE) / (1.0 - Self::POWER_SHARE));
        Some((index, Self::mixed(self.probability_emitting(index), by_place)))
    }

    /// Probability that `choose_towards` picks the light of an index for a lit position.
    #[inline]
    pub fn probability_towards(&self, from: Vec3A, index: u32) -> f64 {
        let by_power = self.probability_emitting(index);
        match &self.hierarchy {
            Some(hierarchy) if by_power > 0.0 => Self::mixed(by_power, hierarchy.probability(from, index)),
            _ => by_power,
        }
    }

    const fn mixed(by_power: f64, by_place: f64) -> f64 {
        Self::POWER_SHARE * by_power + (1.0 - Self::POWER_SHARE) * by_place
    }
}

/// Probability of choosing by power any light up to and including each.
fn shares(powers: &[f64]) -> Vec<f64> {
    let total: f64 = powers.iter().sum();
    let shining = powers.iter().filter(|power| **power > 0.0).count() as f64;
    let mut sum = 0.0;
    let mut upto: Vec<f64> = powers
        .iter()
        .map(|power| {
            if *power > 0.0 {
                sum += (1.0 - Lights::EVEN_SHARE) * power / total + Lights::EVEN_SHARE / shining;
            }
            sum
        })
        .collect();
    // Rounding leaves the sum beside one; it is one from the last light that shines on.
    let last = upto.partition_point(|upto| *upto < sum);
    if sum > 0.0 {
        upto[last..].fill(1.0);
    }
    upto
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{GeometryBuilder, Shape, Transform};
    use crate::light::{AreaLight, Distribution, PointLight};
    use crate::sampler::mix;
    use crate::spectrum::{Dense, Emission};
    use glam::DVec3;

    fn uniform(state: &mut u64) -> f64 {
        *state += 1;
        (mix(*state) >> 16) as f64 / (1_u64 << 48) as f64
    }

    fn position(state: &mut u64) -> Vec3A {
        Vec3A::from_array([0; 3].map(|_| uniform(state) as f32))
    }

    fn point(position: Vec3A, distribution: Distribution) -> Light {
        Light::Point(PointLight {
            position,
            distribution,
            intensity: Emission::new(Dense::Flat(1.0), vec![]),
        })
    }

    fn among(lights: Vec<(Light, f64)>) -> Lights {
        Lights::new(&GeometryBuilder::new().build().expect("an empty scene"), lights)
    }

    /// Lamps in a unit cube, half of them with an axis, of powers within six decades; every
    /// seventh is dark.
    fn lamps(count: u64) -> Lights {
        let lamp = |index| {
            let mut state = index << 20;
            let axis = (position(&mut state) - 0.5).normalize();
            let distribution =
                if index % 2 == 0 { Distribution::Isotropic } else { Distribution::Cosine(axis) };
            let power = if index % 7 == 3 { 0.0 } else { 10_f64.powf(6.0 * uniform(&mut state) - 3.0) };
            (point(position(&mut state), distribution), power)
        };
        among((0..count).map(lamp).collect())
    }

    fn probabilities(lights: &Lights, from: Vec3A) -> Vec<f64> {
        (0..lights.len() as u32).map(|index| lights.probability_towards(from, index)).collect()
    }

    /// Probabilities are numbers that add up to one, and above zero where there is power.
    fn assert_sound(lights: &Lights, from: Vec3A) {
        let probabilities = probabilities(lights, from);
        let sum: f64 = probabilities.iter().sum();
        assert!((sum - 1.0).abs() < 1e-9, "{from}: sum {sum}");
        for (index, probability) in probabilities.iter().enumerate() {
            let shines = lights.probability_emitting(index as u32) > 0.0;
            assert!(if shines { *probability > 0.0 } else { *probability == 0.0 }, "{index}: {probability}");
        }
    }

    /// Of evenly spaced numbers each light gets as many as its probability says: its numbers
    /// are two stretches, by power and by place, so the count is off by less than two.
    fn assert_choices_are_as_probable_as_they_say(lights: &Lights, from: Vec3A, draws: u32) {
        let mut counts = vec![0_u32; lights.len()];
        for draw in 0..draws {
            let u = (f64::from(draw) + 0.5) / f64::from(draws);
            let (index, probability) = lights.choose_towards(from, u).expect("something shines");
            assert_eq!(probability, lights.probability_towards(from, index));
            counts[index as usize] += 1;
        }
        for (index, (count, probability)) in counts.iter().zip(probabilities(lights, from)).enumerate() {
            let expected = probability * f64::from(draws);
            assert!((f64::from(*count) - expected).abs() < 2.001, "{index}: {count} against {expected}");
        }
    }

    #[test]
    fn probabilities_add_up_and_choices_follow_them() {
        for count in [1, 2, 3, 5, 33, 1000, 100_000] {
            let lights = lamps(count);
            let Light::Point(first) = lights.get(0) else { unreachable!("all are points") };
            for from in [first.position, Vec3A::new(0.3, 0.6, 0.2), Vec3A::new(-5.0, 40.0, 0.5)] {
                assert_sound(&lights, from);
                assert_choices_are_as_probable_as_they_say(&lights, from, 300_000);
            }
        }
    }

    /// Chi-squared over 60 lights for each of 8 positions, against its 1 - 3e-7 quantile by
    /// Wilson and Hilferty: a false alarm once in 400,000.
    #[test]
    fn random_choices_fit_their_probabilities() {
        const DRAWS: u32 = 100_000;
        let (lights, mut state) = (lamps(70), 1 << 50);
        for _ in 0..8 {
            let from = position(&mut state) * 3.0 - 1.0;
            let mut counts = vec![0.0; lights.len()];
            for _ in 0..DRAWS {
                let (index, _) = lights.choose_towards(from, uniform(&mut state)).expect("something shines");
                counts[index as usize] += 1.0;
            }
            let expected = probabilities(&lights, from).into_iter().map(|p| p * f64::from(DRAWS));
            let terms: Vec<f64> = counts
                .iter()
                .zip(expected)
                .filter(|(_, e)| *e > 0.0)
                .map(|(c, e)| (c - e).powi(2) / e)
                .collect();
            let freedom = (terms.len() - 1) as f64;
            let spread = 2.0 / (9.0 * freedom);
            let quantile = freedom * (1.0 - spread + 5.0 * spread.sqrt()).powi(3);
            let chi_squared: f64 = terms.iter().sum();
            assert!(freedom > 50.0 && chi_squared < quantile, "{from}: {chi_squared} against {quantile}");
        }
    }

    #[test]
    fn degenerate_arrangements_are_sound() {
        let isotropic = |at: [f32; 3]| point(Vec3A::from_array(at), Distribution::Isotropic);
        let one_place = among((0..100).map(|i| (isotropic([0.5; 3]), f64::from(i))).collect());
        let a_row = among((0..100).map(|i| (isotropic([i as f32, 0.0, 0.0]), 1.0)).collect());
        let powers = among((-60..60).map(|i| (isotropic([i as f32; 3]), 10_f64.powi(5 * i))).collect());
        let nearing = among((0..100).map(|i| (isotropic([0.5_f32.powi(i), 0.0, 0.0]), 1.0)).collect());
        let huge = among((0..9).map(|i| (isotropic([1e18 * i as f32, 0.0, 0.0]), 1.0)).collect());
        for lights in [one_place, a_row, powers, nearing, huge] {
            for from in [[0.5; 3], [0.0; 3], [7.0, 0.0, 0.0], [3.3, 0.1, 0.1], [1e18; 3], [1e-30; 3]] {
                assert_sound(&lights, Vec3A::from_array(from));
                assert_choices_are_as_probable_as_they_say(&lights, Vec3A::from_array(from), 1000);
            }
        }
    }

    #[test]
    fn nothing_is_chosen_where_nothing_shines() {
        for lights in [among(vec![]), among(vec![(point(Vec3A::ZERO, Distribution::Isotropic), 0.0)])] {
            for u in [0.0, 0.3, 1.0 - f64::EPSILON / 2.0] {
                assert_eq!(lights.choose_towards(Vec3A::ONE, u), None);
                assert_eq!(lights.choose_emitting(u), None);
            }
        }
    }

    /// The ends of the range of numbers are no special case, nor is what they come to when
    /// they are stretched.
    #[test]
    fn the_first_and_the_last_number_choose_lights_with_power() {
        let (lights, below_one) = (lamps(1000), 1.0 - f64::EPSILON / 2.0);
        for u in [0.0, Lights::POWER_SHARE.next_down(), Lights::POWER_SHARE, below_one] {
            let (_, probability) = lights.choose_towards(Vec3A::splat(0.5), u).expect("something shines");
            assert!(probability > 0.0);
            let (_, probability) = lights.choose_emitting(u).expect("something shines");
            assert!(probability > 0.0);
        }
    }

    /// Eight flat lamps of the same power in a row, the middle ones turned away or two-sided,
    /// and a ball among them.
    #[test]
    fn lamps_that_face_away_are_left_to_the_share_by_power() {
        let mut builder = GeometryBuilder::new();
        for i in 0..8 {
            let center = DVec3::new(f64::from(i), 0.0, 1.0);
            let normal = if (2..6).contains(&i) { DVec3::Z } else { -DVec3::Z };
            let shape = if i == 7 {
                Shape::Sphere { center, radius: 0.1 }
            } else {
                Shape::Disk { center, normal, radius: 0.1 }
            };
            builder.add_object(&shape, &Transform::IDENTITY).expect("a lamp");
        }
        let geometry = builder.build().expect("a row of lamps");
        let lamp = |i: u32| {
            (Light::Area(AreaLight::new(&geometry, i, Emission::new(Dense::Flat(1.0), vec![]), i >= 4)), 1.0)
        };
        let lights = Lights::new(&geometry, (0..8).map(lamp).collect());
        for x in [-1.0, 2.0, 3.5, 6.0] {
            let below = geometry.to_scene(DVec3::new(x, 0.3, 0.0));
            assert_sound(&lights, below);
            for index in 0..8 {
                let probability = lights.probability_towards(below, index);
                let least = Lights::POWER_SHARE * lights.probability_emitting(index);
                assert_eq!(probability <= least, [2, 3].contains(&index), "{index} from {x}: {probability}");
            }
        }
        let under_the_first = geometry.to_scene(DVec3::new(0.0, 0.0, 0.5));
        assert!(lights.probability_towards(under_the_first, 0) > 0.5);
    }
}
