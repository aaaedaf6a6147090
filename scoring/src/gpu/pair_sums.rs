//! Minkowski sums by pairs (B&I section 5.1) on the card, written or streamed.
//!
//! Each set is moved to the middle of its box before it is rounded to single precision, so that an offset of both costs
//! no digits.

use super::kernel::{Kernel, Step, constants, groups};
use super::{GpuDevice, GpuError};
use crate::minkowski::{Knot, Node};
use crate::processor::Cost;

/// Invocations of a workgroup.
const WIDTH: usize = 128;
/// Balls of the first set that a workgroup takes.
const ROWS: usize = 4 * WIDTH;
/// Workgroups that fill a large card.
const MANY_GROUPS: usize = 4096;
/// Most tiles of `WIDTH` balls that a workgroup takes: a driver may cut loops short after 65,536 rounds in all.
const MAX_TILES: usize = 128;

/// The sums of all pairs of two sets of balls (x, y, z, r), written.
pub struct PairSums {
    gpu: GpuDevice,
    steps: Vec<Step>,
    /// Each with its number of sums.
    parts: Vec<(wgpu::Buffer, usize)>,
    middle: Node,
}

/// Signed distances from places to the nearest of the sums of all pairs, none of which is written.
pub struct PairDistances {
    gpu: GpuDevice,
    steps: Vec<Step>,
    nearest: wgpu::Buffer,
    /// Of both sets, and places.
    counts: [usize; 3],
}

impl PairSums {
    /// Uploads both sets. A sum takes 16 bytes; more than one buffer may hold are divided among several.
    ///
    /// # Errors
    /// [`GpuError`] if a coordinate is not finite, or the sums of a single ball are too many for a buffer.
    pub fn new(gpu: &GpuDevice, first: &[Knot], second: &[Knot]) -> Result<Self, GpuError> {
        let (a, b) = (Centered::new(gpu, first)?, Centered::new(gpu, second)?);
        let source = source();
        let kernel = Kernel::new(gpu, "sums of pairs", "write", &source)?;
        let [firsts, seconds] = [&a, &b].map(|set| gpu.filled("balls", &set.balls));
        let (firsts, seconds) = (firsts?, seconds?);
        let (mut steps, mut parts) = (Vec::new(), Vec::new());
        let most = (gpu.binding_limit / (16 * second.len().max(1))).max(1);
        for start in (0..first.len()).step_by(most) {
            let rows = most.min(first.len() - start);
            let count = rows * second.len();
            let sums = gpu.zeros("sums of pairs", 16 * count)?;
            let sizes = gpu.filled(
                "sizes",
                &[start as u32, rows as u32, second.len() as u32, 0],
            )?;
            let buffers = [&sizes, &firsts, &seconds, &sums];
            steps.push(kernel.step(gpu, &buffers, groups(count.div_ceil(WIDTH)))?);
            parts.push((sums, count));
        }
        Ok(Self {
            gpu: gpu.clone(),
            steps,
            parts,
            middle: [0, 1, 2].map(|axis| a.middle[axis] + b.middle[axis]),
        })
    }

    /// Writes the sums to the card's memory, and waits.
    ///
    /// # Errors
    /// [`GpuError::Driver`] if the driver fails.
    pub fn run(&self) -> Result<(), GpuError> {
        self.gpu.run(&[], &self.steps)
    }

    /// The sums (x, y, z, r), those of one ball of the first set together.
    ///
    /// # Errors
    /// [`GpuError::Driver`] if the driver fails.
    pub fn read(&self) -> Result<Vec<Knot>, GpuError> {
        let [x, y, z] = self.middle;
        let mut all = Vec::new();
        for (sums, count) in &self.parts {
            let sums: Vec<[f32; 4]> = self.gpu.read(sums, *count)?;
            let moved = |sum: &[f32; 4]| {
                let [a, b, c, r] = sum.map(f64::from);
                [a + x, b + y, c + z, r]
            };
            all.extend(sums.iter().map(moved));
        }
        Ok(all)
    }

    /// 16 bytes and 4 additions per sum.
    pub fn cost(&self) -> Cost {
        let sums: usize = self.parts.iter().map(|(_, count)| count).sum();
        Cost {
            bytes: 16.0 * sums as f64,
            operations: 4.0 * sums as f64,
        }
    }
}

