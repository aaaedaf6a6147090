//! Phases of a pose, and the sums over modes that read them.
//!
//! Phases of all modes are products of three tables, one per axis. For each column the sum along x is two real products
//! per harmonic and part; columns are then turned by their phase along y, planes by theirs along z.

use super::layout::{Harmonic, Layout};
use crate::rigid_move::PoseGradient;
use knotdock_structures::Knots;
use nalgebra::{Rotation3, Vector3};

/// Phases of all blocks.
#[derive(Clone, Debug)]
pub(super) struct GatherTables {
    /// \[k\]\[block\]: cos, sin of k theta_x.
    x: Vec<[Lane; 2]>,
    /// \[k\]\[block\]: cos, sin of k theta_y.
    y: Vec<[Lane; 2]>,
    /// \[k\]\[block\]: cos, sin of k theta_z, times the knots' weights.
    z: Vec<[Lane; 2]>,
    /// \[block\]: weight and phase of one column at kx = 0.
    column: Vec<[Lane; 2]>,
}

impl GatherTables {
    /// Buffers for a layout and a number of blocks.
    pub fn new(layout: &Layout, blocks: usize) -> Self {
        let [nx, ny, nz] = layout.limits.map(|limit| (limit + 1) * blocks);
        let zero = [[0.0; LANES]; 2];
        Self {
            x: vec![zero; nx],
            y: vec![zero; ny],
            z: vec![zero; nz],
            column: vec![zero; blocks],
        }
    }

    /// Sums all knots, turned, into one spectrum: E and O of sum over components of H conj(B).
    ///
    /// Let conj(B) = sum_j c_j exp(i k theta_j), with c_j the weight and the phase along y and z. With X = sum c cos k
    /// theta and Y = sum c sin k theta, the product's E is E X + O Y and its O is O X - E Y.
    #[inline(always)]
    pub fn gather(
        &mut self,
        layout: &Layout,
        components: &[Vec<Harmonic>],
        blocks: &[Block],
        rotation: &Rotation3<f64>,
        out: &mut [Harmonic],
    ) {
        let count = blocks.len();
        let radians = layout.radians();
        for (index, block) in blocks.iter().enumerate() {
            let arms = block.turned(rotation);
            let angles = |axis: usize| arms[axis].map(|arm| radians[axis] * arm);
            let fill = |rows: &mut [[Lane; 2]], axis| {
                let rows = rows.iter_mut().skip(index).step_by(count);
                for (row, phase) in rows.zip(powers(angles(axis))) {
                    *row = phase;
                }
            };
            fill(&mut self.x, 0);
            fill(&mut self.y, 1);
            fill(&mut self.z, 2);
            for row in self.z.iter_mut().skip(index).step_by(count) {
                let [cos, sin] = row;
                for lane in 0..LANES {
                    cos[lane] *= block.weights[lane];
                    sin[lane] *= block.weights[lane];
                }
            }
        }
        for (kz, columns) in &layout.planes {
            let along_z = &self.z[kz * count..(kz + 1) * count];
            for column in &layout.columns[columns.clone()] {
                let ky = column.ky.unsigned_abs() as usize;
                let sign = if column.ky < 0 { -1.0 } else { 1.0 };
                let along_y = &self.y[ky * count..(ky + 1) * count];
                for ((phase, z), y) in self.column.iter_mut().zip(along_z).zip(along_y) {
                    for lane in 0..LANES {
                        let (c, s) = (y[0][lane], sign * y[1][lane]);
                        phase[0][lane] = z[0][lane] * c - z[1][lane] * s;
                        phase[1][lane] = z[0][lane] * s + z[1][lane] * c;
                    }
                }
                for entry in column.entries.clone() {
                    let k = layout.harmonics[entry] as usize;
                    let along_x = &self.x[k * count..(k + 1) * count];
                    let mut start = 0;
                    for run in blocks.chunk_by(|a, b| a.component == b.component) {
                        let range = start..start + run.len();
                        start = range.end;
                        let (mut xr, mut xi) = ([0.0; LANES], [0.0; LANES]);
                        let (mut yr, mut yi) = ([0.0; LANES], [0.0; LANES]);
                        for (phase, x) in self.column[range.clone()].iter().zip(&along_x[range]) {
                            let [[re, im], [cos, sin]] = [phase, x];
                            for lane in 0..LANES {
                                xr[lane] = re[lane].mul_add(cos[lane], xr[lane]);
                                xi[lane] = im[lane].mul_add(cos[lane], xi[lane]);
                                yr[lane] = re[lane].mul_add(sin[lane], yr[lane]);
                                yi[lane] = im[lane].mul_add(sin[lane], yi[lane]);
                            }
                        }
                        let total = |lanes: Lane| lanes.iter().sum::<f64>();
                        let (xr, xi, yr, yi) = (total(xr), total(xi), total(yr), total(yi));
                        let [er, ei, or, oi] = components[run[0].component][entry];
                        out[entry][0] += er * xr - ei * xi + or * yr - oi * yi;
                        out[entry][1] += er * xi + ei * xr + or * yi + oi * yr;
                        out[entry][2] += or * xr - oi * xi - er * yr + ei * yi;
                        out[entry][3] += or * xi + oi * xr - er * yi - ei * yr;
                    }
                }
            }
        }
    }
}

