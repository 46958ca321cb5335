//! Microfacets distributed after GGX (Trowbridge and Reitz 1975; Walter et al. 2007).
//!
//! The tangent of a facet is never computed: slopes come from the components of its normal,
//! which keeps the distribution exact down to the smallest roughness. Heights of facets are
//! correlated after Smith, for reflection (Heitz 2014) and transmission (Dupuy, Heitz and
//! d'Eon 2016: a beta function, because what leaves below passes the other facets from
//! behind).
//!
//! Facets scatter once, and light that would meet a second facet is lost. Percentages lost
//! by white facets, and by glass of index 1.5 seen from outside (most of that is light
//! refracted into another facet):
//!
//! | alpha | white: cos 1 | 0.5 | 0.05 | glass: cos 1 | 0.5 | 0.05 |
//! |---|---|---|---|---|---|---|
//! | 0.1 | 1.2 | 3.1 | 8.8 | 0.1 | 0.8 | 7.4 |
//! | 0.2 | 5.2 | 10.5 | 6.8 | 0.5 | 2.8 | 11.8 |
//! | 0.5 | 31.2 | 30.1 | 8.7 | 3.2 | 12.3 | 52.5 |
//! | 1.0 | 69.3 | 54.9 | 15.2 | 10.7 | 38.8 | 87.9 |

use std::f32::consts::{PI, TAU};

use glam::{DVec3, Vec3A};

use crate::sampler::inverse::{turn, unit};

/// A distribution of facet normals about `+z`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    alpha_x: f32,
    alpha_y: f32,
}

/// What a pair of directions above the surface says about the facets between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reflection {
    /// Cosine between either direction and the facet that mirrors one into the other.
    pub cos_facet: f32,
    /// f |cos(wi)| of facets that reflect everything.
    pub value: f32,
    /// Density of `wi` when normals are drawn as they are seen from `wo`.
    pub pdf: f32,
}

impl Ggx {
    /// Below this a facet distribution is narrower than what directions in `f32` resolve
    /// well, and no lens of ordinary size can tell it from a polished surface.
    pub const MIN_ALPHA: f32 = 1e-4;

    /// The same roughness in all directions; `alpha` in [`Self::MIN_ALPHA`], 1.
    pub fn isotropic(alpha: f32) -> Self {
        Self::anisotropic(alpha, alpha)
    }

    /// Roughness along the local x and y axes.
    pub fn anisotropic(alpha_x: f32, alpha_y: f32) -> Self {
        debug_assert!(alpha_x >= Self::MIN_ALPHA && alpha_y >= Self::MIN_ALPHA);
        Self { alpha_x, alpha_y }
    }

    /// The smaller roughness of the two axes.
    pub(super) fn min_alpha(&self) -> f32 {
        self.alpha_x.min(self.alpha_y)
    }

    /// Area of facets with unit normal `h`, per solid angle and per area of the surface.
    #[inline]
    pub fn density(&self, h: Vec3A) -> f32 {
        let (x, y) = (h.x / self.alpha_x, h.y / self.alpha_y);
        let stretched = x * x + y * y + h.z * h.z;
        1.0 / (PI * self.alpha_x * self.alpha_y * stretched * stretched)
    }

    /// |z| (1 + 2 Lambda), which stays finite at grazing angles.
    #[inline]
    fn stretched_length(&self, w: Vec3A) -> f32 {
        let (x, y) = (self.alpha_x * w.x, self.alpha_y * w.y);
        (x * x + y * y + w.z * w.z).sqrt()
    }

    /// The facets that mirror `wo` into `wi`, both above the surface; `None` if none do.
    #[inline]
    pub(super) fn reflection(&self, wo: Vec3A, wi: Vec3A) -> Option<Reflection> {
        let h = (wo + wi).normalize_or_zero();
        let cos_facet = wo.dot(h);
        if wo.z <= 0.0 || wi.z <= 0.0 || h.z <= 0.0 || cos_facet <= 0.0 {
            return None;
        }
        let (root_o, root_i) = (self.stretched_length(wo), self.stretched_length(wi));
        let density = self.density(h);
        // D G / (4 cos_o) with G = 1 / (1 + Lambda_o + Lambda_i).
        let value = 0.5 * density * wi.z / (wi.z * root_o + wo.z * root_i);
        let pdf = 0.5 * density / (wo.z + root_o);
        (value.is_finite() && pdf.is_finite()).then_some(Reflection { cos_facet, value, pdf })
    }

