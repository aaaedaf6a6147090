//! A computation whose input is on the card.

use super::kernel::Step;
use super::{GpuDevice, GpuError};
use crate::processor::Cost;
use bytemuck::Pod;

/// A computation that is ready to run, as often as one likes; its results are `T`s.
///
/// It is made from its input, which it uploads. What it cannot do or hold is refused there.
pub struct Job<T> {
    pub(super) gpu: GpuDevice,
    /// Buffers that each run clears.
    clear: Vec<wgpu::Buffer>,
    pub(super) steps: Vec<Step>,
    /// Buffers of results, with their bytes.
    outputs: Vec<(wgpu::Buffer, usize)>,
    convert: Convert<T>,
    cost: Cost,
}

/// Bytes of a buffer to results.
type Convert<T> = Box<dyn Fn(&[u8]) -> Vec<T> + Send + Sync>;

impl<T> Job<T> {
    /// A computation whose buffers hold an `R` per result.
    pub(super) fn new<R: Pod>(
        gpu: &GpuDevice,
        steps: Vec<Step>,
        outputs: Vec<(wgpu::Buffer, usize)>,
        cost: Cost,
        convert: impl Fn(R) -> T + Send + Sync + 'static,
    ) -> Self {
        let bytes = |(buffer, count): (wgpu::Buffer, usize)| (buffer, count * size_of::<R>());
        Self {
            gpu: gpu.clone(),
            clear: Vec::new(),
            steps,
            outputs: outputs.into_iter().map(bytes).collect(),
            convert: Box::new(move |bytes| {
                let raw: &[R] = bytemuck::cast_slice(bytes);
                raw.iter().copied().map(&convert).collect()
            }),
            cost,
        }
    }

    /// With a buffer that each run clears first.
    pub(super) fn clearing(mut self, buffer: &wgpu::Buffer) -> Self {
        self.clear.push(buffer.clone());
        self
    }

    /// Computes on the card, and waits.
    ///
    /// # Errors
    /// [`GpuError::Driver`] if the driver fails.
    pub fn run(&self) -> Result<(), GpuError> {
        self.gpu.run(&self.clear, &self.steps)
    }

    /// Results of the last run.
    ///
    /// # Errors
    /// [`GpuError::Driver`] if the driver fails.
    pub fn read(&self) -> Result<Vec<T>, GpuError> {
        let mut all = Vec::new();
        for (buffer, bytes) in self.outputs.iter().filter(|(_, bytes)| *bytes > 0) {
            all.append(&mut self.gpu.read(buffer, *bytes, &self.convert)?);
        }
        Ok(all)
    }

    /// Work of a run.
    pub fn cost(&self) -> Cost {
        self.cost
    }
}
