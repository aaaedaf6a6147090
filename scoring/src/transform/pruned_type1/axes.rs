//! The three one-dimensional transforms of a spread block, which is real.
//!
//! Two planes of the block, x and x + 1, go through the transforms along z and y as one complex plane X = A + iB. The
//! spectra of real planes obey A(-k) = A*(k), so that A(k) = (X(k) + X*(-k)) / 2 and B(k) = (X(k) - X*(-k)) / 2i: they
//! are separated as columns are gathered for the transform along x.
//!
//! Every transform reads lines whose ends, beyond the block, stay zero: it leaves its input as it is.

use super::{Forward, ForwardWorkspace, PAIRS};
use crate::transform::Real;
use crate::transform::spreading::MAX_WIDTH;
use crate::transform::transpose::transpose;
use num_complex::Complex;

impl<T: Real> Forward<T> {
    /// Transforms a component of the spread block along z and y; [`Self::columns`] then does x, column by column.
    #[inline(always)]
    pub fn planes(&self, component: usize, work: &mut ForwardWorkspace<T>) {
        let bx = self.block[0];
        let length = self.lines_of_plane() * self.fine[1];
        for first in (0..bx).step_by(2 * PAIRS) {
            let pairs = PAIRS.min((bx - first) / 2);
            for pair in 0..pairs {
                self.plane_along_z(component * bx + first + 2 * pair, work);
                self.along_y.process_immutable_with_scratch(
                    &work.lines,
                    &mut work.line_spectra[pair * length..(pair + 1) * length],
                    &mut work.scratch,
                );
            }
            if pairs == PAIRS {
                self.separate::<PAIRS>(0, first, work);
            } else {
                for pair in 0..pairs {
                    self.separate::<1>(pair, first + 2 * pair, work);
                }
            }
        }
    }

    /// Lines along y of a pair of planes: kz = 0, 1, ..., then the negative ones, rising.
    pub(super) fn lines_of_plane(&self) -> usize {
        2 * self.modes.planes.len() - 1
    }

    /// Transforms planes `plane` and the next, of all components, along z, into lines along y.
    #[inline(always)]
    fn plane_along_z(&self, plane: usize, work: &mut ForwardWorkspace<T>) {
        let [_, by, bz] = self.block;
        let [_, my, mz] = self.fine;
        let stride = bz + MAX_WIDTH;
        let count = self.modes.planes.len();
        let (even, odd) =
            work.block[plane * by * stride..][..2 * by * stride].split_at(by * stride);
        let rows = even.chunks_exact(stride).zip(odd.chunks_exact(stride));
        for (out, (even, odd)) in work.rows.chunks_exact_mut(mz).zip(rows) {
            for ((value, &re), &im) in out[..bz].iter_mut().zip(even).zip(odd) {
                *value = Complex::new(re, im);
            }
        }
        self.along_z.process_immutable_with_scratch(
            &work.rows,
            &mut work.row_spectra,
            &mut work.scratch,
        );
        let (not_negative, negative) = work.lines.split_at_mut(count * my);
        let spectra = &work.row_spectra[..];
        transpose((spectra, not_negative), by, 0..count, [mz, my]);
        transpose((spectra, negative), by, mz + 1 - count..mz, [mz, my]);
    }

    /// Gathers columns along x, from x = `first` on, from `N` of the pairs of planes that are held, from `at` on.
    #[inline(always)]
    fn separate<const N: usize>(&self, at: usize, first: usize, work: &mut ForwardWorkspace<T>) {
        let (mx, my) = (self.fine[0], self.fine[1]);
        let lines = self.lines_of_plane();
        for (kz, range) in self.modes.planes.iter().enumerate() {
            let opposite = if kz == 0 { 0 } else { lines - kz };
            let line = |pair: usize, index: usize| {
                let start = ((at + pair) * lines + index) * my;
                &work.line_spectra[start..start + my]
            };
            let up: [&[Complex<T>]; N] = std::array::from_fn(|pair| line(pair, kz));
            let down: [&[Complex<T>]; N] = std::array::from_fn(|pair| line(pair, opposite));
            // ky comes as 0, 1, ..., n, -n, ..., -1.
            let highest = range.len() / 2;
            let (rising, falling) =
                work.columns[range.start * mx..range.end * mx].split_at_mut((highest + 1) * mx);
            for (ky, column) in rising.chunks_exact_mut(mx).enumerate() {
                let mirror = if ky == 0 { 0 } else { my - ky };
                let run = column[first..first + 2 * N].chunks_exact_mut(2);
                for (pair, values) in run.enumerate() {
                    [values[0], values[1]] = separated(up[pair][ky], down[pair][mirror]);
                }
            }
            for (index, column) in falling.chunks_exact_mut(mx).enumerate() {
                let ky = highest - index;
                let run = column[first..first + 2 * N].chunks_exact_mut(2);
                for (pair, values) in run.enumerate() {
                    [values[0], values[1]] = separated(up[pair][my - ky], down[pair][ky]);
                }
            }
        }
    }

    /// Transforms columns `range` of the component that [`Self::planes`] was last called for along x into `lines`, laid
    /// out `[column][kx place in 0..fine_x]`.
    #[inline(always)]
    pub fn columns(
        &self,
        range: std::ops::Range<usize>,
        work: &mut ForwardWorkspace<T>,
        lines: &mut [Complex<T>],
    ) {
        let mx = self.fine[0];
        self.along_x.process_immutable_with_scratch(
            &work.columns[range.start * mx..range.end * mx],
            &mut lines[..range.len() * mx],
            &mut work.scratch,
        );
    }
}

/// A and B at k of X = A + iB, from X(k) and X(-k).
#[inline(always)]
fn separated<T: Real>(x: Complex<T>, opposite: Complex<T>) -> [Complex<T>; 2] {
    let half = T::of(0.5);
    [
        Complex::new(half * (x.re + opposite.re), half * (x.im - opposite.im)),
        Complex::new(half * (x.im + opposite.im), half * (opposite.re - x.re)),
    ]
}
