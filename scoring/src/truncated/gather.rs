//! A new rotation prepared: all knots summed into one spectrum.

use super::columns::{Harmonic, Layout};
use super::knots::{Block, LANES, Lane, powers};
use nalgebra::Rotation3;

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
