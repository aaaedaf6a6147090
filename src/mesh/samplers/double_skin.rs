//! The fit of a double skin: weights of balls, as they are and grown, whose bumps come closest to F = f(S + B0) -
//! lambda f(S) once both are low-passed.
//!
//! A search sees each body through the square root of the kernel's low-pass W. So the target and the bumps are
//! low-passed before the fit, which leaves the weights free to err in all that the search does not see. A low-passed
//! function is known by its values on a grid of half the resolution: there the fit is a linear least-squares problem.
//! Weights may have either sign. Nodes near the surface, where contact is scored, count fully, others a quarter.
//!
//! The solver is that of conjugate gradients on the normal equations (CGLS), with columns of norm one.

use rayon::prelude::*;
use serde::Serialize;

use super::SamplerError;
use knotdock_scoring::kernel::{Band, KernelOptions, ProductKernel, smooth_step_down};
use knotdock_scoring::transform::real_fft_3d::RealFft3d;
use knotdock_structures::sampling::Ball;
use knotdock_structures::sampling::grid::DepthField;
use num_complex::Complex;

/// Spacing of the fit's nodes in resolutions: below the half that determines a low-passed function.
const NODES: f64 = 0.48;
/// Resolutions beyond a ball at which its low-passed bump counts as zero: 1e-3 of its peak is left there.
const RINGS: f64 = 3.2;
/// Depth of the shell in which a node counts fully, in skins on either side.
const SHELL: f64 = 4.0;
/// Weight of other nodes.
const FAR: f64 = 0.5;
/// Most nodes of either grid along an axis.
const MOST_NODES: usize = 512;
/// Most steps of the solver.
const STEPS: usize = 200;
/// Ends when a step lowers the error by less than this share.
const SETTLED: f64 = 1e-4;

/// Report on the fit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DoubleSkinFit {
    /// Root mean square error of the low-passed F near the surface, where F is from 1 - lambda to 1.
    pub rms: f64,
    /// Root mean square of the low-passed F itself there.
    pub rms_of_target: f64,
    /// Steps of the solver.
    pub steps: usize,
}

/// What is fitted: lengths in the solid's unit.
pub(super) struct DoubleSkin<'a> {
    /// Depths of the solid on a grid that reaches beyond its skin.
    pub field: &'a DepthField,
    /// Growth of the part before the skin.
    pub core: f64,
    /// The kernel, whose offset is the depth of the skin.
    pub kernel: KernelOptions,
    /// Weights of the balls as they are, if they are given: only those of the grown ones are fitted.
    pub given: Option<&'a [f64]>,
    /// Bytes that the fit may take.
    pub room: Option<u64>,
}

/// One weight per ball, of each layer.
pub(super) struct FittedSkin {
    pub weights: Vec<f64>,
    pub skin_weights: Vec<f64>,
    pub fit: DoubleSkinFit,
}

impl DoubleSkin<'_> {
    /// Fits the weights of balls, which have grown by the core.
    pub fn fit(&self, balls: &[Ball]) -> Result<FittedSkin, SamplerError> {
        let nodes = Nodes::new(self)?;
        let columns = Columns::new(self, balls, &nodes)?;
        let mut target = nodes.target.clone();
        let mut weights = vec![[0.0; 2]; balls.len()];
        if let Some(given) = self.given {
            for (weight, given) in weights.iter_mut().zip(given) {
                weight[0] = *given;
            }
            let alone: Vec<[f32; 2]> = given.iter().map(|&weight| [weight as f32, 0.0]).collect();
            let mut sum = vec![0.0; target.len()];
            columns.sum(&alone, &mut sum);
            for (target, sum) in target.iter_mut().zip(sum) {
                *target -= sum;
            }
        }
        let layers = usize::from(self.given.is_some())..2;
        let steps = columns.solve(&mut target, &mut weights, layers);
        let rms = |values: &[f32]| {
            let near = values
                .iter()
                .zip(&nodes.weights)
                .filter(|(_, weight)| **weight == 1.0);
            let (sum, count) = near.fold((0.0, 0usize), |(sum, count), (value, _)| {
                (sum + f64::from(*value).powi(2), count + 1)
            });
            (sum / count.max(1) as f64).sqrt()
        };
        Ok(FittedSkin {
            fit: DoubleSkinFit {
                rms: rms(&target),
                rms_of_target: rms(&nodes.target),
                steps,
            },
            weights: weights.iter().map(|weight| weight[0]).collect(),
            skin_weights: weights.iter().map(|weight| weight[1]).collect(),
        })
    }
}

