//! The search's transform: type 1 (knots to modes), pruned at both ends.
//!
//! Knots are spread with a Kaiser-Bessel window onto a grid finer than the modes need, but only over the block that
//! they occupy. The three one-dimensional transforms then skip the lines that hold nothing and the modes that are not
//! kept. Several components (sets of weights on the same knots) go through together.
//!
//! Unlike the general transform, [`super::nufft`], it takes lengths in Å relative to a block's centre and keeps the modes
//! of a [`ModeSet`]. It runs in stages, component by component, so that an engine can use a column while it is in the
//! cache. It does not divide out the window's own transform: [`Forward::deconvolution`] gives the factors.

mod axes;

use super::Real;
use super::modes::{ModeSet, place};
use super::spreading::{MAX_WIDTH, SpreadingKernel};
use num_complex::Complex;
use rustfft::Fft;
use std::sync::Arc;

/// Pairs of planes that are held together while their columns are written: a cache line of complex numbers.
const PAIRS: usize = 4;

/// A planned type-1 transform for knots inside a block of the box.
pub struct Forward<T: Real> {
    modes: Arc<ModeSet>,
    fine: [usize; 3],
    block: [usize; 3],
    components: usize,
    kernel: SpreadingKernel<T>,
    along_x: Arc<dyn Fft<T>>,
    along_y: Arc<dyn Fft<T>>,
    along_z: Arc<dyn Fft<T>>,
}

/// Buffers of one transform in flight.
pub struct ForwardWorkspace<T> {
    /// [component][x][y][z], z padded by `MAX_WIDTH`.
    block: Vec<T>,
    /// [y][z]: rows of two planes as one complex row, zero beyond the block.
    rows: Vec<Complex<T>>,
    /// [y][kz].
    row_spectra: Vec<Complex<T>>,
    /// [kz][y], zero beyond the block.
    lines: Vec<Complex<T>>,
    /// [pair of planes][kz][ky].
    line_spectra: Vec<Complex<T>>,
    /// Values of one component, [column][x], zero beyond the block.
    columns: Vec<Complex<T>>,
    scratch: Vec<Complex<T>>,
}

/// Lengths of a workspace's buffers.
struct Lengths {
    block: usize,
    /// Rows along z, lines along y, columns along x.
    complex: [usize; 3],
}

impl<T: Real> Forward<T> {
    /// Plans a transform of `components` sets of weights to `modes` over a fine grid of `fine` points per axis, for
    /// knots within `extent` cells of the block's centre on each axis.
    pub fn new(
        modes: Arc<ModeSet>,
        fine: [usize; 3],
        width: usize,
        extent: [f64; 3],
        components: usize,
    ) -> Self {
        let oversampling = (0..3)
            .map(|axis| fine[axis] as f64 / modes.size[axis] as f64)
            .fold(f64::INFINITY, f64::min);
        let kernel = SpreadingKernel::new(width, oversampling);
        let block = [0, 1, 2].map(|axis| {
            // Even, so that planes pair up along x.
            let points = 2 * extent[axis].ceil() as usize + kernel.width() + 2;
            points.next_multiple_of(2).min(fine[axis])
        });
        Self {
            fine,
            block,
            components,
            kernel,
            along_x: T::forward_fft(fine[0]),
            along_y: T::forward_fft(fine[1]),
            along_z: T::forward_fft(fine[2]),
            modes,
        }
    }

