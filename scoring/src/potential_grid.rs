//! The receptor's potentials on a grid: one for each function of the ligand's radius, read anywhere in space.
//!
//! The score of a pose is sum_j d_j phi_{s_j}(R y_j + t). The adjoint transform (type 2) evaluates phi and its gradient
//! at every ligand knot, by the window that spreads them: O(ligand knots), whatever the receptor's size. That makes it
//! cheap to maximise thousands of peaks in six degrees of freedom.
//!
//! Against the sum over the same modes, a score errs by less than 1e-4 of the largest potential of one knot. Against
//! the exact pair sum its accuracy is that of the fast path.

use crate::engine::Plan;
use crate::engine::ReceptorSpectra;
use crate::engine::receptor_spectra::LigandFunctions;
use crate::rigid_move::PoseGradient;
use crate::se3::Pose;
use crate::terms::effect::Effect;
use crate::transform::modes::{ModeSet, place};
use crate::transform::spreading::SpreadingKernel;
use crate::transform::{Real, fast_size};
use crate::vectorized::with_simd;
use knotdock_structures::Knots;
use nalgebra::{Rotation3, Vector3};
use num_complex::Complex;
use pulp::Simd;
use realfft::ComplexToReal;
use rustfft::Fft;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Fine grid points per mode: the window's slope needs more room than its value.
const OVERSAMPLING: f64 = 1.5;
/// Window width in fine cells. A ligand's score is then within 1e-4 of the largest potential of one knot, its force
/// within 2e-3 of that per Å (scoring/tests/potential_grid.rs).
const WIDTH: usize = 6;
/// Lanes of the innermost loop, at least `WIDTH`.
const LANES: usize = crate::blocks::LANES;

/// A ligand knot relative to the ligand's centre (Å), with its weight for every grid that it sees.
type GridKnot = (Vector3<f64>, Vec<(usize, f64)>);

/// Sampled potentials of one receptor for one ligand.
pub struct PotentialGrid {
    size: [usize; 3],
    /// Row length in memory: the grid's, plus `LANES` that repeat its start so that a row's window never wraps.
    stride: usize,
    cells_per_length: [f64; 3],
    /// Receptor's middle, in cells.
    center: [f64; 3],
    /// Farthest a knot may lie from it and still be felt, Å.
    limit: [f64; 3],
    kernel: SpreadingKernel<f32>,
    grids: Vec<Vec<f32>>,
    knots: Vec<GridKnot>,
    /// From the axes of the receptor's file to the grid's.
    frame: Rotation3<f64>,
    receptor_center: Vector3<f64>,
    ligand_center: Vector3<f64>,
}

impl PotentialGrid {
    /// Bytes that the field of a plan takes while it is made: its grids, and the spectrum of one.
    pub fn bytes(plan: &Plan, ligand: &Knots) -> usize {
        let [mx, my, mz] = fine_size(plan);
        let LigandFunctions { columns, effects } = LigandFunctions::of_score(plan, ligand);
        let weight = |knot: usize, function: usize| columns[function][knot];
        let grids = combinations(&effects, ligand.len(), weight).grids.len();
        let spectrum = size_of::<Complex<f32>>() * mx * my * (mz / 2 + 2);
        grids * size_of::<f32>() * mx * my * (mz + LANES) + spectrum
    }

    /// Samples the potentials from the receptor's spectra.
    pub fn new(plan: &Plan, spectra: &ReceptorSpectra, ligand: &Knots) -> Self {
        let modes = plan.modes();
        let size = fine_size(plan);
        let oversampling = (0..3)
            .map(|axis| size[axis] as f64 / modes.size[axis] as f64)
            .fold(f64::INFINITY, f64::min);
        let kernel = SpreadingKernel::<f32>::new(WIDTH, oversampling);
        let mut sampler = Sampler::new(plan, &kernel);
        let functions = 0..spectra.full_rank();
        let effects: Vec<Effect> = functions.map(|function| spectra.effect(function)).collect();
        let weight = |knot: usize, function: usize| spectra.ligand_weight(knot, function);
        let seen = combinations(&effects, ligand.len(), weight);
        let grids = seen
            .grids
            .iter()
            .map(|functions| sampler.sample(spectra, functions))
            .collect();
        let cells_per_length = [0, 1, 2].map(|axis| size[axis] as f64 / modes.lengths[axis]);
        let knots = seen
            .knots
            .into_iter()
            .enumerate()
            .map(|(j, weights)| {
                let center = Vector3::from(ligand.centers[j]);
                (center - plan.ligand_center(), weights)
            })
            .collect();
        Self {
            size,
            stride: size[2] + LANES,
            cells_per_length,
            center: [0, 1, 2].map(|axis| spectra.center()[axis] * cells_per_length[axis]),
            limit: plan.receptor_extent().map(|extent| extent + plan.reach()),
            kernel,
            grids,
            knots,
            frame: plan.frame().to_rotation_matrix(),
            receptor_center: plan.receptor_center(),
            ligand_center: plan.ligand_center(),
        }
    }

