//! Products of columns of modes, the ligand's read as a half-turn of the grid leaves it.

use crate::se3::HalfTurn;
use crate::transform::Real;
use num_complex::Complex;

/// How the ligand's transform B(F w), F a half-turn, is read off the half of the modes that is kept, kz >= 0, with B(-w) = conj B(w).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Reading {
    /// From the column with -ky.
    pub mirrored: bool,
    /// From kx = kx_max down.
    reversed: bool,
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

    /// Adds a conj(b), with b so read, to a column in transform order: `a` and `b` run from kx = -kx_max to kx_max, `sum` is as
    /// long as the inverse transform.
    #[inline(always)]
    pub fn multiply_add<T: Real>(self, sum: &mut [Complex<T>], a: &[Complex<T>], b: &[Complex<T>]) {
        let side = a.len() / 2;
        let low = sum.len() - side;
        let sign = if self.conjugate { T::one() } else { -T::one() };
        if self.reversed {
            multiply_add(&mut sum[low..], &a[..side], b.iter().rev(), sign);
            multiply_add(&mut sum[..=side], &a[side..], b[..=side].iter().rev(), sign);
        } else {
            multiply_add(&mut sum[low..], &a[..side], b.iter(), sign);
            multiply_add(&mut sum[..=side], &a[side..], b[side..].iter(), sign);
        }
    }
}

/// sum += a b (`sign` 1) or a conj(b) (`sign` -1), element by element.
#[inline(always)]
fn multiply_add<'a, T: Real>(
    sum: &mut [Complex<T>],
    a: &[Complex<T>],
    b: impl Iterator<Item = &'a Complex<T>>,
    sign: T,
) {
    for ((sum, a), b) in sum.iter_mut().zip(a).zip(b) {
        let imaginary = sign * b.im;
        sum.re += a.re * b.re - a.im * imaginary;
        sum.im += a.im * b.re + a.re * imaginary;
    }
}
