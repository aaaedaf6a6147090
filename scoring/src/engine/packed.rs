//! Columns of modes packed for vector registers: eight modes side by side, real parts before imaginary parts.
//!
//! The components of the lifted axis follow one another, so that a product is summed over them in registers.

use crate::transform::Real;
use crate::transform::modes::{Column, ModeSet};
use num_complex::Complex;
use std::ops::Range;

/// Modes in a packet.
pub(super) const LANES: usize = 8;

/// Eight modes of one component.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Packet<T> {
    re: [T; LANES],
    im: [T; LANES],
}

impl<T: Real> Packet<T> {
    /// All zero.
    pub fn zero() -> Self {
        Self {
            re: [T::zero(); LANES],
            im: [T::zero(); LANES],
        }
    }

    /// Separates the parts of eight values.
    #[inline(always)]
    pub fn of(values: &[Complex<T>; LANES]) -> Self {
        Self {
            re: std::array::from_fn(|lane| values[lane].re),
            im: std::array::from_fn(|lane| values[lane].im),
        }
    }

    /// The same of values in falling order.
    #[inline(always)]
    pub fn reversed(values: &[Complex<T>; LANES]) -> Self {
        Self {
            re: std::array::from_fn(|lane| values[LANES - 1 - lane].re),
            im: std::array::from_fn(|lane| values[LANES - 1 - lane].im),
        }
    }

    /// The value in a lane.
    #[cfg(feature = "gpu")]
    pub fn get(&self, lane: usize) -> Complex<T> {
        Complex::new(self.re[lane], self.im[lane])
    }

    /// The eight values.
    #[inline(always)]
    pub fn values(&self) -> [Complex<T>; LANES] {
        std::array::from_fn(|lane| Complex::new(self.re[lane], self.im[lane]))
    }

    /// The eight values in falling order.
    #[inline(always)]
    pub fn falling(&self) -> [Complex<T>; LANES] {
        std::array::from_fn(|lane| {
            let lane = LANES - 1 - lane;
            Complex::new(self.re[lane], self.im[lane])
        })
    }

    /// Writes a lane.
    pub fn set(&mut self, lane: usize, value: Complex<T>) {
        (self.re[lane], self.im[lane]) = (value.re, value.im);
    }
}

/// Places of the packets of each column: [column][half][packet][component].
///
/// The first half of a column holds kx = 0, 1, ..., `kx_max`, the second 0, -1, ..., -`kx_max`: a column in falling
/// order is the same packets with the halves exchanged. The filling of the last packet of a half is never read.
#[derive(Clone, Debug)]
pub(super) struct Packing {
    /// For each column the packets before it, for one component; then their number.
    starts: Vec<u32>,
}

impl Packing {
    pub fn new(modes: &ModeSet) -> Self {
        let mut starts = vec![0];
        let mut count = 0;
        for column in &modes.columns {
            count += 2 * packets_of_half(column) as u32;
            starts.push(count);
        }
        Self { starts }
    }

    /// Packets of one component.
    pub fn count(&self) -> usize {
        self.starts.last().map_or(0, |&count| count as usize)
    }

    /// The packets of a column, of all `components`.
    #[inline(always)]
    pub fn range(&self, column: usize, components: usize) -> Range<usize> {
        components * self.starts[column] as usize..components * self.starts[column + 1] as usize
    }
}

/// Packets of half a column, kx = 0 to `kx_max`.
#[inline(always)]
pub(super) fn packets_of_half(column: &Column) -> usize {
    (column.kx_max as usize + 1).div_ceil(LANES)
}

/// Sums over the components of a b (`CONJUGATED` false) or a conj(b) (true), mode by mode.
///
/// The sums stay packed: written as complex numbers here, the compiler would shuffle each component's parts.
#[inline(always)]
pub(super) fn products<T: Real, const CONJUGATED: bool>(
    components: usize,
    a: &[Packet<T>],
    b: &[Packet<T>],
    sums: &mut [Packet<T>],
) {
    let packets = a.chunks_exact(components).zip(b.chunks_exact(components));
    for ((a, b), sum) in packets.zip(sums) {
        let (mut re, mut im) = ([T::zero(); LANES], [T::zero(); LANES]);
        for (a, b) in a.iter().zip(b) {
            for (lane, re) in re.iter_mut().enumerate() {
                let (same, cross) = (a.re[lane] * b.re[lane], a.im[lane] * b.im[lane]);
                *re += if CONJUGATED {
                    same + cross
                } else {
                    same - cross
                };
            }
            for (lane, im) in im.iter_mut().enumerate() {
                let (back, forth) = (a.im[lane] * b.re[lane], a.re[lane] * b.im[lane]);
                *im += if CONJUGATED {
                    back - forth
                } else {
                    back + forth
                };
            }
        }
        *sum = Packet { re, im };
    }
}
