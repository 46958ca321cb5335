//! Back from what was drawn to the numbers that draw it: what all inverse maps share.
//!
//! Inverses compute in `f64` and round at the end, so that they add to the rounding of the
//! maps themselves no more than that of the numbers, 2^-24 at most.

use std::f64::consts::{FRAC_PI_4, TAU};

/// What stands for a number that decides nothing.
pub(crate) const ANY: f32 = 0.5;

/// The largest `f32` below one.
pub(crate) const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// The number in [0, 1) nearest to a value that rounding may have put outside.
#[inline]
pub(crate) fn unit(value: f64) -> f32 {
    (value as f32).clamp(0.0, BELOW_ONE)
}

/// The angle of (x, y) from the x axis in whole turns, in [0, 1]; zero at the origin.
#[inline]
pub(crate) fn turn(x: f64, y: f64) -> f64 {
    let turn = y.atan2(x) / TAU;
    if turn < 0.0 { turn + 1.0 } else { turn }
}

/// The numbers that the concentric map (Shirley and Chiu 1997) takes to a point of the unit
/// disk.
#[inline]
pub(crate) fn square_of_disk([x, y]: [f64; 2]) -> [f32; 2] {
    let radius = x.hypot(y);
    // The wedge about one axis: the signed radius along it, and the angle across.
    let wedge = |along: f64, across: f64| {
        let radius = radius.copysign(along);
        [radius, radius * ((across / along).atan() / FRAC_PI_4)]
    };
    let [a, b] = if x.abs() > y.abs() {
        wedge(x, y)
    } else if y != 0.0 {
        let [b, a] = wedge(y, x);
        [a, b]
    } else {
        [0.0, 0.0]
    };
    [a, b].map(|v| unit(0.5 * (v + 1.0)))
}