/// Nodes of a fit: a cube of `per_axis`^3, x fastest.
struct Nodes {
    per_axis: usize,
    /// Coordinates along an axis.
    coordinates: Vec<f64>,
    weights: Vec<f32>,
    /// The low-passed F times the weights.
    target: Vec<f32>,
}

impl Nodes {
    fn new(skin: &DoubleSkin) -> Result<Self, SamplerError> {
        let grid = skin.field.grid;
        let (h, n) = (grid.spacing(), grid.per_axis());
        let KernelOptions {
            lambda,
            offset,
            resolution,
            pass_length,
            ..
        } = skin.kernel;
        // The period holds the part and the ringing of its low-passed F.
        let padded = n + (RINGS * resolution / h).ceil() as usize;
        let period = padded as f64 * h;
        let per_axis = (period / (NODES * resolution)).ceil() as usize;
        let nodes = padded.max(per_axis);
        if nodes > MOST_NODES {
            let most = MOST_NODES;
            return Err(SamplerError::Nodes { nodes, most });
        }
        // A node's share of a solid that is deeper than `by` there, from its depth.
        let share = |depth: f64, by: f64| ((depth + by) / h + 0.5).clamp(0.0, 1.0);
        let value =
            |depth: f64| share(depth, skin.core + offset) - lambda * share(depth, skin.core);
        let mut fine = vec![0.0f64; padded.pow(3)];
        for (row, depths) in skin.field.depth.chunks_exact(n).enumerate() {
            let start = ((row / n) * padded + row % n) * padded;
            for (value_at, &depth) in fine[start..].iter_mut().zip(depths) {
                *value_at = value(depth);
            }
        }
        let transform = RealFft3d::<f64>::new([padded; 3]);
        let mut spectrum = vec![Complex::new(0.0, 0.0); transform.spectrum_len()];
        transform.forward(&mut fine, &mut spectrum, &mut transform.workspace());
        let coarse = RealFft3d::<f64>::new([per_axis; 3]);
        let mut kept = vec![Complex::new(0.0, 0.0); coarse.spectrum_len()];
        let frequency = |index: usize| match 2 * index > per_axis {
            true => index as isize - per_axis as isize,
            false => index as isize,
        };
        let place = |k: isize| k.rem_euclid(padded as isize) as usize;
        for (z, plane) in kept.chunks_exact_mut(per_axis * per_axis).enumerate() {
            for (y, row) in plane.chunks_exact_mut(per_axis).enumerate() {
                for (x, value) in row.iter_mut().enumerate() {
                    let k = [frequency(x), frequency(y), z as isize];
                    let squared = k.iter().map(|k| k * k).sum::<isize>() as f64;
                    let w = squared.sqrt() / period;
                    if w < 1.0 / resolution {
                        let pass = smooth_step_down(w, 1.0 / pass_length, 1.0 / resolution).sqrt();
                        let at = (z * padded + place(k[1])) * padded + place(k[0]);
                        *value = spectrum[at] * (pass / padded.pow(3) as f64);
                    }
                }
            }
        }
        let mut values = vec![0.0; per_axis.pow(3)];
        coarse.inverse(&mut kept, &mut values, &mut coarse.workspace());
        let spacing = period / per_axis as f64;
        // Nodes beyond the middle of the gap between the part and its next image are on the other side of the part.
        let end = grid.half() + 0.5 * (padded - n) as f64 * h;
        let coordinates: Vec<f64> = (0..per_axis)
            .map(|node| grid.coordinate(0) + node as f64 * spacing)
            .map(|x| if x > end { x - period } else { x })
            .collect();
        let weight = |index: usize| -> f32 {
            let at = [
                index % per_axis,
                index / per_axis % per_axis,
                index / per_axis.pow(2),
            ];
            let nearest = at.map(|node| ((coordinates[node] - grid.coordinate(0)) / h).round());
            let is_near = nearest.iter().all(|&node| node >= 0.0 && node < n as f64) && {
                let depth = skin.field.depth[grid.index(nearest.map(|node| node as usize))];
                depth.abs() < SHELL * offset
            };
            if is_near { 1.0 } else { FAR as f32 }
        };
        let weights: Vec<f32> = (0..values.len()).map(weight).collect();
        let target = values
            .iter()
            .zip(&weights)
            .map(|(value, weight)| *value as f32 * weight);
        Ok(Self {
            per_axis,
            coordinates,
            target: target.collect(),
            weights,
        })
    }
}

