//! Sums of waves at many frequencies or points on the card: the NDFT and its adjoint, which are one computation.
//!
//! # Error
//!
//! Of one sum, as a share of sum |c_j|, at most
//!
//! 2 pi |k| 2^-33 + (W + T + C + 12) 2^-23,
//!
//! |k| the sum of magnitudes of a frequency's parts. The first term is that of coordinates rounded to a fraction 2^-32 of
//! the period: the phase itself is exact. The second counts the additions in a row (W = 128 in a tile, T tiles in a
//! chunk, C chunks) and a few roundings of waves and weights, each in any direction, as if all were in phase. Measured
//! errors are a hundred times smaller.

use super::kernel::{Kernel, constants, groups};
use super::{GpuDevice, GpuError, Job};
use crate::processor::{Cost, largest};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Invocations of a workgroup, and terms that it stages together.
const WIDTH: usize = 128;
/// Invocations that fill a large card.
const MANY: usize = 1 << 18;
/// Most terms of a chunk: a driver may cut loops short after 65,536 rounds in all.
const MAX_CHUNK: usize = 1 << 14;

/// sum_j c_j exp(-+2 pi i k.x_j), one sum per frequency or per point.
///
/// Cost: per sum and term 28 operations in single precision and 7 of integers; per 128 sums all terms (24 bytes each);
/// per sum itself (24 bytes) and its chunks, written and read (16 bytes each).
pub struct WaveSums {
    /// The sums, in the order of the frequencies or points.
    pub job: Job<Complex64>,
    /// Bound of the error of each sum: see the module.
    pub rounding: f64,
    /// Value of 1 on the card.
    unit: f64,
    parts: Vec<Part>,
}

/// Sums that fit a buffer.
struct Part {
    rows: usize,
    sizes: wgpu::Buffer,
    sums: wgpu::Buffer,
}

impl WaveSums {
    /// Type 1: sum_j c_j exp(-2 pi i k.x_j) at each frequency. Points are in units of the period; up to four axes.
    ///
    /// # Errors
    /// [`GpuError`] if a number is not finite, or the points do not fit a buffer.
    pub fn forward<const D: usize>(
        gpu: &GpuDevice,
        points: &[[f64; D]],
        weights: &[Complex64],
        frequencies: &[[i32; D]],
    ) -> Result<Self, GpuError> {
        let rows: Vec<[u32; 4]> = frequencies
            .iter()
            .map(|k| padded(k, |k| k as u32))
            .collect();
        let terms = fractions(gpu, points)?;
        Self::new(gpu, &rows, &terms, weights, largest(frequencies))
    }

    /// Type 2, the adjoint: sum_k f_k exp(+2 pi i k.x) at each point.
    ///
    /// # Errors
    /// [`GpuError`] if a number is not finite, or the modes do not fit a buffer.
    pub fn adjoint<const D: usize>(
        gpu: &GpuDevice,
        frequencies: &[[i32; D]],
        modes: &[Complex64],
        points: &[[f64; D]],
    ) -> Result<Self, GpuError> {
        let rows = fractions(gpu, points)?;
        let reversed = |k: &[i32; D]| padded(k, |k| k.wrapping_neg() as u32);
        let terms: Vec<[u32; 4]> = frequencies.iter().map(reversed).collect();
        Self::new(gpu, &rows, &terms, modes, largest(frequencies))
    }

