//! The sizes of a batch and the buffers that it works in.

use crate::engine::columns::Reading;
use crate::engine::cpu::Transforms;
use crate::gpu::line_fft::{LineFft, WIDTH};
use crate::gpu::{GpuDevice, GpuError};
use crate::transform::Real;
use crate::transform::modes::place;
use bytemuck::{Pod, Zeroable};

/// Sizes that a plan fixes.
#[derive(Clone, Debug)]
pub(super) struct Sizes {
    pub grid: [usize; 3],
    pub fine: [usize; 3],
    pub block: [usize; 3],
    pub fields: usize,
    pub knots: usize,
    /// Points of the spreading window, and terms of each point's polynomial.
    pub window: usize,
    pub terms: usize,
    /// Planes kz that hold modes.
    pub depth: usize,
    pub columns: usize,
    pub modes: usize,
    /// Images of a turn at the most.
    pub images: usize,
    /// Modes of the longest column.
    pub longest: usize,
    /// Peaks of an image, and how far each rules out others on each axis, voxels.
    pub peaks: usize,
    pub reach: [usize; 3],
    /// Whether the plane between the inverses along y and z fits a workgroup's memory.
    pub tile_fits: bool,
}

/// Turns and images of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Batch {
    pub turns: usize,
    pub images: usize,
}

/// Bytes of a number: single precision alone.
const REAL: usize = 4;

/// Turns in a batch: enough to fill a large card, few enough that no batch takes seconds.
const MAX_TURNS: usize = 32;

impl Sizes {
    /// Of an engine, with `peaks` peaks per image, each of which keeps `reach` voxels free on each side.
    pub fn new<T: Real>(
        gpu: &GpuDevice,
        engine: &Transforms<T>,
        peaks: usize,
        reach: usize,
    ) -> Self {
        let plan = &engine.plan;
        let modes = plan.modes();
        let kernel = engine.forward.kernel();
        let mut sizes = Self {
            grid: modes.size,
            fine: plan.fine(),
            block: engine.forward.block(),
            fields: engine.rank(),
            knots: engine.ligand.len(),
            window: kernel.width(),
            terms: kernel.coefficients().len(),
            depth: modes.planes.len(),
            columns: modes.columns.len(),
            modes: modes.count,
            images: engine.readings.len(),
            longest: (modes.columns.iter())
                .map(|column| column.count())
                .max()
                .unwrap_or(0),
            peaks,
            reach: modes.size.map(|n| reach.min((n - 1) / 2)),
            tile_fits: false,
        };
        let [_, ny, nz] = sizes.grid;
        let bytes = LineFft::bytes_of_line(ny.max(nz)) + 8 * sizes.tile() + REAL * WIDTH;
        sizes.tile_fits = bytes <= gpu.device.limits().max_compute_workgroup_storage_size as usize;
        sizes
    }

    /// Modes (kz, y) of a plane x, between the inverses along y and z.
    pub fn tile(&self) -> usize {
        self.depth * self.grid[1]
    }

    /// Peaks that an image of finite scores has at the least: each rules out no more voxels than its neighbourhood has.
    pub fn least_peaks(&self) -> usize {
        let of_peak: usize = self.reach.iter().map(|reach| 2 * reach + 1).product();
        let voxels: usize = self.grid.iter().product();
        self.peaks.min(voxels.div_ceil(of_peak))
    }

    /// Bytes per turn: the block, its rows along z, its columns before the transform along x, the ligand's modes. Bytes
    /// per image: the product's columns, its planes if they do not fit a workgroup's memory, the scores, the best of each
    /// row, the peaks.
    fn bytes(&self) -> ([usize; 4], [usize; 5]) {
        const COMPLEX: usize = 2 * REAL;
        let ([nx, ny, nz], [bx, by, bz]) = (self.grid, self.block);
        let of_turn = [
            REAL * self.fields * bx * by * bz,
            COMPLEX * self.fields * bx * self.depth * by,
            COMPLEX * self.fields * self.columns * bx,
            COMPLEX * self.fields * self.modes,
        ];
        let of_image = [
            COMPLEX * self.columns * nx,
            if self.tile_fits {
                0
            } else {
                COMPLEX * nx * self.tile()
            },
            REAL * nx * ny * nz,
            REAL * nx * ny,
            8 * self.peaks,
        ];
        (of_turn, of_image)
    }

    /// The largest batch that takes at most `memory` bytes and fits the adapter's limits.
    pub fn batch(&self, gpu: &GpuDevice, memory: u64) -> Result<Batch, GpuError> {
        let longest = gpu.binding_limit as u64;
        let (of_turn, of_image) = self.bytes();
        let fits = |batch: Batch| {
            let buffers = of_turn
                .iter()
                .map(|bytes| (batch.turns * bytes) as u64)
                .chain(of_image.iter().map(|bytes| (batch.images * bytes) as u64));
            buffers.clone().all(|bytes| bytes <= longest) && buffers.sum::<u64>() <= memory
        };
        let of = |turns: usize| Batch {
            turns,
            images: self.images * turns,
        };
        let chosen = (1..=MAX_TURNS).rev().map(of).find(|&batch| fits(batch));
        // A grid so large that the images of one turn do not fit goes image by image.
        let least = Batch {
            turns: 1,
            images: 1,
        };
        chosen.or(fits(least).then_some(least)).ok_or_else(|| {
            let needed: usize = of_turn.iter().chain(&of_image).sum();
            gpu.too_small(format!(
                "a rotation takes {:.0} MB, of {:.0} MB at hand, and no buffer may be longer than {:.0} MB",
                needed as f64 / 1e6,
                memory as f64 / 1e6,
                longest as f64 / 1e6
            ))
        })
    }
}

