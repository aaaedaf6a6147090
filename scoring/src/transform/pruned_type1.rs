//! The search's transform: type 1 (knots to modes), pruned at both ends.
//!
//! Knots are spread with a Kaiser-Bessel window onto a grid finer than the modes need, but only over the block that
//! they occupy. The three one-dimensional transforms then skip the lines that hold nothing and the modes that are not
//! kept. Several components (sets of weights on the same knots) go through together.
//!
//! How it differs from the general transform, [`super::nufft`]:
//!
//! - it takes lengths in Å relative to a block's centre, not fractions of a period;
//! - it keeps the modes of a [`ModeSet`], not a box of them;
//! - it runs in stages, so that an engine can use a column while it is in the cache;
//! - it checks its input in debug builds alone;
//! - it does not divide out the window's own transform: [`Forward::deconvolution`] gives the factors, which the caller
//!   multiplies into its own.

use super::Real;
use super::modes::{ModeSet, place};
use super::spreading::{MAX_WIDTH, SpreadingKernel};
use num_complex::Complex;
use rustfft::Fft;
use std::sync::Arc;

/// Lines along x that are held together while their planes are written: a cache line of complex numbers.
const GROUP: usize = 8;

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
    /// [pair of rows][z]: two real rows as one complex row.
    pairs: Vec<Complex<T>>,
    /// [x in group][kz][y].
    lines: Vec<Complex<T>>,
    scratch: Vec<Complex<T>>,
    /// [column][component][x].
    planes: Vec<Complex<T>>,
}

impl<T: Real> Forward<T> {
    /// Plans a transform of `components` sets of weights to `modes` over a fine grid of `fine` points an axis, for
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
            // Even, so that rows along z pair up along y.
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