    /// The block's centre in cells from the box's origin: knots are given relative to it.
    pub fn center(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| 0.5 * (self.block[axis] as f64 - 1.0))
    }

    /// Fine cells per Å on each axis.
    pub fn cells_per_length(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.fine[axis] as f64 / self.modes.lengths[axis])
    }

    /// Fine grid points of the block that knots are spread onto, on each axis.
    #[cfg(feature = "gpu")]
    pub(crate) fn block(&self) -> [usize; 3] {
        self.block
    }

    /// The spreading window.
    #[cfg(feature = "gpu")]
    pub fn kernel(&self) -> &SpreadingKernel<T> {
        &self.kernel
    }

    /// Factor by which mode index k on an axis must be multiplied to undo the window.
    pub fn deconvolution(&self, axis: usize, k: i32) -> f64 {
        1.0 / self.kernel.transform(f64::from(k) / self.fine[axis] as f64)
    }

    /// Buffers for one transform.
    pub fn workspace(&self) -> ForwardWorkspace<T> {
        let zero = Complex::new(T::zero(), T::zero());
        let lengths = self.lengths();
        let scratch = [&self.along_x, &self.along_y, &self.along_z]
            .map(|fft| fft.get_immutable_scratch_len())
            .into_iter()
            .fold(0, usize::max);
        let [rows, lines, columns] = lengths.complex;
        ForwardWorkspace {
            block: vec![T::zero(); lengths.block],
            rows: vec![zero; rows],
            row_spectra: vec![zero; rows],
            lines: vec![zero; lines],
            line_spectra: vec![zero; PAIRS * lines],
            columns: vec![zero; columns],
            scratch: vec![zero; scratch],
        }
    }

    /// Bytes that a workspace takes.
    pub fn workspace_bytes(&self) -> usize {
        let lengths = self.lengths();
        let [rows, lines, columns] = lengths.complex;
        size_of::<T>() * (lengths.block + 2 * (2 * rows + (1 + PAIRS) * lines + columns))
    }

    fn lengths(&self) -> Lengths {
        let [bx, by, bz] = self.block;
        let [mx, my, mz] = self.fine;
        Lengths {
            block: self.components * bx * by * (bz + MAX_WIDTH),
            complex: [
                by * mz,
                self.lines_of_plane() * my,
                self.modes.columns.len() * mx,
            ],
        }
    }

    /// Fine grid points along x: the length of a line of [`Self::columns`].
    pub fn line_length(&self) -> usize {
        self.fine[0]
    }

    /// Number of components transformed together.
    pub fn components(&self) -> usize {
        self.components
    }

    /// The whole transform with the window divided out, for one set-up call: `output` is `[component][mode]`.
    ///
    /// # Panics
    /// If a knot is outside the planned block.
    pub fn transform(
        &self,
        points: &[[f64; 3]],
        weights: &[T],
        work: &mut ForwardWorkspace<T>,
        output: &mut [Complex<T>],
    ) {
        let reach = [0, 1, 2].map(|axis| {
            let cells = 0.5 * (self.block[axis] as f64 - self.kernel.width() as f64);
            cells / self.cells_per_length()[axis]
        });
        let inside = |point: &[f64; 3]| (0..3).all(|axis| point[axis].abs() <= reach[axis]);
        assert!(
            points.iter().all(inside),
            "a knot lies outside the planned block"
        );
        self.spread(points, weights, work);
        let mx = self.fine[0];
        let mut line = vec![Complex::new(T::zero(), T::zero()); mx];
        let factors: [Vec<f64>; 3] = [0, 1, 2].map(|axis| {
            (0..=self.modes.size[axis] as i32 / 2)
                .map(|k| self.deconvolution(axis, k))
                .collect()
        });
        for (component, output) in output.chunks_exact_mut(self.modes.count).enumerate() {
            self.planes(component, work);
            for (index, column) in self.modes.columns.iter().enumerate() {
                self.columns(index..index + 1, work, &mut line);
                let outer =
                    factors[1][column.ky.unsigned_abs() as usize] * factors[2][column.kz as usize];
                for (i, k) in (-column.kx_max..=column.kx_max).enumerate() {
                    let factor = T::of(outer * factors[0][k.unsigned_abs() as usize]);
                    output[column.start + i] = line[place(k, mx)].scale(factor);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;

impl<T: Real> Forward<T> {
    /// Spreads knots onto the block: `points` in Å relative to the block's centre, `weights` as `[knot][component]`.
    ///
    /// Knots farther from the centre than the planned extent are not allowed (debug builds panic).
    #[inline(always)]
    pub fn spread(&self, points: &[[f64; 3]], weights: &[T], work: &mut ForwardWorkspace<T>) {
        work.block.fill(T::zero());
        if self.kernel.width() <= 4 {
            self.spread_lanes::<4>(points, weights, work);
        } else if self.kernel.width() <= 8 {
            self.spread_lanes::<8>(points, weights, work);
        } else {
            self.spread_lanes::<MAX_WIDTH>(points, weights, work);
        }
    }

    #[inline(always)]
    fn spread_lanes<const LANES: usize>(
        &self,
        points: &[[f64; 3]],
        weights: &[T],
        work: &mut ForwardWorkspace<T>,
    ) {
        let width = self.kernel.width();
        let [bx, by, bz] = self.block;
        let stride = bz + MAX_WIDTH;
        let center = self.center();
        let scale = self.cells_per_length();
        let mut values = [[T::zero(); LANES]; 3];
        for (point, weights) in points.iter().zip(weights.chunks_exact(self.components)) {
            let mut first = [0usize; 3];
            for axis in 0..3 {
                let u = point[axis] * scale[axis] + center[axis];
                let start = self.kernel.place(u, &mut values[axis]);
                debug_assert!(start >= 0 && start as usize + width <= self.block[axis]);
                first[axis] = start.max(0) as usize;
            }
            let z_values = values[2];
            for (component, &weight) in weights.iter().enumerate() {
                for (ix, &vx) in values[0][..width].iter().enumerate() {
                    let scaled = weight * vx;
                    let plane = (component * bx + first[0] + ix) * by;
                    for (iy, &vy) in values[1][..width].iter().enumerate() {
                        let value = scaled * vy;
                        let start = (plane + first[1] + iy) * stride + first[2];
                        let Some(row) = work.block.get_mut(start..start + LANES) else {
                            debug_assert!(false, "a window beyond the block");
                            continue;
                        };
                        for lane in 0..LANES {
                            row[lane] += value * z_values[lane];
                        }
                    }
                }
            }
        }
    }
}