/// Nodes in a row along x.
struct Run {
    start: usize,
    count: usize,
}

/// One ball's bump and its grown bump at the nodes that it reaches, times the nodes' weights.
struct Column {
    /// In rising order.
    runs: Vec<Run>,
    /// Per layer along z, and at the end: runs and values before it.
    before: Vec<[usize; 2]>,
    /// Of each run one after another, the bump's and the grown bump's, in shares of the largest: columns are what
    /// sampling holds most of.
    values: [Vec<i16>; 2],
    /// The value of one.
    units: [f32; 2],
    /// The length of each column.
    norms: [f64; 2],
}

/// The matrix of a fit.
struct Columns {
    columns: Vec<Column>,
    /// Nodes of a layer along z.
    layer: usize,
}

impl Columns {
    fn new(skin: &DoubleSkin, balls: &[Ball], nodes: &Nodes) -> Result<Self, SamplerError> {
        let mut radii: Vec<f64> = balls.iter().map(|ball| ball.radius).collect();
        radii.sort_by(f64::total_cmp);
        radii.dedup();
        let largest = radii.last().copied().unwrap_or(1.0);
        let (lambda, stop) = (skin.kernel.lambda, 1.0 / skin.kernel.resolution);
        let kernel = ProductKernel::new(skin.kernel, Band::LowPass, largest, stop)?;
        let tables: Vec<_> = radii
            .iter()
            .map(|&radius| kernel.half_passed(radius, RINGS))
            .collect();
        let spacing = NODES * skin.kernel.resolution;
        let values = |ball: &Ball| {
            let reach = ball.radius + skin.kernel.offset + RINGS * skin.kernel.resolution;
            (4.2 * (reach / spacing).powi(3)).min(nodes.weights.len() as f64)
        };
        let needed = 4.0 * balls.iter().map(values).sum::<f64>();
        if let Some(room) = skin.room.filter(|&room| needed > room as f64) {
            let balls = balls.len();
            return Err(SamplerError::Memory {
                balls,
                needed,
                room,
            });
        }
        let column = |ball: &Ball| {
            let table = &tables[radii.partition_point(|&radius| radius < ball.radius)];
            let squares = |axis: usize| -> Vec<f64> {
                let to = |x: &f64| (x - ball.center[axis]).powi(2);
                nodes.coordinates.iter().map(to).collect()
            };
            let [xs, ys, zs] = [squares(0), squares(1), squares(2)];
            let limit = table.end().powi(2);
            let mut values = [Vec::new(), Vec::new()];
            let mut column = Column {
                runs: Vec::new(),
                before: vec![[0; 2]],
                values: [Vec::new(), Vec::new()],
                units: [0.0; 2],
                norms: [0.0; 2],
            };
            for (z, dz) in zs.iter().enumerate() {
                for (y, dy) in ys.iter().enumerate() {
                    let row = (z * nodes.per_axis + y) * nodes.per_axis;
                    for (x, dx) in xs.iter().enumerate() {
                        let squared = dx + dy + dz;
                        if squared > limit {
                            continue;
                        }
                        let node = row + x;
                        match column.runs.last_mut() {
                            Some(run) if x > 0 && run.start + run.count == node => run.count += 1,
                            _ => column.runs.push(Run {
                                start: node,
                                count: 1,
                            }),
                        }
                        let weight = f64::from(nodes.weights[node]);
                        let [plain, grown] = table.value(squared.sqrt());
                        values[0].push((-lambda * weight * plain) as f32);
                        values[1].push((weight * grown) as f32);
                    }
                }
                column.before.push([column.runs.len(), values[0].len()]);
            }
            for (layer, values) in values.iter().enumerate() {
                let largest = values
                    .iter()
                    .fold(0.0f32, |largest, value| largest.max(value.abs()));
                let unit = (largest / f32::from(i16::MAX)).max(f32::MIN_POSITIVE);
                column.values[layer] = values
                    .iter()
                    .map(|value| (value / unit).round() as i16)
                    .collect();
                column.units[layer] = unit;
                let squares = column.values[layer]
                    .iter()
                    .map(|&value| f64::from(value).powi(2));
                column.norms[layer] = squares.sum::<f64>().sqrt() * f64::from(unit);
            }
            column
        };
        Ok(Self {
            columns: balls.par_iter().map(column).collect(),
            layer: nodes.per_axis.pow(2),
        })
    }

