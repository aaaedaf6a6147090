//! The stages of a batch: what each computes, on which buffers, in how many workgroups.

use super::buffers::{Buffers, Sizes};
use crate::gpu::kernel::{Kernel, Step, constants, groups};
use crate::gpu::line_fft::{Direction, LineFft, MAX_LINES, WIDTH};
use crate::gpu::{GpuDevice, GpuError};
use crate::processor::Cost;
use std::ops::Range;

/// A compiled stage with its buffers.
struct Stage {
    name: &'static str,
    step: Step,
    /// Workgroups for a number of turns and images.
    groups: fn(&Sizes, &Lines, usize, usize) -> [usize; 3],
    /// For each image, a turn's share counted.
    cost: Cost,
}

/// Lines that a workgroup of each transform takes.
#[derive(Clone, Copy, Debug)]
struct Lines {
    forward_z: usize,
    forward_y: usize,
    forward_x: usize,
    inverse_x: usize,
    inverse_yz: usize,
}

/// All stages, in order.
pub(super) struct Stages {
    stages: Vec<Stage>,
    lines: Lines,
}

/// The parts of a stage.
struct Recipe<'a> {
    name: &'static str,
    code: String,
    /// Transforms, each with the suffix of its names.
    transforms: Vec<(&'static str, LineFft)>,
    buffers: Vec<&'a wgpu::Buffer>,
    groups: fn(&Sizes, &Lines, usize, usize) -> [usize; 3],
    /// For each turn, or for each image. Each value is read once and written once.
    cost: Cost,
}

impl Stages {
    /// Compiles the stages for a plan's sizes.
    pub fn new(gpu: &GpuDevice, sizes: &Sizes, buffers: &Buffers) -> Result<Self, GpuError> {
        let lines = Lines::new(gpu, sizes)?;
        let header = header(sizes);
        let forward = forward_recipes(sizes, &lines, buffers);
        let inverse = inverse_recipes(sizes, &lines, buffers);
        let of_turn = forward.into_iter().map(|mut recipe| {
            recipe.cost.bytes /= sizes.images as f64;
            recipe.cost.operations /= sizes.images as f64;
            recipe
        });
        let stages = of_turn
            .chain(inverse)
            .map(|recipe| recipe.compile(gpu, &header))
            .collect::<Result<_, _>>()?;
        gpu.check()?;
        Ok(Self { stages, lines })
    }

    /// Number of stages, the last of which overwrites the grids with the neighbourhoods of their peaks.
    pub fn len(&self) -> usize {
        self.stages.len()
    }

    /// Name of a stage, and its work for an image.
    pub fn of(&self, stage: usize) -> (&'static str, Cost) {
        (self.stages[stage].name, self.stages[stage].cost)
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
            let groups = (stage.groups)(sizes, &self.lines, turns, images);
            stage.step.record(&mut pass, groups);
        }
    }
}

impl Recipe<'_> {
    fn compile(&self, gpu: &GpuDevice, header: &str) -> Result<Stage, GpuError> {
        let mut source = String::from(header);
        let mut tables = Vec::new();
        let transforms: Vec<LineFft> = self.transforms.iter().map(|(_, one)| *one).collect();
        source += &LineFft::arrays(&transforms);
        for (suffix, transform) in &self.transforms {
            let code = transform.source(suffix).ok_or_else(|| {
                gpu.too_small(format!(
                    "no transform of {} points, which a prime above 7 divides",
                    transform.length
                ))
            })?;
            let of = suffix.to_uppercase();
            source += &format!("const LINES{of}: u32 = {}u;\n{code}", transform.lines);
            let table = gpu.filled("twiddle", &transform.twiddles())?;
            tables.push(table);
        }
        source += &self.code;
        let kernel = Kernel::new(gpu, self.name, "main", &source)?;
        let buffers: Vec<&wgpu::Buffer> =
            tables.iter().chain(self.buffers.iter().copied()).collect();
        Ok(Stage {
            name: self.name,
            // The number of workgroups is each batch's own.
            step: kernel.step(gpu, &buffers, [0; 3])?,
            groups: self.groups,
            cost: self.cost,
        })
    }
}

