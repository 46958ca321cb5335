//! A rectangle as a point sees it, by the solid angle that it fills: closed forms both ways in
//! `f64`, and none where they would lose digits.
//!
//! Up to a coordinate along its first edge a rectangle fills the difference of two arcsines
//! (Ureña, Fajardo, King 2013, "An area-preserving parametrization for spherical rectangles").
//! The inverse is written here by half of that angle: it divides by nothing that vanishes at
//! right angles, and what cancels for narrow and far rectangles is known beforehand.

use glam::DVec3;
use std::f64::consts::TAU;

/// A rectangle as a point sees it.
#[derive(Clone, Copy, Debug)]
pub struct SphericalRectangle {
    /// Coordinates along the first edge at both of its ends, from the foot of the point.
    x: [f64; 2],
    /// The same along the second edge.
    y: [f64; 2],
    /// Distance of the point from the plane.
    height: f64,
    /// Of the angles at which the point sees both y off its foot.
    sines: NearSines,
    /// Solid angle of the strip from the foot to the rectangle, in sr.
    before: f64,
    /// In sr.
    solid_angle: f64,
}

/// Least height over the farthest coordinate: of a rectangle that is seen edge on, the far end
/// fills next to nothing, and which part of it does is lost.
const LEAST_HEIGHT: f64 = 1e-4;
/// Least solid angle, in sr: it is a difference of angles that are known to some 2^-53.
const LEAST_SOLID_ANGLE: f64 = 1e-3;

impl SphericalRectangle {
    /// The rectangle with this corner, relative to the point, and two edges from there at right
    /// angles; `None` where it is seen too flatly or too small for `f64`.
    #[inline]
    pub fn new(corner: DVec3, [first, second]: [DVec3; 2]) -> Option<Self> {
        let (length, width) = (first.length(), second.length());
        let (first, second) = (first / length, second / width);
        let height = corner.dot(first.cross(second)).abs();
        let (x, y) = (corner.dot(first), corner.dot(second));
        let (x, y) = ([x, x + length], [y, y + width]);
        let reach = [x, y].into_iter().flatten().fold(0.0, |reach: f64, v| reach.max(v.abs()));
        if height.is_nan() || height <= LEAST_HEIGHT * reach {
            return None;
        }
        let [before, upto] = x.map(|x| strip(x, y, height));
        let solid_angle = angle(minus(upto, before));
        // A rectangle that fills more than half of its half-space comes out as a negative angle; one
        // that fills nothing as zero, give or take a rounding.
        let solid_angle = if solid_angle < -LEAST_SOLID_ANGLE { solid_angle + TAU } else { solid_angle };
        if solid_angle <= LEAST_SOLID_ANGLE {
            return None;
        }
        let sines = NearSines::of(y, width, height);
        Some(Self { x, y, height, sines, before: angle(before), solid_angle })
    }

    /// Solid angle that it fills, in sr.
    #[inline]
    pub const fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// Where two numbers, uniform in [0, 1), put a point that is uniform over the solid angle: its
    /// share of both edges.
    #[inline]
    pub fn sample(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = (0.5 * (self.before + u * self.solid_angle)).sin_cos();
        let x = 2.0 * self.height * sin * cos / self.sines.below(sin, cos).max(0.0).sqrt();
        let x = x.clamp(self.x[0], self.x[1]);
        let away2 = x * x + self.height * self.height;
        let [from, to] = self.sines(away2);
        let sine = from + v * (to - from);
        let y = sine * (away2 / (1.0 - sine * sine)).sqrt();
        [share(self.x, x), share(self.y, y.clamp(self.y[0], self.y[1]))]
    }

    /// The numbers with which [`Self::sample`] draws a point, by its share of both edges.
    #[inline]
    pub fn invert(&self, [s, t]: [f64; 2]) -> [f64; 2] {
        let (x, y) = (at(self.x, s), at(self.y, t));
        let away2 = x * x + self.height * self.height;
        let [from, to] = self.sines(away2);
        let upto = angle(strip(x, self.y, self.height)) - self.before;
        [upto / self.solid_angle, (y / (away2 + y * y).sqrt() - from) / (to - from)]
    }

    /// Sines of the angles at which both y are seen off a line at this squared distance.
    #[inline]
    fn sines(&self, away2: f64) -> [f64; 2] {
        self.y.map(|y| y / (away2 + y * y).sqrt())
    }
}

/// A complex number whose argument is the solid angle of the strip from x = 0 to `x`.
#[inline]
fn strip(x: f64, [from, to]: [f64; 2], height: f64) -> [f64; 2] {
    let corner = |y: f64| [height * (x * x + y * y + height * height).sqrt(), x * y];
    minus(corner(to), corner(from))
}

