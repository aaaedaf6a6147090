//! Balls and their transforms on any processor: the CPU in double precision, or a graphics processor in single.
//!
//! # Conventions
//!
//! - Balls are (x, y, z, r), in one unit of length.
//! - Points of a transform are in units of the period on each axis, frequencies whole numbers. The sign is that of
//!   [`crate::transform`]: points to modes exp(-2 pi i k.x), modes to values exp(+2 pi i k.x). Nothing is normalised.
//! - A graphics processor returns the same bits at every run, whatever the order in which its cores finish.
//!
//! ```
//! use knotdock_scoring::processor::{Cpu, Processor};
//! let (a, b) = ([[1.0, 0.0, 0.0, 2.0]], [[0.0, 1.0, 0.0, 0.5]]);
//! assert_eq!(Cpu.pair_sums(&a, &b)?, [[1.0, 1.0, 0.0, 2.5]]);
//! // Five from the sum's centre, less its radius.
//! assert_eq!(Cpu.pair_distances(&a, &b, &[[4.0, 5.0, 0.0]])?, [2.5]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::gap_grid::Grid;
use crate::kernel::Bump;
use crate::minkowski::{self, Knot, Node};
use crate::transform::ndft;
use crate::transform::nufft::{Plan, TransformError};
use num_complex::Complex64;

/// The computations of Behandish & Ilieş (CAD 70, 2016), section 5, on one processor.
///
/// Numbers must be finite, weights as many as points, and no radius larger than a grid's edge. A graphics processor
/// refuses other input, and sizes that it cannot hold.
pub trait Processor {
    /// Why one cannot be done.
    type Error: std::error::Error;

    /// The Minkowski sum of two sets of balls by pairs (Table 1): n1 n2 balls, those of one of `first` together.
    fn pair_sums(&self, first: &[Knot], second: &[Knot]) -> Result<Vec<Knot>, Self::Error>;

    /// Signed distance from each place to the nearest ball of that sum, min |p - a - b| - (r_a + r_b); infinite without
    /// a pair. O(n1 n2) per place; no sum is kept.
    fn pair_distances(
        &self,
        first: &[Knot],
        second: &[Knot],
        places: &[Node],
    ) -> Result<Vec<f64>, Self::Error>;

    /// The NDFT at any frequencies, in up to four dimensions: sum_j c_j exp(-2 pi i k.x_j). O(points x frequencies).
    fn wave_sums<const D: usize>(
        &self,
        points: &[[f64; D]],
        weights: &[Complex64],
        frequencies: &[[i32; D]],
    ) -> Result<Vec<Complex64>, Self::Error>;

    /// The adjoint, in real part: Re sum_k f_k exp(+2 pi i k.x) at each point, such as the truncated correlation at many
    /// translations of one rotation (eq. 50). O(points x frequencies).
    fn wave_values<const D: usize>(
        &self,
        frequencies: &[[i32; D]],
        modes: &[Complex64],
        points: &[[f64; D]],
    ) -> Result<Vec<f64>, Self::Error>;

    /// Whether [`Self::wave_values`] exceeds `bound` for certain, by point: above it by more than this processor's
    /// rounding. With the bound of the modes left out, the points are translations that collide.
    fn wave_hits<const D: usize>(
        &self,
        frequencies: &[[i32; D]],
        modes: &[Complex64],
        points: &[[f64; D]],
        bound: f64,
    ) -> Result<Hits, Self::Error>;

    /// The gap function of two sets of balls (section 5.2) at the n^3 points of a periodic cube, n even: row-major, z
    /// fastest, translation zero first. As [`crate::gap_grid`] with bumps of exponent 2.
    fn gap_grid(
        &self,
        balls: [&[Knot]; 2],
        per_axis: usize,
        edge: f64,
    ) -> Result<Vec<f64>, Self::Error>;

    /// The fast transform of points to modes, in three or four dimensions, as [`Plan::forward`].
    fn knot_modes<const D: usize>(
        &self,
        plan: &Plan<f64, D>,
        points: &[[f64; D]],
        weights: &[Complex64],
    ) -> Result<Vec<Complex64>, Self::Error>;
}

/// Which values exceed a bound.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hits {
    /// Bit i % 32 of word i / 32 is that of value i.
    pub mask: Vec<u32>,
}

impl Hits {
    /// Number of values above the bound.
    pub fn count(&self) -> usize {
        let ones = self.mask.iter().map(|word| word.count_ones() as usize);
        ones.sum()
    }