    /// Sums the bumps of all balls, each times its weights, at the nodes.
    fn sum(&self, weights: &[[f32; 2]], sum: &mut [f32]) {
        // A layer of nodes belongs to one thread, so that sums do not depend on their number.
        let layers = sum.par_chunks_mut(self.layer).enumerate();
        layers.for_each(|(z, sum)| {
            sum.fill(0.0);
            for (column, weights) in self.columns.iter().zip(weights) {
                let [plain, grown] = [0, 1].map(|layer| weights[layer] * column.units[layer]);
                column.visit(z, |nodes, [plains, growns]| {
                    let nodes = &mut sum[nodes.start - z * self.layer..][..nodes.count];
                    for ((node, a), b) in nodes.iter_mut().zip(plains).zip(growns) {
                        *node += plain * f32::from(*a) + grown * f32::from(*b);
                    }
                });
            }
        });
    }

    /// The sum of every column times some values at the nodes.
    fn dots(&self, values: &[f32], dots: &mut [[f32; 2]]) {
        let columns = self.columns.par_iter().zip(dots);
        columns.for_each(|(column, dots)| {
            let mut sums = [0.0f64; 2];
            for z in 0..column.before.len() - 1 {
                column.visit(z, |nodes, parts| {
                    let values = &values[nodes.start..][..nodes.count];
                    for (sum, part) in sums.iter_mut().zip(parts) {
                        let products = values.iter().zip(part);
                        let products = products.map(|(value, part)| value * f32::from(*part));
                        *sum += f64::from(products.sum::<f32>());
                    }
                });
            }
            *dots = [0, 1].map(|layer| sums[layer] as f32 * column.units[layer]);
        });
    }

    /// Lowers the square of `left`, the target less the sum, by weights that are added; returns the steps.
    fn solve(
        &self,
        left: &mut [f32],
        weights: &mut [[f64; 2]],
        layers: std::ops::Range<usize>,
    ) -> usize {
        let scale = |column: &Column| -> [f32; 2] {
            std::array::from_fn(|layer| match column.norms[layer] {
                norm if norm > 0.0 && layers.contains(&layer) => (1.0 / norm) as f32,
                _ => 0.0,
            })
        };
        let scales: Vec<[f32; 2]> = self.columns.iter().map(scale).collect();
        let scaled = |values: &mut [[f32; 2]]| {
            for (value, scale) in values.iter_mut().zip(&scales) {
                *value = [value[0] * scale[0], value[1] * scale[1]];
            }
        };
        let square = |values: &[[f32; 2]]| -> f64 {
            values
                .iter()
                .flatten()
                .map(|&value| f64::from(value).powi(2))
                .sum()
        };
        let error = |left: &[f32]| {
            left.iter()
                .map(|&value| f64::from(value).powi(2))
                .sum::<f64>()
        };
        let count = self.columns.len();
        let (mut slope, mut step) = (vec![[0.0f32; 2]; count], vec![[0.0f32; 2]; count]);
        let mut way = vec![[0.0f32; 2]; count];
        let mut change = vec![0.0f32; left.len()];
        let (mut last_square, mut last_error) = (0.0, error(left));
        for steps in 0..STEPS {
            self.dots(left, &mut slope);
            scaled(&mut slope);
            let now = square(&slope);
            if now == 0.0 {
                return steps;
            }
            let share = if steps == 0 { 0.0 } else { now / last_square };
            for (step, slope) in step.iter_mut().zip(&slope) {
                *step = [0, 1].map(|layer| slope[layer] + share as f32 * step[layer]);
            }
            last_square = now;
            way.copy_from_slice(&step);
            scaled(&mut way);
            self.sum(&way, &mut change);
            let length = now / error(&change);
            for (weight, way) in weights.iter_mut().zip(&way) {
                for layer in 0..2 {
                    weight[layer] += length * f64::from(way[layer]);
                }
            }
            for (left, change) in left.iter_mut().zip(&change) {
                *left -= length as f32 * change;
            }
            let now = error(left);
            if last_error - now < SETTLED * last_error {
                return steps + 1;
            }
            last_error = now;
        }
        STEPS
    }
}

impl Column {
    /// Calls `visit` with the runs of a layer along z and the values of both bumps.
    #[inline(always)]
    fn visit(&self, z: usize, mut visit: impl FnMut(&Run, [&[i16]; 2])) {
        let ([first, mut place], [end, _]) = (self.before[z], self.before[z + 1]);
        for run in &self.runs[first..end] {
            let values = place..place + run.count;
            visit(
                run,
                [&self.values[0][values.clone()], &self.values[1][values]],
            );
            place += run.count;
        }
    }
}