impl PairDistances {
    /// Uploads both sets and the places.
    ///
    /// # Errors
    /// [`GpuError`] if a coordinate is not finite, or a set is too large for a buffer.
    pub fn new(
        gpu: &GpuDevice,
        first: &[Knot],
        second: &[Knot],
        places: &[Node],
    ) -> Result<Self, GpuError> {
        let (a, b) = (Centered::new(gpu, first)?, Centered::new(gpu, second)?);
        gpu.finite("place", places)?;
        let moved: Vec<[f32; 4]> = places
            .iter()
            .map(|place| {
                let at = |axis: usize| (place[axis] - a.middle[axis] - b.middle[axis]) as f32;
                [at(0), at(1), at(2), 0.0]
            })
            .collect();
        let nearest = gpu.zeros("distances", 4 * places.len())?;
        let counts = [first.len(), second.len(), places.len()];
        let mut steps = Vec::new();
        if !counts.contains(&0) {
            let across = first.len().div_ceil(ROWS);
            let tiles = second.len().div_ceil(WIDTH);
            let reach = (across * tiles * places.len() / MANY_GROUPS).clamp(1, MAX_TILES);
            let source = source();
            let kernel = Kernel::new(gpu, "distances", "distances", &source)?;
            let sizes = [0, counts[0] as u32, counts[1] as u32, counts[2] as u32];
            let buffers = [
                &gpu.filled("sizes", &sizes)?,
                &gpu.filled("balls", &a.balls)?,
                &gpu.filled("balls", &b.balls)?,
                &gpu.filled("reach", &[reach as u32, 0, 0, 0])?,
                &gpu.filled("places", &moved)?,
                &nearest,
            ];
            let groups = groups(across * tiles.div_ceil(reach) * places.len());
            steps.push(kernel.step(gpu, &buffers, groups)?);
        }
        Ok(Self {
            gpu: gpu.clone(),
            steps,
            nearest,
            counts,
        })
    }

    /// Computes the distances, and waits.
    ///
    /// # Errors
    /// [`GpuError::Driver`] if the driver fails.
    pub fn run(&self) -> Result<(), GpuError> {
        self.gpu.run(&[&self.nearest], &self.steps)
    }

    /// The distances by place, as [`crate::minkowski::gap_of_balls`]; infinite without a pair.
    ///
    /// # Errors
    /// [`GpuError::Driver`] if the driver fails.
    pub fn read(&self) -> Result<Vec<f64>, GpuError> {
        let keys: Vec<u32> = self.gpu.read(&self.nearest, self.counts[2])?;
        let distance = |key: u32| match key {
            0 => f64::INFINITY,
            key if key >> 31 == 1 => -f64::from(f32::from_bits(key ^ 0x8000_0000)),
            key => -f64::from(f32::from_bits(!key)),
        };
        Ok(keys.into_iter().map(distance).collect())
    }

    /// Per pair and place 3 subtractions, 5 operations of the square, 2 additions of radii, a product and a comparison;
    /// per place and tile its balls and, per four balls of the first set, themselves: 16 bytes each.
    pub fn cost(&self) -> Cost {
        let [a, b, places] = self.counts.map(|count| count as f64);
        Cost {
            bytes: 16.0 * places * (a / ROWS as f64).ceil() * (b + ROWS as f64),
            operations: 12.0 * a * b * places,
        }
    }
}

fn source() -> String {
    constants(&[("WIDTH", WIDTH)]) + include_str!("pair_sums.wgsl")
}

/// Balls about the middle of the box of their centres.
struct Centered {
    balls: Vec<[f32; 4]>,
    middle: Node,
}

impl Centered {
    fn new(gpu: &GpuDevice, balls: &[Knot]) -> Result<Self, GpuError> {
        gpu.finite("ball", balls)?;
        let middle = [0, 1, 2].map(|axis| {
            let along = balls.iter().map(|ball| ball[axis]);
            let low = along.clone().fold(f64::INFINITY, f64::min);
            let high = along.fold(f64::NEG_INFINITY, f64::max);
            if balls.is_empty() {
                0.0
            } else {
                0.5 * low + 0.5 * high
            }
        });
        let moved = |[x, y, z, r]: &Knot| {
            [x - middle[0], y - middle[1], z - middle[2], *r].map(|part| part as f32)
        };
        Ok(Self {
            balls: balls.iter().map(moved).collect(),
            middle,
        })
    }
}
