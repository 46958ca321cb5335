//! The one place where weights are computed.
//!
//! Vertices of a complete path are numbered from the light. With the density of each vertex
//! from either end, neighbouring strategies differ by one vertex,
//! p(s+1) / p(s) = light\[s\] / eye\[s\] (Veach 1997, equation 10.9), and everything is a product
//! of such ratios. Densities differ between the lanes; a strategy's density is the mean over
//! them, which is what the balance heuristic over the hero makes of it (Wilkie et al. 2014),
//! and between strategies the power heuristic decides (Veach 1997, equation 9.13).

use super::groups::Shares;
use super::strategies::Strategies;
use super::vertex::Vertex;
use crate::material::Quantity;
use crate::measure::AreaPdf;
use crate::spectrum::{LANES, Spectrum};

/// A vertex of a complete path as far as weights depend on it.
#[derive(Clone, Copy, Debug)]
pub struct Known {
    /// Density of the vertex for a subpath from the light.
    pub light: AreaPdf,
    /// Density of the vertex for a subpath from the eye.
    pub eye: AreaPdf,
    /// Density of the vertex's own subpath up to it under each lane, relative to the hero's.
    pub lanes: Spectrum,
    /// Whether the path passes through a Dirac delta here, so that no strategy joins here.
    pub is_delta: bool,
}

/// What becomes of a contribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// Share of the strategy among all that find the path: 0 to 1.
    pub weight: f64,
    /// Density of the path under the strategy, mean over the lanes, relative to the hero's.
    pub lane_mean: f64,
}

/// A path, and the strategy that made it.
#[derive(Clone, Copy, Debug)]
pub struct Made<'p> {
    /// The vertices, numbered from the light; those that no listed strategy differs by may be
    /// missing at the end.
    pub vertices: &'p [Known],
    /// Number of all vertices.
    pub count: usize,
    /// How many of them came from the light.
    pub from_light: usize,
    /// Density of the light's vertex when it is asked for by its neighbour (s = 1).
    pub asked: f64,
}

/// Density as far as weights go: one number where all lanes agree, one per lane elsewhere.
pub trait Density: Copy {
    /// Whether all lanes agree.
    const SCALAR: bool;
    /// One.
    const ONE: Self;
    /// Of a vertex.
    fn of(pdf: &AreaPdf) -> Self;
    /// Of a subpath, relative to the hero's.
    fn relative(lanes: &Spectrum) -> Self;
    /// Product.
    fn times(self, other: Self) -> Self;
    /// Scaled.
    fn scaled(self, factor: f64) -> Self;
    /// Mean over the lanes.
    fn mean(self) -> f64;
    /// Largest lane.
    fn largest(self) -> f64;
}

impl Density for f64 {
    const SCALAR: bool = true;
    const ONE: Self = 1.0;
    #[inline]
    fn of(pdf: &AreaPdf) -> Self {
        pdf.hero()
    }
    #[inline]
    fn relative(_: &Spectrum) -> Self {
        1.0
    }
    #[inline]
    fn times(self, other: Self) -> Self {
        self * other
    }
    #[inline]
    fn scaled(self, factor: f64) -> Self {
        self * factor
    }
    #[inline]
    fn mean(self) -> f64 {
        self
    }
    #[inline]
    fn largest(self) -> f64 {
        self
    }
}

/// Densities of all lanes.
#[derive(Clone, Copy, Debug)]
pub struct Lanes([f64; LANES]);

impl Density for Lanes {
    const SCALAR: bool = false;
    const ONE: Self = Self([1.0; LANES]);
    #[inline]
    fn of(pdf: &AreaPdf) -> Self {
        Self(std::array::from_fn(|lane| pdf.lane(lane)))
    }
    #[inline]
    fn relative(lanes: &Spectrum) -> Self {
        Self(lanes.0.map(f64::from))
    }
    #[inline]
    fn times(self, other: Self) -> Self {
        Self(std::array::from_fn(|lane| self.0[lane] * other.0[lane]))
    }
    #[inline]
    fn scaled(self, factor: f64) -> Self {
        Self(self.0.map(|density| density * factor))
    }
    #[inline]
    fn mean(self) -> f64 {
        self.0.iter().sum::<f64>() / LANES as f64
    }
    #[inline]
    fn largest(self) -> f64 {
        self.0.iter().copied().fold(0.0, f64::max)
    }
}

