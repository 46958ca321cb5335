//! Fresnel's equations for unpolarised light, exact at all angles and for all indices.
//!
//! Every share is a sum of products of positive numbers, so neither the reflected nor the
//! transmitted one is found by subtracting from one: both keep their relative precision at
//! grazing incidence, for indices that hardly differ and for indices beyond all bounds.

/// What becomes of light at a flat boundary; the shares add up to one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shares {
    /// Share of the power that is reflected.
    pub reflected: f64,
    /// Share of the power that crosses: transmitted, or absorbed by a conductor.
    pub crossing: f64,
}

impl Shares {
    const ALL_REFLECTED: Self = Self { reflected: 1.0, crossing: 0.0 };
    const ALL_CROSSING: Self = Self { reflected: 0.0, crossing: 1.0 };

    /// The share of the lobe whose side is the sign of a product of heights: positive where
    /// both directions are on one side; zero for a direction in the plane.
    pub(super) fn of_lobe(&self, side: f32) -> f64 {
        if side > 0.0 {
            self.reflected
        } else if side < 0.0 {
            self.crossing
        } else {
            0.0
        }
    }
}

/// A boundary between two transparent media.
///
/// `cos_i` is the positive cosine on the side of incidence; `excess` is n_t / n_i - 1 with
/// n_i on that side. Indices that are equal reflect nothing, not even at grazing incidence.
///
/// With m = eta^2 - 1 and q = eta cos_t = sqrt(cos_i^2 + m), the amplitudes are
/// r_s = -m / (c + q)^2 and r_p = m ((2 + m) c^2 - 1) / (eta^2 c + q)^2.
#[inline]
pub fn dielectric(cos_i: f64, excess: f64) -> Shares {
    let m = excess * (2.0 + excess);
    if m == 0.0 {
        return Shares::ALL_CROSSING;
    }
    let c = cos_i;
    let q_squared = c * c + m;
    if c <= 0.0 || q_squared <= 0.0 {
        return Shares::ALL_REFLECTED;
    }
    let q = q_squared.sqrt();
    let eta_squared = 1.0 + m;
    let s = (c + q) * (c + q);
    let p = (eta_squared * c + q) * (eta_squared * c + q);
    let r_s = m / s;
    let r_p = m * ((2.0 + m) * (c * c) - 1.0) / p;
    Shares { reflected: 0.5 * (r_s * r_s + r_p * r_p), crossing: 2.0 * c * q * (1.0 / s + eta_squared / p) }
}

/// A boundary from a transparent medium to a metal of relative index n + ik.
///
/// With Q = sqrt(N^2 - sin_i^2) = a + ib, the amplitudes are r_s = (c - Q) / (c + Q) and
/// r_p = (N^2 c - Q) / (N^2 c + Q).
#[inline]
pub fn conductor(cos_i: f64, n: f64, k: f64) -> Shares {
    let c = cos_i.clamp(0.0, 1.0);
    let sin_squared = (1.0 - c) * (1.0 + c);
    let (n2_re, n2_im) = ((n - k) * (n + k), 2.0 * n * k);
    let t = n2_re - sin_squared;
    let q_squared = t.hypot(n2_im);
    // The larger part of Q comes from a sum, the smaller from ab = nk.
    let larger = (0.5 * (q_squared + t.abs())).sqrt();
    if larger == 0.0 {
        return Shares::ALL_REFLECTED;
    }
    let smaller = n * k / larger;
    let (a, b) = if t >= 0.0 { (larger, smaller) } else { (smaller, larger) };

    let s = (a + c) * (a + c) + b * b;
    let (p_re, p_im) = (n2_re * c + a, n2_im * c + b);
    let p = p_re * p_re + p_im * p_im;
    let reflected_s = ((a - c) * (a - c) + b * b) / s;
    let (d_re, d_im) = (n2_re * c - a, n2_im * c - b);
    let reflected_p = (d_re * d_re + d_im * d_im) / p;
    Shares {
        reflected: 0.5 * (reflected_s + reflected_p),
        crossing: 2.0 * a * c * (1.0 / s + (q_squared + sin_squared) / p),
    }
}
