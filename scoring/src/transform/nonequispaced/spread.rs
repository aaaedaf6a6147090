//! Points onto the rows of the fine grid: the adjoint of `interpolate`.

use super::super::Real;
use super::{Located, Plan};

/// Where a point's window stands: rows of the grid with their shares.
pub(super) struct Stencil<T, const LANES: usize> {
    /// First number of the window in a row.
    pub(super) start: usize,
    /// Window values along axis 1.
    pub(super) along: [T; LANES],
    /// Offsets of rows along axis 2 and their window values.
    pub(super) rows: [(usize, T); LANES],
}

impl<T: Real, const D: usize> Plan<T, D> {
    /// Fills `footprint` with the window on axis 0 and the axes from 3 on, and returns its rest.
    #[inline(always)]
    pub(super) fn stencil<const LANES: usize, const PARTS: usize>(
        &self,
        low: &[f64; D],
        slots: &[usize],
        row: usize,
        footprint: &mut Vec<(usize, T)>,
    ) -> Stencil<T, LANES> {
        let fine = &self.grid.fine;
        let on_axis = |axis: usize| {
            if self.grid.widths[axis] == 1 {
                let mut values = [T::zero(); LANES];
                values[0] = T::one();
                (0, values)
            } else {
                self.window.values::<LANES>(low[axis])
            }
        };
        let (first, values) = on_axis(0);
        footprint.clear();
        footprint.extend(
            slots[first..first + self.grid.widths[0]]
                .iter()
                .copied()
                .zip(values),
        );
        let mut stride = row * fine[2];
        for axis in 3..D {
            let (first, values) = on_axis(axis);
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
        let (first, values) = on_axis(2);
        let mut rows = [(0, T::zero()); LANES];
        for lane in 0..self.grid.widths[2] {
            rows[lane] = (wrap(first + lane, fine[2]) * row, values[lane]);
        }
        let (first, along) = on_axis(1);
        Stencil {
            start: PARTS * first,
            along,
            rows,
        }
    }

    /// Adds the sorted points `range` to the ring. `PARTS` numbers make a weight; `NUMBERS` = `PARTS` x `LANES`.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    pub(super) fn spread<const LANES: usize, const PARTS: usize, const NUMBERS: usize>(
        &self,
        points: &Located<D>,
        range: std::ops::Range<usize>,
        weight: impl Fn(usize) -> [T; PARTS],
        slots: &[usize],
        row: usize,
        footprint: &mut Vec<(usize, T)>,
        ring: &mut [T],
    ) {
        let height = self.grid.widths[2];
        for (low, &index) in points.low[range.clone()].iter().zip(&points.order[range]) {
            let stencil = self.stencil::<LANES, PARTS>(low, slots, row, footprint);
            let weight = weight(index as usize);
            let mut line = [T::zero(); NUMBERS];
            for lane in 0..LANES {
                for part in 0..PARTS {
                    line[PARTS * lane + part] = weight[part] * stencil.along[lane];
                }
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
