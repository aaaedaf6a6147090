//! Products of columns of modes, the ligand's read as a turn of the grid leaves it.
//!
//! With F a turn, B(w; F R) = B(F^-1 w; R): the transform of the turned ligand is that of the ligand itself, read from
//! other columns.

use super::packed::{LANES, Packet, products};
use crate::grid_turn::GridTurn;
use crate::transform::Real;
use crate::transform::modes::ModeSet;
use num_complex::Complex;

/// The source of a column of the turned ligand's transform, in the half of the modes that is kept: kz >= 0, with B(-w)
/// = B*(w).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Reading {
    /// Index of the column.
    pub column: u32,
    /// From kx = kx_max down.
    reversed: bool,
    /// Conjugated.
    conjugate: bool,
}

impl Reading {
    /// The readings of all columns.
    pub fn after(turn: GridTurn, modes: &ModeSet) -> Vec<Self> {
        let read = |column: &crate::transform::modes::Column| {
            let [x, y, z] = turn.source([1, column.ky, column.kz]);
            let conjugate = z < 0;
            let sign = if conjugate { -1 } else { 1 };
            let range = &modes.planes[(sign * z) as usize];
            // ky comes as 0, 1, ..., n, -n, ..., -1.
            let ky = sign * y;
            let start = if ky < 0 { range.end } else { range.start };
            let index = (start as i32 + ky) as usize;
            let found = &modes.columns[index];
            assert_eq!(
                (found.ky, found.kz, found.kx_max),
                (ky, sign * z, column.kx_max),
                "the turn does not map the modes onto themselves"
            );
            Self {
                column: index as u32,
                reversed: sign * x < 0,
                conjugate,
            }
        };
        modes.columns.iter().map(read).collect()
    }

    /// 1 from kx = kx_max down, 2 conjugated.
    #[cfg(feature = "gpu")]
    pub fn flags(self) -> u32 {
        u32::from(self.reversed) + 2 * u32::from(self.conjugate)
    }

    /// Writes sum_q a_q conj(b_q), with b so read, as a column in transform order. `a` and `b` hold a column, modes
    /// from kx = 0 up, then from 0 down; `sums` has room for one.
    #[inline(always)]
    pub fn multiply<T: Real>(
        self,
        components: usize,
        side: usize,
        [a, b]: [&[Packet<T>]; 2],
        sums: &mut [Packet<T>],
        column: &mut [Complex<T>],
    ) {
        let half = a.len() / 2;
        let ((a_up, a_down), (b_first, b_last)) = (a.split_at(half), b.split_at(half));
        let (b_up, b_down) = if self.reversed {
            (b_last, b_first)
        } else {
            (b_first, b_last)
        };
        let packets = half / components;
        let (up, down) = sums[..2 * packets].split_at_mut(packets);
        self.sum(components, a_up, b_up, up);
        self.sum(components, a_down, b_down, down);
        let (rising, rest) = column.split_at_mut(side + 1);
        let (gap, falling) = rest.split_at_mut(rest.len() - side);
        for (to, from) in rising.chunks_mut(LANES).zip(up) {
            let values = from.values();
            if to.len() == LANES {
                to.copy_from_slice(&values);
            } else {
                copy_few(to, &values);
            }
        }
        gap.fill(Complex::new(T::zero(), T::zero()));
        // kx = -1, ..., -side from the end; the first packet begins with kx = 0.
        let first = side.min(LANES - 1);
        let (before, nearest) = falling.split_at_mut(side - first);
        if let Some(from) = down.first() {
            let values = from.falling();
            copy_few(nearest, &values[LANES - 1 - first..]);
        }
        for (to, from) in before.rchunks_mut(LANES).zip(&down[1..]) {
            let values = from.falling();
            if to.len() == LANES {
                to.copy_from_slice(&values);
            } else {
                copy_few(to, &values[LANES - to.len()..]);
            }
        }
    }

    #[inline(always)]
    fn sum<T: Real>(
        self,
        components: usize,
        a: &[Packet<T>],
        b: &[Packet<T>],
        sums: &mut [Packet<T>],
    ) {
        if self.conjugate {
            products::<T, false>(components, a, b, sums);
        } else {
            products::<T, true>(components, a, b, sums);
        }
    }
}

/// Copies the first of `from` to all of `to`, fewer than eight, in pieces whose lengths the compiler knows: a call for
/// each takes longer than the copy.
#[inline(always)]
fn copy_few<C: Copy>(to: &mut [C], from: &[C]) {
    let (mut to, mut from) = (to, from);
    for length in [4, 2, 1] {
        if to.len() >= length {
            let (now, later) = to.split_at_mut(length);
            let (these, those) = from.split_at(length);
            for (to, from) in now.iter_mut().zip(these) {
                *to = *from;
            }
            (to, from) = (later, those);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn modes(size: [usize; 3]) -> ModeSet {
        ModeSet::new(size, size.map(|n| 2.0 * n as f64), 0.25)
    }

    /// Each mode's reading is the mode that the turn takes there, or its conjugate.
    #[test]
    fn readings_follow_the_turns() {
        let modes = modes([16, 20, 20]);
        for turn in GridTurn::ALL {
            let readings = Reading::after(turn, &modes);
            for (column, reading) in modes.columns.iter().zip(&readings) {
                let from = &modes.columns[reading.column as usize];
                for kx in -column.kx_max..=column.kx_max {
                    let source = turn.source([kx, column.ky, column.kz]);
                    let read = [if reading.reversed { -kx } else { kx }, from.ky, from.kz];
                    let sign = if reading.conjugate { -1 } else { 1 };
                    assert_eq!(source.map(|k| sign * k), read, "{turn:?}, {column:?}");
                }
            }
        }
    }
}
