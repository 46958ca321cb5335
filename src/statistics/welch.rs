//! Whether two means differ when both scatter, each in its own way.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Differences below this share of the values do not count: paths carry single precision.
pub const ROUNDING: f64 = 2e-5;

/// Independent values of one quantity in moments.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moments {
    /// Mean.
    pub mean: f64,
    /// Variance of the mean.
    pub variance: f64,
    /// Third cumulant of the mean.
    pub third: f64,
    /// Number of values.
    pub count: f64,
    /// How many of them are zero.
    pub zeros: usize,
}

impl Moments {
    /// From at least three values.
    pub fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let count = values.clone().count() as f64;
        let mean = values.clone().sum::<f64>() / count;
        let power = |n: i32| values.clone().map(|v| (v - mean).powi(n)).sum::<f64>();
        let variance = power(2) / (count - 1.0) / count;
        let third = power(3) / ((count - 1.0) * (count - 2.0)) / count;
        let zeros = values.filter(|v| *v == 0.0).count();
        Self { mean, variance, third, count, zeros }
    }

    /// Variance of a single value over the squared mean; infinite where the mean is zero.
    pub fn relative_variance(&self) -> f64 {
        if self.mean == 0.0 { f64::INFINITY } else { self.variance * self.count / (self.mean * self.mean) }
    }

    /// Whether any value is not zero.
    pub fn is_lit(&self) -> bool {
        (self.zeros as f64) < self.count
    }
}

/// Welch's comparison of two means.
#[derive(Clone, Copy, Debug)]
pub struct Welch {
    /// Difference of the means over its standard error.
    pub t: f64,
    /// Degrees of freedom after Welch and Satterthwaite.
    pub freedom: f64,
}

impl Welch {
    /// Compares two means, with the third cumulant of their difference over its variance to
    /// the power of 3/2 to correct for: see [`unskewed`].
    ///
    /// Welch 1947, "The generalization of Student's problem".
    pub fn of(a: &Moments, b: &Moments, skewness: f64) -> Self {
        let variance = a.variance + b.variance;
        let difference = a.mean - b.mean;
        let counted = (difference.abs() - ROUNDING * a.mean.abs().max(b.mean.abs())).max(0.0);
        if variance == 0.0 {
            let t = if counted > 0.0 { f64::INFINITY.copysign(difference) } else { 0.0 };
            return Self { t, freedom: a.count + b.count - 2.0 };
        }
        let share = |m: &Moments| (m.variance / variance).powi(2) / (m.count - 1.0);
        let t = counted.copysign(difference) / variance.sqrt();
        Self { t: unskewed(t, skewness), freedom: 1.0 / (share(a) + share(b)) }
    }

    /// Probability of a |t| as large where the means are equal.
    pub fn p_value(&self) -> f64 {
        2.0 * student(self.freedom).sf(self.t.abs())
    }
}

/// A t statistic of skewed values, brought back to Student's distribution to first order.
///
/// Values with a long tail upwards often miss it, and then their mean and their scatter are
/// both too small: t is skewed the other way. Hall 1992, "On the removal of skewness by
/// transformation", section 2, with g = gamma / sqrt(n).
pub fn unskewed(t: f64, g: f64) -> f64 {
    t + g * t * t / 3.0 + g * g * t.powi(3) / 27.0 + g / 6.0
}

/// Student's t that is exceeded, up or down, with probability `p`.
pub fn two_sided_quantile(freedom: f64, p: f64) -> f64 {
    student(freedom).inverse_cdf(1.0 - 0.5 * p)
}

/// The standard normal deviate that is exceeded, up or down, with probability `p`.
pub fn deviate(p: f64) -> f64 {
    // Below this a deviate of 37 says all that is to say.
    Normal::standard().inverse_cdf(0.5 * p.max(1e-300)).abs()
}

pub fn student(freedom: f64) -> StudentsT {
    StudentsT::new(0.0, 1.0, freedom).expect("two or more values on either side")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(value: f64, truth: f64) {
        assert!((value / truth - 1.0).abs() < 1e-9, "{value}, truth {truth}");
    }

    /// Against scipy.stats.ttest_ind(..., equal_var=False); the t is smaller by the share of
    /// rounding that does not count.
    #[test]
    fn welch_as_in_scipy() {
        let a = Moments::of([1.0, 2.0, 4.0, 5.0, 3.0].into_iter());
        let b = Moments::of([2.0, 8.0, 5.0, 9.0].into_iter());
        let welch = Welch::of(&a, &b, 0.0);
        close(welch.t, -1.732_050_807_568_877_2 * (1.0 - ROUNDING * 6.0 / 3.0));
        close(welch.freedom, 4.194_174_757_281_553);
        close(Welch { t: 1.732_050_807_568_877_2, ..welch }.p_value(), 0.154_977_263_480_232_6);
    }

    /// Against scipy.stats.t.sf and scipy.stats.t.ppf.
    #[test]
    fn tails_of_student_as_in_scipy() {
        for (t, freedom, p) in [
            (8.0, 12.0, 3.759_898_224_750_258e-6),
            (-12.0, 20.0, 1.359_555_702_588_066e-10),
            (3.0, 3.3, 0.051_074_273_956_642_324),
        ] {
            close(Welch { t, freedom }.p_value(), p);
        }
        close(two_sided_quantile(31.0, 0.05), 2.039_513_446_396_408);
        close(deviate(0.05), 1.959_963_984_540_054_5);
    }

    /// What does not scatter differs by more than rounding, or not at all.
    #[test]
    fn constants_are_compared_up_to_rounding() {
        let constant = |value: f64| Moments::of(std::iter::repeat_n(value, 8));
        assert_eq!(Welch::of(&constant(1.0), &constant(1.000_01), 0.0).p_value(), 1.0);
        assert_eq!(Welch::of(&constant(1.0), &constant(1.000_1), 0.0).p_value(), 0.0);
        assert_eq!(Welch::of(&constant(0.0), &constant(0.0), 0.0).p_value(), 1.0);
    }

    /// The cumulant of a mean of n is that of one value over n^2; 0, 0, 3 has an unbiased
    /// third cumulant of 27 / 3 (k-statistic, n = 3).
    #[test]
    fn third_cumulant_is_unbiased() {
        close(Moments::of([0.0, 0.0, 3.0].into_iter()).third, 9.0 / 9.0);
    }
}
