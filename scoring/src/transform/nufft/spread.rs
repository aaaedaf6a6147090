//! Points onto the rows of the fine grid: the adjoint of `interpolate`.

use super::super::Real;
use super::super::spreading::MAX_WIDTH;
use super::{Plan, SortedPoints, Workspace};
use num_complex::Complex;

/// A point's window: rows of the grid with their shares.
pub(super) struct Stencil<T, const LANES: usize> {
    /// First number of the window in a row.
    pub(super) start: usize,
    /// Window values along axis 1.
    pub(super) along: [T; LANES],
    /// Offsets of rows along axis 2 and their window values.
    pub(super) rows: [(usize, T); LANES],
}

impl<T: Real, const D: usize> Plan<T, D> {
    /// First grid point and values of a point's window on one axis.
    #[inline(always)]
    fn on_axis<const LANES: usize>(&self, low: &[f64; D], axis: usize) -> (usize, [T; LANES]) {
        if self.grid.widths[axis] == 1 {
            let mut values = [T::zero(); LANES];
            values[0] = T::one();
            return (0, values);
        }
        self.window.values::<LANES>(low[axis])
    }

    /// Fills `footprint` with the window on axis 0 and the axes from 3 on, and returns its rest.
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // `lane` counts from the window's first point
    pub(super) fn stencil<const LANES: usize>(
        &self,
        low: &[f64; D],
        slots: &[usize],
        row: usize,
        footprint: &mut Vec<(usize, T)>,
    ) -> Stencil<T, LANES> {
        let fine = &self.grid.fine;
        let (first, values) = self.on_axis::<LANES>(low, 0);
        footprint.clear();
        footprint.extend(
            slots[first..first + self.grid.widths[0]]
                .iter()
                .copied()
                .zip(values),
        );
        let mut stride = row * fine[2];
        for axis in 3..D {
            let (first, values) = self.on_axis::<LANES>(low, axis);
            let before = footprint.len();
            for (lane, &value) in values[..self.grid.widths[axis]].iter().enumerate().skip(1) {
                let place = wrap(first + lane, fine[axis]) * stride;
                for index in 0..before {
                    let (offset, share) = footprint[index];
                    footprint.push((offset + place, share * value));
                }
            }
            let place = first * stride;
            for entry in &mut footprint[..before] {
                *entry = (entry.0 + place, entry.1 * values[0]);
            }
            stride *= fine[axis];
        }
        let (first, values) = self.on_axis::<LANES>(low, 2);
        let mut rows = [(0, T::zero()); LANES];
        for lane in 0..self.grid.widths[2] {
            rows[lane] = (wrap(first + lane, fine[2]) * row, values[lane]);
        }
        let (first, along) = self.on_axis(low, 1);
        Stencil {
            start: 2 * first,
            along,
            rows,
        }
    }

    /// Adds the sorted points `range` to the workspace's ring, by the kernel for the window's width, rounded up to even.
    #[inline(always)]
    pub(super) fn spread_by_width(
        &self,
        points: &SortedPoints<D>,
        range: std::ops::Range<usize>,
        weights: &[Complex<T>],
        work: &mut Workspace<T, D>,
    ) {
        let Workspace {
            slots,
            footprint,
            ring,
            row,
            ..
        } = work;
        macro_rules! with_lanes {
            ($($lanes:literal)*) => {
                match self.window.width.next_multiple_of(2) {
                    $($lanes => self.spread::<$lanes, { 2 * $lanes }>(points, range, weights, slots, *row, footprint, ring),)*
                    _ => unreachable!("a plan's windows are 2 to {MAX_WIDTH} points wide"),
                }
            };
        }
        with_lanes!(2 4 6 8 10 12 14 16);
    }

    /// Adds the sorted points `range` to the ring. `NUMBERS` = 2 x `LANES`.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn spread<const LANES: usize, const NUMBERS: usize>(
        &self,
        points: &SortedPoints<D>,
        range: std::ops::Range<usize>,
        weights: &[Complex<T>],
        slots: &[usize],
        row: usize,
        footprint: &mut Vec<(usize, T)>,
        ring: &mut [T],
    ) {
        let height = self.grid.widths[2];
        for (low, &index) in points.low[range.clone()].iter().zip(&points.order[range]) {
            let stencil = self.stencil::<LANES>(low, slots, row, footprint);
            let weight = weights[index as usize];
            let mut line = [T::zero(); NUMBERS];
            for lane in 0..LANES {
                line[2 * lane] = weight.re * stencil.along[lane];
                line[2 * lane + 1] = weight.im * stencil.along[lane];
            }
            for &(offset, share) in footprint.iter() {
                for &(place, value) in &stencil.rows[..height] {
                    let factor = share * value;
                    let start = offset + place + stencil.start;
                    if let Some(target) = ring[start..].first_chunk_mut::<NUMBERS>() {
                        for (sum, part) in target.iter_mut().zip(&line) {
                            *sum += factor * *part;
                        }
                    }
                }
            }
        }
    }
}

/// An index that runs less than once around the period.
#[inline(always)]
fn wrap(index: usize, size: usize) -> usize {
    if index >= size { index - size } else { index }
}

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
            let stencil = self.stencil::<LANES>(low, slots, row, footprint);
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
