//! A prepared rotation: the value and slope of one spectrum at one place.

use super::columns::{Harmonic, Layout};
use nalgebra::Vector3;

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
