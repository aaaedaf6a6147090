//! Real molecules: the fast path on the example pair, mode by mode against the 4D direct transform and pose by pose
//! against the pair sum.
//!
//! Clouds of knots have no surface, no dense core and no waters' worth of holes; what the tables were tuned on could
//! hide there. Both references are too slow for all modes and all voxels of a protein, so 500 modes and 200 poses
//! are drawn.

use crate::scene::{Numbers, Pair, engine_options, some_rotation};
use knotdock_scoring::Precision;
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::transform::ndft::ndft_4d;
use knotdock_scoring::transform::real_fft_3d::RealFft3d;
use knotdock_structures::Knots;
use knotdock_structures::molecule::{InputSpec, ReadOptions, read};
use nalgebra::{UnitQuaternion, Vector3};
use num_complex::Complex64;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::path::Path;

const MODES: usize = 500;
const POSES: usize = 200;

fn example(name: &str) -> Knots {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("structures/examples");
    let spec = InputSpec::whole(folder.join(name));
    read(&spec, &ReadOptions::default())
        .unwrap()
        .knots()
        .unwrap()
}

/// What the fast path made of one rotation, as shares of the best exact score.
struct Errors {
    /// Largest over the drawn modes, each mode's share of G.
    mode: f64,
    /// Root mean square over all translations, from the drawn modes by Parseval's identity.
    rms: f64,
    /// Largest over the drawn poses.
    pose: f64,
}

fn errors(precision: Precision, a: &Knots, b: &Knots, tolerance: f64) -> Errors {
    let pair = Pair::new(precision, a, b, engine_options(tolerance));
    let rotation = some_rotation();
    let mut grid = pair.correlate(&rotation).scores.to_vec();
    let (pose, best) = worst_pose(&pair, &grid, rotation);

    let plan = &pair.plan;
    let drawn = drawn_modes(&pair);
    let exact = direct(&pair, a, b, rotation, &drawn);
    let fft = RealFft3d::<f64>::new(plan.modes().size);
    let mut spectrum = vec![Complex64::default(); fft.spectrum_len()];
    fft.forward(&mut grid, &mut spectrum, &mut fft.workspace());
    let [nx, ny, _] = plan.modes().size;
    let points = plan.modes().size.iter().product::<usize>() as f64;
    // Voxel 0 is not the origin of translations.
    let origin = pair.engine.position(0);
    let mut all = 0.0;
    plan.modes()
        .for_each(|_, _, multiplicity| all += multiplicity);
    let (mut worst, mut squares, mut weight) = (0.0f64, 0.0, 0.0);
    for (mode, exact) in drawn.iter().zip(exact) {
        let place = mode.map(|w| w.index);
        let index = |axis: usize, n: usize| place[axis].rem_euclid(n as i64) as usize;
        let value =
            spectrum[(index(2, plan.modes().size[2]) * ny + index(1, ny)) * nx + index(0, nx)];
        let turns: f64 = (0..3).map(|i| mode[i].frequency * origin[i]).sum();
        let error = (value / points * Complex64::cis(-2.0 * PI * turns) - exact).norm() / best;
        let multiplicity = if place[2] == 0 { 1.0 } else { 2.0 };
        worst = worst.max(error);
        squares += multiplicity * error * error;
        weight += multiplicity;
    }
    Errors {
        mode: worst,
        rms: (squares / weight * all).sqrt(),
        pose,
    }
}

/// Largest error over the hundred best voxels and a hundred spread over all ranks, as a share of the best exact
/// score, and that score.
fn worst_pose(pair: &Pair, grid: &[f64], rotation: UnitQuaternion<f64>) -> (f64, f64) {
    let mut order: Vec<usize> = (0..grid.len()).collect();
    order.sort_by(|&x, &y| grid[y].total_cmp(&grid[x]));
    let sweep = order.iter().step_by(order.len() / (POSES / 2));
    let drawn: Vec<usize> = order[..POSES / 2].iter().chain(sweep).copied().collect();
    let exact: Vec<f64> = drawn
        .par_iter()
        .map(|&voxel| pair.exact(rotation, voxel))
        .collect();
    let best = exact.iter().copied().fold(f64::MIN, f64::max);
    let error = drawn
        .iter()
        .zip(&exact)
        .map(|(&voxel, exact)| (grid[voxel] - exact).abs())
        .fold(0.0, f64::max);
    (error / best, best)
}

/// One axis of a mode.
#[derive(Clone, Copy)]
struct Wave {
    index: i64,
    frequency: f64,
}

/// Modes drawn evenly from all that the plan keeps.
fn drawn_modes(pair: &Pair) -> Vec<[Wave; 3]> {
    let modes = pair.plan.modes();
    let mut all = Vec::with_capacity(modes.count);
    modes.for_each(|_, w, _| all.push(w));
    let mut numbers = Numbers(17);
    let axis = |w: f64, length: f64| Wave {
        index: (w * length).round() as i64,
        frequency: w,
    };
    (0..MODES)
        .map(|_| all[(numbers.next() * all.len() as f64) as usize])
        .map(|w| [0, 1, 2].map(|i| axis(w[i], modes.lengths[i])))
        .collect()
}

