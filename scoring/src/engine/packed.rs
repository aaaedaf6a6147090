//! Columns of modes packed for vector registers: eight modes side by side, real parts before imaginary parts.
//!
//! The components of the lifted axis follow one another, so that a product is summed over them in registers.

use crate::transform::Real;
use crate::transform::modes::ModeSet;
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

    /// Separates the parts of eight values; where they are fewer, zeros follow.
    #[inline(always)]
    pub fn of(values: &[Complex<T>]) -> Self {
        let mut packet = Self::zero();
        for (lane, value) in values.iter().enumerate().take(LANES) {
            packet.re[lane] = value.re;
            packet.im[lane] = value.im;
        }
        packet
    }

    /// The value in a lane.
    pub fn get(&self, lane: usize) -> Complex<T> {
        Complex::new(self.re[lane], self.im[lane])
    }

    /// Writes a lane.
    fn set(&mut self, lane: usize, value: Complex<T>) {
        (self.re[lane], self.im[lane]) = (value.re, value.im);
    }
}

/// Where the packets of each column lie: [column][packet][component].
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
            count += column.len().div_ceil(LANES) as u32;
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

/// Packets with the modes of each column in falling order.
pub(super) fn reversed<T: Real>(
    modes: &ModeSet,
    packing: &Packing,
    components: usize,
    packets: &[Packet<T>],
) -> Vec<Packet<T>> {
    let mut turned_round = vec![Packet::zero(); packets.len()];
    for (index, column) in modes.columns.iter().enumerate() {
        let range = packing.range(index, components);
        let (from, to) = (&packets[range.clone()], &mut turned_round[range]);
        let last = column.len() - 1;
        for (place, opposite) in (0..=last).zip((0..=last).rev()) {
            for component in 0..components {
                let value = from[opposite / LANES * components + component].get(opposite % LANES);
                to[place / LANES * components + component].set(place % LANES, value);
            }
        }
    }
    turned_round
}

/// Sums over the components of a b (`CONJUGATED` false) or a conj(b) (true), mode by mode.
#[inline(always)]
pub(super) fn products<T: Real, const CONJUGATED: bool>(
    components: usize,
    a: &[Packet<T>],
    b: &[Packet<T>],
    sums: &mut [Complex<T>],
) {
    let packets = a.chunks_exact(components).zip(b.chunks_exact(components));
    for ((a, b), sums) in packets.zip(sums.chunks_exact_mut(LANES)) {
        let mut sum = Packet::zero();
        for (a, b) in a.iter().zip(b) {
            for lane in 0..LANES {
                let (same, cross) = (a.re[lane] * b.re[lane], a.im[lane] * b.im[lane]);
                let (back, forth) = (a.im[lane] * b.re[lane], a.re[lane] * b.im[lane]);
                sum.re[lane] += if CONJUGATED {
                    same + cross
                } else {
                    same - cross
                };
                sum.im[lane] += if CONJUGATED {
                    back - forth
                } else {
                    back + forth
                };
            }
        }
        for (lane, value) in sums.iter_mut().enumerate() {
            *value = Complex::new(sum.re[lane], sum.im[lane]);
        }
    }
}
