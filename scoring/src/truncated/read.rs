//! A new rotation: every knot of a block reads a component and its slope.
//!
//! Phases of all modes are products of three tables, one an axis. For each column the sum along x is two real products
//! a harmonic and part; columns are then turned by their phase along y, planes by theirs along z.

use super::columns::{Harmonic, Layout};
use super::knots::{Arms, LANES, Lane, Read, powers};
use nalgebra::Vector3;

/// Phases of one block.
#[derive(Clone, Debug)]
pub(super) struct ReadTables {
    /// \[k\]: cos, sin, k cos, k sin of k theta_x.
    x: Vec<[Lane; 4]>,
    /// \[k\]: cos, sin of k theta_y.
    y: Vec<[Lane; 2]>,
    /// \[k\]: cos, sin of k theta_z.
    z: Vec<[Lane; 2]>,
}

impl ReadTables {
    /// Buffers for a layout.
    pub fn new(layout: &Layout) -> Self {
        let [nx, ny, nz] = layout.limits.map(|limit| limit + 1);
        Self {
            x: vec![[[0.0; LANES]; 4]; nx],
            y: vec![[[0.0; LANES]; 2]; ny],
            z: vec![[[0.0; LANES]; 2]; nz],
        }
    }

    /// What a block at `arms` about `center` reads of a component.
    #[inline(always)]
    pub fn read(
        &mut self,
        layout: &Layout,
        values: &[Harmonic],
        arms: &Arms,
        center: &Vector3<f64>,
    ) -> Read {
        let radians = layout.radians();
        let angles = |axis: usize| arms[axis].map(|arm| radians[axis] * (arm + center[axis]));
        for ((k, row), [cos, sin]) in (0..).zip(&mut self.x).zip(powers(angles(0))) {
            let k = f64::from(k);
            for lane in 0..LANES {
                row[0][lane] = cos[lane];
                row[1][lane] = sin[lane];
                row[2][lane] = k * cos[lane];
                row[3][lane] = k * sin[lane];
            }
        }
        for (row, phase) in self.y.iter_mut().zip(powers(angles(1))) {
            *row = phase;
        }
        for (row, phase) in self.z.iter_mut().zip(powers(angles(2))) {
            *row = phase;
        }
        let mut read = Read {
            value: [0.0; LANES],
            slope: [[0.0; LANES]; 3],
        };
        for (kz, columns) in &layout.planes {
            // Sums over the plane: value, slope along x, slope along y / i, real and imaginary.
            let mut plane = [[0.0; LANES]; 6];
            for column in &layout.columns[columns.clone()] {
                let (mut sr, mut si) = ([0.0; LANES], [0.0; LANES]);
                let (mut dr, mut di) = ([0.0; LANES], [0.0; LANES]);
                let range = column.entries.clone();
                for (&k, value) in layout.harmonics[range.clone()].iter().zip(&values[range]) {
                    let [er, ei, or, oi] = *value;
                    let [cos, sin, k_cos, k_sin] = &self.x[k as usize];
                    for lane in 0..LANES {
                        sr[lane] = er.mul_add(cos[lane], or.mul_add(sin[lane], sr[lane]));
                        si[lane] = ei.mul_add(cos[lane], oi.mul_add(sin[lane], si[lane]));
                        dr[lane] = or.mul_add(k_cos[lane], (-er).mul_add(k_sin[lane], dr[lane]));
                        di[lane] = oi.mul_add(k_cos[lane], (-ei).mul_add(k_sin[lane], di[lane]));
                    }
                }
                let [cos, sin] = &self.y[column.ky.unsigned_abs() as usize];
                let sign = if column.ky < 0 { -1.0 } else { 1.0 };
                let ky = f64::from(column.ky);
                for lane in 0..LANES {
                    let (c, s) = (cos[lane], sign * sin[lane]);
                    let (re, im) = (sr[lane] * c - si[lane] * s, sr[lane] * s + si[lane] * c);
                    plane[0][lane] += re;
                    plane[1][lane] += im;
                    plane[2][lane] += dr[lane] * c - di[lane] * s;
                    plane[3][lane] += dr[lane] * s + di[lane] * c;
                    plane[4][lane] += ky * re;
                    plane[5][lane] += ky * im;
                }
            }
            let [cos, sin] = &self.z[*kz];
            let kz = *kz as f64;
            for lane in 0..LANES {
                let (c, s) = (cos[lane], sin[lane]);
                read.value[lane] += plane[0][lane] * c - plane[1][lane] * s;
                read.slope[0][lane] += radians[0] * (plane[2][lane] * c - plane[3][lane] * s);
                // Re(i a) = -Im a.
                read.slope[1][lane] -= radians[1] * (plane[4][lane] * s + plane[5][lane] * c);
                read.slope[2][lane] -= radians[2] * kz * (plane[0][lane] * s + plane[1][lane] * c);
            }
        }
        read
    }
}
