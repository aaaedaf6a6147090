//! The gap function on a uniform periodic grid (B&I section 5.2, Fig. 7) on the card.
//!
//! Both solids' summed bumps f_A and f_B are the real and imaginary part of one array, so that one complex transform
//! gives both spectra. Their product A conj(B) goes back by another. Conventions are those of [`crate::gap_grid`].
//!
//! Errors are those of single precision: of each sampled value a few roundings, and of a transform by about log2 of its
//! length roundings of the root mean square. They are a share of the largest value of g, so that values far below it
//! keep fewer digits.

use super::kernel::{Kernel, constants, groups};
use super::line_fft::{Direction, WIDTH};
use super::lines::Axis;
use super::{GpuDevice, GpuError, Job};
use crate::minkowski::Knot;
use crate::processor::Cost;

/// Points of a block along x, y and z.
const BLOCK: [usize; 3] = [4, 4, 8];
/// Most balls near one block: a driver may cut loops short after 65,536 rounds.
const MAX_NEAR: u32 = 60_000;

/// The gap function of two sets of balls.
pub struct GapGrid {
    /// Samples both solids on the grid: the real and imaginary part of its points, row-major, z fastest.
    ///
    /// Cost: per ball near a block 16 bytes and, at each of its 128 points, 15 operations; 8 bytes per grid point.
    pub rasterise: Job<[f32; 2]>,
    /// Transforms the sampled solids, multiplies and transforms back: the values, row-major, z fastest, translation zero
    /// first. The samples are lost: to be run once after each run of `rasterise`.
    ///
    /// Cost: in each of six passes 16 bytes per point and 5 n log2 n operations per line of n; in the product 24 bytes
    /// and 14 operations per point.
    pub correlate: Job<f64>,
}

impl GapGrid {
    /// Sorts the balls (x, y, z, r) of both solids by the blocks of points that they touch, and uploads them. The cube has
    /// the given edge and an even number of points per axis, without a prime above 7.
    ///
    /// # Errors
    /// [`GpuError`] if a number is not finite, or the grid does not fit a buffer.
    pub fn new(
        gpu: &GpuDevice,
        balls: [&[Knot]; 2],
        per_axis: usize,
        edge: f64,
    ) -> Result<Self, GpuError> {
        if per_axis == 0 || per_axis % 2 == 1 || !(edge > 0.0 && edge.is_finite()) {
            return Err(GpuError::Input(format!(
                "a cube of edge {edge} with {per_axis} points per axis; an even number and an edge above zero are needed"
            )));
        }
        for balls in balls {
            gpu.finite("ball", balls)?;
        }
        if let Some(large) = balls.iter().copied().flatten().find(|ball| ball[3] > edge) {
            return Err(GpuError::Input(format!(
                "a ball of radius {} in a cube of edge {edge}; no larger one than the edge is possible",
                large[3]
            )));
        }
        let points = per_axis
            .checked_pow(3)
            .filter(|points| *points <= usize::MAX / 8);
        let points = points.ok_or_else(|| {
            gpu.too_small(format!(
                "{per_axis} points per axis are more than memory can have"
            ))
        })?;
        let arrays = [
            gpu.zeros("grid", 8 * points)?,
            gpu.zeros("grid", 8 * points)?,
        ];
        let (starts, near) = near_blocks(balls, per_axis, edge);
        if starts.windows(3).any(|ends| ends[2] - ends[0] > MAX_NEAR) {
            return Err(gpu.too_small(format!("more than {MAX_NEAR} balls meet at one place")));
        }
        let code = constants(&[("WIDTH", WIDTH), ("N", per_axis)]) + include_str!("gap_grid.wgsl");
        let rasterise = Kernel::new(gpu, "rasterise", "rasterise", &code)?;
        let buffers = [
            &gpu.filled("balls", &near)?,
            &gpu.filled("starts", &starts)?,
            &arrays[0],
        ];
        let [x, y, z] = BLOCK.map(|side| per_axis.div_ceil(side));
        let step = rasterise.step(gpu, &buffers, [z, y, x])?;
        let cost = Cost {
            bytes: 16.0 * near.len() as f64 + 8.0 * points as f64,
            operations: 15.0 * 128.0 * near.len() as f64,
        };
        let samples = vec![(arrays[0].clone(), points)];
        let rasterise = Job::new(gpu, vec![step], samples, cost, |values| values);
        let mut cost = Cost {
            bytes: 24.0 * points as f64,
            operations: 14.0 * points as f64,
        };
        let mut steps = Vec::new();
        let (mut before, mut after) = (&arrays[0], &arrays[1]);
        let factors = vec![1.0; per_axis];
        for direction in [Direction::Forward, Direction::Inverse] {
            for axis in [2, 1, 0] {
                let axis = Axis {
                    shape: &[per_axis; 3],
                    axis,
                    direction,
                    factors: &factors,
                    below: 0,
                    whole: false,
                };
                steps.push(axis.step(gpu, before, after, &mut cost)?);
                std::mem::swap(&mut before, &mut after);
            }
            if direction == Direction::Forward {
                let multiply = Kernel::new(gpu, "multiply", "multiply", &code)?;
                let groups = groups(points.div_ceil(WIDTH));
                steps.push(multiply.step(gpu, &[before, after], groups)?);
                std::mem::swap(&mut before, &mut after);
            }
        }
        let factor = (edge / per_axis as f64 / per_axis as f64).powi(3);
        let scaled = move |[value, _]: [f32; 2]| f64::from(value) * factor;
        let values = vec![(before.clone(), points)];
        Ok(Self {
            rasterise,
            correlate: Job::new(gpu, steps, values, cost, scaled),
        })
    }
}

