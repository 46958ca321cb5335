//! The mean of independent batches, and the interval that holds the truth 95 times of 100.

/// Independent batches that a measurement is split into, whatever its size.
pub const BATCHES: usize = 32;

/// 97.5 % quantile of Student's t with 31 degrees of freedom.
const T_975_OF_31: f64 = 2.039_513_446_396_408;

/// A mean over [`BATCHES`] independent batches of equal size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BatchMean {
    /// The mean.
    pub mean: f64,
    /// Standard error of the mean.
    pub standard_error: f64,
}

impl BatchMean {
    /// From the mean of each batch.
    pub fn of(means: &[f64; BATCHES]) -> Self {
        let count = BATCHES as f64;
        let mean = means.iter().sum::<f64>() / count;
        let scatter: f64 = means.iter().map(|m| (m - mean).powi(2)).sum();
        Self { mean, standard_error: (scatter / (count - 1.0) / count).sqrt() }
    }

    /// Half width of the 95 % confidence interval.
    pub fn half_width_95(&self) -> f64 {
        T_975_OF_31 * self.standard_error
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::mix;

    /// Coverage of the interval over 4000 sets of batches of uniform numbers: the count of
    /// misses is binomial with p = 0.05; five sigma is 1.7 %.
    #[test]
    fn the_interval_covers_the_truth_95_times_of_100() {
        const SETS: u64 = 4000;
        let uniform = |i: u64| (mix(i) >> 11) as f64 / (1_u64 << 53) as f64;
        let misses = (0..SETS)
            .filter(|set| {
                let means = std::array::from_fn(|b| uniform(set * BATCHES as u64 + b as u64));
                let batch = BatchMean::of(&means);
                (batch.mean - 0.5).abs() > batch.half_width_95()
            })
            .count();
        let share = misses as f64 / SETS as f64;
        assert!((share - 0.05).abs() < 0.0173, "{share}");
    }
}
