//! The computations of [`crate::processor`] on the card: uploaded, run and read back at each call.

use super::{GapGrid, GpuDevice, GpuError, KnotModes, PairDistances, PairSums, WaveSums};
use crate::minkowski::{Knot, Node};
use crate::processor::{Hits, Processor};
use crate::transform::nufft::Plan;
use num_complex::Complex64;

impl Processor for GpuDevice {
    type Error = GpuError;

    fn pair_sums(&self, first: &[Knot], second: &[Knot]) -> Result<Vec<Knot>, GpuError> {
        let sums = PairSums::new(self, first, second)?;
        sums.run()?;
        sums.read()
    }

    fn pair_distances(
        &self,
        first: &[Knot],
        second: &[Knot],
        places: &[Node],
    ) -> Result<Vec<f64>, GpuError> {
        let distances = PairDistances::new(self, first, second, places)?;
        distances.run()?;
        distances.read()
    }

    fn wave_sums<const D: usize>(
        &self,
        points: &[[f64; D]],
        weights: &[Complex64],
        frequencies: &[[i32; D]],
    ) -> Result<Vec<Complex64>, GpuError> {
        let sums = WaveSums::forward(self, points, weights, frequencies)?;
        sums.run()?;
        sums.read()
    }

    fn wave_values<const D: usize>(
        &self,
        frequencies: &[[i32; D]],
        modes: &[Complex64],
        points: &[[f64; D]],
    ) -> Result<Vec<f64>, GpuError> {
        let sums = WaveSums::adjoint(self, frequencies, modes, points)?;
        sums.run()?;
        Ok(sums.read()?.into_iter().map(|sum| sum.re).collect())
    }

    fn wave_hits<const D: usize>(
        &self,
        frequencies: &[[i32; D]],
        modes: &[Complex64],
        points: &[[f64; D]],
        bound: f64,
    ) -> Result<Hits, GpuError> {
        let hits = WaveSums::adjoint(self, frequencies, modes, points)?.hits(bound)?;
        hits.run()?;
        hits.read()
    }

    fn gap_grid(
        &self,
        balls: [&[Knot]; 2],
        per_axis: usize,
        edge: f64,
    ) -> Result<Vec<f64>, GpuError> {
        let gap = GapGrid::new(self, balls, per_axis, edge)?;
        gap.rasterise()?;
        gap.correlate()?;
        gap.read()
    }

    fn knot_modes<const D: usize>(
        &self,
        plan: &Plan<f64, D>,
        points: &[[f64; D]],
        weights: &[Complex64],
    ) -> Result<Vec<Complex64>, GpuError> {
        let modes = KnotModes::new(self, plan, points, weights)?;
        modes.run()?;
        modes.read()
    }
}