    /// Density of facet normals as seen from `wo` above, divided by D cos(wo, h).
    #[inline]
    pub(super) fn visible_over_density(&self, wo: Vec3A) -> f32 {
        2.0 / (wo.z + self.stretched_length(wo))
    }

    /// Share of facets seen from `wo` above and from `wi` below, over cos(wo).
    #[inline]
    pub(super) fn through_over_cos(&self, wo: Vec3A, wi: Vec3A) -> f32 {
        let one_plus_lambda = |w: Vec3A| {
            let z = f64::from(w.z.abs());
            0.5 * (1.0 + f64::from(self.stretched_length(w)).max(z) / z)
        };
        let share = beta(one_plus_lambda(wo), one_plus_lambda(wi));
        (share / f64::from(wo.z)) as f32
    }

    /// Draws a facet normal with the density of those seen from `wo` above.
    ///
    /// Spherical caps after Dupuy and Benyoub 2023, arranged so that nothing cancels: with
    /// w the stretched `wo`, the cap's z is (1 - u)(1 + w_z) - w_z.
    #[inline]
    pub(super) fn sample_visible(&self, wo: Vec3A, u: [f32; 2]) -> Vec3A {
        let w = Vec3A::new(self.alpha_x * wo.x, self.alpha_y * wo.y, wo.z).normalize();
        let above = 1.0 + w.z;
        // 1 - w_z, from the components.
        let below = (w.x * w.x + w.y * w.y) / above;
        let h_z = (1.0 - u[1]) * above;
        let sine = (u[1] * above * (h_z + below)).max(0.0).sqrt();
        let phi = TAU * u[0];
        let h_x = sine * phi.cos() + w.x;
        let h_y = sine * phi.sin() + w.y;
        Vec3A::new(self.alpha_x * h_x, self.alpha_y * h_y, h_z).normalize_or_zero()
    }

    /// The numbers with which `sample_visible` draws the facet along the unit vector `h`,
    /// seen from `wo` above.
    ///
    /// The facet stretched to unit length is d = (c + w) / |c + w|, with w the stretched `wo`
    /// and c a point of the unit sphere above height -w_z; hence c = 2 (d.w) d - w.
    #[inline]
    pub(super) fn invert_visible(&self, wo: Vec3A, h: DVec3) -> [f32; 2] {
        let (alpha_x, alpha_y) = (f64::from(self.alpha_x), f64::from(self.alpha_y));
        let wo = wo.as_dvec3();
        let w = DVec3::new(alpha_x * wo.x, alpha_y * wo.y, wo.z).normalize();
        let d = DVec3::new(h.x / alpha_x, h.y / alpha_y, h.z).normalize();
        let raised = d * (2.0 * d.dot(w));
        [unit(turn(raised.x - w.x, raised.y - w.y)), unit(1.0 - raised.z / (1.0 + w.z))]
    }
}

/// Unit vector along wo + eta wi: the normal, up or down, of the facet that mirrors (eta = 1)
/// or refracts `wo` into `wi`.
///
/// Of exactly unit length, or a rounding of their lengths would turn the facet as soon as the
/// two directions nearly cancel.
pub(super) fn facet_along(wo: Vec3A, wi: Vec3A, eta: f64) -> DVec3 {
    (wo.as_dvec3().normalize() + wi.as_dvec3().normalize() * eta).normalize_or_zero()
}

/// Euler's beta function for arguments of at least one, to a relative 1e-7.
///
/// Both arguments are raised by four, where Stirling's series converges fast.
fn beta(p: f64, q: f64) -> f64 {
    let mut factor = 1.0;
    for i in 0..4 {
        let i = f64::from(i);
        factor *= (p + q + 2.0 * i) / (p + i) * ((p + q + 2.0 * i + 1.0) / (q + i));
    }
    let (p, q) = (p + 4.0, q + 4.0);
    let correction = |x: f64| {
        let y = 1.0 / x;
        y * (1.0 / 12.0 - y * y * (1.0 / 360.0 - y * y / 1260.0))
    };
    let ln = -(p - 0.5) * (q / p).ln_1p() - (q - 0.5) * (p / q).ln_1p()
        + 0.5 * (std::f64::consts::TAU / (p + q)).ln()
        + correction(p)
        + correction(q)
        - correction(p + q);
    factor * ln.exp()
}
