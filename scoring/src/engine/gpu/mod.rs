//! The engine on a graphics processor: the plan, the spectra and the answers of [`CpuEngine`], many rotations in
//! flight.
//!
//! All runs through wgpu (Vulkan, Metal, Direct3D 12), in single precision. A batch of turned ligands goes through the
//! stages of the engine on the CPU, one dispatch each. They are: spreading, the three pruned forward transforms, the
//! product with the inverse along x (four or eight images from one transform), the inverses along y and z plane by plane,
//! and the peaks.
//! Only the peaks come back. Knots are spread in whole numbers, whose sum does not depend on the order of the
//! additions: one card gives the same bits each time.

mod buffers;
mod stages;

use super::cpu::{CpuEngine, Transforms};
use crate::gpu::{GpuDevice, GpuError};
use crate::grid_turn::GridTurn;
use crate::precision::of_precision;
use crate::processor::Cost;
use crate::transform::Real;
use buffers::{Batch, Buffers, Sizes};
use nalgebra::UnitQuaternion;
use stages::Stages;
use std::collections::VecDeque;
use std::time::Instant;

/// A prepared correlation of one pair on a graphics processor.
pub struct GpuEngine {
    gpu: GpuDevice,
    sizes: Sizes,
    batch: Batch,
    buffers: Buffers,
    stages: Stages,
    /// Å to cells of the block, per axis, and the block's centre in it.
    scale: [f64; 3],
    center: [f64; 3],
    /// From the axes of the receptor's file to the grid's.
    frame: UnitQuaternion<f64>,
}

/// One rotation of the ligand, and which of its images are wanted: turns of the grid that follow it.
#[derive(Clone, Copy, Debug)]
pub struct LigandRotation {
    /// The rotation.
    pub rotation: UnitQuaternion<f64>,
    /// In the order of [`GridTurn::ALL`]; of [`CpuEngine::turns`] alone.
    pub wanted: [bool; GridTurn::ALL.len()],
}

/// One of the best voxels of one image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridPeak {
    /// Index of the turn among those given.
    pub turn: usize,
    /// Index of the image's turn in [`GridTurn::ALL`].
    pub image: usize,
    /// Voxel, row-major.
    pub voxel: u32,
    /// G there.
    pub score: f32,
}

/// What a stage takes and does for one image. A turn's transforms are shared by its images.
#[derive(Clone, Copy, Debug)]
pub struct StageCost {
    /// What it does.
    pub name: &'static str,
    /// Time.
    pub seconds: f64,
    /// Each value is read once and written once; a transform of n points counts 5 n log2 n operations.
    pub cost: Cost,
}

/// An image of a batch: which turn of all, and which turn of the grid.
#[derive(Clone, Copy)]
struct Image {
    turn: usize,
    image: usize,
}

/// Batches that may be under way before the first is waited for.
const AHEAD: usize = 2;

impl GpuEngine {
    /// Takes an engine to the card.
    ///
    /// It finds up to `peaks` (at least 1) voxels a rotation, each more than `reach` voxels from the others on some
    /// axis. Rotations in flight take at most `memory` bytes of the card.
    ///
    /// # Errors
    /// [`GpuError`] where the grid does not fit the card or the driver fails.
    pub fn new(
        gpu: &GpuDevice,
        engine: &CpuEngine,
        peaks: usize,
        reach: usize,
        memory: u64,
    ) -> Result<Self, GpuError> {
        of_precision!(&engine.0, transforms => Self::of(gpu, transforms, peaks, reach, memory))
    }

    fn of<T: Real>(
        gpu: &GpuDevice,
        engine: &Transforms<T>,
        peaks: usize,
        reach: usize,
        memory: u64,
    ) -> Result<Self, GpuError> {
        let sizes = Sizes::new(gpu, engine, peaks.max(1), reach);
        let batch = sizes.batch(gpu, memory)?;
        let buffers = Buffers::new(gpu, engine, &sizes, batch)?;
        let stages = Stages::new(gpu, &sizes, &buffers)?;
        Ok(Self {
            gpu: gpu.clone(),
            sizes,
            batch,
            buffers,
            stages,
            scale: engine.forward.cells_per_length(),
            center: engine.forward.center(),
            frame: engine.plan.frame(),
        })
    }

