//! Minkowski sums by pairs (B&I section 5.1) on the card, written or streamed.
//!
//! Each set is moved to the middle of its box before it is rounded to single precision, so that an offset of both costs
//! no digits.

use super::kernel::{Kernel, constants, groups};
use super::{GpuDevice, GpuError, Job};
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

impl Job<Knot> {
    /// The sums of all pairs of two sets of balls (x, y, z, r), written: those of one ball of the first set together.
    ///
    /// A sum takes 16 bytes; more than a buffer may hold are divided among several. Cost: 16 bytes and 4 additions per
    /// sum.
    ///
    /// # Errors
    /// [`GpuError`] if a number is not finite, or the sums of a single ball are too many for a buffer.
    pub fn pair_sums(gpu: &GpuDevice, first: &[Knot], second: &[Knot]) -> Result<Self, GpuError> {
        let (a, b) = (Centered::new(gpu, first)?, Centered::new(gpu, second)?);
        let kernel = Kernel::new(gpu, "sums of pairs", "write", &source())?;
        let (firsts, seconds) = (
            gpu.filled("balls", &a.balls)?,
            gpu.filled("balls", &b.balls)?,
        );
        let (mut steps, mut parts) = (Vec::new(), Vec::new());
        let most = (gpu.binding_limit / (16 * second.len().max(1))).max(1);
        for start in (0..first.len()).step_by(most) {
            let rows = most.min(first.len() - start);
            let count = rows * second.len();
            let sums = gpu.zeros("sums of pairs", 16 * count)?;
            let sizes = [start, rows, second.len(), 0].map(|size| size as u32);
            let buffers = [&gpu.filled("sizes", &sizes)?, &firsts, &seconds, &sums];
            steps.push(kernel.step(gpu, &buffers, groups(count.div_ceil(WIDTH)))?);
            parts.push((sums, count));
        }
        let pairs = first.len() as f64 * second.len() as f64;
        let cost = Cost {
            bytes: 16.0 * pairs,
            operations: 4.0 * pairs,
        };
        let [x, y, z] = [0, 1, 2].map(|axis| a.middle[axis] + b.middle[axis]);
        Ok(Self::new(gpu, steps, parts, cost, move |sum: [f32; 4]| {
            let [a, b, c, r] = sum.map(f64::from);
            [a + x, b + y, c + z, r]
        }))
    }
}

impl Job<f64> {
    /// Signed distance from each place to the nearest of the sums of all pairs, none of which is written; infinite
    /// without a pair. As [`crate::minkowski::gap_of_balls`].
    ///
    /// Cost: per pair and place 3 subtractions, 5 operations of the square, 2 additions, a product and a comparison; per
    /// place and 512 balls of the first set these and all balls of the second, 16 bytes each.
    ///
    /// # Errors
    /// [`GpuError`] if a number is not finite, or a set is too large for a buffer.
    pub fn pair_distances(
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
        let across = first.len().div_ceil(ROWS);
        let mut steps = Vec::new();
        if !counts.contains(&0) {
            let tiles = second.len().div_ceil(WIDTH);
            let reach = (across * tiles * places.len() / MANY_GROUPS).clamp(1, MAX_TILES);
            let kernel = Kernel::new(gpu, "distances", "distances", &source())?;
            let [n1, n2, n] = counts.map(|count| count as u32);
            let buffers = [
                &gpu.filled("sizes", &[0, n1, n2, n])?,
                &gpu.filled("balls", &a.balls)?,
                &gpu.filled("balls", &b.balls)?,
                &gpu.filled("reach", &[reach as u32, 0, 0, 0])?,
                &gpu.filled("places", &moved)?,
                &nearest,
            ];
            let groups = groups(across * tiles.div_ceil(reach) * places.len());
            steps.push(kernel.step(gpu, &buffers, groups)?);
        }
        let [n1, n2, n] = counts.map(|count| count as f64);
        let cost = Cost {
            bytes: 16.0 * n * (n1 + across as f64 * n2),
            operations: 12.0 * n1 * n2 * n,
        };
        let outputs = vec![(nearest.clone(), places.len())];
        let job = Self::new(gpu, steps, outputs, cost, |key: u32| match key {
            0 => f64::INFINITY,
            key if key >> 31 == 1 => -f64::from(f32::from_bits(key ^ 0x8000_0000)),
            key => -f64::from(f32::from_bits(!key)),
        });
        Ok(job.clearing(&nearest))
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