    /// Score of a pose and its gradient, per Å and per radian about the ligand's centre.
    pub fn gradient(&self, pose: &Pose) -> (f64, PoseGradient) {
        let grid = self;
        with_simd!(
            <'a>(grid: &'a PotentialGrid, pose: &'a Pose) -> (f64, PoseGradient),
            |simd| grid.gradient_inline(simd, pose)
        )
    }

    #[inline(always)]
    fn gradient_inline<S: Simd>(&self, simd: S, pose: &Pose) -> (f64, PoseGradient) {
        let rotation = pose.rotation.to_rotation_matrix();
        let center = rotation * self.ligand_center + pose.translation - self.receptor_center;
        let (rotation, center) = (self.frame * rotation, self.frame * center);
        let mut score = 0.0;
        let mut gradient = PoseGradient::default();
        for (y, weights) in &self.knots {
            let arm = rotation * y;
            let x = arm + center;
            if (0..3).any(|axis| x[axis].abs() > self.limit[axis]) {
                continue;
            }
            let (value, force) = self.at(simd, &x, weights);
            score += value;
            gradient.force += force;
            gradient.torque += arm.cross(&force);
        }
        gradient.force = self.frame.inverse() * gradient.force;
        gradient.torque = self.frame.inverse() * gradient.torque;
        (score, gradient)
    }

    /// Weighted potential and its gradient (per Å) at a point relative to the receptor's middle.
    #[inline(always)]
    fn at<S: Simd>(
        &self,
        simd: S,
        x: &Vector3<f64>,
        weights: &[(usize, f64)],
    ) -> (f64, Vector3<f64>) {
        let [mx, my, mz] = self.size;
        let mut values = [[0.0f32; LANES]; 3];
        let mut slopes = [[0.0f32; LANES]; 3];
        let mut first = [0; 3];
        for axis in 0..3 {
            let u = x[axis] * self.cells_per_length[axis] + self.center[axis];
            let kernel = &self.kernel;
            first[axis] = kernel.place_with_slope(u, &mut values[axis], &mut slopes[axis]);
        }
        let planes = wrapped(first[0], mx);
        let rows = wrapped(first[1], my);
        let [z, ..] = wrapped(first[2], mz);
        let mut score = 0.0;
        let mut force = Vector3::zeros();
        for &(grid, weight) in weights {
            let grid = &self.grids[grid];
            // Sums over x and y of the rows: plain, with the slope along x, with the slope along y.
            let [mut plain, mut along_x, mut along_y] = [[0.0f32; LANES]; 3];
            for (ix, plane) in planes.iter().enumerate() {
                for (iy, row) in rows.iter().enumerate() {
                    let row = (plane * my + row) * self.stride + z;
                    let Some(row) = grid.get(row..).and_then(|rest| rest.first_chunk()) else {
                        debug_assert!(false, "a window beyond the grid");
                        continue;
                    };
                    add_scaled(simd, &mut plain, values[0][ix] * values[1][iy], row);
                    add_scaled(simd, &mut along_x, slopes[0][ix] * values[1][iy], row);
                    add_scaled(simd, &mut along_y, values[0][ix] * slopes[1][iy], row);
                }
            }
            let dot = |sum: &[f32; LANES], with: &[f32; LANES]| -> f64 {
                (0..WIDTH)
                    .map(|lane| f64::from(sum[lane] * with[lane]))
                    .sum()
            };
            score += weight * dot(&plain, &values[2]);
            force += Vector3::new(
                weight * dot(&along_x, &values[2]) * self.cells_per_length[0],
                weight * dot(&along_y, &values[2]) * self.cells_per_length[1],
                weight * dot(&plain, &slopes[2]) * self.cells_per_length[2],
            );
        }
        (score, force)
    }
}