    /// Rotations that go through together, images counted.
    pub fn in_flight(&self) -> usize {
        self.batch.images
    }

    /// Takes the device from the engine, as if it were lost: for tests.
    #[doc(hidden)]
    pub fn lose_device(&self) {
        self.gpu.device.destroy();
    }

    /// The best voxels of every wanted image of every turn, in the order of the turns.
    ///
    /// `done` is called with the number of images as they are finished.
    ///
    /// # Errors
    /// [`GpuError::Driver`] where the driver fails.
    pub fn best(
        &self,
        turns: &[LigandRotation],
        done: &mut dyn FnMut(usize),
    ) -> Result<Vec<GridPeak>, GpuError> {
        let all: Vec<Image> = turns
            .iter()
            .enumerate()
            .flat_map(|(turn, wanted)| {
                let images = (0..wanted.wanted.len()).filter(|&image| wanted.wanted[image]);
                images.map(move |image| Image { turn, image })
            })
            .collect();
        assert!(
            all.iter().all(|image| image.image < self.sizes.images),
            "the grid has no such turn"
        );
        if all.is_empty() {
            return Ok(Vec::new());
        }
        let bytes = 8 * self.sizes.peaks * all.len();
        let results = self.gpu.readable(bytes);
        let mut under_way: VecDeque<(wgpu::SubmissionIndex, usize)> = VecDeque::new();
        let mut at = 0;
        for images in self.batches(&all) {
            let mut encoder = self.encode(turns, images, self.stages.len());
            let length = (8 * self.sizes.peaks * images.len()) as u64;
            encoder.copy_buffer_to_buffer(&self.buffers.peaks, 0, &results, at, length);
            at += length;
            under_way.push_back((self.gpu.queue.submit([encoder.finish()]), images.len()));
            if under_way.len() > AHEAD
                && let Some((submission, count)) = under_way.pop_front()
            {
                self.gpu.wait(submission)?;
                done(count);
            }
        }
        for (submission, count) in under_way {
            self.gpu.wait(submission)?;
            done(count);
        }
        let records: Vec<[u32; 2]> = self
            .gpu
            .read_mapped(&results, |bytes| bytemuck::cast_slice(bytes).to_vec())?;
        let least = self.sizes.least_peaks();
        let mut peaks = Vec::with_capacity(records.len());
        for (records, image) in records.chunks_exact(self.sizes.peaks).zip(&all) {
            let before = peaks.len();
            // A grid may hold fewer voxels than requested: 0 is none, else voxel + 1.
            let found = records.iter().filter_map(|&[place, bits]| {
                place.checked_sub(1).map(|voxel| GridPeak {
                    turn: image.turn,
                    image: image.image,
                    voxel,
                    score: f32::from_bits(bits),
                })
            });
            peaks.extend(found);
            if peaks.len() - before < least {
                return Err(self.gpu.driver(format!(
                    "{} peaks came of a grid that has {least} or more: scores that are not finite, or a stage that the driver cut short",
                    peaks.len() - before
                )));
            }
        }
        Ok(peaks)
    }

    /// G over all translations at one rotation followed by a turn of the grid, (nx, ny, nz) row-major: for checks, one at a
    /// time.
    ///
    /// # Errors
    /// [`GpuError::Driver`] where the driver fails.
    pub fn correlate(
        &self,
        rotation: &UnitQuaternion<f64>,
        turn: GridTurn,
    ) -> Result<Vec<f32>, GpuError> {
        let image = turn.index();
        let wanted = GridTurn::ALL.map(|one| one == turn);
        let turn = LigandRotation {
            rotation: *rotation,
            wanted,
        };
        let encoder = self.encode(&[turn], &[Image { turn: 0, image }], self.stages.len() - 1);
        let submission = self.gpu.queue.submit([encoder.finish()]);
        self.gpu.wait(submission)?;
        let bytes = 4 * self.sizes.grid.iter().product::<usize>();
        self.gpu.read(&self.buffers.grid, bytes, |bytes| {
            bytemuck::cast_slice(bytes).to_vec()
        })
    }

