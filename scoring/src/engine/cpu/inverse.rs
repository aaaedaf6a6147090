//! Products of the receptor's spectra with the ligand's, and their way back to the grid.
//!
//! The images of one ligand's transform go through together. A column of modes and the one with -ky are multiplied for
//! all of them while both are in the cache.

use super::transforms::{Buffers, Transforms};
use crate::engine::columns::Reading;
use crate::engine::packed::Packet;
use crate::grid_turn::GridTurn;
use crate::peaks::{Rows, largest};
use crate::transform::Real;
use crate::transform::modes::ModeSet;
use crate::transform::transpose::transpose;
use crate::vectorized::vectorize;
use num_complex::Complex;
use std::ops::Range;

/// Columns ky, and as many -ky, that go through the x transforms together: a cache line of a plane's rows.
pub(in crate::engine) const SIDE: usize = 8;

/// Lines of a slab that are joined together: a cache line of a row.
const LEVELS: usize = 8;

impl<T: Real> Transforms<T> {
    /// Products of columns and their inverse along x: the slabs of each turn's image.
    pub fn products(&self, turns: &[GridTurn], work: &mut Buffers<T>) {
        vectorize!(self.multiply(turns, work));
    }

    #[inline(always)]
    fn multiply(&self, turns: &[GridTurn], work: &mut Buffers<T>) {
        for range in &self.plan.modes().planes {
            self.plane(turns, range, work);
        }
    }

    /// The columns `range`, which share kz, of each image's product, transformed along x, into `work.slabs`.
    #[inline(always)]
    fn plane(&self, turns: &[GridTurn], range: &Range<usize>, work: &mut Buffers<T>) {
        let nx = self.plan.modes().size[0];
        let stride = slab_length(self.plan.modes());
        // ky comes as 0, 1, ..., n, -n, ..., -1.
        let count = range.len() / 2 + 1;
        for first in (0..count).step_by(SIDE) {
            let end = (first + SIDE).min(count);
            // Columns with ky from `first` on, then those with -ky, in rising order.
            let (plus, minus) = (end - first, end - first.max(1));
            let of_image = (plus + minus) * nx;
            for ky in first..end {
                let up = (range.start + ky, ky - first);
                let down = (range.end - ky, plus + end - 1 - ky);
                for (column, slot) in [up, down].into_iter().take(if ky == 0 { 1 } else { 2 }) {
                    let products = work.product[slot * nx..].chunks_mut(of_image);
                    for (turn, product) in turns.iter().zip(products) {
                        let reading = self.readings[turn.index()][column];
                        let turned = &work.turned;
                        let sums = &mut work.sums;
                        self.multiply_column(reading, column, turned, sums, &mut product[..nx]);
                    }
                }
            }
            let products = &mut work.product[..turns.len() * of_image];
            self.inverse_x
                .process_with_scratch(products, &mut work.scratch);
            let slabs = work.slabs.chunks_exact_mut(nx * stride);
            for (products, slabs) in products.chunks_exact(of_image).zip(slabs) {
                let (up, down) = products.split_at(plus * nx);
                let from = range.start + first;
                transpose((up, &mut slabs[from..]), plus, 0..nx, [nx, stride]);
                if minus > 0 {
                    let lowest = range.end + 1 - end;
                    transpose((down, &mut slabs[lowest..]), minus, 0..nx, [nx, stride]);
                }
            }
        }
    }

    /// sum_q U_q conj(B_q) of one column, B as the reading has it.
    #[inline(always)]
    fn multiply_column(
        &self,
        reading: Reading,
        index: usize,
        turned: &[Packet<T>],
        sums: &mut [Packet<T>],
        product: &mut [Complex<T>],
    ) {
        let rank = self.rank();
        let pair = [
            &self.spectra[self.packing.range(index, rank)],
            &turned[self.packing.range(reading.column as usize, rank)],
        ];
        let side = self.plan.modes().columns[index].kx_max as usize;
        reading.multiply(rank, side, pair, sums, product);
    }

