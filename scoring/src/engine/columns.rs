//! Products of columns of modes, the ligand's read as a half-turn of the grid leaves it.

use super::packed::{Packet, products};
use crate::se3::HalfTurn;
use crate::transform::Real;
use num_complex::Complex;

/// How the ligand's transform B(F w), F a half-turn, is read off the half of the modes that is kept, kz >= 0, with
/// B(-w) = conj B(w).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Reading {
    /// From the column with -ky.
    pub mirrored: bool,
    /// From kx = kx_max down.
    pub reversed: bool,
    /// Conjugated.
    conjugate: bool,
}

impl Reading {
    pub fn after(half_turn: HalfTurn) -> Self {
        let (mirrored, reversed, conjugate) = match half_turn {
            HalfTurn::None => (false, false, false),
            HalfTurn::X => (false, true, true),
            HalfTurn::Y => (true, false, true),
            HalfTurn::Z => (true, true, false),
        };
        Self {
            mirrored,
            reversed,
            conjugate,
        }
    }

    /// 1 mirrored, 2 reversed, 4 conjugated.
    #[cfg(feature = "gpu")]
    pub fn bits(self) -> u32 {
        u32::from(self.mirrored) + 2 * u32::from(self.reversed) + 4 * u32::from(self.conjugate)
    }

    /// Writes sum_q a_q conj(b_q), with b so read, as a column in transform order. `a` and `b` run from kx = -`side` to
    /// `side`, `a` the other way where b is [`Self::reversed`]; `sums` has room for their packets.
    #[inline(always)]
    pub fn multiply<T: Real>(
        self,
        components: usize,
        side: usize,
        [a, b]: [&[Packet<T>]; 2],
        sums: &mut [Complex<T>],
        column: &mut [Complex<T>],
    ) {
        if self.conjugate {
            products::<T, false>(components, a, b, sums);
        } else {
            products::<T, true>(components, a, b, sums);
        }
        let low = column.len() - side;
        let (first, last) = sums[..=2 * side].split_at(side);
        column[side + 1..low].fill(Complex::new(T::zero(), T::zero()));
        if self.reversed {
            // The sum at -kx belongs to kx: the middle one is first, and those before it follow.
            column[0] = last[0];
            for (to, from) in column[1..=side].iter_mut().zip(first.iter().rev()) {
                *to = *from;
            }
            for (to, from) in column[low..].iter_mut().zip(last[1..].iter().rev()) {
                *to = *from;
            }
        } else {
            column[..=side].copy_from_slice(last);
            column[low..].copy_from_slice(first);
        }
    }
}