    /// What each stage takes and does, of a full batch, divided by its images.
    ///
    /// Each time is the least of a few measurements. Stages are submitted and awaited one by one, so that together they
    /// take longer than a whole batch.
    ///
    /// # Errors
    /// [`GpuError::Driver`] where the driver fails.
    pub fn stages(&self, rotation: &UnitQuaternion<f64>) -> Result<Vec<StageCost>, GpuError> {
        const REPEATS: usize = 5;
        let turn = LigandRotation {
            rotation: *rotation,
            wanted: [true; GridTurn::ALL.len()],
        };
        let images: Vec<Image> = (0..self.batch.images)
            .map(|index| Image {
                turn: index / self.sizes.images,
                image: index % self.sizes.images,
            })
            .collect();
        let turns = vec![turn; self.batch.turns];
        let counts = (self.batch.turns, images.len());
        let mut costs = Vec::new();
        for stage in 0..self.stages.len() {
            let mut least = f64::INFINITY;
            for _ in 0..REPEATS {
                // The stages before give it its data.
                let before = self.encode(&turns, &images, stage);
                self.gpu.wait(self.gpu.queue.submit([before.finish()]))?;
                let mut encoder = self
                    .gpu
                    .device
                    .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
                self.stages
                    .record(&mut encoder, &self.sizes, counts, stage..stage + 1);
                let start = Instant::now();
                self.gpu.wait(self.gpu.queue.submit([encoder.finish()]))?;
                least = least.min(start.elapsed().as_secs_f64());
            }
            let (name, cost) = self.stages.of(stage);
            costs.push(StageCost {
                name,
                seconds: least / images.len() as f64,
                cost,
            });
        }
        Ok(costs)
    }

    /// Runs of images that fit a batch, no turn's divided among two but where one alone is too many.
    fn batches<'a>(&self, all: &'a [Image]) -> Vec<&'a [Image]> {
        let mut batches = Vec::new();
        let mut rest = all;
        while !rest.is_empty() {
            let mut count = 0;
            let groups = rest.chunk_by(|a, b| a.turn == b.turn);
            for group in groups.take(self.batch.turns) {
                if count + group.len() > self.batch.images {
                    break;
                }
                count += group.len();
            }
            // Where not even one turn's images fit: as many of them as do.
            let count = if count == 0 { self.batch.images } else { count };
            let (batch, after) = rest.split_at(count.min(rest.len()));
            batches.push(batch);
            rest = after;
        }
        batches
    }

    /// The commands of the first `stages` stages of a batch, whose turns and images are written to the card.
    fn encode(
        &self,
        turns: &[LigandRotation],
        images: &[Image],
        stages: usize,
    ) -> wgpu::CommandEncoder {
        let mut rows: Vec<[f32; 4]> = Vec::with_capacity(3 * self.batch.turns);
        let mut table: Vec<[u32; 2]> = Vec::with_capacity(images.len());
        for group in images.chunk_by(|a, b| a.turn == b.turn) {
            let slot = (rows.len() / 3) as u32;
            let matrix = (self.frame * turns[group[0].turn].rotation).to_rotation_matrix();
            for axis in 0..3 {
                let row = [0, 1, 2].map(|j| (matrix[(axis, j)] * self.scale[axis]) as f32);
                rows.push([row[0], row[1], row[2], self.center[axis] as f32]);
            }
            table.extend(group.iter().map(|image| [slot, image.image as u32]));
        }
        let queue = &self.gpu.queue;
        queue.write_buffer(&self.buffers.turns, 0, bytemuck::cast_slice(&rows));
        queue.write_buffer(&self.buffers.images, 0, bytemuck::cast_slice(&table));
        let mut encoder = self
            .gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.clear_buffer(&self.buffers.block, 0, None);
        // A driver that cuts a stage short must not leave the last batch's peaks standing.
        encoder.clear_buffer(&self.buffers.peaks, 0, None);
        let counts = (rows.len() / 3, images.len());
        self.stages
            .record(&mut encoder, &self.sizes, counts, 0..stages);
        encoder
    }
}
