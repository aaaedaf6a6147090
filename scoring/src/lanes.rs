//! Loops over eight numbers at once. Each is one operation, so that the compiler makes it one vector instruction.

use crate::blocks::LANES;
use std::ops::Add;

/// 1.5 * 2^52: added to a number below 2^31 in size, it leaves that number, rounded, in the sum's low bits.
pub(crate) const ROUNDING: f64 = 6755399441055744.0;

/// A value for each lane.
#[inline(always)]
pub(crate) fn each<T: Copy + Default>(value: impl Fn(usize) -> T) -> [T; LANES] {
    let mut lanes = [T::default(); LANES];
    for (index, lane) in lanes.iter_mut().enumerate() {
        *lane = value(index);
    }
    lanes
}

/// Sum of the lanes, by halves.
#[inline(always)]
pub(crate) fn total<T: Copy + Add<Output = T>>(lanes: &[T; LANES]) -> T {
    let [a, b, c, d, e, f, g, h] = *lanes;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}
