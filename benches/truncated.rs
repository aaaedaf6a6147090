//! Time of one configuration of the example pair against its number of modes, on one core.
//!
//! Timed are a new translation at a prepared rotation, preparing a rotation, and a new rotation with the gradient
//! over all six degrees of freedom.
//!
//! `cargo bench --bench truncated` prints medians in microseconds, and nanoseconds a mode, which stay level where
//! time is linear in modes. B&I (Fig. 9) report under a millisecond for fewer than 4,096 modes.

mod example;

use knotdock_scoring::Precision;
use knotdock_scoring::engine::Plan;
use knotdock_scoring::engine::ReceptorSpectra;
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::transform::truncation::{Selection, total};
use knotdock_scoring::truncated::TruncatedCorrelation;
use nalgebra::{UnitQuaternion, Vector3};
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let [receptor, ligand] = example::knots()?;
    let mut options = knotdock::options::DockOptions::default().kernel.engine();
    options.tolerance = 1e-4;
    let plan = Plan::new(&receptor, &ligand, options)?;
    let spectra = ReceptorSpectra::new(
        &plan,
        &receptor,
        &ligand,
        Quantity::Score,
        Precision::Double,
    );
    println!(
        "{} receptor and {} ligand knots, {} modes in all; medians",
        receptor.len(),
        ligand.len(),
        total(plan.modes())
    );
    println!(
        "{:>7} {:>24} {:>24} {:>24}",
        "modes", "translation, µs (ns/mode)", "prepare, µs (ns/mode)", "rotation, µs (ns/mode)"
    );
    let mut most = 256;
    while most <= 65_536 && most <= total(plan.modes()) {
        let selection = Selection::low_frequency(plan.modes(), most);
        let few = TruncatedCorrelation::new(&plan, &spectra, &ligand, &selection);
        let mut work = few.workspace();
        let rotation = UnitQuaternion::from_euler_angles(0.3, -0.4, 1.2);
        let prepared = few.prepare(&rotation, &mut work);
        let place = |i: usize| {
            let t = i as f64 * 0.01;
            plan.receptor_center() + Vector3::new(20.0 - t, 5.0 + t, 1.0)
        };
        let pose = |i: usize| {
            let turn = UnitQuaternion::from_euler_angles(0.3 + 0.001 * i as f64, -0.4, 1.2);
            Pose::about(turn, plan.ligand_center(), place(i))
        };
        let translation = median(2001, |i| {
            let t = place(i) - rotation * plan.ligand_center();
            prepared.gradient(&t, &mut work).0
        });
        let prepare = median(41, |i| {
            few.prepare(&pose(i).rotation, &mut work).modes() as f64
        });
        let whole = median(41, |i| few.gradient(&pose(i), &mut work).0);
        let column =
            |seconds: f64| format!("{:.1} ({:.2})", 1e6 * seconds, 1e9 * seconds / most as f64);
        println!(
            "{most:>7} {:>24} {:>24} {:>24}",
            column(translation),
            column(prepare),
            column(whole)
        );
        most *= 2;
    }
    Ok(())
}

/// Median seconds of one call.
fn median(count: usize, mut call: impl FnMut(usize) -> f64) -> f64 {
    let mut times: Vec<f64> = (0..count)
        .map(|i| {
            let start = Instant::now();
            std::hint::black_box(call(i));
            start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[count / 2]
}
