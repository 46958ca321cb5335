//! Many tests at once: which p-values count, given that some are small by chance.

/// How many of the hypotheses Holm's procedure rejects, so that one or more true ones among
/// them is as likely as `alpha` at most, however the tests depend on one another.
///
/// Holm 1979, "A simple sequentially rejective multiple test procedure".
pub fn holm(p_values: &[f64], alpha: f64) -> usize {
    let mut sorted = p_values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len();
    let passes = |(i, p): &(usize, f64)| *p > alpha / (count - i) as f64;
    sorted.into_iter().enumerate().find(passes).map_or(count, |(i, _)| i)
}

/// The largest p-value that Benjamini and Hochberg's procedure rejects, so that a share `q`
/// of the rejected is wrongly so; `None` where none is rejected.
///
/// Benjamini and Hochberg 1995, "Controlling the false discovery rate".
pub fn benjamini_hochberg(p_values: &[f64], q: f64) -> Option<f64> {
    let mut sorted = p_values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len() as f64;
    (0..sorted.len()).rev().find(|&i| sorted[i] <= q * (i + 1) as f64 / count).map(|i| sorted[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Thresholds 0.0125, 0.0167, 0.025, 0.05: the third fails and stops what follows.
    #[test]
    fn holm_stops_at_the_first_that_passes() {
        assert_eq!(holm(&[0.03, 0.001, 0.04, 0.015], 0.05), 2);
        assert_eq!(holm(&[0.02, 0.02, 0.02, 0.02], 0.05), 0);
        assert_eq!(holm(&[], 0.05), 0);
    }

    /// Thresholds 0.0125, 0.025, 0.0375, 0.05: the third saves the second.
    #[test]
    fn benjamini_hochberg_goes_up_to_the_last_that_fails() {
        assert_eq!(benjamini_hochberg(&[0.03, 0.001, 0.9, 0.028], 0.05), Some(0.03));
        assert_eq!(benjamini_hochberg(&[0.2, 0.4], 0.05), None);
    }
}