/// Numbers of the points of a window that begins at `first` on a periodic axis.
#[inline(always)]
fn wrapped(first: i64, size: usize) -> [usize; WIDTH] {
    let mut at = [first.rem_euclid(size as i64) as usize; WIDTH];
    for point in 1..WIDTH {
        let next = at[point - 1] + 1;
        at[point] = if next == size { 0 } else { next };
    }
    at
}

/// Adds a multiple of a row. Vectors are named: left to itself the compiler takes the lanes one by one.
#[inline(always)]
fn add_scaled<S: Simd>(simd: S, sum: &mut [f32; LANES], factor: f32, row: &[f32; LANES]) {
    const {
        assert!(
            S::F32_LANES <= LANES,
            "longer vectors would leave numbers out"
        )
    };
    let factor = simd.splat_f32s(factor);
    let (sums, rows) = (S::as_mut_simd_f32s(sum).0, S::as_simd_f32s(row).0);
    for (sum, row) in sums.iter_mut().zip(rows) {
        *sum = simd.add_f32s(*sum, simd.mul_f32s(factor, *row));
    }
}

/// Transforms of spectra to potentials on the fine grid, and their buffers.
struct Sampler<'a> {
    modes: &'a ModeSet,
    size: [usize; 3],
    /// One over the window's transform, for each axis and wave number from 0 on.
    factors: [Vec<f64>; 3],
    along_x: Arc<dyn Fft<f32>>,
    along_y: Arc<dyn Fft<f32>>,
    along_z: Arc<dyn ComplexToReal<f32>>,
    /// [kz][ky][kx] for x, then [kz][x][y], then rows along z.
    spectrum: Vec<Complex<f32>>,
}

impl<'a> Sampler<'a> {
    fn new(plan: &'a Plan, kernel: &SpreadingKernel<f32>) -> Self {
        let modes = plan.modes();
        let size = fine_size(plan);
        let [mx, my, mz] = size;
        Self {
            modes,
            size,
            factors: [0, 1, 2].map(|axis| {
                (0..=modes.size[axis] as i32 / 2)
                    .map(|k| 1.0 / kernel.transform(f64::from(k) / size[axis] as f64))
                    .collect()
            }),
            along_x: f32::inverse_fft(mx),
            along_y: f32::inverse_fft(my),
            along_z: f32::inverse_real_fft(mz),
            spectrum: vec![Complex::new(0.0, 0.0); mx * my * (mz / 2 + 1)],
        }
    }

    /// The grid of the weighted sum of some functions, rows padded to the stride.
    fn sample(&mut self, spectra: &ReceptorSpectra, functions: &[(usize, f32)]) -> Vec<f32> {
        self.fill(spectra, functions);
        self.along_x.process(&mut self.spectrum);
        self.transform_y();
        self.transform_z()
    }

    /// Fills the spectrum with the weighted sum, divided by the window's transform.
    fn fill(&mut self, spectra: &ReceptorSpectra, functions: &[(usize, f32)]) {
        let Self { modes, factors, .. } = self;
        let [mx, my, _] = self.size;
        let zero = Complex::new(0.0f32, 0.0);
        self.spectrum.fill(zero);
        for column in &modes.columns {
            let outer = factors[1][column.ky.unsigned_abs() as usize]
                * factors[2][column.kz as usize]
                / modes.volume();
            for (i, k) in (-column.kx_max..=column.kx_max).enumerate() {
                let factor = (outer * factors[0][k.unsigned_abs() as usize]) as f32;
                let at = (column.kz as usize * my + place(column.ky, my)) * mx + place(k, mx);
                let source = functions.iter().fold(zero, |sum, &(function, weight)| {
                    let value = spectra.value(function, column.start + i);
                    sum + Complex::new(value.re as f32, value.im as f32).scale(weight)
                });
                self.spectrum[at] = source.scale(factor);
            }
        }
    }