/// A product of ratios that may leave the range of f64 and come back.
#[derive(Clone, Copy)]
struct Ratio<D> {
    /// Its largest lane is 1 to 2, or zero.
    value: D,
    /// Power of two that the value is to be multiplied by.
    exponent: i64,
}

impl<D: Density> Ratio<D> {
    fn new(value: D) -> Self {
        let mut ratio = Self { value: D::ONE, exponent: 0 };
        ratio.multiply(value);
        ratio
    }

    fn multiply(&mut self, factor: D) {
        self.value = self.value.times(factor);
        let largest = self.value.largest();
        if largest > 0.0 && largest.is_finite() {
            let exponent = largest.log2().floor();
            self.value = self.value.scaled(0.5 * (-exponent + 1.0).exp2());
            self.exponent += exponent as i64;
        }
    }

    /// Squared mean over the lanes with what the rest of the path contributes; `None` where it
    /// leaves nothing for others.
    fn squared(&self, rest: D) -> Option<f64> {
        /// A ratio whose square is far beyond the precision of f64, yet within its range.
        const BEYOND: i64 = 400;
        let exponent = self.exponent.clamp(-2 * BEYOND, 2 * BEYOND);
        let mean = self.value.times(rest).mean() * (exponent as f64).exp2();
        (mean < (BEYOND as f64).exp2()).then_some(mean * mean)
    }
}

/// Completes the sum of the last but one vertex of a walk, whose `reverse` has become known.
///
/// The sums follow from one another as those of Georgiev 2012, "Implementing Vertex Connection
/// and Merging", with squares for the power heuristic.
pub fn note_given_away(walk: &mut [Vertex], quantity: Quantity, asked: f64, strategies: &Strategies) {
    let Some((last, before)) = walk.split_last_mut() else { return };
    let ratio = last.reverse.hero() / last.forward.hero();
    let joins = before.last().is_some_and(|previous| !previous.is_delta && !last.is_delta);
    let share = match (before.len(), quantity) {
        _ if strategies.only.is_some() => 0.0,
        (0, Quantity::Importance) => f64::from(u8::from(strategies.meets_lights)),
        (0, Quantity::Radiance) => f64::from(u8::from(strategies.meets_eye)),
        (1, Quantity::Importance) if joins && strategies.asks_lights => {
            (asked / before[0].forward.hero()).powi(2)
        }
        (1, Quantity::Radiance) => f64::from(u8::from(joins && strategies.asks_eye)),
        _ => f64::from(u8::from(joins && strategies.joins && before.len() > 1)),
    };
    let further = before.last().map_or(0.0, |previous| previous.given_away);
    last.given_away = in_range(ratio * ratio * (share + further));
}

/// The last two vertices of one side of a joint, as far as the other side's strategies go.
#[derive(Clone, Copy, Debug, Default)]
pub struct Side {
    /// Density of the last vertex from the other end over that from its own.
    pub last: f64,
    /// Share of the strategy that gives the last vertex away: 0 or 1, or the square of what it
    /// is drawn with otherwise.
    pub last_share: f64,
    /// The same of the vertex before it.
    pub before: f64,
    /// The same of the vertex before it.
    pub before_share: f64,
    /// What is known of the vertices before those.
    pub given_away: f64,
}

impl Side {
    /// Sum of the squared densities of the other side's strategies; not a number where it is
    /// out of range.
    #[inline]
    pub fn sum(&self) -> f64 {
        let before = self.before * self.before * (self.before_share + self.given_away);
        in_range(self.last * self.last * (self.last_share + in_range(before)))
    }
}

/// Sums beyond this range are left to the slow way, which does not lose them.
#[inline]
fn in_range(sum: f64) -> f64 {
    const LARGEST: f64 = 1e100;
    if sum == 0.0 || (1.0 / LARGEST..LARGEST).contains(&sum) { sum } else { f64::NAN }
}

