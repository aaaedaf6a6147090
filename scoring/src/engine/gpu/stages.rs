//! The stages of a batch: what each computes, on which buffers, in how many workgroups.

use super::buffers::{Buffers, Sizes};
use crate::gpu::line_fft::{self, Direction, WIDTH, radices, twiddles};
use crate::gpu::{GpuDevice, GpuError};
use std::ops::Range;
use wgpu::util::DeviceExt;

/// Most workgroups along one axis of a dispatch, of any adapter.
const MAX_GROUPS: usize = 65_535;
/// Most lines that a workgroup transforms together: beyond, a row of them is longer than a memory transaction.
const MAX_LINES: usize = 16;

/// A compiled stage with its buffers.
struct Stage {
    name: &'static str,
    pipeline: wgpu::ComputePipeline,
    bindings: wgpu::BindGroup,
    /// Workgroups for a number of turns and images.
    groups: fn(&Sizes, &Lines, usize, usize) -> [usize; 3],
}

/// Lines that a workgroup of each transform takes: forward z, y, x, then inverse x, y, z.
type Lines = [usize; 6];

/// All stages, in order.
pub(super) struct Stages {
    stages: Vec<Stage>,
    lines: Lines,
}

/// The parts of a stage.
struct Recipe<'a> {
    name: &'static str,
    code: &'static str,
    /// Which of the transforms, and which way; `None`: none.
    transform: Option<(usize, usize, Direction)>,
    buffers: Vec<&'a wgpu::Buffer>,
    groups: fn(&Sizes, &Lines, usize, usize) -> [usize; 3],
}

impl Stages {
    /// Compiles the stages for a plan's sizes.
    pub fn new(gpu: &GpuDevice, sizes: &Sizes, buffers: &Buffers) -> Result<Self, GpuError> {
        let lines = lines(gpu, sizes)?;
        let recipes = [
            forward_recipes(sizes, buffers),
            inverse_recipes(sizes, buffers),
        ];
        let header = header(sizes);
        let stages = recipes
            .iter()
            .flatten()
            .map(|recipe| recipe.compile(gpu, &header, &lines))
            .collect::<Result<_, _>>()?;
        gpu.check()?;
        Ok(Self { stages, lines })
    }

    /// Number of stages, the last of which overwrites the grids with the neighbourhoods of their peaks.
    pub fn len(&self) -> usize {
        self.stages.len()
    }

    /// Name of a stage.
    pub fn name(&self, stage: usize) -> &'static str {
        self.stages[stage].name
    }

    /// Records a range of stages for a number of turns and images.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        sizes: &Sizes,
        (turns, images): (usize, usize),
        range: Range<usize>,
    ) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        for stage in &self.stages[range] {
            pass.set_pipeline(&stage.pipeline);
            pass.set_bind_group(0, &stage.bindings, &[]);
            let [x, y, z] = (stage.groups)(sizes, &self.lines, turns, images);
            pass.dispatch_workgroups(x as u32, y as u32, z as u32);
        }
    }
}

impl Recipe<'_> {
    fn compile(&self, gpu: &GpuDevice, header: &str, lines: &Lines) -> Result<Stage, GpuError> {
        let mut source = String::from(header);
        let mut table = None;
        if let Some((which, length, direction)) = self.transform {
            let lines = lines[which];
            let radices = radices(length).ok_or_else(|| {
                gpu.too_small(format!(
                    "no transform of {length} points, which a prime above 7 divides"
                ))
            })?;
            source += &format!("const LINES: u32 = {lines}u;\n");
            source += &line_fft::source(length, &radices, lines, direction);
            let twiddles = twiddles(length, direction);
            table = Some(
                gpu.device
                    .create_buffer_init(&wgpu::util::BufferInitDescriptor {
                        label: Some("twiddle"),
                        contents: bytemuck::cast_slice(&twiddles),
                        usage: wgpu::BufferUsages::STORAGE,
                    }),
            );
        }
        source += self.code;
        let module = gpu
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(self.name),
                source: wgpu::ShaderSource::Wgsl(source.into()),
            });
        let pipeline = gpu
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(self.name),
                layout: None,
                module: &module,
                entry_point: Some("main"),
                compilation_options: wgpu::PipelineCompilationOptions {
                    // Every invocation fills the part of a workgroup's memory that it reads.
                    zero_initialize_workgroup_memory: false,
                    ..Default::default()
                },
                cache: None,
            });
        gpu.check()?;
        let entries: Vec<wgpu::BindGroupEntry> = table
            .iter()
            .chain(self.buffers.iter().copied())
            .enumerate()
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding: binding as u32,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let bindings = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.name),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        Ok(Stage {
            name: self.name,
            pipeline,
            bindings,
            groups: self.groups,
        })
    }
}

/// Lines that a workgroup of each transform takes, by its memory.
fn lines(gpu: &GpuDevice, sizes: &Sizes) -> Result<Lines, GpuError> {
    let [mx, my, mz] = sizes.fine;
    let [nx, ny, nz] = sizes.grid;
    let lengths = [mz, my, mx, nx, ny, nz];
    let allowed = gpu.device.limits().max_compute_workgroup_storage_size as usize;
    let mut lines: Lines = [1; 6];
    for (lines, length) in lines.iter_mut().zip(lengths) {
        // Two arrays of complex numbers; half of the memory, so that two workgroups share a core.
        let most = allowed / 2 / (16 * length);
        if 16 * length > allowed {
            return Err(gpu.too_small(format!(
                "a line of {length} points takes {} bytes of workgroup memory, and there are {allowed}",
                16 * length
            )));
        }
        *lines = most.clamp(1, MAX_LINES);
    }
    Ok(lines)
}

