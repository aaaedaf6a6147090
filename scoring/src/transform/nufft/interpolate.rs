//! Values at points from the rows of the fine grid: the adjoint of `spread`.

use super::super::Real;
use super::{Plan, SortedPoints};
use num_complex::Complex;

impl<T: Real, const D: usize> Plan<T, D> {
    /// Reads the values of the sorted points `range` off the ring. `NUMBERS` = 2 x `LANES`.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    pub(super) fn interpolate<const LANES: usize, const NUMBERS: usize>(
        &self,
        points: &SortedPoints<D>,
        range: std::ops::Range<usize>,
        slots: &[usize],
        row: usize,
        footprint: &mut Vec<(usize, T)>,
        ring: &[T],
        values: &mut [Complex<T>],
    ) {
        let height = self.grid.widths[2];
        for (low, &index) in points.low[range.clone()].iter().zip(&points.order[range]) {
            let stencil = self.stencil::<LANES, 2>(low, slots, row, footprint);
            let mut sums = [T::zero(); NUMBERS];
            for &(offset, share) in footprint.iter() {
                for &(place, value) in &stencil.rows[..height] {
                    let factor = share * value;
                    let start = offset + place + stencil.start;
                    if let Some(source) = ring[start..].first_chunk::<NUMBERS>() {
                        for (sum, part) in sums.iter_mut().zip(source) {
                            *sum += factor * *part;
                        }
                    }
                }
            }
            let mut total = Complex::new(T::zero(), T::zero());
            for lane in 0..LANES {
                total.re += sums[2 * lane] * stencil.along[lane];
                total.im += sums[2 * lane + 1] * stencil.along[lane];
            }
            values[index as usize] = total;
        }
    }
}
