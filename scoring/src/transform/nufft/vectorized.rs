//! The executions as tasks that are compiled once for each vector instruction set.
//!
//! Types with `#[inline(always)]` methods, not closures: the code of a closure that could be called again sits behind a
//! shim of its own, which the compiler left out of line and thus without vector instructions.

use super::super::Real;
use super::{Plan, SortedPoints, TransformError, Workspace};
use num_complex::Complex;
use pulp::{Simd, WithSimd};

/// Folding and sorting points.
pub(super) struct Sort<'a, const D: usize> {
    pub(super) sorted: &'a mut SortedPoints<D>,
    pub(super) points: &'a [[f64; D]],
}

impl<const D: usize> WithSimd for Sort<'_, D> {
    type Output = Result<(), TransformError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.sorted.set(self.points)
    }
}

/// Points to modes, with weights of type `W`: real or complex.
pub(super) struct Forward<'a, T: Real, W, const D: usize> {
    pub(super) plan: &'a Plan<T, D>,
    pub(super) points: &'a SortedPoints<D>,
    pub(super) weights: &'a [W],
    pub(super) work: &'a mut Workspace<T, D>,
    pub(super) output: &'a mut [Complex<T>],
}

impl<T: Real, const D: usize> WithSimd for Forward<'_, T, Complex<T>, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.plan
            .run_forward::<_, 2>(self.points, self.weights, self.work, self.output);
    }
}

impl<T: Real, const D: usize> WithSimd for Forward<'_, T, T, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.plan
            .run_forward::<_, 1>(self.points, self.weights, self.work, self.output);
    }
}

/// Modes to values at the points.
pub(super) struct Adjoint<'a, T: Real, const D: usize> {
    pub(super) plan: &'a Plan<T, D>,
    pub(super) points: &'a SortedPoints<D>,
    pub(super) modes: &'a [Complex<T>],
    pub(super) work: &'a mut Workspace<T, D>,
    pub(super) values: &'a mut [Complex<T>],
}

impl<T: Real, const D: usize> WithSimd for Adjoint<'_, T, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.plan
            .run_adjoint(self.points, self.modes, self.work, self.values);
    }
}