    /// Transforms along y, and exchanges x and y.
    fn transform_y(&mut self) {
        let [mx, my, _] = self.size;
        let zero = Complex::new(0.0f32, 0.0);
        let mut line = vec![zero; my];
        let mut turned = vec![zero; mx * my];
        for plane in self.spectrum.chunks_exact_mut(mx * my) {
            for x in 0..mx {
                for y in 0..my {
                    line[y] = plane[y * mx + x];
                }
                self.along_y.process(&mut line);
                turned[x * my..(x + 1) * my].copy_from_slice(&line);
            }
            plane.copy_from_slice(&turned);
        }
    }

    /// Transforms along z into rows that repeat their start.
    fn transform_z(&self) -> Vec<f32> {
        let [mx, my, mz] = self.size;
        let stride = mz + LANES;
        let mut grid = vec![0.0f32; mx * my * stride];
        let mut row = vec![0.0f32; mz];
        let mut along = self.along_z.make_input_vec();
        for xy in 0..mx * my {
            for (kz, value) in along.iter_mut().enumerate() {
                *value = self.spectrum[kz * mx * my + xy];
            }
            along[0].im = 0.0;
            along[mz / 2].im = 0.0;
            let done = self.along_z.process(&mut along, &mut row);
            assert!(
                done.is_ok(),
                "lengths are the plan's, and the ends are real"
            );
            let out = &mut grid[xy * stride..(xy + 1) * stride];
            for (z, value) in out.iter_mut().enumerate() {
                *value = row[z % mz];
            }
        }
        grid
    }
}

/// Which combinations of the spectra are sampled, and which knot reads which.
struct Combinations {
    /// (function, weight) by grid.
    grids: Vec<Vec<(usize, f32)>>,
    /// (grid, weight) by knot.
    knots: Vec<Vec<(usize, f64)>>,
}

/// Knots of one radius and one class have one potential: the functions of the classes are added up beforehand, so that
/// a knot reads one grid for all of them. Charges, of which there are many values, keep a separate grid.
///
/// `effects` are those of the functions, and `weight` is that of a function at one of the `count` knots.
fn combinations(
    effects: &[Effect],
    count: usize,
    weight: impl Fn(usize, usize) -> f64,
) -> Combinations {
    let (charges, classes): (Vec<usize>, Vec<usize>) =
        (0..effects.len()).partition(|&function| effects[function] == Effect::Electrostatics);
    let mut keys: BTreeMap<Vec<(usize, u64)>, usize> = BTreeMap::new();
    let mut grids: Vec<Vec<(usize, f32)>> = Vec::new();
    let mut knots = Vec::with_capacity(count);
    let weights = |knot: usize, functions: &[usize]| -> Vec<(usize, f64)> {
        functions
            .iter()
            .map(|&function| (function, weight(knot, function)))
            .filter(|&(_, weight)| weight != 0.0)
            .collect()
    };
    // With continuous radii or weights no two knots are alike, and nothing is won.
    let merge = classes.len() > 1 && {
        let distinct: BTreeSet<Vec<(usize, u64)>> = (0..count)
            .map(|knot| bits(&weights(knot, &classes)))
            .collect();
        distinct.len() <= 2 * classes.len()
    };
    let mut single = vec![None; effects.len()];
    for knot in 0..count {
        let mut reads = Vec::new();
        let separate = if merge {
            let own = weights(knot, &classes);
            if !own.is_empty() {
                let grid = *keys.entry(bits(&own)).or_insert_with(|| {
                    grids.push(own.iter().map(|&(b, weight)| (b, weight as f32)).collect());
                    grids.len() - 1
                });
                reads.push((grid, 1.0));
            }
            weights(knot, &charges)
        } else {
            let all: Vec<usize> = (0..effects.len()).collect();
            weights(knot, &all)
        };
        for (function, weight) in separate {
            let grid = *single[function].get_or_insert_with(|| {
                grids.push(vec![(function, 1.0)]);
                grids.len() - 1
            });
            reads.push((grid, weight));
        }
        knots.push(reads);
    }
    Combinations { grids, knots }
}

fn bits(weights: &[(usize, f64)]) -> Vec<(usize, u64)> {
    weights
        .iter()
        .map(|&(function, weight)| (function, weight.to_bits()))
        .collect()
}

fn fine_size(plan: &Plan) -> [usize; 3] {
    plan.modes()
        .size
        .map(|n| fast_size((n as f64 * OVERSAMPLING).ceil() as usize))
}