impl Lines {
    /// By a workgroup's memory.
    fn new(gpu: &GpuDevice, sizes: &Sizes) -> Result<Self, GpuError> {
        let [mx, my, mz] = sizes.fine;
        let [nx, ny, nz] = sizes.grid;
        let allowed = gpu.device.limits().max_compute_workgroup_storage_size as usize;
        let most = |length: usize, allowed: usize| {
            let bytes = LineFft::bytes_of_line(length);
            match allowed / bytes {
                0 => Err(gpu.too_small(format!(
                    "a line of {length} points takes {bytes} bytes of workgroup memory, and there are {allowed}"
                ))),
                lines => Ok(lines.min(MAX_LINES)),
            }
        };
        // Half of the memory if a line fits it, so that two workgroups share a core.
        let of = |length| most(length, allowed / 2).or_else(|_| most(length, allowed));
        let beside = 4 * WIDTH + if sizes.tile_fits { 8 * sizes.tile() } else { 0 };
        Ok(Self {
            forward_z: of(mz)?,
            forward_y: of(my)?,
            forward_x: of(mx)?,
            inverse_x: of(nx)?,
            inverse_yz: most(ny.max(nz), allowed - beside)?,
        })
    }
}

/// The transform of lines of a length.
fn fft(length: usize, lines: usize, direction: Direction) -> LineFft {
    LineFft {
        length,
        lines,
        direction,
    }
}

/// Bytes of a complex number.
const COMPLEX: f64 = 8.0;

/// The stages from the ligand's knots to the modes of each turn.
fn forward_recipes<'a>(sizes: &Sizes, lines: &Lines, b: &'a Buffers) -> [Recipe<'a>; 4] {
    use Direction::Forward;
    let [mx, my, mz] = sizes.fine;
    let [bx, by, bz] = sizes.block.map(|n| n as f64);
    let [fields, depth, columns] = [sizes.fields, sizes.depth, sizes.columns].map(|n| n as f64);
    let spread = (sizes.knots * sizes.window.pow(3)) as f64 * fields;
    let rows = COMPLEX * fields * bx * depth * by;
    let partial = COMPLEX * fields * columns * bx;
    let turned = COMPLEX * fields * sizes.modes as f64;
    [
        Recipe {
            name: "spread",
            code: include_str!("spread.wgsl").into(),
            transforms: Vec::new(),
            buffers: vec![&b.knots, &b.weights, &b.window, &b.turns, &b.block],
            groups: |sizes, _, turns, _| {
                let rows = sizes.knots * sizes.window * sizes.window;
                let [x, y, _] = groups(rows.div_ceil(WIDTH));
                [x, y, turns]
            },
            // The block is cleared, and each point of a window is read and written.
            cost: Cost {
                bytes: 4.0 * fields * bx * by * bz + 8.0 * spread,
                operations: 2.0 * spread,
            },
        },
        Recipe {
            name: "forward z",
            code: include_str!("forward_z.wgsl").into(),
            transforms: vec![("", fft(mz, lines.forward_z, Forward))],
            buffers: vec![&b.block, &b.fine_rows],
            groups: |sizes, lines, turns, _| {
                let [bx, by, _] = sizes.block;
                let across = (by / 2).div_ceil(lines.forward_z);
                [across, bx, turns * sizes.fields]
            },
            cost: Cost {
                bytes: 4.0 * fields * bx * by * bz + rows,
                operations: fields * bx * by / 2.0 * LineFft::flops_of_line(mz),
            },
        },
        Recipe {
            name: "forward y",
            code: include_str!("forward_y.wgsl").into(),
            transforms: vec![("", fft(my, lines.forward_y, Forward))],
            buffers: vec![&b.columns, &b.planes, &b.fine_rows, &b.partial],
            groups: |sizes, lines, turns, _| {
                let across = sizes.block[0].div_ceil(lines.forward_y);
                [across, sizes.depth, turns * sizes.fields]
            },
            cost: Cost {
                bytes: rows + partial,
                operations: fields * bx * depth * LineFft::flops_of_line(my),
            },
        },
        Recipe {
            name: "forward x",
            code: include_str!("forward_x.wgsl").into(),
            transforms: vec![("", fft(mx, lines.forward_x, Forward))],
            buffers: vec![&b.columns, &b.partial, &b.turned],
            groups: |sizes, lines, turns, _| {
                let across = sizes.columns.div_ceil(lines.forward_x);
                [across, turns * sizes.fields, 1]
            },
            cost: Cost {
                bytes: partial + turned,
                operations: fields * columns * LineFft::flops_of_line(mx),
            },
        },
    ]
}