    /// An image from its slabs of one x, each of which stays in the cache: along y, then complex to real along z, two rows
    /// at a time, and the best of each row.
    pub fn image(&self, image: usize, work: &mut Buffers<T>, grid: &mut Rows<T>) {
        vectorize!(self.slabs_to_grid(image, work, grid));
    }

    #[inline(always)]
    fn slabs_to_grid(&self, image: usize, work: &mut Buffers<T>, grid: &mut Rows<T>) {
        let modes = self.plan.modes();
        let [nx, ny, nz] = modes.size;
        let zero = Complex::new(T::zero(), T::zero());
        let stride = slab_length(modes);
        let slabs = work.slabs[image * nx * stride..(image + 1) * nx * stride]
            .chunks_exact(stride)
            .zip(grid.values.chunks_exact_mut(ny * nz))
            .zip(grid.best.chunks_exact_mut(ny));
        for ((slab, grid), best) in slabs {
            for (line, range) in work.along_y.chunks_exact_mut(ny).zip(&modes.planes) {
                let count = range.len() / 2 + 1;
                let (up, down) = slab[range.clone()].split_at(count);
                line[..count].copy_from_slice(up);
                line[count..ny + 1 - count].fill(zero);
                line[ny + 1 - count..].copy_from_slice(down);
            }
            self.inverse_y
                .process_with_scratch(&mut work.along_y, &mut work.scratch);
            join_rows(&work.along_y, &mut work.rows, [ny, nz]);
            self.inverse_z
                .process_with_scratch(&mut work.rows, &mut work.scratch);
            for ((pair, rows), best) in work
                .rows
                .chunks_exact(nz)
                .zip(grid.chunks_exact_mut(2 * nz))
                .zip(best.chunks_exact_mut(2))
            {
                let (even, odd) = rows.split_at_mut(nz);
                separate(pair, even, odd);
                [best[0], best[1]] = [largest(even), largest(odd)];
            }
        }
    }
}

/// Numbers of a slab of one x: those of all columns, filled up to an odd number of cache lines, so that slabs do not share cache sets.
pub(in crate::engine) fn slab_length(modes: &ModeSet) -> usize {
    8 * (modes.columns.len().div_ceil(8) | 1)
}

/// Joins the rows along z of real numbers in pairs, from `[kz][y]` to `[pair of y][kz]`: A + iB at kz, and A* + iB* at
/// -kz. The mean of a real row is real, and the Nyquist plane is empty.
#[inline(always)]
fn join_rows<T: Real>(lines: &[Complex<T>], rows: &mut [Complex<T>], [ny, nz]: [usize; 2]) {
    let zero = Complex::new(T::zero(), T::zero());
    let depth = lines.len() / ny;
    for block in (0..depth).step_by(LEVELS) {
        let lines = &lines[block * ny..];
        let levels = LEVELS.min(depth - block);
        for (pair, row) in rows.chunks_exact_mut(nz).enumerate() {
            for (level, line) in lines.chunks_exact(ny).take(levels).enumerate() {
                let (a, b) = (line[2 * pair], line[2 * pair + 1]);
                let kz = block + level;
                if kz == 0 {
                    row[0] = Complex::new(a.re, b.re);
                    row[depth..=nz - depth].fill(zero);
                } else {
                    row[kz] = Complex::new(a.re - b.im, a.im + b.re);
                    row[nz - kz] = Complex::new(a.re + b.im, b.re - a.im);
                }
            }
        }
    }
}

/// Separates the parts of complex numbers.
#[inline(always)]
fn separate<T: Real>(pair: &[Complex<T>], even: &mut [T], odd: &mut [T]) {
    const LANES: usize = 8;
    let (pairs, pairs_left) = pair.as_chunks::<LANES>();
    let (evens, evens_left) = even.as_chunks_mut::<LANES>();
    let (odds, odds_left) = odd.as_chunks_mut::<LANES>();
    for ((values, even), odd) in pairs.iter().zip(evens).zip(odds) {
        *even = std::array::from_fn(|lane| values[lane].re);
        *odd = std::array::from_fn(|lane| values[lane].im);
    }
    for ((value, even), odd) in pairs_left.iter().zip(evens_left).zip(odds_left) {
        (*even, *odd) = (value.re, value.im);
    }
}
