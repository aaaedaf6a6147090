//! The calls of a plan: sorting points, and the transforms.

use super::super::Real;
use super::vectorized::{Adjoint, Forward, Sort};
use super::{Plan, SortedPoints, TransformError, Workspace};
use num_complex::Complex;

impl<T: Real, const D: usize> Plan<T, D> {
    /// Buffers for transforms by this plan; executions allocate nothing.
    pub fn workspace(&self) -> Workspace<T, D> {
        Workspace::new(self)
    }

    /// Folds and sorts points (in units of the period) for transforms by this plan.
    ///
    /// # Errors
    ///
    /// [`TransformError`] when a coordinate is not finite or there are more than 2^32 - 1 points.
    pub fn locate(&self, points: &[[f64; D]]) -> Result<SortedPoints<D>, TransformError> {
        let mut sorted = SortedPoints::new(self.grid);
        self.locate_into(points, &mut sorted)?;
        Ok(sorted)
    }

    /// As [`Self::locate`], into memory that is there: nothing is allocated for no more points than were there before.
    ///
    /// # Errors
    ///
    /// As [`Self::locate`]; after one, `sorted` must not be used until points have been set.
    pub fn locate_into(
        &self,
        points: &[[f64; D]],
        sorted: &mut SortedPoints<D>,
    ) -> Result<(), TransformError> {
        sorted.grid = self.grid;
        pulp::Arch::new().dispatch(Sort { sorted, points })
    }

    /// Type 1, points to modes: `output[k] = sum_j weights[j] exp(-2 pi i k.x_j)`.
    ///
    /// # Errors
    ///
    /// [`TransformError`] when an array has another length than points or modes, or belongs to another plan.
    pub fn forward(
        &self,
        points: &SortedPoints<D>,
        weights: &[Complex<T>],
        work: &mut Workspace<T, D>,
        output: &mut [Complex<T>],
    ) -> Result<(), TransformError> {
        self.check(points, weights.len(), output.len(), work)?;
        pulp::Arch::new().dispatch(Forward::<T, Complex<T>, D> {
            plan: self,
            points,
            weights,
            work,
            output,
        });
        Ok(())
    }

    /// As [`Self::forward`] for real weights, in less time.
    ///
    /// # Errors
    ///
    /// As [`Self::forward`].
    pub fn forward_real(
        &self,
        points: &SortedPoints<D>,
        weights: &[T],
        work: &mut Workspace<T, D>,
        output: &mut [Complex<T>],
    ) -> Result<(), TransformError> {
        self.check(points, weights.len(), output.len(), work)?;
        pulp::Arch::new().dispatch(Forward::<T, T, D> {
            plan: self,
            points,
            weights,
            work,
            output,
        });
        Ok(())
    }

    /// Type 2, modes to values at the points: `values[j] = sum_k modes[k] exp(+2 pi i k.x_j)`.
    ///
    /// # Errors
    ///
    /// As [`Self::forward`].
    pub fn adjoint(
        &self,
        points: &SortedPoints<D>,
        modes: &[Complex<T>],
        work: &mut Workspace<T, D>,
        values: &mut [Complex<T>],
    ) -> Result<(), TransformError> {
        self.check(points, values.len(), modes.len(), work)?;
        pulp::Arch::new().dispatch(Adjoint {
            plan: self,
            points,
            modes,
            work,
            values,
        });
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
