//! Time of the exact score of the example pair, alone and with its slices, beside a plain double loop over the same
//! tables.
//!
//! `cargo bench --bench exact` prints microseconds a pose and nanoseconds a pair within reach, medians over the best
//! grid pose of each of some rotations.

mod example;

use knotdock_scoring::Precision;
use knotdock_scoring::engine::ReceptorSpectra;
use knotdock_scoring::engine::{CpuEngine, Plan};
use knotdock_scoring::exact::ExactScorer;
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Knots;
use nalgebra::Vector3;
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

const POSES: usize = 201;

fn main() -> Result<(), Box<dyn Error>> {
    let [receptor, ligand] = example::knots()?;
    let options = knotdock::options::DockOptions::default().kernel.engine();
    let plan = Arc::new(Plan::new(&receptor, &ligand, options)?);
    let prepared = Instant::now();
    let scorer = ExactScorer::new(plan.kernel(), &receptor, &ligand)?;
    println!(
        "{} x {} knots, reach {:.1} Å, prepared in {:.1} ms",
        receptor.len(),
        ligand.len(),
        plan.kernel().reach(),
        1e3 * prepared.elapsed().as_secs_f64()
    );
    let spectra = ReceptorSpectra::new(
        &plan,
        &receptor,
        &ligand,
        Quantity::Score,
        Precision::Single,
    );
    let engine = CpuEngine::new(Arc::clone(&plan), &spectra, &ligand, 3);
    let mut work = engine.workspace();
    let brute = Brute::new(&plan, &receptor, &ligand);
    let mut times: [Vec<f64>; 4] = Default::default();
    let (mut pairs, mut best, mut worst) = (0, f64::MIN_POSITIVE, 0.0f64);
    for rotation in knotdock_scoring::so3::rotation_set(POSES) {
        engine.correlate(&rotation, &mut work);
        let peak = (0..work.scores.count())
            .max_by(|&a, &b| work.scores.score(a).total_cmp(&work.scores.score(b)))
            .unwrap_or(0);
        let place = plan.receptor_center() + engine.position(peak);
        let pose = Pose::about(rotation, plan.ligand_center(), place);
        let mut timed = |index: usize, run: &mut dyn FnMut() -> f64| {
            let start = Instant::now();
            let score = run();
            times[index].push(start.elapsed().as_secs_f64());
            score
        };
        let only = timed(0, &mut || scorer.score_only(&pose));
        let full = timed(1, &mut || scorer.score(&pose).score);
        timed(2, &mut || scorer.gradient(&pose).0);
        let plain = timed(3, &mut || {
            let (score, count) = brute.score(&pose);
            pairs += count;
            score
        });
        best = best.max(plain);
        worst = worst.max((only - plain).abs()).max((full - plain).abs());
    }
    let pairs = pairs as f64 / POSES as f64;
    println!("{pairs:.0} pairs within reach a pose");
    for (name, mut times) in ["score alone", "with slices", "gradient", "plain loop"]
        .into_iter()
        .zip(times)
    {
        times.sort_by(f64::total_cmp);
        let median = times[times.len() / 2];
        println!(
            "  {name:12} {:7.1} µs a pose, {:5.2} ns a pair",
            1e6 * median,
            1e9 * median / pairs
        );
    }
    println!(
        "largest difference from the plain loop: {:.1e} of the best score {best:.1}",
        worst / best
    );
    Ok(())
}

/// All pairs, one after the other, on the ranking kernel's own distance tables.
struct Brute {
    tables: Vec<Vec<knotdock_scoring::kernel::table::Table<4>>>,
    receptor: Vec<(Vector3<f64>, usize)>,
    ligand: Vec<(Vector3<f64>, usize)>,
    reach: f64,
}

impl Brute {
    fn new(plan: &Plan, receptor: &Knots, ligand: &Knots) -> Self {
        let (receptor_radii, receptor_class) = receptor.radius_classes();
        let (ligand_radii, ligand_class) = ligand.radius_classes();
        let placed = |knots: &Knots, classes: Vec<usize>| {
            let points = knots.centers.iter().map(|&x| Vector3::from(x));
            points.zip(classes).collect()
        };
        Self {
            tables: ligand_radii
                .iter()
                .map(|s| {
                    receptor_radii
                        .iter()
                        .map(|r| plan.kernel().distance_table(r + s))
                        .collect()
                })
                .collect(),
            receptor: placed(receptor, receptor_class),
            ligand: placed(ligand, ligand_class),
            reach: plan.kernel().reach(),
        }
    }

    fn score(&self, pose: &Pose) -> (f64, usize) {
        let (mut sum, mut count) = (0.0, 0);
        for (y, s) in &self.ligand {
            let y = pose.rotation * y + pose.translation;
            for (x, r) in &self.receptor {
                let square = (x - y).norm_squared();
                if square < self.reach * self.reach {
                    sum += self.tables[*s][*r].value(square.sqrt())[3];
                    count += 1;
                }
            }
        }
        (sum, count)
    }
}
