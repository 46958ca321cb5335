//! A matrix from sensitivities alone: the one that shows 24 known surfaces best.
//!
//! What ISO 17321-1 does with a photographed chart is done with its measured reflectances: least
//! squares over the patches of the ColorChecker under the light that is white. A sensor whose
//! sensitivities are mixtures of the observer's is matched exactly; any other is off by what it
//! cannot tell apart.

use super::develop::{D65_WHITE, Matrix, MatrixTarget};
use super::record::Responses;
use crate::error::{Error, Result};
use crate::spectrum::LampSpectrum;
use crate::spectrum::colour::adapt;
use crate::spectrum::library::{self, Purpose};
use glam::{DMat3, DVec3};

impl Responses {
    /// The matrix from white-balanced channels to X, Y, Z under D65, for a sensor of three
    /// channels; the white itself is matched exactly.
    pub fn fitted_matrix(&self, light: &LampSpectrum) -> Result<Matrix> {
        if self.channels.len() != 3 {
            return Err(Error::new(format!(
                "a matrix is fitted to three channels, and the sensor has {}",
                self.channels.len()
            ))
            .hint("give the matrix itself"));
        }
        let white = self.white(light);
        let xyz_white = light.xyz().map(|c| c / light.xyz()[1]);
        let (mut products, mut squares) = (DMat3::ZERO, DMat3::ZERO);
        for entry in library::entries().filter(|entry| entry.name.starts_with("colorchecker-")) {
            let patch = library::curve(&entry.table(), None, Purpose::Reflectance)?;
            let seen = self.under(light, |nm| patch.at(nm));
            let balanced = DVec3::from_array(std::array::from_fn(|c| seen.channels[c] / white.channels[c]));
            let truth = DVec3::from_array(adapt(seen.xyz, xyz_white, D65_WHITE));
            products += outer(truth, balanced);
            squares += outer(balanced, balanced);
        }
        let fit = products * squares.inverse();
        if !fit.is_finite() {
            return Err(Error::new("the sensor's channels do not tell colours apart")
                .hint("check that no two of its sensitivities are alike"));
        }
        let shown = fit * DVec3::ONE;
        let row = |i: usize| fit.row(i).to_array().map(|m| m * D65_WHITE[i] / shown[i]).to_vec();
        Ok(Matrix { to: MatrixTarget::Xyz, rows: (0..3).map(row).collect() })
    }
}

/// The matrix a b^T.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Sensor;
    use crate::spectrum::colour::xyz_to_linear_srgb;

    fn light(name: &str) -> LampSpectrum {
        library::light(&library::table(name).expect("built in"), None, Purpose::Emission).expect("a light")
    }

    /// The observer's own channels need no compromise: every surface is shown as adaptation of
    /// its tristimulus values shows it, one that is not in the fit among them.
    #[test]
    fn an_observer_is_matched_exactly() {
        let responses = Responses::of(&Sensor::cie());
        let tungsten = light("cie-a");
        let matrix = responses.fitted_matrix(&tungsten).expect("three channels");
        let white = responses.white(&tungsten);
        let xyz_white = tungsten.xyz().map(|c| c / tungsten.xyz()[1]);
        let green =
            library::curve(&library::table("cornell-green").expect("built in"), None, Purpose::Reflectance)
                .expect("a curve");
        let seen = responses.under(&tungsten, |nm| green.at(nm));
        let balanced: Vec<f64> = seen.channels.iter().zip(&white.channels).map(|(c, w)| c / w).collect();
        let truth = xyz_to_linear_srgb(adapt(seen.xyz, xyz_white, D65_WHITE));
        for (shown, truth) in matrix.apply(&balanced).into_iter().zip(truth) {
            assert!((shown - truth).abs() < 1e-5, "{shown} against {truth}");
        }
    }

    /// A real camera is off, and not by much: no patch by a tenth of white in any of R, G, B,
    /// and less than half of what it is off without a matrix.
    #[test]
    fn a_camera_is_matched_nearly() {
        let responses = Responses::of(&Sensor::named("nikon-5100").expect("built in"));
        let day = light("d65");
        let fitted = responses.fitted_matrix(&day).expect("three channels");
        let none = Matrix {
            to: MatrixTarget::Srgb,
            rows: vec![vec![1.0, 0.0, 0.0], vec![0.0, 1.0, 0.0], vec![0.0, 0.0, 1.0]],
        };
        let white = responses.white(&day);
        let worst = |matrix: &Matrix| {
            let patches = library::entries().filter(|entry| entry.name.starts_with("colorchecker-"));
            let errors = patches.flat_map(|entry| {
                let patch = library::curve(&entry.table(), None, Purpose::Reflectance).expect("a curve");
                let seen = responses.under(&day, |nm| patch.at(nm));
                let balanced: Vec<f64> =
                    seen.channels.iter().zip(&white.channels).map(|(c, w)| c / w).collect();
                let truth = xyz_to_linear_srgb(seen.xyz);
                let shown = matrix.apply(&balanced);
                [0, 1, 2].map(|i| (shown[i] - truth[i]).abs())
            });
            errors.fold(0.0, f64::max)
        };
        assert!(
            worst(&fitted) < 0.1 && worst(&none) > 2.0 * worst(&fitted),
            "{} {}",
            worst(&fitted),
            worst(&none)
        );
        for shown in fitted.apply(&[1.0; 3]) {
            assert!((shown - 1.0).abs() < 1e-5, "{shown}");
        }
    }
}
