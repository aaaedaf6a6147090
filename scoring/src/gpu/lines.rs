//! The FFT of all lines along one axis of a row-major array.

use super::kernel::{Kernel, Step, constants, groups};
use super::line_fft::{Direction, LineFft, MAX_LINES, WIDTH};
use super::{GpuDevice, GpuError};
use crate::processor::Cost;

/// Bytes of workgroup memory of every adapter.
const MEMORY: usize = 16 << 10;

/// A transform along one axis.
pub(crate) struct Axis<'a> {
    /// Lengths of the array before it, row-major.
    pub shape: &'a [usize],
    /// Which.
    pub axis: usize,
    pub direction: Direction,
    /// Factor of each frequency that is kept. The first is -`below`, as of all of them for 0.
    pub factors: &'a [f32],
    pub below: usize,
    /// Whether the numbers before it are whole (pairs of i32).
    pub whole: bool,
}

impl Axis<'_> {
    /// The transform from one buffer to another, the array after it as long along the axis as frequencies are kept.
    ///
    /// It costs 8 bytes of each point before and frequency kept, and 5 n log2 n operations per line of n.
    pub fn step(
        &self,
        gpu: &GpuDevice,
        source: &wgpu::Buffer,
        kept: &wgpu::Buffer,
        cost: &mut Cost,
    ) -> Result<Step, GpuError> {
        let length = self.shape[self.axis];
        let fft = LineFft {
            length,
            lines: (MEMORY / LineFft::bytes_of_line(length)).min(MAX_LINES),
            direction: self.direction,
        };
        let transform = fft.source("").filter(|_| fft.lines > 0).ok_or_else(|| {
            gpu.too_small(format!(
                "no transform of {length} points: a length has no prime factor above 7, and takes {MEMORY} bytes of workgroup memory at most, about 17 per point"
            ))
        })?;
        let outer: usize = self.shape[..self.axis].iter().product();
        let inner: usize = self.shape[self.axis + 1..].iter().product();
        let mut code = constants(&[
            ("WIDTH", WIDTH),
            ("LENGTH", length),
            ("KEPT", self.factors.len()),
            ("BELOW", self.below),
            ("OUTER", outer),
            ("INNER", inner),
            ("LINES", fft.lines),
        ]);
        let number = if self.whole { "i32" } else { "f32" };
        code += &format!("alias Source = vec2<{number}>;\n");
        code += &(LineFft::arrays(&[fft]) + &transform);
        code += include_str!("lines.wgsl");
        let kernel = Kernel::new(gpu, "lines", "main", &code)?;
        let table = gpu.filled("twiddle", &fft.twiddles())?;
        let factors = gpu.filled("factors", self.factors)?;
        let (points, all) = (length as f64, (outer * inner) as f64);
        cost.bytes += 8.0 * all * (points + self.factors.len() as f64);
        cost.operations += all * LineFft::flops_of_line(length);
        let groups = groups((outer * inner).div_ceil(fft.lines));
        kernel.step(gpu, &[&table, &factors, source, kept], groups)
    }
}
