//! The direct nufft sum over a box of modes, as fast as it goes without a fast transform.
//!
//! f_k = sum_j c_j exp(-2 pi i k.x_j) for several sets of weights c on the same points. Phases are products of three
//! tables, one per axis (B&I's "cascade" NDFT), so that a point and a mode cost one complex multiplication: O(points x
//! modes), in vector lanes. For few modes or few points it needs less time than [`super::nufft`], whose grid has a
//! price too.
//!
//! Conventions are those of [`super::ndft::forward`], against which it is tested: points in units of the period, modes
//! from -floor(n/2) on each axis, row-major, the last axis fastest.

use crate::vectorized::vectorize;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Points that go through the arithmetic together.
const LANES: usize = 8;
/// Groups of `LANES` points whose phases are held at a time: the tables of an axis of 64 modes are then some 64 kB.
const GROUPS: usize = 8;

/// A complex number for each of some points.
#[derive(Clone, Copy, Debug)]
struct Lane {
    re: [f64; LANES],
    im: [f64; LANES],
}

const ZERO: Lane = Lane {
    re: [0.0; LANES],
    im: [0.0; LANES],
};

impl Lane {
    #[inline(always)]
    fn times(&self, other: &Self) -> Self {
        let mut product = ZERO;
        for lane in 0..LANES {
            let (a, b) = (self.re[lane], self.im[lane]);
            let (c, d) = (other.re[lane], other.im[lane]);
            product.re[lane] = a.mul_add(c, -(b * d));
            product.im[lane] = a.mul_add(d, b * c);
        }
        product
    }

    /// Adds the product of two.
    #[inline(always)]
    fn add_product(&mut self, left: &Self, right: &Self) {
        for lane in 0..LANES {
            let (a, b) = (left.re[lane], left.im[lane]);
            let (c, d) = (right.re[lane], right.im[lane]);
            self.re[lane] = a.mul_add(c, (-b).mul_add(d, self.re[lane]));
            self.im[lane] = a.mul_add(d, b.mul_add(c, self.im[lane]));
        }
    }

    #[inline(always)]
    fn sum(&self) -> Complex64 {
        Complex64::new(self.re.iter().sum(), self.im.iter().sum())
    }
}

/// All modes of every field, a field a set of weights with one for each point: as many arrays of modes as there are
/// fields.
pub fn forward(
    points: &[[f64; 3]],
    fields: &[Vec<Complex64>],
    modes: [usize; 3],
) -> Vec<Vec<Complex64>> {
    let count = modes.iter().product();
    let mut output = vec![vec![Complex64::default(); count]; fields.len()];
    let mut tables = modes.map(|n| vec![ZERO; n * GROUPS]);
    for (block, points) in points.chunks(LANES * GROUPS).enumerate() {
        for (axis, table) in tables.iter_mut().enumerate() {
            tabulate(points, axis, modes[axis], table);
        }
        let first = block * LANES * GROUPS;
        for (weights, output) in fields.iter().zip(&mut output) {
            let weights = gathered(&weights[first..first + points.len()]);
            vectorize!(accumulate(&weights, &tables, modes, output));
        }
    }
    output
}

/// Weights of a block, zero where it has no point.
fn gathered(weights: &[Complex64]) -> [Lane; GROUPS] {
    let mut groups = [ZERO; GROUPS];
    for (index, weight) in weights.iter().enumerate() {
        let group = &mut groups[index / LANES];
        group.re[index % LANES] = weight.re;
        group.im[index % LANES] = weight.im;
    }
    groups
}

/// exp(-2 pi i k x) of a block's points along an axis: \[k\]\[group\].
fn tabulate(points: &[[f64; 3]], axis: usize, modes: usize, table: &mut [Lane]) {
    for (index, point) in points.iter().enumerate() {
        // Whole periods go first, so that a point many periods away keeps the digits that it has.
        let x = point[axis] - point[axis].round();
        for k in 0..modes {
            let wave = Complex64::cis(-2.0 * PI * (k as f64 - (modes / 2) as f64) * x);
            let lane = &mut table[k * GROUPS + index / LANES];
            lane.re[index % LANES] = wave.re;
            lane.im[index % LANES] = wave.im;
        }
    }
}

#[inline(always)]
fn accumulate(
    weights: &[Lane; GROUPS],
    [x, y, z]: &[Vec<Lane>; 3],
    [_, ny, nz]: [usize; 3],
    output: &mut [Complex64],
) {
    let planes = x.chunks_exact(GROUPS).zip(output.chunks_exact_mut(ny * nz));
    for (x, plane) in planes {
        let rows = y.chunks_exact(GROUPS).zip(plane.chunks_exact_mut(nz));
        for (y, row) in rows {
            let mut carried = [ZERO; GROUPS];
            for group in 0..GROUPS {
                carried[group] = weights[group].times(&x[group]).times(&y[group]);
            }
            for (z, value) in z.chunks_exact(GROUPS).zip(row) {
                let mut sum = ZERO;
                for group in 0..GROUPS {
                    sum.add_product(&carried[group], &z[group]);
                }
                *value += sum.sum();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transform::ndft;

    /// Numbers of points below, at and above the size of a block, axes odd, even and of one mode.
    #[test]
    fn equals_the_plain_sum() {
        for (count, modes) in [(1, [4, 3, 2]), (64, [5, 1, 8]), (130, [2, 6, 7])] {
            let number = |j: usize, step: f64| 7.0 * (j as f64 * step).sin();
            let points: Vec<[f64; 3]> = (0..count)
                .map(|j| [number(j, 0.7), number(j, 1.3), number(j, 2.9)])
                .collect();
            let fields: Vec<Vec<Complex64>> = (0..2)
                .map(|field| {
                    (0..count)
                        .map(|j| Complex64::new(number(j + field, 0.4), number(j, 1.9)))
                        .collect()
                })
                .collect();
            let ours = forward(&points, &fields, modes);
            for (ours, weights) in ours.iter().zip(&fields) {
                let plain = ndft::forward(&points, weights, modes);
                for (a, b) in ours.iter().zip(plain) {
                    assert!((a - b).norm() < 1e-11 * count as f64, "{count} {modes:?}");
                }
            }
        }
    }
}