    /// Whether value `index` exceeds the bound.
    pub fn contains(&self, index: usize) -> bool {
        let word = self.mask.get(index / 32).copied().unwrap_or(0);
        (word >> (index % 32)) & 1 == 1
    }
}

/// Work of a computation on a card, for shares of what it can do. Each computation documents its formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Bytes to and from the card's memory, each buffer's once per pass over it.
    pub bytes: f64,
    /// Arithmetic operations: a fused multiply-add is two.
    pub operations: f64,
}

/// The CPU, in double precision on one thread: the reference.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cpu;

impl Processor for Cpu {
    type Error = TransformError;

    fn pair_sums(&self, first: &[Knot], second: &[Knot]) -> Result<Vec<Knot>, Self::Error> {
        let mut sum = Vec::with_capacity(first.len() * second.len());
        minkowski::write(first, second, &mut sum);
        Ok(sum)
    }

    fn pair_distances(
        &self,
        first: &[Knot],
        second: &[Knot],
        places: &[Node],
    ) -> Result<Vec<f64>, Self::Error> {
        let gap = |place: &Node| minkowski::gap_of_balls(first, second, *place);
        Ok(places.iter().map(gap).collect())
    }

    fn wave_sums<const D: usize>(
        &self,
        points: &[[f64; D]],
        weights: &[Complex64],
        frequencies: &[[i32; D]],
    ) -> Result<Vec<Complex64>, Self::Error> {
        let at = |k: &[i32; D]| ndft::at_frequency(points, weights, *k);
        Ok(frequencies.iter().map(at).collect())
    }

    fn wave_values<const D: usize>(
        &self,
        frequencies: &[[i32; D]],
        modes: &[Complex64],
        points: &[[f64; D]],
    ) -> Result<Vec<f64>, Self::Error> {
        let at = |x: &[f64; D]| ndft::at_point(frequencies, modes, *x).re;
        Ok(points.iter().map(at).collect())
    }

    fn wave_hits<const D: usize>(
        &self,
        frequencies: &[[i32; D]],
        modes: &[Complex64],
        points: &[[f64; D]],
        bound: f64,
    ) -> Result<Hits, Self::Error> {
        // A wave's phase takes D products and sums, of numbers up to |k|, times 2 pi; and the sums over modes.
        let size: f64 = modes.iter().map(|mode| mode.norm()).sum();
        let turns = largest(frequencies);
        let rounding = f64::EPSILON * size * (modes.len() as f64 + 10.0 + 30.0 * turns);
        let mut mask = vec![0; points.len().div_ceil(32)];
        let values = self.wave_values(frequencies, modes, points)?;
        for (index, value) in values.into_iter().enumerate() {
            mask[index / 32] |= u32::from(value > bound + rounding) << (index % 32);
        }
        Ok(Hits { mask })
    }

    fn gap_grid(
        &self,
        balls: [&[Knot]; 2],
        per_axis: usize,
        edge: f64,
    ) -> Result<Vec<f64>, Self::Error> {
        let bump = Bump::default();
        let grid = Grid::new(per_axis, edge);
        let mut buffers = grid.buffers();
        let [a, b] = balls.map(|balls| {
            grid.rasterise(balls, &bump, &mut buffers);
            grid.forward(&mut buffers);
            buffers.spectrum.clone()
        });
        grid.multiply(&a, &b, &mut buffers.spectrum);
        grid.inverse(&mut buffers);
        Ok(buffers.grid)
    }

    fn knot_modes<const D: usize>(
        &self,
        plan: &Plan<f64, D>,
        points: &[[f64; D]],
        weights: &[Complex64],
    ) -> Result<Vec<Complex64>, Self::Error> {
        let mut modes = vec![Complex64::default(); plan.mode_count()];
        let sorted = plan.locate(points)?;
        plan.forward(&sorted, weights, &mut plan.workspace(), &mut modes)?;
        Ok(modes)
    }
}

/// Largest sum of the magnitudes of a frequency's parts: by how many turns a point's error of one period changes a
/// phase.
pub(crate) fn largest<const D: usize>(frequencies: &[[i32; D]]) -> f64 {
    let size = |k: &[i32; D]| k.iter().map(|k| f64::from(k.unsigned_abs())).sum();
    frequencies.iter().map(size).fold(0.0, f64::max)
}