/// Knots in a block.
pub(super) const LANES: usize = 8;

/// One number of each knot of a block.
pub(super) type Lane = [f64; LANES];

/// Up to `LANES` knots that read the same component; places without a knot have weight 0.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// The component.
    pub component: usize,
    /// Relative to the ligand's centre, Å.
    positions: [Vector3<f64>; LANES],
    pub weights: Lane,
}

/// Values and slopes (per Å) along each axis at the knots of a block.
pub(super) struct Read {
    pub value: Lane,
    pub slope: [Lane; 3],
}

/// Positions by axis, relative to a centre, Å.
pub(super) type Arms = [Lane; 3];

impl Block {
    /// The blocks of a component.
    pub fn of(
        component: usize,
        knots: &[(usize, f64)],
        ligand: &Knots,
        center: Vector3<f64>,
    ) -> Vec<Self> {
        let fill = |chunk: &[(usize, f64)]| {
            let mut block = Self {
                component,
                positions: [Vector3::zeros(); LANES],
                weights: [0.0; LANES],
            };
            for (lane, &(knot, weight)) in chunk.iter().enumerate() {
                block.positions[lane] = Vector3::from(ligand.centers[knot]) - center;
                block.weights[lane] = weight;
            }
            block
        };
        knots.chunks(LANES).map(fill).collect()
    }

    /// Positions after a rotation about the ligand's centre.
    #[inline(always)]
    pub fn turned(&self, rotation: &Rotation3<f64>) -> Arms {
        let mut arms = [[0.0; LANES]; 3];
        for (lane, position) in self.positions.iter().enumerate() {
            let arm = rotation * position;
            for axis in 0..3 {
                arms[axis][lane] = arm[axis];
            }
        }
        arms
    }

    /// Adds values and slopes at the knots to a score and its gradient.
    #[inline(always)]
    pub fn gather(&self, read: &Read, arms: &Arms, score: &mut f64, gradient: &mut PoseGradient) {
        for (lane, &weight) in self.weights.iter().enumerate() {
            let ([x, y, z], [ax, ay, az]) = (&read.slope, arms);
            let force = weight * Vector3::new(x[lane], y[lane], z[lane]);
            let arm = Vector3::new(ax[lane], ay[lane], az[lane]);
            *score += weight * read.value[lane];
            gradient.force += force;
            gradient.torque += arm.cross(&force);
        }
    }
}

/// exp(i k theta) for k = 0, 1, ...: cosines and sines, by multiplication; the error grows as k times the rounding.
#[inline(always)]
pub(super) fn powers(theta: Lane) -> impl Iterator<Item = [Lane; 2]> {
    let (mut cos, mut sin) = ([0.0; LANES], [0.0; LANES]);
    for lane in 0..LANES {
        (sin[lane], cos[lane]) = theta[lane].sin_cos();
    }
    let mut next = [[1.0; LANES], [0.0; LANES]];
    std::iter::from_fn(
        #[inline(always)]
        move || {
            let now = next;
            for lane in 0..LANES {
                next[0][lane] = now[0][lane] * cos[lane] - now[1][lane] * sin[lane];
                next[1][lane] = now[0][lane] * sin[lane] + now[1][lane] * cos[lane];
            }
            Some(now)
        },
    )
}

