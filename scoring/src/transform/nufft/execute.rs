//! The calls of a plan: sorting points, and the transforms.

use super::super::Real;
use super::sorted_points::Grid;
use super::{FIRST_GROUP, Plan, SortedPoints, TransformError};
use crate::vectorized::vectorize;
use num_complex::Complex;

impl<T: Real, const D: usize> Plan<T, D> {
    /// Buffers for transforms by this plan; executions allocate nothing.
    pub fn workspace(&self) -> Workspace<T, D> {
        Workspace::new(self)
    }

    /// Folds and sorts points (in units of the period) for transforms by this plan.
    ///
    /// # Errors
    /// [`TransformError`] when a coordinate is not finite or there are more than 2^32 - 1 points.
    pub fn locate(&self, points: &[[f64; D]]) -> Result<SortedPoints<D>, TransformError> {
        let mut sorted = SortedPoints::new(self.grid);
        self.locate_into(points, &mut sorted)?;
        Ok(sorted)
    }

    /// As [`Self::locate`], into memory that is there: nothing is allocated for no more points than were there before.
    ///
    /// # Errors
    /// As [`Self::locate`]; after one, `sorted` must not be used until points have been set.
    pub fn locate_into(
        &self,
        points: &[[f64; D]],
        sorted: &mut SortedPoints<D>,
    ) -> Result<(), TransformError> {
        sorted.grid = self.grid;
        vectorize!(sorted.set(points))
    }

    /// Type 1, points to modes: `output[k] = sum_j weights[j] exp(-2 pi i k.x_j)`.
    ///
    /// # Errors
    /// [`TransformError`] when an array has another length than points or modes, or belongs to another plan.
    pub fn forward(
        &self,
        points: &SortedPoints<D>,
        weights: &[Complex<T>],
        work: &mut Workspace<T, D>,
        output: &mut [Complex<T>],
    ) -> Result<(), TransformError> {
        self.check(points, weights.len(), output.len(), work)?;
        vectorize!(self.run_forward(points, weights, work, output));
        Ok(())
    }

    /// Type 2, modes to values at the points: `values[j] = sum_k modes[k] exp(+2 pi i k.x_j)`.
    ///
    /// # Errors
    /// As [`Self::forward`].
    pub fn adjoint(
        &self,
        points: &SortedPoints<D>,
        modes: &[Complex<T>],
        work: &mut Workspace<T, D>,
        values: &mut [Complex<T>],
    ) -> Result<(), TransformError> {
        self.check(points, values.len(), modes.len(), work)?;
        vectorize!(self.run_adjoint(points, modes, work, values));
        Ok(())
    }

    fn check(
        &self,
        points: &SortedPoints<D>,
        values: usize,
        modes: usize,
        work: &Workspace<T, D>,
    ) -> Result<(), TransformError> {
        if points.grid != self.grid {
            return Err(TransformError::Foreign { what: "the points" });
        }
        if work.grid != self.grid || work.modes != self.modes {
            return Err(TransformError::Foreign {
                what: "the workspace",
            });
        }
        for (what, expected, got) in [
            ("the array of weights or values", points.len(), values),
            ("the array of modes", self.mode_count(), modes),
        ] {
            if expected != got {
                return Err(TransformError::Length {
                    what,
                    expected,
                    got,
                });
            }
        }
        Ok(())
    }
}

/// Buffers that belong to one plan and serve one transform at a time; made by [`Plan::workspace`].
#[derive(Clone, Debug)]
pub struct Workspace<T, const D: usize> {
    pub(super) grid: Grid<D>,
    pub(super) modes: [usize; D],
    /// Fine planes in use, [slot][axis D-1]...[axis 2][axis 1], re and im interleaved, axis 1 padded by the lanes of a
    /// window.
    pub(super) ring: Vec<T>,
    /// Whether `ring` holds anything but zeros between two executions.
    pub(super) used: bool,
    /// Place of each plane 0..fine + width of the first axis in `ring`.
    pub(super) slots: Vec<usize>,
    /// Rows that a point's window touches on all axes but 1 and 2: offset and product of window values.
    pub(super) footprint: Vec<(usize, T)>,
    /// A plane between two of its transforms.
    pub(super) planes: [Vec<Complex<T>>; 2],
    /// [plane][modes of the axes but the first].
    pub(super) middle: Vec<Complex<T>>,
    pub(super) lines: Vec<Complex<T>>,
    pub(super) scratch: Vec<Complex<T>>,
    /// Numbers of the precision from one row to the next, and from one plane to the next.
    pub(super) row: usize,
    pub(super) plane: usize,
}

impl<T: Real, const D: usize> Workspace<T, D> {
    pub(super) fn new(plan: &Plan<T, D>) -> Self {
        let zero = Complex::new(T::zero(), T::zero());
        let grid = plan.grid;
        let Grid { fine, widths, slab } = grid;
        let row = 2 * (fine[1] + plan.window.width.next_multiple_of(2));
        let plane = row * fine[2..].iter().product::<usize>();
        // The first planes wait for the window around the period; the others take turns.
        let turns = (slab + widths[0])
            .min(fine[0].saturating_sub(widths[0]))
            .max(1);
        let slots = (0..fine[0] + widths[0])
            .map(|index| {
                let index = index % fine[0];
                let slot = if index < widths[0] {
                    index
                } else {
                    widths[0] + index % turns
                };
                slot * plane
            })
            .collect();
        let largest = (2..=D)
            .map(|axis| {
                plan.modes[1..axis].iter().product::<usize>()
                    * fine[axis..].iter().product::<usize>()
            })
            .max()
            .unwrap_or(0);
        let longest = fine.iter().copied().max().unwrap_or(1);
        let scratch = plan
            .to_modes
            .iter()
            .chain(&plan.to_grid)
            .map(|fft| fft.get_inplace_scratch_len())
            .max()
            .unwrap_or(0);
        Self {
            grid,
            modes: plan.modes,
            ring: vec![T::zero(); (widths[0] + turns) * plane],
            used: false,
            slots,
            footprint: Vec::with_capacity(plan.window.width.pow(D as u32 - 2)),
            planes: std::array::from_fn(|_| vec![zero; largest]),
            middle: vec![zero; fine[0] * plan.modes[1..].iter().product::<usize>()],
            lines: vec![zero; FIRST_GROUP * longest],
            scratch: vec![zero; scratch],
            row,
            plane,
        }
    }

    /// Bytes that the buffers take.
    pub fn bytes(&self) -> usize {
        let complex = self.planes[0].len()
            + self.planes[1].len()
            + self.middle.len()
            + self.lines.len()
            + self.scratch.len();
        std::mem::size_of::<T>() * (self.ring.len() + 2 * complex)
            + std::mem::size_of::<usize>() * self.slots.len()
            + std::mem::size_of::<(usize, T)>() * self.footprint.capacity()
    }
}