impl Made<'_> {
    /// The weight of the strategy that made the path among those of a list.
    #[inline]
    pub fn judge<D: Density>(&self, strategies: &Strategies) -> Judged {
        let (light_side, eye_side) = (self.lanes_before(self.from_light), self.lanes_from(self.from_light));
        let lane_mean = D::relative(&light_side).times(D::relative(&eye_side)).mean();
        let own = lane_mean * lane_mean;
        let (mut fewer, mut more) = (0.0, 0.0);
        let others = self
            .fewer_from_light::<D>(strategies, &eye_side, |_, squared| fewer += squared)
            .and_then(|()| self.more_from_light::<D>(strategies, &light_side, |_, squared| more += squared))
            .map(|()| fewer + more);
        // An unlisted sum is beyond any number.
        let weight = others.map_or(0.0, |others| own / (own + others));
        Judged { weight, lane_mean }
    }

    /// The densities of every strategy there is, relative to that of the one which made the path;
    /// `survival` is the probability with which roulette has let it live.
    pub fn shares<D: Density>(&self, survival: f64) -> Shares {
        let (light_side, eye_side) = (self.lanes_before(self.from_light), self.lanes_from(self.from_light));
        let own = D::relative(&light_side).times(D::relative(&eye_side)).mean().powi(2);
        let mut shares = Shares::new(self.from_light, self.count - self.from_light, survival);
        let mut note = |s: usize, squared: f64| shares.add(s, self.count - s, squared / own);
        let within = self
            .fewer_from_light::<D>(&Strategies::ALL, &eye_side, &mut note)
            .and_then(|()| self.more_from_light::<D>(&Strategies::ALL, &light_side, &mut note));
        if let Err(s) = within {
            shares.set_beyond(s, self.count - s);
        }
        shares
    }

    /// Hands on the squared densities of strategies with fewer vertices from the light, relative
    /// to this one's hero; an error, with its vertices from the light, is the first beyond the range.
    #[inline]
    fn fewer_from_light<D: Density>(
        &self,
        strategies: &Strategies,
        eye_side: &Spectrum,
        mut put: impl FnMut(usize, f64),
    ) -> Result<(), usize> {
        let (fewest, _) = strategies.span(self.count);
        let mut ratio = Ratio::new(D::relative(eye_side));
        for s in (fewest..self.from_light).rev() {
            let vertex = &self.vertices[s];
            let drawn = if s == 0 { self.first_drawn() } else { vertex.light.hero() };
            ratio.multiply(D::of(&vertex.eye).scaled(1.0 / drawn));
            if self.is_open(strategies, s) {
                let rest = D::relative(&self.lanes_before(s)).scaled(self.asked_instead(s));
                put(s, ratio.squared(rest).ok_or(s)?);
            }
        }
        Ok(())
    }

    /// The same for strategies with more vertices from the light.
    #[inline]
    fn more_from_light<D: Density>(
        &self,
        strategies: &Strategies,
        light_side: &Spectrum,
        mut put: impl FnMut(usize, f64),
    ) -> Result<(), usize> {
        let (_, most) = strategies.span(self.count);
        let mut ratio = Ratio::new(D::relative(light_side));
        if self.from_light == 1 {
            ratio.multiply(D::ONE.scaled(self.vertices[0].light.hero() / self.asked));
        }
        for s in self.from_light + 1..=most {
            let vertex = &self.vertices[s - 1];
            ratio.multiply(D::of(&vertex.light).scaled(1.0 / vertex.eye.hero()));
            if self.is_open(strategies, s) {
                let rest = D::relative(&self.lanes_from(s)).scaled(self.asked_instead(s));
                put(s, ratio.squared(rest).ok_or(s)?);
            }
        }
        Ok(())
    }

    /// What a strategy draws the light's own vertex with, over the density of a subpath from
    /// the light.
    fn asked_instead(&self, s: usize) -> f64 {
        let started = self.vertices[0].light.hero();
        if s != 1 {
            1.0
        } else if started > 0.0 {
            self.asked / started
        } else {
            0.0
        }
    }

    /// Density with which this strategy drew the light's vertex, as vertex of a subpath from
    /// the light.
    fn first_drawn(&self) -> f64 {
        if self.from_light == 1 { self.asked } else { self.vertices[0].light.hero() }
    }

    /// Whether a strategy is listed and joins no delta.
    fn is_open(&self, strategies: &Strategies, s: usize) -> bool {
        let joins = |vertex: usize| self.vertices.get(vertex).is_none_or(|known| !known.is_delta);
        let open = s == 0 || s == self.count || joins(s - 1) && joins(s);
        open && strategies.plans(s, self.count - s)
    }

    /// Lanes of the subpath of the first `s` vertices, as a subpath from the light.
    fn lanes_before(&self, s: usize) -> Spectrum {
        if s < 2 { Spectrum::ONE } else { self.vertices[s - 1].lanes }
    }

    /// Lanes of the subpath of the vertices from `s` on, as a subpath from the eye.
    fn lanes_from(&self, s: usize) -> Spectrum {
        self.vertices.get(s).map_or(Spectrum::ONE, |vertex| vertex.lanes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::mix;

    /// A number in [0, 1).
    fn uniform(state: &mut u64) -> f64 {
        *state = mix(*state);
        (*state >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Densities that differ by many orders of magnitude, between vertices and between lanes.
    fn densities(count: usize, orders: f64, state: &mut u64) -> Vec<(AreaPdf, AreaPdf)> {
        let mut draw = || {
            let lanes = Spectrum::from_fn(|_| (4.0 * uniform(state) - 2.0).exp() as f32);
            AreaPdf::of_direction(lanes, 10_f64.powf(orders * (2.0 * uniform(state) - 1.0)))
        };
        (0..count).map(|_| (draw(), draw())).collect()
    }

    /// The path as the strategy `s` would keep it.
    fn known(densities: &[(AreaPdf, AreaPdf)], s: usize) -> Vec<Known> {
        let relative = |pdf: &AreaPdf| Spectrum::from_fn(|lane| (pdf.lane(lane) / pdf.hero()) as f32);
        let mut all: Vec<Known> = densities
            .iter()
            .map(|(light, eye)| Known { light: *light, eye: *eye, lanes: Spectrum::ONE, is_delta: false })
            .collect();
        let mut lanes = Spectrum::ONE;
        for vertex in &mut all[..s] {
            lanes *= relative(&vertex.light);
            vertex.lanes = lanes;
        }
        lanes = Spectrum::ONE;
        for vertex in all[s..].iter_mut().rev() {
            lanes *= relative(&vertex.eye);
            vertex.lanes = lanes;
        }
        all
    }

    fn sum_of_weights<D: Density>(densities: &[(AreaPdf, AreaPdf)], asked: f64) -> f64 {
        let count = densities.len();
        let strategies = Strategies::ALL;
        (0..=count)
            .map(|from_light| {
                let vertices = known(densities, from_light);
                Made { vertices: &vertices, count, from_light, asked }.judge::<D>(&strategies).weight
            })
            .sum()
    }

    /// Whatever the densities, the weights of all strategies share the path among them.
    #[test]
    fn weights_sum_to_one_at_any_density() {
        let mut state = 1;
        for (count, orders) in [(2, 3.0), (3, 30.0), (5, 8.0), (9, 100.0), (300, 3.0), (300, 120.0)] {
            for _ in 0..50 {
                let densities = densities(count, orders, &mut state);
                let asked = 10_f64.powf(6.0 * uniform(&mut state) - 3.0) * densities[0].0.hero();
                let sum = sum_of_weights::<f64>(&densities, asked);
                assert!((sum - 1.0).abs() < 1e-9, "{count} vertices over 1e{orders}: {sum}");
            }
        }
    }

    /// The same where every lane has its own densities: lanes are kept in 32 bits, so short
    /// paths and their rounding.
    #[test]
    fn weights_of_lanes_sum_to_one() {
        let mut state = 2;
        for (count, orders) in [(2, 3.0), (3, 30.0), (5, 8.0), (9, 100.0)] {
            for _ in 0..50 {
                let mut densities = densities(count, orders, &mut state);
                // The light's own vertex is drawn alike by all lanes.
                densities[0].0 = AreaPdf::of_all_lanes(densities[0].0.hero());
                let asked = 10_f64.powf(6.0 * uniform(&mut state) - 3.0) * densities[0].0.hero();
                let sum = sum_of_weights::<Lanes>(&densities, asked);
                assert!((sum - 1.0).abs() < 1e-5, "{count} vertices over 1e{orders}: {sum}");
            }
        }
    }
}