/// Phases of one place.
#[derive(Clone, Debug)]
pub(super) struct PlaceTables {
    /// \[k\]: (cos, cos, sin, sin) and (-k sin, -k sin, k cos, k cos) of k theta_x, to go with a harmonic's four
    /// numbers.
    x: Vec<[Harmonic; 2]>,
    /// \[k\]: cos, sin of k theta_y.
    y: Vec<[f64; 2]>,
    /// \[k\]: cos, sin of k theta_z.
    z: Vec<[f64; 2]>,
}

impl PlaceTables {
    /// Buffers for a layout.
    pub fn new(layout: &Layout) -> Self {
        let [nx, ny, nz] = layout.limits.map(|limit| limit + 1);
        Self {
            x: vec![[[0.0; 4]; 2]; nx],
            y: vec![[0.0; 2]; ny],
            z: vec![[0.0; 2]; nz],
        }
    }

    /// Value and slope at one place of a function with one spectrum.
    #[inline(always)]
    pub fn sum(
        &mut self,
        layout: &Layout,
        values: &[Harmonic],
        position: &Vector3<f64>,
    ) -> (f64, Vector3<f64>) {
        let radians = layout.radians();
        let place = |axis: usize, rows: &mut [[f64; 2]]| {
            let (s, c) = (radians[axis] * position[axis]).sin_cos();
            let mut phase = [1.0, 0.0];
            for row in rows {
                *row = phase;
                phase = [phase[0] * c - phase[1] * s, phase[0] * s + phase[1] * c];
            }
        };
        place(1, &mut self.y);
        place(2, &mut self.z);
        let (s, c) = (radians[0] * position[0]).sin_cos();
        let (mut cos, mut sin) = (1.0, 0.0);
        for (k, row) in (0..).zip(&mut self.x) {
            let k = f64::from(k);
            *row = [[cos, cos, sin, sin], [-k * sin, -k * sin, k * cos, k * cos]];
            (cos, sin) = (cos * c - sin * s, cos * s + sin * c);
        }
        let mut value = 0.0;
        let mut slope = Vector3::zeros();
        for (kz, columns) in &layout.planes {
            let mut plane = [0.0; 6];
            for column in &layout.columns[columns.clone()] {
                let mut sum = [0.0; 4];
                let mut along = [0.0; 4];
                let range = column.entries.clone();
                for (&k, value) in layout.harmonics[range.clone()].iter().zip(&values[range]) {
                    let [plain, turned] = &self.x[k as usize];
                    for part in 0..4 {
                        sum[part] = value[part].mul_add(plain[part], sum[part]);
                        along[part] = value[part].mul_add(turned[part], along[part]);
                    }
                }
                let (sr, si) = (sum[0] + sum[2], sum[1] + sum[3]);
                let (dr, di) = (along[0] + along[2], along[1] + along[3]);
                let [c, sin] = self.y[column.ky.unsigned_abs() as usize];
                let s = if column.ky < 0 { -sin } else { sin };
                let ky = f64::from(column.ky);
                let (re, im) = (sr * c - si * s, sr * s + si * c);
                plane[0] += re;
                plane[1] += im;
                plane[2] += dr * c - di * s;
                plane[3] += dr * s + di * c;
                plane[4] += ky * re;
                plane[5] += ky * im;
            }
            let [c, s] = self.z[*kz];
            value += plane[0] * c - plane[1] * s;
            slope[0] += radians[0] * (plane[2] * c - plane[3] * s);
            slope[1] -= radians[1] * (plane[4] * s + plane[5] * c);
            slope[2] -= radians[2] * *kz as f64 * (plane[0] * s + plane[1] * c);
        }
        (value, slope)
    }
}

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

    /// Values and slopes of a component at a block at `arms` about `center`.
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