/// Per block and solid the first of the balls that touch it, and these balls: centre from the block's first point and
/// 1 / r^2, in grid cells. A ball that reaches over a face of the cube also touches blocks on the other side.
fn near_blocks(balls: [&[Knot]; 2], per_axis: usize, edge: f64) -> (Vec<u32>, Vec<[f32; 4]>) {
    let blocks = BLOCK.map(|side| per_axis.div_ceil(side) as i64);
    let cells = per_axis as f64 / edge;
    let mut lists = vec![Vec::new(); 2 * blocks.iter().product::<i64>() as usize];
    for (solid, balls) in balls.into_iter().enumerate() {
        for ball in balls.iter().filter(|ball| ball[3] > 0.0) {
            let [x, y, z, r] = ball.map(|part| part * cells);
            let center = [x, y, z];
            // By axis: place of the block, and the distance of the centre from its first point. Periods count apart, as
            // a last block may be a short one.
            let along: [Vec<(i64, f64)>; 3] = [0, 1, 2].map(|axis| {
                let low = ((center[axis] - r) / per_axis as f64).floor() as i64;
                let high = ((center[axis] + r) / per_axis as f64).floor() as i64;
                let periods = low..=high;
                let of_period = |period: i64| {
                    let from = center[axis] - period as f64 * per_axis as f64;
                    (0..blocks[axis]).filter_map(move |block| {
                        let from = from - (block as f64) * BLOCK[axis] as f64;
                        let touches = from + r >= 0.0 && from - r <= (BLOCK[axis] - 1) as f64;
                        touches.then_some((block, from))
                    })
                };
                periods.flat_map(of_period).collect()
            });
            for &(bx, dx) in &along[0] {
                for &(by, dy) in &along[1] {
                    for &(bz, dz) in &along[2] {
                        // Distance to the box of the block's points.
                        let beyond = [dx, dy, dz].into_iter().zip(BLOCK);
                        let square: f64 = beyond
                            .map(|(d, side)| (d - d.clamp(0.0, (side - 1) as f64)).powi(2))
                            .sum();
                        if square < r * r {
                            let block = (bx * blocks[1] + by) * blocks[2] + bz;
                            let near = [dx, dy, dz, 1.0 / (r * r)].map(|part| part as f32);
                            lists[2 * block as usize + solid].push(near);
                        }
                    }
                }
            }
        }
    }
    let mut starts = vec![0];
    starts.extend(lists.iter().scan(0, |end, list| {
        *end += list.len() as u32;
        Some(*end)
    }));
    (starts, lists.concat())
}
