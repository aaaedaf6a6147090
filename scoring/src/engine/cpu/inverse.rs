//! Products of the receptor's spectra with the ligand's, and their way back to the grid.
//!
//! The images of one ligand's transform go through together. A column of modes and the one with -ky are multiplied for
//! all of them while both are in the cache.

use super::PLANES;
use super::transforms::{Buffers, Transforms};
use crate::engine::columns::Reading;
use crate::engine::packed::Packet;
use crate::grid_turn::GridTurn;
use crate::peaks::{Rows, largest};
use crate::transform::Real;
use crate::transform::transpose::transpose;
use crate::vectorized::vectorize;
use num_complex::Complex;

/// Columns ky, and as many -ky, that go through the x transforms together: a cache line of a plane's rows.
pub(in crate::engine) const SIDE: usize = 8;

impl<T: Real> Transforms<T> {
    /// Products of columns and their inverse along x and y: the rows along z of each turn's image.
    pub fn products(&self, turns: &[GridTurn], work: &mut Buffers<T>) {
        vectorize!(self.multiply(turns, work));
    }

    #[inline(always)]
    fn multiply(&self, turns: &[GridTurn], work: &mut Buffers<T>) {
        let half = self.plan.modes().size[2] / 2 + 1;
        for block in (0..half).step_by(PLANES) {
            let depth = PLANES.min(half - block);
            for level in 0..depth {
                self.plane(turns, block + level, level, work);
            }
            for image in 0..turns.len() {
                self.pair_rows(image, block, depth, work);
            }
        }
    }

    /// Plane kz of each image's product, transformed along x and y, into `work.planes` at `level`.
    #[inline(always)]
    fn plane(&self, turns: &[GridTurn], kz: usize, level: usize, work: &mut Buffers<T>) {
        let modes = self.plan.modes();
        let [nx, ny, _] = modes.size;
        let zero = Complex::new(T::zero(), T::zero());
        let place = |image: usize| {
            let start = (image * PLANES + level) * nx * ny;
            start..start + nx * ny
        };
        let Some(range) = modes.planes.get(kz) else {
            for image in 0..turns.len() {
                work.planes[place(image)].fill(zero);
            }
            return;
        };
        // ky comes as 0, 1, ..., n, -n, ..., -1.
        let count = range.len() / 2 + 1;
        for image in 0..turns.len() {
            for row in work.planes[place(image)].chunks_exact_mut(ny) {
                row[count..ny + 1 - count].fill(zero);
            }
        }
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
            for (image, products) in products.chunks_exact(of_image).enumerate() {
                let plane = &mut work.planes[place(image)];
                let (up, down) = products.split_at(plus * nx);
                transpose((up, &mut plane[first..]), plus, 0..nx, [nx, ny]);
                if minus > 0 {
                    let lowest = ny + 1 - end;
                    transpose((down, &mut plane[lowest..]), minus, 0..nx, [nx, ny]);
                }
            }
        }
        for image in 0..turns.len() {
            self.inverse_y
                .process_with_scratch(&mut work.planes[place(image)], &mut work.scratch);
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

    /// Joins the rows of an image's `depth` planes from kz = `block` on in pairs.
    #[inline(always)]
    fn pair_rows(&self, image: usize, block: usize, depth: usize, work: &mut Buffers<T>) {
        let [nx, ny, nz] = self.plan.modes().size;
        let planes = &work.planes[image * PLANES * nx * ny..(image + 1) * PLANES * nx * ny];
        let rows = &mut work.rows[image * nx * ny / 2 * nz..(image + 1) * nx * ny / 2 * nz];
        for (pair, row) in rows.chunks_exact_mut(nz).enumerate() {
            for level in 0..depth {
                let at = level * nx * ny + 2 * pair;
                let (a, b) = (planes[at], planes[at + 1]);
                let kz = block + level;
                // A + iB at kz, and A* + iB* at -kz; the mean of a real row is real, and the Nyquist plane is empty.
                if kz == 0 {
                    row[0] = Complex::new(a.re, b.re);
                } else {
                    row[kz] = Complex::new(a.re - b.im, a.im + b.re);
                    row[nz - kz] = Complex::new(a.re + b.im, b.re - a.im);
                }
            }
        }
    }

    /// Rows of an image: complex to real along z, two at a time, and the best of each row.
    pub fn image(&self, image: usize, work: &mut Buffers<T>, grid: &mut Rows<T>) {
        vectorize!(self.rows_to_grid(image, work, grid));
    }

    #[inline(always)]
    fn rows_to_grid(&self, image: usize, work: &mut Buffers<T>, grid: &mut Rows<T>) {
        let [nx, ny, nz] = self.plan.modes().size;
        let planes = work.rows[image * nx * ny / 2 * nz..(image + 1) * nx * ny / 2 * nz]
            .chunks_exact_mut(ny / 2 * nz)
            .zip(grid.values.chunks_exact_mut(ny * nz))
            .zip(grid.best.chunks_exact_mut(ny));
        for ((pairs, grid), best) in planes {
            self.inverse_z
                .process_with_scratch(pairs, &mut work.scratch);
            for ((pair, rows), best) in pairs
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
