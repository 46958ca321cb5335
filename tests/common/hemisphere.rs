//! Directions, random numbers and quadrature.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::sync::LazyLock;

use glam::Vec3A;

/// Unit vector from its cosine to z and its azimuth.
pub fn direction(z: f64, phi: f64) -> Vec3A {
    let sine = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
    Vec3A::new((sine * phi.cos()) as f32, (sine * phi.sin()) as f32, z as f32)
}

/// Directions that tests look from: normal, oblique, grazing, and from inside.
pub fn viewpoints() -> Vec<Vec3A> {
    [(1.0, 0.0), (0.8, 0.3), (0.45, 2.0), (0.05, 4.0), (-1.0, 0.0), (-0.7, 1.0), (-0.1, 5.0)]
        .map(|(z, phi)| direction(z, phi))
        .to_vec()
}

/// SplitMix64 (Steele, Lea and Flood 2014).
pub struct Random(pub u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        x ^ (x >> 31)
    }

    /// Uniform in [0, 1), a multiple of 2^-24.
    pub fn uniform(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1u64 << 24) as f32
    }

    pub fn pair(&mut self) -> [f32; 2] {
        [self.uniform(), self.uniform()]
    }

    pub fn on_sphere(&mut self) -> Vec3A {
        let (z, phi) = (2.0 * f64::from(self.uniform()) - 1.0, f64::from(self.uniform()));
        direction(z, 2.0 * PI * phi)
    }
}

/// A mean with its standard error.
#[derive(Clone, Copy, Default)]
pub struct Mean {
    count: f64,
    sum: f64,
    sum_of_squares: f64,
}

impl Mean {
    pub fn add(&mut self, value: f64) {
        self.count += 1.0;
        self.sum += value;
        self.sum_of_squares += value * value;
    }

    pub fn value(&self) -> f64 {
        self.sum / self.count
    }

    pub fn error(&self) -> f64 {
        let variance = self.sum_of_squares / self.count - self.value() * self.value();
        (variance.max(0.0) / self.count).sqrt()
    }

    /// Within five standard errors of the truth, with a floor for rounding, and with an
    /// error small enough to mean something.
    pub fn assert_is(&self, truth: f64, floor: f64, largest_error: f64, what: &str) {
        let (value, error) = (self.value(), self.error());
        assert!(error < largest_error, "{what}: too noisy: {value} +- {error}, truth {truth}");
        assert!(
            (value - truth).abs() < 5.0 * error + floor,
            "{what}: {value} +- {error}, truth {truth}, z = {}",
            (value - truth) / error
        );
    }
}

/// Nodes and weights of Gauss and Legendre on [0, 1].
pub fn gauss(n: usize) -> Vec<(f64, f64)> {
    let polynomial = |x: f64| {
        let (mut before, mut now) = (1.0, x);
        for k in 2..=n {
            let k = k as f64;
            (before, now) = (now, ((2.0 * k - 1.0) * x * now - (k - 1.0) * before) / k);
        }
        (now, n as f64 * (x * now - before) / (x * x - 1.0))
    };
    let node = |i: usize| {
        let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        for _ in 0..8 {
            let (p, slope) = polynomial(x);
            x -= p / slope;
        }
        let slope = polynomial(x).1;
        (0.5 + 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(node).collect()
}

/// Integral over [from, to] of a function whose derivative may be singular at `from`.
pub fn integral(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss(48));
    let width = to - from;
    RULE.iter().map(|&(t, w)| 2.0 * t * w * width * f(from + width * t * t)).sum()
}

/// A direction as a hemisphere (0 above, 1 below) and a point in the unit square; equal
/// areas of the square are equal solid angles.
pub fn to_square(w: Vec3A) -> (usize, [f64; 2]) {
    let (x, y, z) = (f64::from(w.x), f64::from(w.y), f64::from(w.z).abs());
    let scale = 1.0 / (1.0 + z).sqrt();
    let (x, y) = (x * scale, y * scale);
    let radius = x.hypot(y).min(1.0);
    let phi = y.abs().atan2(x.abs());
    let (a, b) = if phi < FRAC_PI_4 {
        (radius, radius * phi / FRAC_PI_4)
    } else {
        (radius * (FRAC_PI_2 - phi) / FRAC_PI_4, radius)
    };
    let below = usize::from(w.z.is_sign_negative());
    (below, [0.5 + 0.5 * a.copysign(x), 0.5 + 0.5 * b.copysign(y)])
}

/// The inverse of [`to_square`].
pub fn from_square(below: usize, p: [f64; 2]) -> Vec3A {
    let (a, b) = (2.0 * p[0] - 1.0, 2.0 * p[1] - 1.0);
    let (radius, phi) = if a.abs() > b.abs() {
        (a, FRAC_PI_4 * b / a)
    } else if b != 0.0 {
        (b, FRAC_PI_2 - FRAC_PI_4 * a / b)
    } else {
        (0.0, 0.0)
    };
    let stretch = radius * (2.0 - radius * radius).sqrt();
    let z = 1.0 - radius * radius;
    let z = if below == 1 { -z } else { z };
    Vec3A::new((stretch * phi.cos()) as f32, (stretch * phi.sin()) as f32, z as f32)
}

/// Solid angle of the unit square.
pub const SQUARE_SOLID_ANGLE: f64 = 2.0 * PI;
