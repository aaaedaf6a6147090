//! Compiled shaders, their buffers, and the dispatches that use both.

use super::{GpuDevice, GpuError};
use bytemuck::Pod;
use wgpu::util::DeviceExt;

/// Most workgroups along one axis of a dispatch, of any adapter.
pub(crate) const MAX_GROUPS: usize = 65_535;

/// An entry point of a shader, compiled.
pub(crate) struct Kernel {
    name: &'static str,
    pipeline: wgpu::ComputePipeline,
}

/// A kernel with its buffers and its number of workgroups.
#[derive(Clone)]
pub(crate) struct Step {
    pipeline: wgpu::ComputePipeline,
    bindings: wgpu::BindGroup,
    groups: [usize; 3],
}

impl Kernel {
    /// Compiles the entry point `entry` of a WGSL source.
    ///
    /// Workgroup memory is not cleared: every invocation must fill the part that it reads.
    pub fn new(
        gpu: &GpuDevice,
        name: &'static str,
        entry: &str,
        source: &str,
    ) -> Result<Self, GpuError> {
        let module = gpu.shader(name, source);
        let pipeline = gpu
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(name),
                layout: None,
                module: &module,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions {
                    zero_initialize_workgroup_memory: false,
                    ..Default::default()
                },
                cache: None,
            });
        gpu.check()?;
        Ok(Self { name, pipeline })
    }

    /// Binds buffers in the order of their bindings, from 0.
    pub fn step(
        &self,
        gpu: &GpuDevice,
        buffers: &[&wgpu::Buffer],
        groups: [usize; 3],
    ) -> Result<Step, GpuError> {
        let entries: Vec<wgpu::BindGroupEntry> = buffers
            .iter()
            .enumerate()
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding: binding as u32,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let bindings = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.name),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        gpu.check()?;
        Ok(Step {
            pipeline: self.pipeline.clone(),
            bindings,
            groups,
        })
    }
}

impl Step {
    /// Records the dispatch of a number of workgroups.
    pub fn record(&self, pass: &mut wgpu::ComputePass, [x, y, z]: [usize; 3]) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bindings, &[]);
        pass.dispatch_workgroups(x as u32, y as u32, z as u32);
    }
}

/// `count` workgroups over two axes; a shader numbers them `group.y * MAX_GROUPS + group.x` and leaves out the rest.
pub(crate) fn groups(count: usize) -> [usize; 3] {
    [count.min(MAX_GROUPS), count.div_ceil(MAX_GROUPS), 1]
}

/// Constants as WGSL, [`MAX_GROUPS`] among them.
pub(crate) fn constants(values: &[(&str, usize)]) -> String {
    let mut all = vec![("MAX_GROUPS", MAX_GROUPS)];
    all.extend(values);
    let line = |(name, value): &(&str, usize)| format!("const {name}: u32 = {value}u;\n");
    all.iter().map(line).collect()
}

impl GpuDevice {
    /// A buffer with these contents, or 16 bytes of zeros.
    pub(crate) fn filled<T: Pod>(
        &self,
        name: &str,
        contents: &[T],
    ) -> Result<wgpu::Buffer, GpuError> {
        let contents: &[u8] = bytemuck::cast_slice(contents);
        self.fits(name, contents.len())?;
        let empty = [0; 16];
        let buffer = self
            .device
            .create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some(name),
                contents: if contents.is_empty() {
                    &empty
                } else {
                    contents
                },
                usage: wgpu::BufferUsages::STORAGE,
            });
        self.check()?;
        Ok(buffer)
    }

    /// A buffer of zeros that can be read back; of 16 bytes at the least.
    pub(crate) fn zeros(&self, name: &str, bytes: usize) -> Result<wgpu::Buffer, GpuError> {
        self.fits(name, bytes)?;
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(name),
            size: bytes.max(16) as u64,
            usage: wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::COPY_SRC
                | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.check()?;
        Ok(buffer)
    }

    fn fits(&self, name: &str, bytes: usize) -> Result<(), GpuError> {
        let limit = self.binding_limit;
        if bytes <= limit {
            return Ok(());
        }
        Err(self.too_small(format!(
            "{name} take {:.0} MB, and no buffer may be longer than {:.0} MB",
            bytes as f64 / 1e6,
            limit as f64 / 1e6
        )))
    }

    /// Clears buffers, runs the steps in order, and waits.
    pub(crate) fn run(&self, clear: &[wgpu::Buffer], steps: &[Step]) -> Result<(), GpuError> {
        let mut encoder = self
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for buffer in clear {
            encoder.clear_buffer(buffer, 0, None);
        }
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        for step in steps {
            step.record(&mut pass, step.groups);
        }
        drop(pass);
        self.wait(self.queue.submit([encoder.finish()]))
    }

    /// The first `bytes` (some) of a buffer of [`Self::zeros`], through `view`.
    pub(crate) fn read<T>(
        &self,
        buffer: &wgpu::Buffer,
        bytes: usize,
        view: impl FnOnce(&[u8]) -> T,
    ) -> Result<T, GpuError> {
        let results = self.readable(bytes);
        let mut encoder = self
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &results, 0, bytes as u64);
        self.queue.submit([encoder.finish()]);
        self.read_mapped(&results, view)
    }

    /// A buffer that [`Self::read_mapped`] reads.
    pub(crate) fn readable(&self, bytes: usize) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("results"),
            size: bytes as u64,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }

    /// The bytes of a buffer of [`Self::readable`] once all that was submitted is done, through `view`.
    pub(crate) fn read_mapped<T>(
        &self,
        results: &wgpu::Buffer,
        view: impl FnOnce(&[u8]) -> T,
    ) -> Result<T, GpuError> {
        let (sender, mapped) = std::sync::mpsc::channel();
        results.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver lives until the wait is over.
            let _ = sender.send(result);
        });
        self.wait(None)?;
        match mapped.recv() {
            Ok(Ok(())) => {}
            _ => return Err(self.driver("results could not be read back".into())),
        }
        let bytes = results
            .get_mapped_range(..)
            .map_err(|error| self.driver(error.to_string()))?;
        Ok(view(&bytes))
    }
}
