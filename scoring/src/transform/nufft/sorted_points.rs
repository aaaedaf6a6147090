//! Points wrapped into the period and sorted in the order in which the fine grid is walked.

use super::TransformError;

/// Cells of a bin on every axis but the first, whose bins are the plan's slabs.
const BIN: usize = 8;

/// Points in cells of one plan's fine grid, sorted; made by [`super::Plan::locate`].
#[derive(Clone, Debug)]
pub struct SortedPoints<const D: usize> {
    /// Place of each sorted point in the caller's order.
    pub(super) order: Vec<u32>,
    /// Lower end of each sorted point's window in cells; its ceiling is the first grid point, in 0..fine.
    pub(super) low: Vec<[f64; D]>,
    /// Start of each slab among the sorted points, and their number at the end.
    pub(super) slabs: Vec<usize>,
    pub(super) grid: Grid<D>,
    keys: Vec<u32>,
    unsorted: Vec<[f64; D]>,
    starts: Vec<u32>,
}

/// Quantities that the order of points depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grid<const D: usize> {
    pub(super) fine: [usize; D],
    pub(super) widths: [usize; D],
    pub(super) slab: usize,
}

impl<const D: usize> SortedPoints<D> {
    pub(super) fn new(grid: Grid<D>) -> Self {
        Self {
            order: Vec::new(),
            low: Vec::new(),
            slabs: Vec::new(),
            grid,
            keys: Vec::new(),
            unsorted: Vec::new(),
            starts: Vec::new(),
        }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.order.is_empty()
    }

    /// Counting sort by slab, then by bin in the order of the grid's memory. Stable, so that results do not depend on
    /// chance.
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // an axis indexes the point, the grid and the bins alike
    pub(super) fn set(&mut self, points: &[[f64; D]]) -> Result<(), TransformError> {
        let count = points.len();
        if u32::try_from(count).is_err() {
            return Err(TransformError::TooManyPoints { count });
        }
        let Grid { fine, widths, slab } = self.grid;
        let bins: [usize; D] =
            std::array::from_fn(|axis| fine[axis].div_ceil(if axis == 0 { slab } else { BIN }));
        let per_slab: usize = bins[1..].iter().product();
        self.starts.clear();
        self.starts.resize(bins[0] * per_slab + 1, 0);
        self.keys.clear();
        self.unsorted.clear();
        for (index, point) in points.iter().enumerate() {
            let mut low = [0.0; D];
            let mut bin = [0usize; D];
            for axis in 0..D {
                let value = point[axis];
                if !value.is_finite() {
                    return Err(TransformError::Point { index, axis, value });
                }
                if widths[axis] == 1 {
                    continue;
                }
                let size = fine[axis] as f64;
                let mut start = (value - value.floor()) * size - 0.5 * widths[axis] as f64;
                if start <= -1.0 {
                    start += size;
                }
                if start > size - 1.0 {
                    start -= size;
                }
                low[axis] = start;
                bin[axis] = start.ceil() as usize / if axis == 0 { slab } else { BIN };
            }
            let mut key = bin[0];
            for axis in (1..D).rev() {
                key = key * bins[axis] + bin[axis];
            }
            self.starts[key + 1] += 1;
            self.keys.push(key as u32);
            self.unsorted.push(low);
        }
        for bin in 1..self.starts.len() {
            self.starts[bin] += self.starts[bin - 1];
        }
        self.slabs.clear();
        self.slabs.extend(
            self.starts
                .iter()
                .step_by(per_slab)
                .map(|&start| start as usize),
        );
        self.order.clear();
        self.order.resize(count, 0);
        self.low.clear();
        self.low.resize(count, [0.0; D]);
        for (index, (&key, low)) in self.keys.iter().zip(&self.unsorted).enumerate() {
            let target = &mut self.starts[key as usize];
            self.order[*target as usize] = index as u32;
            self.low[*target as usize] = *low;
            *target += 1;
        }
        Ok(())
    }
}