/// A column of modes as the stages know it.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Column {
    fine_y: u32,
    y: u32,
    side: u32,
    start: u32,
    plane: u32,
}

/// Everything on the card.
pub(super) struct Buffers {
    pub columns: wgpu::Buffer,
    pub planes: wgpu::Buffer,
    pub spectra: wgpu::Buffer,
    pub readings: wgpu::Buffer,
    pub knots: wgpu::Buffer,
    pub weights: wgpu::Buffer,
    pub window: wgpu::Buffer,
    pub turns: wgpu::Buffer,
    pub images: wgpu::Buffer,
    pub block: wgpu::Buffer,
    pub fine_rows: wgpu::Buffer,
    pub partial: wgpu::Buffer,
    pub turned: wgpu::Buffer,
    pub along: wgpu::Buffer,
    pub tiles: wgpu::Buffer,
    pub grid: wgpu::Buffer,
    pub row_best: wgpu::Buffer,
    pub peaks: wgpu::Buffer,
}

impl Buffers {
    /// Uploads what does not turn and makes room for a batch.
    pub fn new<T: Real>(
        gpu: &GpuDevice,
        engine: &Transforms<T>,
        sizes: &Sizes,
        batch: Batch,
    ) -> Result<Self, GpuError> {
        let modes = engine.plan.modes();
        let mut planes: Vec<u32> = modes
            .planes
            .iter()
            .map(|range| range.start as u32)
            .collect();
        planes.push(sizes.columns as u32);
        let units = units(engine);
        let weights: Vec<f32> = engine
            .weights
            .iter()
            .zip(units.iter().cycle())
            .map(|(weight, unit)| (weight.wide() / unit) as f32)
            .collect();
        let knots: Vec<[f32; 4]> = engine
            .ligand
            .iter()
            .map(|y| [y.x as f32, y.y as f32, y.z as f32, 0.0])
            .collect();
        let window: Vec<f32> = engine
            .forward
            .kernel()
            .coefficients()
            .iter()
            .flat_map(|points| &points[..sizes.window])
            .map(|value| value.wide() as f32)
            .collect();
        let Batch { turns, images } = batch;
        let (of_turn, of_image) = sizes.bytes();
        Ok(Self {
            columns: gpu.filled("columns", &columns(engine, sizes))?,
            planes: gpu.filled("planes", &planes)?,
            spectra: gpu.filled("spectra", &spectra(engine, &units))?,
            readings: gpu.filled("readings", &readings(engine))?,
            knots: gpu.filled("knots", &knots)?,
            weights: gpu.filled("weights", &weights)?,
            window: gpu.filled("window", &window)?,
            turns: gpu.zeros("turns", 48 * turns)?,
            images: gpu.zeros("images", 8 * images)?,
            block: gpu.zeros("block", turns * of_turn[0])?,
            fine_rows: gpu.zeros("fine rows", turns * of_turn[1])?,
            partial: gpu.zeros("partial", turns * of_turn[2])?,
            turned: gpu.zeros("turned", turns * of_turn[3])?,
            along: gpu.zeros("along", images * of_image[0])?,
            tiles: gpu.zeros("tiles", images * of_image[1])?,
            grid: gpu.zeros("grid", images * of_image[2])?,
            row_best: gpu.zeros("row best", images * of_image[3])?,
            peaks: gpu.zeros("peaks", images * of_image[4])?,
        })
    }
}

/// The columns of modes with their places on the grids.
fn columns<T: Real>(engine: &Transforms<T>, sizes: &Sizes) -> Vec<Column> {
    let modes = engine.plan.modes();
    modes
        .columns
        .iter()
        .map(|column| Column {
            fine_y: place(column.ky, sizes.fine[1]) as u32,
            y: place(column.ky, sizes.grid[1]) as u32,
            side: column.kx_max as u32,
            start: column.start as u32,
            plane: column.kz as u32,
        })
        .collect()
}

/// Where each image reads its columns: the first mode, and how ([`Reading::flags`]), `[image][column]`.
fn readings<T: Real>(engine: &Transforms<T>) -> Vec<[u32; 2]> {
    let columns = &engine.plan.modes().columns;
    let of = |reading: &Reading| {
        [
            columns[reading.column as usize].start as u32,
            reading.flags(),
        ]
    };
    engine.readings.iter().flatten().map(of).collect()
}

/// The receptor's spectra in the units of the fields: `[column][field][mode of the column]`.
fn spectra<T: Real>(engine: &Transforms<T>, units: &[f64]) -> Vec<[f32; 2]> {
    let modes = engine.plan.modes();
    let fields = engine.rank();
    let mut spectra = vec![[0f32; 2]; fields * modes.count];
    for (index, column) in modes.columns.iter().enumerate() {
        for (field, unit) in units.iter().enumerate() {
            let start = fields * column.start + field * column.count();
            let values = engine.spectrum(index, field);
            for (to, from) in spectra[start..start + column.count()]
                .iter_mut()
                .zip(values)
            {
                *to = [
                    (from.re.wide() * unit) as f32,
                    (from.im.wide() * unit) as f32,
                ];
            }
        }
    }
    spectra
}

/// Value of 1 in the spread block of whole numbers, by field: all knots of a field on one point would reach 2^30.
fn units<T: Real>(engine: &Transforms<T>) -> Vec<f64> {
    let fields = engine.rank();
    let mut sums = vec![0.0; fields];
    for weights in engine.weights.chunks_exact(fields) {
        for (sum, weight) in sums.iter_mut().zip(weights) {
            *sum += weight.wide().abs();
        }
    }
    sums.iter()
        .map(|sum| sum.max(f64::from(f32::MIN_POSITIVE)) / f64::from(1 << 30))
        .collect()
}