/// Modes of G by the uncompressed 4D direct transform: sum over eta of K C rhoA conj(rhoB), over the box's volume.
///
/// Knots of one radius have the same phase along eta, so their sum over x is taken once. At some modes that is
/// compared with the plain 4D sum.
fn direct(
    pair: &Pair,
    a: &Knots,
    b: &Knots,
    rotation: UnitQuaternion<f64>,
    drawn: &[[Wave; 3]],
) -> Vec<Complex64> {
    let plan = &pair.plan;
    let receptor = Lifted::new(a, |x| x - plan.receptor_center(), 1.0);
    // The r-mirrored ligand: radii enter with the other sign.
    let ligand = Lifted::new(b, |y| rotation * (y - plan.ligand_center()), -1.0);
    let last = plan.axis().modes() as i64;
    drawn
        .par_iter()
        .enumerate()
        .map(|(place, mode)| {
            let w = mode.map(|wave| wave.frequency);
            let length = w.iter().map(|x| x * x).sum::<f64>().sqrt();
            let classes = [receptor.classes(w), ligand.classes(w)];
            if place % 100 == 0 {
                for (body, classes) in [&receptor, &ligand].into_iter().zip(&classes) {
                    let eta = plan.axis().eta(last);
                    let plain = ndft_4d(&body.centers, &body.radii, &body.weights, w, eta);
                    let difference = (plain - turned(classes, eta)).norm();
                    assert!(
                        difference < 1e-9 * body.radii.len() as f64,
                        "{difference:e}"
                    );
                }
            }
            let sum: Complex64 = (-last..=last)
                .map(|k| {
                    let eta = plan.axis().eta(k);
                    plan.axis().coefficient(plan.kernel(), length, k)
                        * plan.axis().fold_factor(plan.kernel(), Quantity::Score, k)
                        * turned(&classes[0], eta)
                        * turned(&classes[1], eta).conj()
                })
                .sum();
            sum / plan.modes().volume()
        })
        .collect()
}

/// A body as 4D points.
struct Lifted {
    centers: Vec<[f64; 3]>,
    radii: Vec<f64>,
    weights: Vec<f64>,
}

impl Lifted {
    fn new(knots: &Knots, place: impl Fn(Vector3<f64>) -> Vector3<f64>, sign: f64) -> Self {
        let centers = knots.centers.iter();
        Self {
            centers: centers.map(|&x| place(Vector3::from(x)).into()).collect(),
            radii: knots.radii.iter().map(|r| sign * r).collect(),
            weights: knots.weights.clone(),
        }
    }

    /// For each distinct radius the sum of its knots at w.
    fn classes(&self, w: [f64; 3]) -> Vec<(f64, Complex64)> {
        let mut classes: Vec<(f64, Complex64)> = Vec::new();
        for ((x, &radius), weight) in self.centers.iter().zip(&self.radii).zip(&self.weights) {
            let turns = w[0] * x[0] + w[1] * x[1] + w[2] * x[2];
            let value = weight * Complex64::cis(-2.0 * PI * turns);
            match classes.iter_mut().find(|(known, _)| *known == radius) {
                Some((_, sum)) => *sum += value,
                None => classes.push((radius, value)),
            }
        }
        classes
    }
}

/// A body's 4D transform from the sums of its classes.
fn turned(classes: &[(f64, Complex64)], eta: f64) -> Complex64 {
    let class = |&(radius, sum): &(f64, Complex64)| sum * Complex64::cis(-2.0 * PI * eta * radius);
    classes.iter().map(class).sum()
}

#[test]
fn proteins_meet_the_tolerance_mode_by_mode_and_pose_by_pose() {
    let a = example("1ppe_receptor_unbound.pdb");
    let b = example("1ppe_ligand_unbound.pdb");
    let check = |precision: &str, tolerance: f64, errors: Errors| {
        let Errors { mode, rms, pose } = errors;
        println!(
            "{precision} {tolerance:e}: mode {mode:.1e}, all modes {rms:.1e}, pose {pose:.1e}"
        );
        assert!(
            mode <= tolerance,
            "{precision} at {tolerance:e}: mode {mode:e}"
        );
        assert!(
            rms <= tolerance,
            "{precision} at {tolerance:e}: all modes {rms:e}"
        );
        assert!(
            pose <= tolerance,
            "{precision} at {tolerance:e}: pose {pose:e}"
        );
    };
    for tolerance in [1e-2, 1e-4, 1e-6] {
        check(
            "f64",
            tolerance,
            errors(Precision::Double, &a, &b, tolerance),
        );
    }
    for tolerance in [1e-2, 1e-4] {
        check(
            "f32",
            tolerance,
            errors(Precision::Single, &a, &b, tolerance),
        );
    }
}