/// A complex number whose argument is the difference of those of two.
#[inline]
fn minus([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a * c + b * d, b * c - a * d]
}

#[inline]
fn angle([real, imaginary]: [f64; 2]) -> f64 {
    imaginary.atan2(real)
}

/// Two sines by what cancels where both angles are nearly the same or nearly right.
#[derive(Clone, Copy, Debug)]
struct NearSines {
    /// The second less the first.
    difference: f64,
    sum: f64,
    /// Sum of the squared cosines.
    cosines2: f64,
}

impl NearSines {
    #[inline]
    fn of(y: [f64; 2], width: f64, height: f64) -> Self {
        let height2 = height * height;
        let [a, b] = y.map(|y| height2 / (y * y + height2));
        let [from, to] = y.map(|y| y / (y * y + height2).sqrt());
        // The smaller of both by their product, the difference of the squared sines.
        let product = a * b * width * (y[0] + y[1]) / height2;
        let [difference, sum] = if from * to < 0.0 {
            [to - from, product / (to - from)]
        } else {
            [product / (to + from), to + from]
        };
        Self { difference, sum, cosines2: a + b }
    }

    /// The squared sine of a strip's solid angle over the squared tangent of the angle at which
    /// its end is seen off the foot, by sine and cosine of half of that solid angle.
    #[inline]
    fn below(&self, sin: f64, cos: f64) -> f64 {
        let (part, near) =
            if sin.abs() < cos.abs() { (sin * sin, self.difference) } else { (cos * cos, self.sum) };
        near * near - 4.0 * part * (0.5 * (self.cosines2 + near * near) - part)
    }
}

#[inline]
fn at([from, to]: [f64; 2], share: f64) -> f64 {
    from + share * (to - from)
}

