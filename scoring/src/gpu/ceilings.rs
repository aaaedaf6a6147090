//! Peak rates of an adapter, measured: bytes copied and operations per second. Shaders are judged by their shares of both.

use super::kernel::Kernel;
use super::{GpuDevice, GpuError};
use std::time::Instant;

/// Peak rates of an adapter.
#[derive(Clone, Copy, Debug)]
pub struct Ceilings {
    /// Bytes per second of a copy within its memory, read and written both counted.
    pub bytes: f64,
    /// Floating-point operations per second of fused multiplications and additions in registers.
    pub flops: f64,
}

/// Invocations of a workgroup.
const WIDTH: usize = 256;
/// Chains of an invocation, and rounds of each.
const CHAINS: usize = 8;
const ROUNDS: usize = 1024;

impl Ceilings {
    /// Measures an adapter: the best of a few copies of `bytes` bytes, and of as many chains as there are threads.
    ///
    /// # Errors
    /// [`GpuError`] if the driver fails.
    pub fn measure(gpu: &GpuDevice, bytes: u64, threads: usize) -> Result<Self, GpuError> {
        let bytes = bytes.min(gpu.device.limits().max_buffer_size) & !3;
        let buffer = |usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("copied"),
                size: bytes,
                usage,
                mapped_at_creation: false,
            })
        };
        let from = buffer(wgpu::BufferUsages::COPY_SRC);
        let to = buffer(wgpu::BufferUsages::COPY_DST);
        let copying = best_of(|| {
            let descriptor = wgpu::CommandEncoderDescriptor::default();
            let mut encoder = gpu.device.create_command_encoder(&descriptor);
            encoder.copy_buffer_to_buffer(&from, 0, &to, 0, bytes);
            gpu.wait(gpu.queue.submit([encoder.finish()]))
        })?;
        let groups = threads.div_ceil(WIDTH);
        let results = gpu.filled("chains", &vec![1f32; groups * WIDTH])?;
        let kernel = Kernel::new(gpu, "chains", "main", &chains())?;
        let step = kernel.step(gpu, &[&results], [groups, 1, 1])?;
        let adding = best_of(|| gpu.run(&[], std::slice::from_ref(&step)))?;
        Ok(Self {
            bytes: 2.0 * bytes as f64 / copying,
            flops: (2 * CHAINS * ROUNDS * groups * WIDTH) as f64 / adding,
        })
    }
}

/// Chains of dependent multiplications and additions, independent of one another; the result is kept, so that none is
/// left out.
fn chains() -> String {
    let each = |text: &dyn Fn(usize) -> String| (0..CHAINS).map(text).collect::<String>();
    format!(
        "@group(0) @binding(0) var<storage, read_write> values: array<f32>;\n\
         @compute @workgroup_size({WIDTH})\n\
         fn main(@builtin(global_invocation_id) id: vec3<u32>) {{\n\
         let a = values[id.x];\n{}\
         for (var round = 0u; round < {ROUNDS}u; round += 1u) {{\n{}}}\n\
         values[id.x] = {};\n}}\n",
        each(&|i| format!("var x{i} = a + {i}.0;\n")),
        each(&|i| format!("x{i} = fma(x{i}, a, 0.5);\n")),
        (0..CHAINS)
            .map(|i| format!("x{i}"))
            .collect::<Vec<_>>()
            .join(" + "),
    )
}

/// Seconds of the fastest of a few runs, after one that is not counted.
fn best_of(mut run: impl FnMut() -> Result<(), GpuError>) -> Result<f64, GpuError> {
    run()?;
    let mut least = f64::INFINITY;
    for _ in 0..5 {
        let start = Instant::now();
        run()?;
        least = least.min(start.elapsed().as_secs_f64());
    }
    Ok(least)
}
