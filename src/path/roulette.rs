//! With which probability a walk goes on: any leaves the mean as it is, and the variance depends on
//! it.

/// How roulette is played.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Roulette {
    /// In proportion to what the walk still carries: all that go on carry the same.
    #[default]
    Carried,
    /// With the same probability at every bounce, however much the walk carries: to compare
    /// with. The probability is never below a hundredth of what is carried, so that weights stay
    /// below a hundred times what is usual and the variance is finite.
    Constant(f32),
}

/// Largest weight of a walk that a constant probability has let live.
const LARGEST_WEIGHT: f32 = 100.0;

impl Roulette {
    /// Probability, from 0 to 1, with which a walk goes on that carries a share of what it set
    /// out with, roulette so far included.
    pub fn survival(self, carried: f32) -> f32 {
        match self {
            Self::Carried => carried.min(1.0),
            Self::Constant(probability) => probability.max(carried / LARGEST_WEIGHT).min(1.0),
        }
    }
}
