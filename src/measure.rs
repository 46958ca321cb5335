//! Densities that know their measure, and the only conversion between measures.
//!
//! Directions are drawn per solid angle, vertices are compared per area; one becomes the other
//! by |cos| / d^2 at the vertex that is reached (Veach 1997, equation 8.2). A Dirac delta is
//! kept by its coefficient. Coefficients of a scattering delta belong to the measure
//! n^2 |cos| dw, which refraction and reflection conserve: in it the delta is the same one
//! seen from either side, and cancels wherever two densities are compared.

use crate::spectrum::Spectrum;
use glam::Vec3A;

/// Density of a vertex per unit of area, each lane as if it were the hero.
#[derive(Clone, Copy, Debug)]
pub struct AreaPdf {
    lanes: Spectrum,
    factor: f64,
}

impl AreaPdf {
    /// A vertex that is never reached.
    pub const ZERO: Self = Self { lanes: Spectrum::ONE, factor: 0.0 };

    /// The same density for all lanes: per square scene unit, or the probability of a point.
    pub const fn of_all_lanes(density: f64) -> Self {
        Self { lanes: Spectrum::ONE, factor: density }
    }

    /// A density per solid angle, brought to the area of the vertex that the direction
    /// reaches by [`solid_angle_per_area`].
    pub const fn of_direction(pdf_solid_angle: Spectrum, solid_angle_per_area: f64) -> Self {
        Self { lanes: pdf_solid_angle, factor: solid_angle_per_area }
    }

    /// Density at the hero wavelength.
    #[inline]
    pub fn hero(&self) -> f64 {
        f64::from(self.lanes.hero()) * self.factor
    }

    /// Density of one lane.
    #[inline]
    pub fn lane(&self, lane: usize) -> f64 {
        f64::from(self.lanes[lane]) * self.factor
    }
}

/// |cos| / d^2: solid angle at `from` over area at `to`, whose normal is `normal`.
#[inline]
pub fn solid_angle_per_area(from: Vec3A, to: Vec3A, normal: Vec3A) -> f64 {
    let span = to.as_dvec3() - from.as_dvec3();
    let squared = span.length_squared();
    if squared == 0.0 {
        return 0.0;
    }
    span.dot(normal.as_dvec3()).abs() / (squared * squared.sqrt())
}
