//! The computations of [`crate::processor`] on the card: uploaded, run and read back at each call.

use super::{GapGrid, GpuDevice, GpuError, Job, WaveSums};
use crate::minkowski::{Knot, Node};
use crate::processor::{Hits, Processor};
use crate::transform::nufft::Plan;
use num_complex::Complex64;

fn done<T>(job: &Job<T>) -> Result<Vec<T>, GpuError> {
    job.run()?;
    job.read()
}

impl Processor for GpuDevice {
    type Error = GpuError;

    fn pair_sums(&self, first: &[Knot], second: &[Knot]) -> Result<Vec<Knot>, GpuError> {
        done(&Job::pair_sums(self, first, second)?)
    }

    fn pair_distances(
        &self,
        first: &[Knot],
        second: &[Knot],
        places: &[Node],
    ) -> Result<Vec<f64>, GpuError> {
        done(&Job::pair_distances(self, first, second, places)?)
    }

    fn wave_sums<const D: usize>(
        &self,
        points: &[[f64; D]],
        weights: &[Complex64],
        frequencies: &[[i32; D]],
    ) -> Result<Vec<Complex64>, GpuError> {
        done(&WaveSums::forward(self, points, weights, frequencies)?.job)
    }

    fn wave_values<const D: usize>(
        &self,
        frequencies: &[[i32; D]],
        modes: &[Complex64],
        points: &[[f64; D]],
    ) -> Result<Vec<f64>, GpuError> {
        let sums = done(&WaveSums::adjoint(self, frequencies, modes, points)?.job)?;
        Ok(sums.into_iter().map(|sum| sum.re).collect())
    }

    fn wave_hits<const D: usize>(
        &self,
        frequencies: &[[i32; D]],
        modes: &[Complex64],
        points: &[[f64; D]],
        bound: f64,
    ) -> Result<Hits, GpuError> {
        let sums = WaveSums::adjoint(self, frequencies, modes, points)?;
        let mask = done(&sums.hits(bound)?)?;
        Ok(Hits { mask })
    }

    fn gap_grid(
        &self,
        balls: [&[Knot]; 2],
        per_axis: usize,
        edge: f64,
    ) -> Result<Vec<f64>, GpuError> {
        let gap = GapGrid::new(self, balls, per_axis, edge)?;
        gap.rasterise.run()?;
        done(&gap.correlate)
    }

    fn knot_modes<const D: usize>(
        &self,
        plan: &Plan<f64, D>,
        points: &[[f64; D]],
        weights: &[Complex64],
    ) -> Result<Vec<Complex64>, GpuError> {
        done(&Job::knot_modes(self, plan, points, weights)?)
    }
}
