//! A spectrum as transport sees it: one value for each wavelength that a path carries.
//!
//! Arithmetic is plain loops over an aligned array, which the compiler turns into
//! vector instructions; no SIMD crate is needed. Values are `f32`: a path multiplies a
//! few dozen of them at most, and the film adds them up in `f64`.

use std::ops::{Add, AddAssign, Div, DivAssign, Index, IndexMut, Mul, MulAssign};

/// Wavelengths that one path carries side by side.
pub const LANES: usize = 8;
const _: () = assert!(LANES.is_power_of_two());

/// One value per carried wavelength; lane 0 belongs to the hero wavelength.
///
/// The unit is that of the quantity stored: radiance in W sr^-1 m^-2 nm^-1, throughput
/// and reflectance without unit, probability densities relative to the hero's.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct Spectrum(pub [f32; LANES]);

impl Spectrum {
    /// Nothing at any wavelength.
    pub const ZERO: Self = Self([0.0; LANES]);
    /// One at every wavelength.
    pub const ONE: Self = Self([1.0; LANES]);

    /// The same value in every lane.
    #[inline]
    pub const fn splat(value: f32) -> Self {
        Self([value; LANES])
    }

    /// The value of each lane from its index.
    #[inline]
    pub fn from_fn(value_of_lane: impl FnMut(usize) -> f32) -> Self {
        Self(std::array::from_fn(value_of_lane))
    }

    /// Applies a function to every lane.
    #[inline]
    pub fn map(self, mut f: impl FnMut(f32) -> f32) -> Self {
        Self::from_fn(|i| f(self.0[i]))
    }

    /// Applies a function to pairs of lanes.
    #[inline]
    pub fn zip(self, other: Self, mut f: impl FnMut(f32, f32) -> f32) -> Self {
        Self::from_fn(|i| f(self.0[i], other.0[i]))
    }

    /// The value at the hero wavelength.
    #[inline]
    pub const fn hero(self) -> f32 {
        self.0[0]
    }

    /// Keeps the hero lane and clears its companions.
    #[inline]
    pub const fn hero_only(self) -> Self {
        let mut lanes = [0.0; LANES];
        lanes[0] = self.0[0];
        Self(lanes)
    }

    /// The mean over the lanes.
    #[inline]
    pub fn mean(self) -> f32 {
        self.sum() / LANES as f32
    }

    /// The sum over the lanes.
    #[inline]
    pub fn sum(self) -> f32 {
        self.halved(|a, b| a + b)
    }

    /// The largest lane; those that are no number are left out.
    #[inline]
    pub fn max(self) -> f32 {
        let floor = Self::splat(f32::NEG_INFINITY);
        self.zip(floor, larger).halved(larger)
    }

    /// All lanes as one, half of them taken together with the other half at each step: vector
    /// instructions, where one lane after another is a chain.
    #[inline]
    fn halved(self, both: impl Fn(f32, f32) -> f32) -> f32 {
        let (mut lanes, mut count) = (self.0, LANES);
        while count > 1 {
            count /= 2;
            for lane in 0..count {
                lanes[lane] = both(lanes[lane], lanes[lane + count]);
            }
        }
        lanes[0]
    }

    /// Whether every lane is zero: such a path carries nothing and can stop.
    #[inline]
    pub fn is_black(self) -> bool {
        self.all(|v| v == 0.0)
    }

    /// Whether no lane is NaN or infinite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.all(f32::is_finite)
    }

    /// Whether something holds for every lane; all are looked at, without a branch.
    #[inline]
    fn all(self, holds: impl Fn(f32) -> bool) -> bool {
        self.0.iter().fold(true, |all, &v| all & holds(v))
    }

    /// Whether all lanes are equal bit for bit, as those of a quantity without dispersion.
    #[inline]
    pub fn is_flat(self) -> bool {
        self.all(|v| v.to_bits() == self.0[0].to_bits())
    }
}

/// The larger of two numbers, and the second where the first is none: one instruction.
#[inline]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

impl Default for Spectrum {
    fn default() -> Self {
        Self::ZERO
    }
}

impl Index<usize> for Spectrum {
    type Output = f32;
    #[inline]
    fn index(&self, lane: usize) -> &f32 {
        &self.0[lane]
    }
}

impl IndexMut<usize> for Spectrum {
    #[inline]
    fn index_mut(&mut self, lane: usize) -> &mut f32 {
        &mut self.0[lane]
    }
}

macro_rules! lane_by_lane {
    ($($operation:ident $method:ident $assign:ident $assign_method:ident $op:tt;)*) => {$(
        impl $operation for Spectrum {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $op b)
            }
        }
        impl $operation<f32> for Spectrum {
            type Output = Self;
            #[inline]
            fn $method(self, other: f32) -> Self {
                self.map(|a| a $op other)
            }
        }
        impl $assign for Spectrum {
            #[inline]
            fn $assign_method(&mut self, other: Self) {
                *self = *self $op other;
            }
        }
        impl $assign<f32> for Spectrum {
            #[inline]
            fn $assign_method(&mut self, other: f32) {
                *self = *self $op other;
            }
        }
    )*};
}

lane_by_lane! {
    Add add AddAssign add_assign +;
    Mul mul MulAssign mul_assign *;
    Div div DivAssign div_assign /;
}
