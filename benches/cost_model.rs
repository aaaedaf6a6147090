//! Predicted against measured: time and error of dockings of the example pair, by the built-in cost model and by one fitted here.
//!
//! Printed are, for each rung of the ladder of accuracies and for three numbers of rotations, the seconds on the clock that both models
//! expect and those that the search took, and the error expected and made.

use std::path::Path;

use knotdock::search::{DockOptions, DockPlan, Progress, dock, molecule_points, plan};
use knotdock::tradeoff::calibrate::calibrate;
use knotdock::tradeoff::cost_model::{CostModel, LADDER, Workload};
use knotdock_structures::molecule::{InputSpec, Molecule, ReadOptions, read};

struct Silent;

impl Progress for Silent {
    fn stage(&self, _: &str, _: u64) {}
    fn advance(&self, _: u64) {}
}

fn molecule(name: &str) -> Molecule {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("structures/examples");
    let spec = InputSpec::parse(&folder.join(name).display().to_string()).unwrap();
    read(&spec, &ReadOptions::default()).unwrap()
}

fn main() {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let [receptor, ligand] = ["1ppe_receptor_unbound.pdb", "1ppe_ligand_unbound.pdb"].map(molecule);
    let fitted = calibrate(threads, &Silent).unwrap();
    println!("{threads} threads; fitted here: {fitted:?}\n");
    println!(
        "setting                                built-in  fitted    took   error expected    made"
    );
    let default = DockOptions {
        threads,
        ..DockOptions::default()
    };
    let mut settings: Vec<(DockOptions, Option<f64>)> = [600, 1800, 3600]
        .map(|rotations| {
            (
                DockOptions {
                    rotations,
                    ..default.clone()
                },
                None,
            )
        })
        .to_vec();
    for rung in LADDER {
        let mut options = DockOptions {
            rotations: 600,
            ..default.clone()
        };
        rung.apply(&mut options);
        settings.push((options, Some(rung.error)));
    }
    for (options, error) in settings {
        let clock = std::time::Instant::now();
        let plan: DockPlan = plan(&receptor, &ligand, &options).unwrap();
        let outcome = dock(&plan, &molecule_points(&ligand), &Silent).unwrap();
        let took = clock.elapsed().as_secs_f64();
        let work = Workload::of(&plan);
        let expected = |model: &CostModel| model.seconds(&work, options.rotations, threads);
        println!(
            "{:5} rotations, {:6} at {:.2} Å, rank {} ({:.0}) {:8.2} {:7.2} {took:7.2} {:>16} {:7.1e}",
            options.rotations,
            options.tolerance,
            plan.spacing,
            outcome.rank,
            work.rank,
            expected(&CostModel::BUILT_IN),
            expected(&fitted),
            error.map_or(String::new(), |error| format!("{error:.0e}")),
            outcome.error.rms,
        );
    }
}