    fn new(
        gpu: &GpuDevice,
        rows: &[[u32; 4]],
        terms: &[[u32; 4]],
        weights: &[Complex64],
        turns: f64,
    ) -> Result<Self, GpuError> {
        let parts: Vec<[f64; 2]> = weights
            .iter()
            .map(|weight| [weight.re, weight.im])
            .collect();
        gpu.finite("weight", &parts)?;
        if terms.len() != weights.len() {
            return Err(GpuError::Input(format!(
                "{} weights for {} terms",
                weights.len(),
                terms.len()
            )));
        }
        let size: f64 = parts.iter().map(|[re, im]| re.hypot(*im)).sum();
        // Sums of up to 1, so that single precision neither overflows nor underflows.
        let unit = size.max(f64::MIN_POSITIVE).log2().ceil().exp2();
        let weights: Vec<[f32; 2]> = parts
            .iter()
            .map(|part| part.map(|x| (x / unit) as f32))
            .collect();
        // Few rows fill a card only if their terms are divided.
        let wanted = (MANY / rows.len().max(1)).max(1);
        let chunk = terms.len().div_ceil(wanted).min(MAX_CHUNK);
        let chunk = chunk.next_multiple_of(WIDTH).max(WIDTH);
        let chunks = terms.len().div_ceil(chunk);
        let sum = Kernel::new(gpu, "sums of waves", "sum_chunks", &source())?;
        let add = Kernel::new(gpu, "sums of chunks", "add_chunks", &source())?;
        // Whole words of a mask of hits.
        let most = (gpu.binding_limit / (8 * chunks.max(2)) / WIDTH * WIDTH).max(WIDTH);
        let scratch = gpu.zeros("chunks of sums", 8 * chunks * most.min(rows.len()))?;
        let points = gpu.filled("terms", terms)?;
        let weights = gpu.filled("weights", &weights)?;
        let (mut parts, mut steps) = (Vec::new(), Vec::new());
        for rows in rows.chunks(most) {
            let count = rows.len();
            let numbers = [count, terms.len(), chunk, chunks].map(|number| number as u32);
            let sizes = gpu.filled("sizes", &numbers)?;
            let sums = gpu.zeros("sums", 8 * count)?;
            let across = count.div_ceil(WIDTH);
            let rows = gpu.filled("rows", rows)?;
            let buffers = [&sizes, &rows, &points, &weights, &scratch];
            steps.push(sum.step(gpu, &buffers, groups(across * chunks))?);
            steps.push(add.step(gpu, &[&sizes, &scratch, &sums], groups(across))?);
            parts.push(Part {
                rows: count,
                sizes,
                sums,
            });
        }
        let additions = (WIDTH + chunk / WIDTH + chunks + 12) as f64;
        let (n, terms) = (rows.len() as f64, terms.len() as f64);
        let cost = Cost {
            bytes: 24.0 * (n / WIDTH as f64).ceil() * terms + n * (24.0 + 16.0 * chunks as f64),
            operations: 35.0 * n * terms,
        };
        let outputs = parts
            .iter()
            .map(|part: &Part| (part.sums.clone(), part.rows));
        let wide = move |[re, im]: [f32; 2]| Complex64::new(f64::from(re), f64::from(im)) * unit;
        Ok(Self {
            job: Job::new(gpu, steps, outputs.collect(), cost, wide),
            rounding: size * (TAU * turns * 0.5f64.powi(33) + additions * 0.5f64.powi(23)),
            unit,
            parts,
        })
    }

    /// The sums, and a mask of the real parts that exceed `bound` by more than the rounding error: a bit per sum, the
    /// lowest first, as [`crate::processor::Hits`].
    ///
    /// # Errors
    /// [`GpuError`] if the driver fails.
    pub fn hits(&self, bound: f64) -> Result<Job<u32>, GpuError> {
        let gpu = &self.job.gpu;
        let kernel = Kernel::new(gpu, "hits", "mark_hits", &source())?;
        let level = (bound + self.rounding) / self.unit;
        let level = gpu.filled("bound", &[(level as f32).next_up()])?;
        let (mut steps, mut masks) = (self.job.steps.clone(), Vec::new());
        for part in &self.parts {
            let words = part.rows.div_ceil(32);
            let mask = gpu.zeros("mask", 4 * words)?;
            let buffers = [&part.sizes, &part.sums, &level, &mask];
            steps.push(kernel.step(gpu, &buffers, groups(words.div_ceil(WIDTH)))?);
            masks.push((mask, words));
        }
        Ok(Job::new(gpu, steps, masks, self.job.cost(), |word| word))
    }
}

fn source() -> String {
    constants(&[("WIDTH", WIDTH)]) + include_str!("wave_sums.wgsl")
}

/// Coordinates as fractions of the period in units of 2^-32.
fn fractions<const D: usize>(
    gpu: &GpuDevice,
    points: &[[f64; D]],
) -> Result<Vec<[u32; 4]>, GpuError> {
    gpu.finite("point", points)?;
    // 1 - 2^-33 and above round to a whole period, which is none.
    let fraction = |x: f64| ((x - x.floor()) * 2f64.powi(32)).round() as u64 as u32;
    Ok(points.iter().map(|point| padded(point, fraction)).collect())
}

/// Up to four axes, the others zero.
fn padded<T: Copy, const D: usize>(values: &[T; D], part: impl Fn(T) -> u32) -> [u32; 4] {
    const { assert!(D <= 4, "sums of waves have up to four axes") };
    std::array::from_fn(|axis| values.get(axis).map_or(0, |&value| part(value)))
}