    /// Where the block's centre lies, in cells from the box's origin: knots are given relative to it.
    pub fn center(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| 0.5 * (self.block[axis] as f64 - 1.0))
    }

    /// Fine cells per Å on each axis.
    pub fn cells_per_length(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.fine[axis] as f64 / self.modes.lengths[axis])
    }

    /// Width of the spreading window in cells.
    pub fn width(&self) -> usize {
        self.kernel.width()
    }

    /// Fine grid points of the block that knots are spread onto, on each axis.
    #[cfg(feature = "gpu")]
    pub(crate) fn block(&self) -> [usize; 3] {
        self.block
    }

    /// The spreading window.
    pub fn kernel(&self) -> &SpreadingKernel<T> {
        &self.kernel
    }

    /// Factor by which mode index k on an axis must be multiplied to undo the window.
    pub fn deconvolution(&self, axis: usize, k: i32) -> f64 {
        1.0 / self.kernel.transform(f64::from(k) / self.fine[axis] as f64)
    }

    /// Buffers for one transform.
    pub fn workspace(&self) -> ForwardWorkspace<T> {
        let [bx, by, bz] = self.block;
        let zero = Complex::new(T::zero(), T::zero());
        let planes = self.modes.planes.len();
        let scratch = self
            .along_x
            .get_inplace_scratch_len()
            .max(self.along_y.get_inplace_scratch_len())
            .max(self.along_z.get_inplace_scratch_len());
        ForwardWorkspace {
            block: vec![T::zero(); self.components * bx * by * (bz + MAX_WIDTH)],
            pairs: vec![zero; by / 2 * self.fine[2]],
            lines: vec![zero; GROUP * planes * self.fine[1]],
            scratch: vec![zero; scratch],
            planes: vec![zero; self.modes.columns.len() * self.components * bx],
        }
    }

    /// Bytes that a workspace takes.
    pub fn workspace_bytes(&self) -> usize {
        let [bx, by, bz] = self.block;
        std::mem::size_of::<T>()
            * (self.components * bx * by * (bz + MAX_WIDTH)
                + 2 * GROUP * self.modes.planes.len() * self.fine[1]
                + 2 * self.modes.columns.len() * self.components * bx)
    }

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
        let mut values = [[T::zero(); MAX_WIDTH]; 3];
        for (point, weights) in points.iter().zip(weights.chunks_exact(self.components)) {
            let mut first = [0usize; 3];
            for axis in 0..3 {
                let u = point[axis] * scale[axis] + center[axis];
                let start = self.kernel.place(u, &mut values[axis]);
                debug_assert!(start >= 0 && start as usize + width <= self.block[axis]);
                first[axis] = start.max(0) as usize;
            }
            let mut z_values = [T::zero(); LANES];
            z_values.copy_from_slice(&values[2][..LANES]);
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

    /// Transforms the spread block along z and y; [`Self::columns`] then does x, column by column.
    #[inline(always)]
    pub fn planes(&self, work: &mut ForwardWorkspace<T>) {
        let [bx, by, bz] = self.block;
        let stride = bz + MAX_WIDTH;
        let count = self.modes.planes.len();
        let [_, my, mz] = self.fine;
        let zero = Complex::new(T::zero(), T::zero());
        let half = T::of(0.5);
        for component in 0..self.components {
            for group in (0..bx).step_by(GROUP) {
                let members = GROUP.min(bx - group);
                for member in 0..members {
                    let lines = &mut work.lines[member * count * my..(member + 1) * count * my];
                    let plane = (component * bx + group + member) * by;
                    for (pair, out) in work.pairs.chunks_exact_mut(mz).enumerate() {
                        let start = (plane + 2 * pair) * stride;
                        let (even, odd) = (&work.block[start..], &work.block[start + stride..]);
                        for ((value, &re), &im) in out[..bz].iter_mut().zip(even).zip(odd) {
                            *value = Complex::new(re, im);
                        }
                        out[bz..].fill(zero);
                    }
                    self.along_z
                        .process_with_scratch(&mut work.pairs, &mut work.scratch);
                    // X = A + iB with A, B Hermitian: A = (X(k) + X*(-k)) / 2, B = (X(k) - X*(-k)) / 2i.
                    for (pair, out) in work.pairs.chunks_exact(mz).enumerate() {
                        for kz in 0..count {
                            let (x, mirror) = (out[kz], out[(mz - kz) % mz]);
                            let line = &mut lines[kz * my + 2 * pair..kz * my + 2 * pair + 2];
                            line[0] =
                                Complex::new(half * (x.re + mirror.re), half * (x.im - mirror.im));
                            line[1] =
                                Complex::new(half * (x.im + mirror.im), half * (mirror.re - x.re));
                        }
                    }
                    for kz in 0..count {
                        lines[kz * my + by..(kz + 1) * my].fill(zero);
                    }
                    self.along_y.process_with_scratch(lines, &mut work.scratch);
                }
                for (kz, range) in self.modes.planes.iter().enumerate() {
                    for column in range.clone() {
                        let y = place(self.modes.columns[column].ky, my);
                        let out = (column * self.components + component) * bx + group;
                        for member in 0..members {
                            work.planes[out + member] = work.lines[(member * count + kz) * my + y];
                        }
                    }
                }
            }
        }
    }

    /// Transforms columns `range` along x into `lines`, laid out `[column][component][kx place in 0..fine_x]`.
    #[inline(always)]
    pub fn columns(
        &self,
        range: std::ops::Range<usize>,
        work: &mut ForwardWorkspace<T>,
        lines: &mut [Complex<T>],
    ) {
        let bx = self.block[0];
        let mx = self.fine[0];
        let count = range.len() * self.components;
        let zero = Complex::new(T::zero(), T::zero());
        let start = range.start * self.components * bx;
        let source = &work.planes[start..start + count * bx];
        for (line, values) in lines.chunks_exact_mut(mx).zip(source.chunks_exact(bx)) {
            line[..bx].copy_from_slice(values);
            line[bx..].fill(zero);
        }
        self.along_x
            .process_with_scratch(&mut lines[..count * mx], &mut work.scratch);
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
    /// Where a knot lies outside the planned block.
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
        self.planes(work);
        let mx = self.fine[0];
        let mut lines = vec![Complex::new(T::zero(), T::zero()); self.components * mx];
        let factors: [Vec<f64>; 3] = [0, 1, 2].map(|axis| {
            (0..=self.modes.size[axis] as i32 / 2)
                .map(|k| self.deconvolution(axis, k))
                .collect()
        });
        let modes = Arc::clone(&self.modes);
        for (index, column) in modes.columns.iter().enumerate() {
            self.columns(index..index + 1, work, &mut lines);
            let outer =
                factors[1][column.ky.unsigned_abs() as usize] * factors[2][column.kz as usize];
            for component in 0..self.components {
                for (i, k) in (-column.kx_max..=column.kx_max).enumerate() {
                    let factor = T::of(outer * factors[0][k.unsigned_abs() as usize]);
                    output[component * modes.count + column.start + i] =
                        lines[component * mx + place(k, mx)].scale(factor);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::ndft::ndft_3d;
    use super::*;
    use crate::test_support::Numbers;

    fn points(count: usize, radius: f64, seed: u64) -> (Vec<[f64; 3]>, Vec<f64>) {
        let mut numbers = Numbers(seed);
        let mut next = || numbers.next();
        let points = (0..count)
            .map(|_| std::array::from_fn(|_| radius * (2.0 * next() - 1.0)))
            .collect();
        let weights = (0..2 * count).map(|_| 2.0 * next() - 1.0).collect();
        (points, weights)
    }

    fn worst<T: Real>(tolerance: f64, oversampling: f64) -> f64 {
        let size = [20, 18, 24];
        let lengths = [40.0, 36.0, 48.0];
        let modes = Arc::new(ModeSet::new(size, lengths, 0.24));
        let fine = size.map(|n| super::super::fast_size((n as f64 * oversampling).ceil() as usize));
        let width = SpreadingKernel::<T>::width_for(tolerance, oversampling);
        let radius = 5.0;
        let extent = [0, 1, 2].map(|axis| radius * fine[axis] as f64 / lengths[axis]);
        let forward = Forward::<T>::new(Arc::clone(&modes), fine, width, extent, 2);
        let (points, weights) = points(40, radius, 7);
        let mut work = forward.workspace();
        let mut output = vec![Complex::new(T::zero(), T::zero()); 2 * modes.count];
        let cast: Vec<T> = weights.iter().map(|&w| T::of(w)).collect();
        forward.transform(&points, &cast, &mut work, &mut output);
        let center = forward.center();
        let scale = forward.cells_per_length();
        let shifted: Vec<[f64; 3]> = points
            .iter()
            .map(|p| [0, 1, 2].map(|axis| p[axis] + center[axis] / scale[axis]))
            .collect();
        let mut error: f64 = 0.0;
        let mut largest: f64 = 0.0;
        for component in 0..2 {
            let of_field: Vec<f64> = weights.iter().skip(component).step_by(2).copied().collect();
            modes.for_each(|mode, w, _| {
                let exact = ndft_3d(&shifted, &of_field, w);
                let ours = output[component * modes.count + mode];
                error = error.max((exact - Complex::new(ours.re.wide(), ours.im.wide())).norm());
                largest = largest.max(exact.norm());
            });
        }
        error / largest
    }

    #[test]
    fn meets_the_direct_sum_over_swept_tolerances() {
        for oversampling in [1.25, 1.5, 2.0] {
            for tolerance in [1e-2, 1e-3, 1e-4, 1e-6, 1e-8] {
                if SpreadingKernel::<f64>::width_for(tolerance, oversampling) >= MAX_WIDTH {
                    continue;
                }
                let error = worst::<f64>(tolerance, oversampling);
                assert!(error < tolerance, "{tolerance} at {oversampling}: {error}");
            }
            for tolerance in [1e-2, 1e-3, 1e-5] {
                let error = worst::<f32>(tolerance, oversampling);
                assert!(
                    error < tolerance,
                    "f32 {tolerance} at {oversampling}: {error}"
                );
            }
        }
    }
}