/// The stages from the ligand's knots to the modes of each turn.
fn forward_recipes<'a>(sizes: &Sizes, b: &'a Buffers) -> [Recipe<'a>; 4] {
    let [mx, my, mz] = sizes.fine;
    [
        Recipe {
            name: "spread",
            code: include_str!("spread.wgsl"),
            transform: None,
            buffers: vec![&b.knots, &b.weights, &b.window, &b.turns, &b.block],
            groups: |sizes, _, turns, _| {
                let groups = (sizes.knots * sizes.window * sizes.window).div_ceil(WIDTH);
                [groups.min(MAX_GROUPS), groups.div_ceil(MAX_GROUPS), turns]
            },
        },
        Recipe {
            name: "forward z",
            code: include_str!("forward_z.wgsl"),
            transform: Some((0, mz, Direction::Forward)),
            buffers: vec![&b.block, &b.fine_rows],
            groups: |sizes, lines, turns, _| {
                let [bx, by, _] = sizes.block;
                [(by / 2).div_ceil(lines[0]), bx, turns * sizes.fields]
            },
        },
        Recipe {
            name: "forward y",
            code: include_str!("forward_y.wgsl"),
            transform: Some((1, my, Direction::Forward)),
            buffers: vec![&b.columns, &b.planes, &b.fine_rows, &b.partial],
            groups: |sizes, lines, turns, _| {
                let across = sizes.block[0].div_ceil(lines[1]);
                [across, sizes.depth, turns * sizes.fields]
            },
        },
        Recipe {
            name: "forward x",
            code: include_str!("forward_x.wgsl"),
            transform: Some((2, mx, Direction::Forward)),
            buffers: vec![&b.columns, &b.partial, &b.turned],
            groups: |sizes, lines, turns, _| {
                [sizes.columns.div_ceil(lines[2]), turns * sizes.fields, 1]
            },
        },
    ]
}

/// The stages from the modes of each turn to the peaks of each image.
fn inverse_recipes<'a>(sizes: &Sizes, b: &'a Buffers) -> [Recipe<'a>; 4] {
    let [nx, ny, nz] = sizes.grid;
    [
        Recipe {
            name: "product",
            code: include_str!("product.wgsl"),
            transform: Some((3, nx, Direction::Inverse)),
            buffers: vec![
                &b.columns,
                &b.spectra,
                &b.turned,
                &b.images,
                &b.along,
                &b.readings,
            ],
            groups: |sizes, lines, _, images| [sizes.columns.div_ceil(lines[3]), images, 1],
        },
        Recipe {
            name: "inverse y",
            code: include_str!("inverse_y.wgsl"),
            transform: Some((4, ny, Direction::Inverse)),
            buffers: vec![&b.columns, &b.planes, &b.along, &b.rows],
            groups: |sizes, lines, _, images| {
                [sizes.grid[0].div_ceil(lines[4]), sizes.depth, images]
            },
        },
        Recipe {
            name: "inverse z",
            code: include_str!("inverse_z.wgsl"),
            transform: Some((5, nz, Direction::Inverse)),
            buffers: vec![&b.rows, &b.grid, &b.row_best],
            groups: |sizes, lines, _, images| {
                let [nx, ny, _] = sizes.grid;
                [(ny / 2).div_ceil(lines[5]), nx, images]
            },
        },
        Recipe {
            name: "peaks",
            code: include_str!("peaks.wgsl"),
            transform: None,
            buffers: vec![&b.grid, &b.row_best, &b.peaks],
            groups: |_, _, _, images| [images, 1, 1],
        },
    ]
}

/// The sizes as WGSL, and declarations of all stages.
fn header(sizes: &Sizes) -> String {
    let [bx, by, bz] = sizes.block;
    let [mx, my, mz] = sizes.fine;
    let [nx, ny, nz] = sizes.grid;
    let [reach_x, reach_y, reach_z] = sizes.reach;
    let constants = [
        ("WIDTH", WIDTH),
        ("MAX_GROUPS", MAX_GROUPS),
        ("FIELDS", sizes.fields),
        ("KNOTS", sizes.knots),
        ("WINDOW", sizes.window),
        ("TERMS", sizes.terms),
        ("BX", bx),
        ("BY", by),
        ("BZ", bz),
        ("MX", mx),
        ("MY", my),
        ("MZ", mz),
        ("NX", nx),
        ("NY", ny),
        ("NZ", nz),
        ("DEPTH", sizes.depth),
        ("COLUMNS", sizes.columns),
        ("MODES", sizes.modes),
        ("LONGEST", sizes.longest),
        ("PEAKS", sizes.peaks),
        ("REACH_X", reach_x),
        ("REACH_Y", reach_y),
        ("REACH_Z", reach_z),
    ];
    let mut header: String = constants
        .iter()
        .map(|(name, value)| format!("const {name}: u32 = {value}u;\n"))
        .collect();
    header += &format!("const LOWEST: f32 = {:e};\n", f32::MIN);
    header += "struct Column { fine_y: u32, y: u32, side: u32, start: u32 }\n";
    header
}
