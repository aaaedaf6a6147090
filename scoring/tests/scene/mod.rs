//! Scenes for tests: clouds of knots, options, and the fast path compared with the exact pair sum. One set for all test
//! files, the root package's included.

// The tests of either package use a part of this.
#![allow(dead_code)]

use knotdock_scoring::Precision;
use knotdock_scoring::engine::{CpuEngine, EngineOptions, Plan, ReceptorSpectra, Workspace};
use knotdock_scoring::exact::ExactScorer;
use knotdock_scoring::kernel::{KernelOptions, RankingKernel, Trim};
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Knots;
use nalgebra::{UnitQuaternion, Vector3};
use std::sync::Arc;

#[path = "../../src/test_support.rs"]
pub mod test_support;
pub use test_support::Numbers;

/// Radii like those of protein atoms, Å.
pub const RADII: [f64; 3] = [1.5, 1.7, 1.9];

/// Knots strewn over a ball about the origin, radii cycling through `radii`. Lengths in Å.
pub fn cloud(count: usize, size: f64, radii: &[f64], seed: u64) -> Knots {
    let mut numbers = Numbers(seed);
    let mut centers = Vec::new();
    while centers.len() < count {
        let p: [f64; 3] = std::array::from_fn(|_| 2.0 * size * (numbers.next() - 0.5));
        if p.iter().map(|x| x * x).sum::<f64>() < size * size {
            centers.push(p);
        }
    }
    knots(centers, radii)
}

/// Knots at given places, radii cycling through `radii`.
pub fn knots(centers: Vec<[f64; 3]>, radii: &[f64]) -> Knots {
    let radii = (0..centers.len()).map(|i| radii[i % radii.len()]).collect();
    Knots::new(centers, radii).unwrap()
}

/// A flat cloud that lies askew: a grid that is turned to fit it has fewer points.
pub fn askew_cloud(count: usize, size: f64, radii: &[f64], seed: u64) -> Knots {
    let mut flat = cloud(count, size, radii, seed);
    for x in &mut flat.centers {
        x[2] *= 0.3;
    }
    moved(
        &flat,
        &Pose::from_parts([0.8, 0.3, -0.4, 0.2], [5.0, -3.0, 2.0]),
    )
}

/// The knots carried by a rigid motion.
pub fn moved(knots: &Knots, motion: &Pose) -> Knots {
    Knots {
        centers: knots.centers.iter().map(|&x| motion.apply(x)).collect(),
        ..knots.clone()
    }
}

/// The kernel that most tests use.
pub fn kernel_options() -> KernelOptions {
    KernelOptions {
        lambda: 10.0,
        offset: 2.0,
        alpha: 2.0,
        resolution: 4.0,
        pass_length: 8.0,
        trim: Trim::FlatTop,
    }
}

/// Engine options with that kernel.
pub fn engine_options(tolerance: f64) -> EngineOptions {
    EngineOptions {
        kernel: kernel_options(),
        spacing: None,
        tolerance,
    }
}

/// The ranking kernel for the radius sums of two bodies.
pub fn kernel_for(options: KernelOptions, a: &Knots, b: &Knots) -> RankingKernel {
    let ((r_low, r_high), (s_low, s_high)) = (ends(a), ends(b));
    RankingKernel::new(options, r_low + s_low, r_high + s_high, 1.0).unwrap()
}

/// Smallest and largest radius.
pub fn ends(knots: &Knots) -> (f64, f64) {
    let low = knots.radii.iter().copied().fold(f64::INFINITY, f64::min);
    (low, knots.radii.iter().copied().fold(0.0, f64::max))
}

/// A rotation without symmetry.
pub fn some_rotation() -> UnitQuaternion<f64> {
    Pose::from_parts([0.3, -0.2, 0.8, 0.4], [0.0; 3]).rotation
}

/// A pair prepared for both the fast path and the exact sum.
pub struct Pair {
    pub plan: Arc<Plan>,
    pub engine: CpuEngine,
    pub scorer: ExactScorer,
}

impl Pair {
    /// The pair with the fast path's full rank.
    pub fn new(precision: Precision, a: &Knots, b: &Knots, options: EngineOptions) -> Self {
        Self::of_plan(precision, Plan::new(a, b, options).unwrap(), a, b)
    }

    /// The same on the grid that is turned to fit the receptor.
    pub fn fitted(precision: Precision, a: &Knots, b: &Knots, options: EngineOptions) -> Self {
        let plan = Plan::new(a, b, options).unwrap();
        Self::of_plan(precision, plan.fitted(a).unwrap(), a, b)
    }

    fn of_plan(precision: Precision, plan: Plan, a: &Knots, b: &Knots) -> Self {
        let plan = Arc::new(plan);
        let spectra = ReceptorSpectra::new(&plan, a, b, Quantity::Score, precision);
        Self {
            engine: CpuEngine::new(Arc::clone(&plan), &spectra, b, spectra.full_rank()),
            scorer: ExactScorer::new(plan.kernel(), a, b).unwrap(),
            plan,
        }
    }

    /// The fast path's scores over all translations at a rotation.
    pub fn correlate(&self, rotation: &UnitQuaternion<f64>) -> Workspace {
        let mut work = self.engine.workspace();
        self.engine.correlate(rotation, &mut work);
        work
    }

    /// The pose of a voxel.
    pub fn pose(&self, rotation: UnitQuaternion<f64>, voxel: usize) -> Pose {
        let place: Vector3<f64> = self.plan.receptor_center() + self.engine.position(voxel);
        Pose::about(rotation, self.plan.ligand_center(), place)
    }

    /// The exact score of a voxel's pose.
    pub fn exact(&self, rotation: UnitQuaternion<f64>, voxel: usize) -> f64 {
        self.scorer.score_only(&self.pose(rotation, voxel))
    }

    /// Largest |fast - exact| over every `step`-th voxel and the `best` of the grid, with the best exact score among
    /// them.
    pub fn error(&self, rotation: UnitQuaternion<f64>, step: usize, best: usize) -> (f64, f64) {
        let work = self.correlate(&rotation);
        let mut order: Vec<usize> = (0..work.scores.count()).collect();
        order.sort_by(|&x, &y| work.scores.score(y).total_cmp(&work.scores.score(x)));
        let sweep = order.iter().copied().step_by(step);
        let (mut error, mut highest) = (0.0f64, f64::NEG_INFINITY);
        for voxel in order.iter().copied().take(best).chain(sweep) {
            let exact = self.exact(rotation, voxel);
            let off = (exact - work.scores.score(voxel)).abs();
            assert!(off.is_finite(), "voxel {voxel}: {exact}");
            error = error.max(off);
            highest = highest.max(exact);
        }
        (error, highest)
    }
}
