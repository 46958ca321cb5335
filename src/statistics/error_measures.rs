//! How far a picture is from a reference.

/// The usual `floor_share` of [`relative_mse`].
pub const FLOOR_SHARE: f64 = 0.01;

/// Share of the pixels, those with the largest terms, that the trimmed mean leaves out.
const TRIMMED_SHARE: f64 = 0.001;

/// Mean relative squared error; the two differ where a few pixels make up the error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativeMse {
    /// Mean over all pixels.
    pub plain: f64,
    /// Mean without the largest 0.1 % of the terms, at least one.
    pub trimmed: f64,
}

/// Mean of (I - R)^2 / (R^2 + e), e = (`floor_share` times the mean of R)^2.
///
/// Noise of the reference adds its own variance. NaN where the pictures are empty, or where
/// the reference and its mean are zero and nothing differs.
pub fn relative_mse(image: &[f64], reference: &[f64], floor_share: f64) -> RelativeMse {
    assert_eq!(image.len(), reference.len(), "pictures of one size");
    let floor = (floor_share * mean(reference)).powi(2);
    let term = |(i, r): (&f64, &f64)| (i - r).powi(2) / (r * r + floor);
    let mut terms: Vec<f64> = image.iter().zip(reference).map(term).collect();
    terms.sort_by(f64::total_cmp);
    let left_out = (TRIMMED_SHARE * terms.len() as f64).ceil() as usize;
    RelativeMse { plain: mean(&terms), trimmed: mean(&terms[..terms.len() - left_out]) }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: R = 1, 3, mean 2, e = (0.5 * 2)^2 = 1; terms (0.1)^2 / 2 and (0.2)^2 / 10.
    #[test]
    fn the_floor_is_a_share_of_the_mean() {
        let error = relative_mse(&[1.1, 3.2], &[1.0, 3.0], 0.5);
        assert!((error.plain - 0.0045).abs() < 1e-12, "{error:?}");
        assert!((error.trimmed - 0.004).abs() < 1e-12, "{error:?}");
    }

    /// Two of 2000 pixels are 0.1 %: spikes there are trimmed away, a third one is not.
    #[test]
    fn spikes_in_a_thousandth_of_the_pixels_are_trimmed() {
        let reference = vec![1.0; 2000];
        let spiked = |count: usize| {
            let mut image = vec![1.1; 2000];
            image[..count].fill(101.0);
            relative_mse(&image, &reference, FLOOR_SHARE)
        };
        let common = 0.01 / 1.0001;
        assert!((spiked(0).plain - common).abs() < 1e-12);
        assert!((spiked(2).trimmed - common).abs() < 1e-12);
        assert!(spiked(2).plain > 9.0 && spiked(3).trimmed > 4.0);
    }

    #[test]
    fn brightness_does_not_change_the_error() {
        let (image, reference) = ([0.9, 2.2, 0.1], [1.0, 2.0, 0.0]);
        let scaled = |v: [f64; 3]| v.map(|x| 1e-6 * x);
        let (plain, dim) = (
            relative_mse(&image, &reference, FLOOR_SHARE),
            relative_mse(&scaled(image), &scaled(reference), FLOOR_SHARE),
        );
        assert!((plain.plain / dim.plain - 1.0).abs() < 1e-9);
    }
}
