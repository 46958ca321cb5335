//! Which wavelengths a path carries, and how they are drawn.
//!
//! All lanes of a path are drawn together: one uniform number, rotated by equal steps, goes
//! through one inverse distribution (hero wavelength sampling: Wilkie et al. 2014), so the
//! lanes are stratified and each has the marginal density of a wavelength drawn alone.

use super::lanes::{LANES, Spectrum};

/// First wavelength that transport considers, nm: where the CIE observer's table begins.
pub const FIRST_NM: f64 = 360.0;
/// Last wavelength that transport considers, nm.
pub const LAST_NM: f64 = 830.0;
/// Points of the 1 nm grid.
pub const GRID_POINTS: usize = 471;

/// The wavelengths of the 1 nm grid.
pub fn grid_nm() -> impl ExactSizeIterator<Item = f64> + Clone {
    (0..GRID_POINTS).map(|i| FIRST_NM + i as f64)
}

/// The wavelengths that one path carries.
#[derive(Clone, Copy, Debug)]
pub struct Wavelengths {
    /// Wavelength of each lane in nm.
    pub nm: Spectrum,
    /// Density with which each lane's wavelength was drawn, per nm.
    pub pdf_per_nm: Spectrum,
    /// Grid cell of each lane: its wavelength lies between this grid point and the next.
    pub(super) cell: [u16; LANES],
    /// Position within the cell, 0 to 1.
    pub(super) fraction: Spectrum,
}

/// A density over wavelength, constant within each cell of the 1 nm grid.
#[derive(Clone, Debug)]
pub struct WavelengthSampler {
    pdf_per_nm: Vec<f64>,
    cumulative: Vec<f64>,
}

impl WavelengthSampler {
    /// Share of the density that is spread evenly over all cells of the support.
    const EVEN_SHARE: f64 = 0.02;

    /// A sampler whose density follows `weight_at_grid_points` (any scale, not negative).
    ///
    /// Wherever the weight is positive at either end of a cell, the density is positive over
    /// the whole cell; `None` if all weights are zero.
    pub fn proportional_to(weight_at_grid_points: &[f64]) -> Option<Self> {
        let cells: Vec<f64> = weight_at_grid_points.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
        let total: f64 = cells.iter().sum();
        if total <= 0.0 || !total.is_finite() {
            return None;
        }
        let support = cells.iter().filter(|w| **w > 0.0).count() as f64;
        let density = |w: &f64| {
            if *w > 0.0 { (1.0 - Self::EVEN_SHARE) * w / total + Self::EVEN_SHARE / support } else { 0.0 }
        };
        let pdf_per_nm: Vec<f64> = cells.iter().map(density).collect();
        let mut sum = 0.0;
        let mut cumulative: Vec<f64> = vec![0.0];
        cumulative.extend(pdf_per_nm.iter().map(|p| {
            sum += p;
            sum
        }));
        Some(Self { pdf_per_nm, cumulative })
    }

    /// The same density everywhere.
    pub fn even() -> Self {
        Self::proportional_to(&[1.0; GRID_POINTS]).expect("the weights are positive")
    }

    /// Density at a wavelength, per nm; zero outside the grid.
    pub fn pdf_per_nm(&self, nm: f64) -> f64 {
        let cell = (nm - FIRST_NM).floor();
        if cell < 0.0 { 0.0 } else { self.pdf_per_nm.get(cell as usize).copied().unwrap_or(0.0) }
    }

    /// The lanes of a path from one uniform number in [0, 1).
    pub fn sample(&self, u: f32) -> Wavelengths {
        let mut drawn = Wavelengths {
            nm: Spectrum::ZERO,
            pdf_per_nm: Spectrum::ZERO,
            cell: [0; LANES],
            fraction: Spectrum::ZERO,
        };
        for lane in 0..LANES {
            let rotated = f64::from(u) + lane as f64 / LANES as f64;
            let (cell, fraction) = self.invert(if rotated >= 1.0 { rotated - 1.0 } else { rotated });
            drawn.nm[lane] = (FIRST_NM + cell as f64 + fraction) as f32;
            drawn.pdf_per_nm[lane] = self.pdf_per_nm[cell] as f32;
            drawn.cell[lane] = cell as u16;
            drawn.fraction[lane] = fraction as f32;
        }
        drawn
    }

    fn invert(&self, u: f64) -> (usize, f64) {
        let last = self.pdf_per_nm.len() - 1;
        let mut cell = self.cumulative.partition_point(|&c| c <= u).saturating_sub(1).min(last);
        while self.pdf_per_nm[cell] == 0.0 && cell > 0 {
            cell -= 1; // u rounded past the end of the support
        }
        let fraction = (u - self.cumulative[cell]) / self.pdf_per_nm[cell];
        (cell, fraction.clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_lane_integrates_what_the_grid_integrates() {
        // Weight and integrand differ, and the weight vanishes below 400 nm with the integrand.
        let weights: Vec<f64> = grid_nm().map(|nm| (nm - 400.0).clamp(0.0, 120.0)).collect();
        let sampler = WavelengthSampler::proportional_to(&weights).expect("positive weights");
        let integrand = |nm: f64| if nm < 400.0 { 0.0 } else { 1.0 + (nm * 0.02).sin() };
        let truth: f64 = (0..430_000).map(|i| integrand(400.0 + (f64::from(i) + 0.5) * 1e-3) * 1e-3).sum();
        const SAMPLES: u32 = 200_000;
        let mut sums = [0.0; LANES];
        for i in 0..SAMPLES {
            let drawn = sampler.sample((i as f32 + 0.5) / SAMPLES as f32);
            for (lane, sum) in sums.iter_mut().enumerate() {
                *sum += integrand(f64::from(drawn.nm[lane])) / f64::from(drawn.pdf_per_nm[lane]);
            }
        }
        for sum in sums {
            let value = sum / f64::from(SAMPLES);
            // An equidistant rule in u: the error is of the order of one cell's share.
            assert!((value / truth - 1.0).abs() < 1e-3, "{value} against {truth}");
        }
    }

    #[test]
    fn density_sums_to_one_and_covers_the_support() {
        let mut weights = vec![0.0; GRID_POINTS];
        weights[100] = 1e-12;
        weights[300] = 1.0;
        let sampler = WavelengthSampler::proportional_to(&weights).expect("positive weights");
        let total: f64 = sampler.pdf_per_nm.iter().sum();
        assert!((total - 1.0).abs() < 1e-12);
        for nm in [459.5, 460.5, 659.5, 660.5] {
            assert!(sampler.pdf_per_nm(nm) >= WavelengthSampler::EVEN_SHARE / 4.0 * 0.99, "{nm}");
        }
    }
}
