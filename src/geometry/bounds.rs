//! Axis-aligned boxes, and the power of two that brings a scene to about unit size.

use glam::{DVec3, Vec3A};

/// An axis-aligned box in scene units; empty when `min` exceeds `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lowest corner.
    pub min: Vec3A,
    /// Highest corner.
    pub max: Vec3A,
}

impl Bounds {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };

    /// The smallest `f32` box around the box from `min` to `max`.
    pub(crate) fn around(min: DVec3, max: DVec3) -> Self {
        let down = |x: f64| -super::precise::round_up(-x);
        let up = super::precise::round_up;
        Self {
            min: Vec3A::new(down(min.x), down(min.y), down(min.z)),
            max: Vec3A::new(up(max.x), up(max.y), up(max.z)),
        }
    }

    /// The smallest box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether nothing is inside.
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// Half the diagonal: the radius of a ball around the box; 0 when empty.
    pub fn radius(&self) -> f32 {
        if self.is_empty() { 0.0 } else { (self.max - self.min).length() * 0.5 }
    }

    /// The centre; meaningless when empty.
    pub fn center(&self) -> Vec3A {
        (self.min + self.max) * 0.5
    }
}

/// An axis-aligned box in metres; empty when `min` exceeds `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetreBounds {
    /// Lowest corner.
    pub min: DVec3,
    /// Highest corner.
    pub max: DVec3,
}

impl MetreBounds {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// Grows to hold `point`.
    pub fn include(&mut self, point: DVec3) {
        self.min = self.min.min(point);
        self.max = self.max.max(point);
    }
}

/// The least power of two (metres per scene unit) that no coordinate of `bounds` exceeds;
/// 1 for an empty box or one that is only the origin.
///
/// Dividing by a power of two rounds nothing, so a scene scaled by one is the same scene
/// in scene units, bit for bit.
pub fn unit_scale(bounds: &MetreBounds) -> f64 {
    let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
    if !(reach.is_finite() && reach >= f64::MIN_POSITIVE) {
        return 1.0;
    }
    let below = f64::from_bits(reach.to_bits() & !((1 << MANTISSA_BITS) - 1));
    // The largest power of two has no successor to round up to.
    if below < reach && below < LARGEST_POWER { 2.0 * below } else { below }
}

/// Explicit mantissa bits of an `f64`.
const MANTISSA_BITS: u32 = 52;
/// 2^1023.
const LARGEST_POWER: f64 = 8.98846567431158e307;

#[cfg(test)]
mod tests {
    use super::*;

    fn scale_of(reach: f64) -> f64 {
        unit_scale(&MetreBounds { min: DVec3::ZERO, max: DVec3::splat(reach) })
    }

    #[test]
    fn the_unit_scale_is_the_next_power_of_two() {
        assert_eq!(scale_of(1.0), 1.0);
        assert_eq!(scale_of(1.1), 2.0);
        assert_eq!(scale_of(5.5), 8.0);
        assert_eq!(scale_of(0.3), 0.5);
        assert_eq!(scale_of(0.0), 1.0);
        assert_eq!(unit_scale(&MetreBounds::EMPTY), 1.0);
        assert_eq!(LARGEST_POWER, 2f64.powi(1023));
    }
}
