//! The uniform-grid baseline against the lifted engine on the example pair: time of a rotation at equal residual error.
//!
//! `cargo bench --bench engines` correlates the product kernel, which alone both engines compute, whole and
//! low-passed. Each line is one setting. The error is the root mean square over the best voxels of each rotation
//! against the exact pair sum, relative to the best exact score of the run. The time is that of the fastest rotation,
//! one thread, single precision. Below, for each error requested, is the fastest setting of either engine that meets
//! it. Neither engine's preparation of the receptor, once a run, counts.

mod example;
#[path = "../scoring/tests/scene/uniform_grid.rs"]
mod uniform_grid;

use knotdock::options::DockOptions;
use knotdock_scoring::Precision;
use knotdock_scoring::engine::ReceptorSpectra;
use knotdock_scoring::engine::{CpuEngine, EngineOptions, PairKernel, Plan};
use knotdock_scoring::kernel::{Band, ProductScorer};
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::so3::rotation_set;
use knotdock_structures::Knots;
use nalgebra::{UnitQuaternion, Vector3};
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;
use uniform_grid::{UniformGrid, UniformGridOptions, UniformGridPlan};

/// Rotations whose errors are measured; each is timed `REPEATS` times.
const ROTATIONS: usize = 3;
const REPEATS: usize = 5;
/// Voxels of each rotation that count into the error.
const TOP: usize = 100;
const SPACINGS: [f64; 7] = [2.0, 1.6, 1.3, 1.0, 0.8, 0.65, 0.5];

/// One setting's error and seconds per rotation.
struct Row {
    name: String,
    error: f64,
    seconds: f64,
}

struct Pair {
    receptor: Knots,
    ligand: Knots,
    rotations: Vec<UnitQuaternion<f64>>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let [receptor, ligand] = example::knots()?;
    let pair = Pair {
        receptor,
        ligand,
        rotations: rotation_set(ROTATIONS),
    };
    let base = DockOptions::default().kernel.engine();
    for band in [Band::Whole, Band::LowPass] {
        println!(
            "product kernel, {}:",
            match band {
                Band::Whole => "whole band".to_string(),
                Band::LowPass => format!(
                    "low-passed from 1 / {} to 1 / {} per Å",
                    base.kernel.pass_length, base.kernel.resolution
                ),
            }
        );
        let grids = uniform_rows(&pair, base, band)?;
        let lifted = lifted_rows(&pair, base, band)?;
        println!("  at most this error: uniform grid, lifted engine, ratio of times");
        for target in [1e-1, 3e-2, 1e-2, 3e-3, 1e-3] {
            let fastest = |rows: &[Row]| {
                rows.iter()
                    .filter(|row| row.error <= target)
                    .min_by(|a, b| a.seconds.total_cmp(&b.seconds))
                    .map(|row| (row.name.clone(), row.seconds))
            };
            let show = |found: &Option<(String, f64)>| match found {
                Some((name, seconds)) => format!("{:.2} ms ({name})", 1e3 * seconds),
                None => "none".to_string(),
            };
            let (a, b) = (fastest(&grids), fastest(&lifted));
            let ratio = match (&a, &b) {
                (Some(a), Some(b)) => format!("{:.1}", a.1 / b.1),
                _ => "-".to_string(),
            };
            println!("  {target:.0e}: {}, {}, {ratio}", show(&a), show(&b));
        }
    }
    Ok(())
}

fn uniform_rows(pair: &Pair, base: EngineOptions, band: Band) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut scorer = None;
    let mut rows = Vec::new();
    for spacing in SPACINGS {
        let options = UniformGridOptions {
            kernel: base.kernel,
            band,
            spacing,
            tolerance: 1e-3,
        };
        let plan = UniformGridPlan::new(&pair.receptor, &pair.ligand, options)?;
        let scorer = match &mut scorer {
            Some(scorer) => scorer,
            none => none.insert(ProductScorer::new(
                &plan.kernel,
                &pair.receptor,
                &pair.ligand,
            )?),
        };
        let centers = (plan.receptor_center, plan.ligand_center);
        let size = plan.size;
        let engine = UniformGrid::<f32>::new(plan, &pair.receptor, &pair.ligand, Quantity::Score);
        let mut work = engine.workspace();
        let mut measured = Measured::default();
        let mut rasterising = f64::INFINITY;
        for rotation in &pair.rotations {
            rasterising = rasterising.min(engine.rasterising_seconds(rotation, &mut work));
            for _ in 0..REPEATS {
                measured.time(|| engine.correlate(rotation, &mut work));
            }
            let position = |voxel| engine.position(voxel);
            measured.compare(&work.grid, position, rotation, centers, scorer);
        }
        let name = format!("h = {spacing} Å, {size:?}");
        let row = measured.row(name);
        println!(
            "  uniform grid {}: rms error {:.1e}, {:.2} ms, rasterising {:.2} of it",
            row.name,
            row.error,
            1e3 * row.seconds,
            1e3 * rasterising
        );
        rows.push(row);
    }
    Ok(rows)
}