/// The stages from the modes of each turn to the peaks of each image.
fn inverse_recipes<'a>(sizes: &Sizes, lines: &Lines, b: &'a Buffers) -> [Recipe<'a>; 3] {
    use Direction::Inverse;
    let [nx, ny, nz] = sizes.grid;
    let rows = (nx * ny) as f64;
    let along = COMPLEX * (sizes.columns * nx) as f64;
    // The ligand's modes and the receptor's.
    let modes = 2.0 * COMPLEX * (sizes.fields * sizes.modes) as f64;
    let tile = COMPLEX * (nx * sizes.tile()) as f64;
    let mut of_yz = vec![&b.columns, &b.planes, &b.along, &b.grid, &b.row_best];
    if !sizes.tile_fits {
        of_yz.push(&b.tiles);
    }
    [
        Recipe {
            name: "product and inverse x",
            code: include_str!("product.wgsl").into(),
            transforms: vec![("", fft(nx, lines.inverse_x, Inverse))],
            buffers: vec![
                &b.columns,
                &b.spectra,
                &b.turned,
                &b.images,
                &b.along,
                &b.readings,
            ],
            groups: |sizes, lines, _, images| [sizes.columns.div_ceil(lines.inverse_x), images, 1],
            cost: Cost {
                bytes: modes + along,
                // A complex product and sum: eight operations.
                operations: modes / 2.0 + sizes.columns as f64 * LineFft::flops_of_line(nx),
            },
        },
        Recipe {
            name: "inverse y and z",
            code: tile_source(sizes) + include_str!("inverse_yz.wgsl"),
            transforms: vec![
                ("_y", fft(ny, lines.inverse_yz, Inverse)),
                ("_z", fft(nz, lines.inverse_yz, Inverse)),
            ],
            buffers: of_yz,
            groups: |sizes, _, _, images| [sizes.grid[0], images, 1],
            cost: Cost {
                bytes: along
                    + 4.0 * rows * nz as f64
                    + 4.0 * rows
                    + if sizes.tile_fits { 0.0 } else { 2.0 * tile },
                operations: (nx * sizes.depth) as f64 * LineFft::flops_of_line(ny)
                    + rows / 2.0 * LineFft::flops_of_line(nz),
            },
        },
        Recipe {
            name: "peaks",
            code: include_str!("peaks.wgsl").into(),
            transforms: Vec::new(),
            buffers: vec![&b.grid, &b.row_best, &b.peaks],
            groups: |_, _, _, images| [images, 1, 1],
            cost: Cost {
                bytes: 4.0 * sizes.peaks as f64 * rows,
                operations: 0.0,
            },
        },
    ]
}

/// The plane between the inverses along y and z: in the workgroup's memory if it fits, else in the card's.
fn tile_source(sizes: &Sizes) -> String {
    let count = sizes.tile();
    if sizes.tile_fits {
        format!(
            "var<workgroup> tile: array<vec2<f32>, {count}>;\n\
             const TILE: u32 = 0u;\n\
             fn tileBarrier() {{ workgroupBarrier(); }}\n"
        )
    } else {
        format!(
            "@group(0) @binding(7) var<storage, read_write> tile: array<vec2<f32>>;\n\
             const TILE: u32 = {count}u;\n\
             fn tileBarrier() {{ storageBarrier(); workgroupBarrier(); }}\n"
        )
    }
}

/// The sizes as WGSL, and declarations of all stages.
fn header(sizes: &Sizes) -> String {
    let [bx, by, bz] = sizes.block;
    let [mx, my, mz] = sizes.fine;
    let [nx, ny, nz] = sizes.grid;
    let [reach_x, reach_y, reach_z] = sizes.reach;
    let mut header = constants(&[
        ("WIDTH", WIDTH),
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
    ]);
    header += &format!("const LOWEST: f32 = {:e};\n", f32::MIN);
    header += "struct Column { fine_y: u32, y: u32, side: u32, start: u32, plane: u32 }\n";
    header
}
