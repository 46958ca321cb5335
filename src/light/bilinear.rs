//! A density over the unit square that is bilinear between its corners: the product of what a
//! map of the square already follows with what it does not.
//!
//! Both numbers are drawn by closed forms that divide by nothing that may vanish, and the way
//! back is a polynomial (Hart, Pharr, Müller, Lopes, McGuire, Shirley 2020, "Practical product
//! sampling by fitting and composing warps").

/// A density over the unit square by its values at (0, 0), (1, 0), (0, 1), (1, 1), which need not
/// be normalised: none is negative and one is positive.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bilinear(pub [f64; 4]);

impl Bilinear {
    /// Density at a place; its mean is one.
    #[inline]
    pub fn density(&self, [u, v]: [f64; 2]) -> f64 {
        let [from, to] = self.row(v);
        let [a, b, c, d] = self.0;
        4.0 * (from + u * (to - from)) / (a + b + c + d)
    }

    /// The place that two numbers name.
    #[inline]
    pub fn sample(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let [a, b, c, d] = self.0;
        let v = place([a + b, c + d], v);
        [place(self.row(v), u), v]
    }

    /// The numbers that name a place.
    #[inline]
    pub fn invert(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let [a, b, c, d] = self.0;
        [share(self.row(v), u), share([a + b, c + d], v)]
    }

    /// The density at both ends of a row.
    #[inline]
    fn row(&self, v: f64) -> [f64; 2] {
        let [a, b, c, d] = self.0;
        [a + v * (c - a), b + v * (d - b)]
    }
}

/// The place up to which a linear density, by its values at both ends, has a share.
#[inline]
fn place([from, to]: [f64; 2], share: f64) -> f64 {
    let root = (from * from + share * (to * to - from * from)).max(0.0).sqrt();
    if root > 0.0 { (share * (from + to) / (from + root)).min(1.0) } else { 0.0 }
}

/// The share of a linear density up to a place.
#[inline]
fn share([from, to]: [f64; 2], place: f64) -> f64 {
    let sum = from + to;
    if sum > 0.0 { place * (2.0 * from + place * (to - from)) / sum } else { place }
}