#[inline]
fn share([from, to]: [f64; 2], at: f64) -> f64 {
    (at - from) / (to - from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::mix;
    use std::f64::consts::PI;

    fn uniform(state: &mut u64) -> f64 {
        *state += 1;
        (mix(*state) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A length within six decades.
    fn length(state: &mut u64) -> f64 {
        10_f64.powf(6.0 * uniform(state) - 4.0)
    }

    fn coordinate(state: &mut u64) -> f64 {
        (2.0 * uniform(state) - 1.0) * length(state)
    }

    /// Corner and edges of a rectangle of any aspect, place and distance, turned anyhow.
    fn any(state: &mut u64) -> (DVec3, [DVec3; 2]) {
        let normal = DVec3::from_array([0; 3].map(|_| uniform(state) - 0.5)).normalize();
        let (first, second) = normal.any_orthonormal_pair();
        let corner = first * coordinate(state) + second * coordinate(state) + normal * coordinate(state);
        (corner, [first * length(state), second * length(state)])
    }

    /// Solid angle of a triangle (Van Oosterom and Strackee 1983), and how far its rounding may
    /// turn it: four products of three lengths, each of some ten operations.
    fn of_triangle([a, b, c]: [DVec3; 3]) -> (f64, f64) {
        let [l, m, n] = [a, b, c].map(DVec3::length);
        let below = l * m * n + a.dot(b) * n + a.dot(c) * m + b.dot(c) * l;
        let above = a.dot(b.cross(c)).abs();
        (2.0 * above.atan2(below), 40.0 * f64::EPSILON * l * m * n / above.hypot(below))
    }

    fn of_rectangle(corner: DVec3, [first, second]: [DVec3; 2]) -> (f64, f64) {
        let [a, b, c, d] = [corner, corner + first, corner + first + second, corner + second];
        let (one, two) = (of_triangle([a, b, c]), of_triangle([a, c, d]));
        (one.0 + two.0, one.1 + two.1)
    }

    /// Both start from corners that are rounded: three coordinates, twice, in each of two products.
    #[test]
    fn solid_angles_are_those_of_two_triangles() {
        let mut state = 1;
        let mut seen = 0;
        for _ in 0..100_000 {
            let (corner, edges) = any(&mut state);
            let Some(rectangle) = SphericalRectangle::new(corner, edges) else { continue };
            let (own, (other, turned)) = (rectangle.solid_angle(), of_rectangle(corner, edges));
            let least = rectangle.height.min(edges[0].length()).min(edges[1].length());
            let reach = corner.length() + edges[0].length() + edges[1].length();
            let rounding = 12.0 * f64::EPSILON * reach / least;
            assert!((own - other).abs() < turned + rounding * own, "{corner} {edges:?}: {own} | {other}");
            seen += 1;
        }
        assert!(seen > 20_000, "{seen}");
        let (corner, edges) = (DVec3::new(-1.0, -1.0, 1.0), [2.0 * DVec3::X, 2.0 * DVec3::Y]);
        let face = SphericalRectangle::new(corner, edges).expect("a face of a cube from its centre");
        assert!((face.solid_angle() - 4.0 * PI / 6.0).abs() < 1e-15);
        let close = SphericalRectangle::new(DVec3 { z: 1e-3, ..corner }, edges).expect("close to its middle");
        let quarter = (1.0 / (1e-3 * 2.000_001_f64.sqrt())).atan();
        assert!((close.solid_angle() - 4.0 * quarter).abs() < 1e-14, "more than half of a half-space");
    }

    /// Over six decades of aspect ratio, size and distance. What is told apart are numbers of 24
    /// bits: the tolerance is half of their spacing.
    #[test]
    fn points_give_back_the_numbers_that_draw_them() {
        let mut state = 1 << 40;
        let mut seen = 0;
        for _ in 0..200_000 {
            let (corner, edges) = any(&mut state);
            let Some(rectangle) = SphericalRectangle::new(corner, edges) else { continue };
            let u = [uniform(&mut state), uniform(&mut state)];
            let shares = rectangle.sample(u);
            assert!(shares.iter().all(|share| (0.0..=1.0).contains(share)), "{corner} {edges:?}: {shares:?}");
            let back = rectangle.invert(shares);
            for (u, back) in u.into_iter().zip(back) {
                assert!((u - back).abs() < 0.5_f64.powi(25), "{corner} {edges:?}: {u} came back as {back}");
            }
            seen += 1;
        }
        assert!(seen > 40_000, "{seen}");
    }

    /// Chi-squared over 8 x 8 parts of each rectangle, against the solid angles of the parts by
    /// the other formula: 63 degrees of freedom, of which 140 is beyond the 1 - 1e-7 quantile, so
    /// that 30 rectangles give a false alarm once in 300,000.
    #[test]
    fn points_are_uniform_over_the_solid_angle() {
        const DRAWS: usize = 64_000;
        let mut state = 2 << 40;
        let mut left = 30;
        while left > 0 {
            let (corner, edges) = any(&mut state);
            let Some(rectangle) = SphericalRectangle::new(corner, edges) else { continue };
            left -= 1;
            let parts = edges.map(|edge| edge / 8.0);
            let mut counts = [0.0; 64];
            for _ in 0..DRAWS {
                let [s, t] = rectangle.sample([uniform(&mut state), uniform(&mut state)]);
                counts[(8.0 * s).min(7.0) as usize * 8 + (8.0 * t).min(7.0) as usize] += 1.0;
            }
            // Parts of which fewer than five are expected are taken together.
            let (mut chi_squared, mut rest) = (0.0, [0.0; 2]);
            for (index, count) in counts.into_iter().enumerate() {
                let part = corner + (index / 8) as f64 * parts[0] + (index % 8) as f64 * parts[1];
                let expected = of_rectangle(part, parts).0 / rectangle.solid_angle() * DRAWS as f64;
                if expected < 5.0 {
                    rest = [rest[0] + count, rest[1] + expected];
                } else {
                    chi_squared += (count - expected).powi(2) / expected;
                }
            }
            if rest[1] >= 5.0 {
                chi_squared += (rest[0] - rest[1]).powi(2) / rest[1];
            }
            assert!(chi_squared < 140.0, "{corner} {edges:?}: {chi_squared}");
        }
    }

    #[test]
    fn a_rectangle_seen_edge_on_or_from_too_far_has_none() {
        let edges = [DVec3::X, DVec3::Y];
        for corner in [[1.0, 1.0, 0.0], [1.0, 1.0, 1e-3], [0.0, 0.0, 1e9], [0.0, 0.0, f64::NAN]] {
            assert!(SphericalRectangle::new(DVec3::from_array(corner), edges).is_none(), "{corner:?}");
        }
    }

    /// A hair fills nothing from anywhere: the rounding of zero is no whole turn.
    #[test]
    fn a_hair_has_none() {
        let mut state = 3 << 40;
        for width in [1e-17, 1e-16, 3e-16, 1e-15, 1e-14] {
            for _ in 0..2000 {
                let corner = DVec3::from_array([(); 3].map(|()| 2.0 * uniform(&mut state) - 1.0));
                let edges = [DVec3::X * (0.5 + uniform(&mut state)), DVec3::Y * width];
                assert!(SphericalRectangle::new(corner, edges).is_none(), "{corner} {width}");
            }
        }
    }
}
