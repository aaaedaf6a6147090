//! Modes of a real function as columns along x, a harmonic |kx| at a time.
//!
//! With H_k the modes of a column (ky, kz) and theta = 2 pi x / Lx,
//!
//! sum_k H_k exp(i k theta) = sum_{k >= 0} E_k cos k theta + O_k sin k theta,
//!
//! where E_k = H_k + H_-k and O_k = i (H_k - H_-k). Cosine and sine are real, so a value costs half of the complex
//! sum, and its slope along x, sum_k k (O_k cos k theta - E_k sin k theta), as much again. Of a conjugate pair of
//! columns one is kept, with twice the weight, and the real part of the sum is the function.

use crate::transform::modes::ModeSet;
use crate::transform::truncation::Selection;
use num_complex::Complex64;
use std::ops::Range;

/// E and O of one harmonic: re E, im E, re O, im O.
pub(super) type Harmonic = [f64; 4];

/// Places of the kept modes: the same for every spectrum of a correlation.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// Box lengths, Å.
    pub lengths: [f64; 3],
    /// Largest |k| on each axis.
    pub limits: [usize; 3],
    /// By rising kz, each with its columns.
    pub planes: Vec<(usize, Range<usize>)>,
    /// The columns.
    pub columns: Vec<Column>,
    /// |kx| of every entry.
    pub harmonics: Vec<u32>,
    /// Modes kept, conjugates counted.
    pub modes: usize,
}

/// Entries that share ky and kz.
#[derive(Clone, Debug)]
pub(super) struct Column {
    /// Index along y.
    pub ky: i32,
    /// Its entries.
    pub entries: Range<usize>,
    /// 1 where the set holds the conjugates too, else 2.
    pub multiplicity: f64,
    /// Place of kx = 0 in the mode set.
    pub middle: usize,
    /// Place of kx = 0 of the column (-ky, -kz), where the set stores it and it is another.
    pub mirror: Option<usize>,
}

impl Layout {
    /// The kept modes of a set, by harmonics.
    pub fn new(modes: &ModeSet, selection: &Selection) -> Self {
        let mut layout = Self {
            lengths: modes.lengths,
            limits: [0; 3],
            planes: Vec::new(),
            columns: Vec::new(),
            harmonics: Vec::new(),
            modes: selection.modes(),
        };
        for (kz, range) in modes.planes.iter().enumerate() {
            let first = layout.columns.len();
            let plane = &modes.columns[range.clone()];
            for column in plane.iter().filter(|column| kz > 0 || column.ky >= 0) {
                let start = layout.harmonics.len();
                let middle = column.start + column.kx_max as usize;
                for k in 0..=column.kx_max as usize {
                    if selection.keeps(middle + k) {
                        layout.harmonics.push(k as u32);
                        layout.limits[0] = layout.limits[0].max(k);
                    }
                }
                if layout.harmonics.len() == start {
                    continue;
                }
                let mirror = plane
                    .iter()
                    .find(|other| kz == 0 && column.ky > 0 && other.ky == -column.ky)
                    .map(|other| other.start + other.kx_max as usize);
                layout.limits[1] = layout.limits[1].max(column.ky.unsigned_abs() as usize);
                layout.limits[2] = kz;
                layout.columns.push(Column {
                    ky: column.ky,
                    entries: start..layout.harmonics.len(),
                    multiplicity: if kz == 0 && column.ky == 0 { 1.0 } else { 2.0 },
                    middle,
                    mirror,
                });
            }
            if layout.columns.len() > first {
                layout.planes.push((kz, first..layout.columns.len()));
            }
        }
        layout
    }

    /// Radians per Å of index 1 on each axis.
    pub fn radians(&self) -> [f64; 3] {
        self.lengths
            .map(|length| 2.0 * std::f64::consts::PI / length)
    }

    /// E and O of a spectrum given mode by mode, times multiplicity and `factor`.
    pub fn harmonics_of(&self, factor: f64, mode: impl Fn(usize) -> Complex64) -> Vec<Harmonic> {
        let mut values = Vec::with_capacity(self.harmonics.len());
        for column in &self.columns {
            let scale = factor * column.multiplicity;
            for &k in &self.harmonics[column.entries.clone()] {
                let k = k as usize;
                let plus = mode(column.middle + k) * scale;
                values.push(if k == 0 {
                    [plus.re, plus.im, 0.0, 0.0]
                } else {
                    let minus = mode(column.middle - k) * scale;
                    let (even, odd) = (plus + minus, plus - minus);
                    [even.re, even.im, -odd.im, odd.re]
                });
            }
        }
        values
    }

    /// |mode| of every mode of a set of `count` that is kept, multiplicity taken out again; 0 for the rest.
    pub fn magnitudes(&self, values: &[Harmonic], count: usize) -> Vec<f64> {
        let mut magnitudes = vec![0.0; count];
        for column in &self.columns {
            for entry in column.entries.clone() {
                let k = self.harmonics[entry] as usize;
                let [er, ei, or, oi] = values[entry];
                let (even, odd) = (Complex64::new(er, ei), Complex64::new(oi, -or));
                // E = H+ + H-, -i O = H+ - H-.
                let half = if k == 0 { 1.0 } else { 0.5 } / column.multiplicity;
                let plus = (even + odd).norm() * half;
                let minus = (even - odd).norm() * half;
                magnitudes[column.middle + k] = plus;
                magnitudes[column.middle - k] = minus;
                if let Some(mirror) = column.mirror {
                    magnitudes[mirror - k] = plus;
                    magnitudes[mirror + k] = minus;
                }
            }
        }
        magnitudes
    }
}