fn lifted_rows(pair: &Pair, base: EngineOptions, band: Band) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut scorer = None;
    let mut rows = Vec::new();
    let settings: Vec<(Option<f64>, f64)> = match band {
        Band::Whole => SPACINGS.iter().map(|&h| (Some(h), 1e-2)).collect(),
        Band::LowPass => vec![(None, 1e-2), (None, 1e-3), (None, 1e-4)],
    };
    for (spacing, tolerance) in settings {
        let options = EngineOptions {
            spacing,
            tolerance,
            ..base
        };
        let plan = Arc::new(Plan::product(&pair.receptor, &pair.ligand, options, band)?);
        let PairKernel::Product(kernel) = plan.pair() else {
            continue;
        };
        let scorer = match &mut scorer {
            Some(scorer) => scorer,
            none => none.insert(ProductScorer::new(kernel, &pair.receptor, &pair.ligand)?),
        };
        let spectra = ReceptorSpectra::new(
            &plan,
            &pair.receptor,
            &pair.ligand,
            Quantity::Score,
            Precision::Single,
        );
        for rank in 1..=spectra.full_rank().min(4) {
            let engine = CpuEngine::new(Arc::clone(&plan), &spectra, &pair.ligand, rank);
            let mut work = engine.workspace();
            let mut measured = Measured::default();
            for rotation in &pair.rotations {
                for _ in 0..REPEATS {
                    measured.time(|| engine.correlate(rotation, &mut work));
                }
                let position = |voxel| engine.position(voxel);
                let centers = (plan.receptor_center(), plan.ligand_center());
                let scores: Vec<f32> = work.scores.iter().map(|score| score as f32).collect();
                measured.compare(&scores, position, rotation, centers, scorer);
            }
            let name = format!(
                "h = {} Å, {:?}, fine {:?} x {}, rank {rank}",
                plan.spacing(),
                plan.size(),
                plan.fine(),
                plan.width()
            );
            let row = measured.row(name);
            println!(
                "  lifted {}: rms error {:.1e}, {:.2} ms",
                row.name,
                row.error,
                1e3 * row.seconds
            );
            rows.push(row);
        }
    }
    Ok(rows)
}

struct Measured {
    squares: f64,
    count: usize,
    best: f64,
    seconds: f64,
}

impl Default for Measured {
    fn default() -> Self {
        Self {
            squares: 0.0,
            count: 0,
            best: f64::MIN_POSITIVE,
            seconds: f64::INFINITY,
        }
    }
}

impl Measured {
    fn time(&mut self, work: impl FnOnce()) {
        let start = Instant::now();
        work();
        self.seconds = self.seconds.min(start.elapsed().as_secs_f64());
    }

    /// Takes in the best voxels of one rotation.
    fn compare(
        &mut self,
        grid: &[f32],
        position: impl Fn(usize) -> Vector3<f64>,
        rotation: &UnitQuaternion<f64>,
        (receptor_center, ligand_center): (Vector3<f64>, Vector3<f64>),
        scorer: &ProductScorer,
    ) {
        let mut order: Vec<usize> = (0..grid.len()).collect();
        let by_score = |&a: &usize, &b: &usize| grid[b].total_cmp(&grid[a]);
        order.select_nth_unstable_by(TOP, by_score);
        for &voxel in &order[..TOP] {
            let place = receptor_center + position(voxel);
            let exact = scorer
                .score(&Pose::about(*rotation, ligand_center, place))
                .score;
            self.squares += (exact - f64::from(grid[voxel])).powi(2);
            self.count += 1;
            self.best = self.best.max(exact);
        }
    }

    fn row(&self, name: String) -> Row {
        Row {
            name,
            error: (self.squares / self.count as f64).sqrt() / self.best,
            seconds: self.seconds,
        }
    }
}
