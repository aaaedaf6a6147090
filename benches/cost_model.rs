//! Predicted against measured: time and error of dockings, by the built-in cost model and by one fitted here.
//!
//!     cargo bench --bench cost_model [-- RECEPTOR LIGAND [RECEPTOR LIGAND ...]]
//!
//! docks the example pair, and then any pairs of structure files that are named.
//!
//! Printed are, for each rung of the ladder of accuracies and for three numbers of rotations, the seconds on the clock that both models
//! expect and those that the search took, and the error expected and made. Each docking is done three times, or until they have taken a
//! minute, and the fastest counts, for whatever else runs on the machine only ever slows one down; the slowest stands beside it.

use std::error::Error;
use std::path::Path;

use knotdock::search::{DockOptions, DockPlan, Progress, dock, molecule_points, plan};
use knotdock::tradeoff::calibrate::calibrate;
use knotdock::tradeoff::cost_model::{CostModel, LADDER, Workload};
use knotdock_structures::molecule::{InputSpec, Molecule, ReadOptions, read};

/// Dockings of a setting, and seconds after which no further one is begun.
const MOST_DOCKINGS: usize = 3;
const ENOUGH_SECONDS: f64 = 60.0;

struct Silent;

impl Progress for Silent {
    fn stage(&self, _: &str, _: u64) {}
    fn advance(&self, _: u64) {}
}

fn molecule(path: &str) -> Result<Molecule, Box<dyn Error>> {
    Ok(read(&InputSpec::parse(path)?, &ReadOptions::default())?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("structures/examples");
    let example = ["1ppe_receptor_unbound.pdb", "1ppe_ligand_unbound.pdb"]
        .map(|name| folder.join(name).display().to_string());
    // Cargo itself hands a `--bench` over.
    let named: Vec<String> = std::env::args()
        .skip(1)
        .filter(|word| !word.starts_with("--"))
        .collect();
    let (pairs, []) = named.as_chunks::<2>() else {
        return Err("each receptor needs a ligand".into());
    };
    let fitted = calibrate(threads, &Silent)?;
    println!("{threads} threads; fitted here: {fitted:?}");
    for files in std::iter::once(&example).chain(pairs) {
        pair(files, threads, &fitted)?;
    }
    Ok(())
}

/// Docks a pair at each setting.
fn pair(files: &[String; 2], threads: usize, fitted: &CostModel) -> Result<(), Box<dyn Error>> {
    let [receptor, ligand] = [molecule(&files[0])?, molecule(&files[1])?];
    println!(
        "\n{}\n{:39}{:>9} {:>7} {:>7} {:>7} {:>16} {:>7}",
        files.join(" "),
        "setting",
        "built-in",
        "fitted",
        "took",
        "slowest",
        "error expected",
        "made"
    );
    let default = DockOptions {
        threads,
        ..DockOptions::default()
    };
    let few = DockOptions {
        rotations: 600,
        ..default.clone()
    };
    let counts = [600, 1800, 3600].map(|rotations| DockOptions {
        rotations,
        ..default.clone()
    });
    let mut settings: Vec<(DockOptions, Option<f64>)> =
        counts.map(|options| (options, None)).to_vec();
    for rung in LADDER {
        let mut options = few.clone();
        rung.apply(&mut options);
        settings.push((options, Some(rung.error)));
    }
    for (options, error) in settings {
        let (mut took, mut slowest, mut spent, mut dockings) = (f64::INFINITY, 0.0f64, 0.0, 0);
        let (plan, outcome) = loop {
            let clock = std::time::Instant::now();
            let plan: DockPlan = plan(&receptor, &ligand, &options)?;
            let outcome = dock(&plan, &molecule_points(&ligand), &Silent)?;
            let seconds = clock.elapsed().as_secs_f64();
            (took, slowest) = (took.min(seconds), slowest.max(seconds));
            spent += seconds;
            dockings += 1;
            if dockings == MOST_DOCKINGS || spent > ENOUGH_SECONDS {
                break (plan, outcome);
            }
        };
        let work = Workload::of(&plan);
        let expected = |model: &CostModel| model.seconds(&work, options.rotations, threads);
        println!(
            "{:5} rotations, {:6} at {:.2} Å, rank {} ({:.0}) {:8.2} {:7.2} {took:7.2} {slowest:7.2} {:>16} {:7.1e}",
            options.rotations,
            options.tolerance,
            plan.spacing,
            outcome.rank,
            work.rank,
            expected(&CostModel::BUILT_IN),
            expected(fitted),
            error.map_or(String::new(), |error| format!("{error:.0e}")),
            outcome.error.rms,
        );
    }
    Ok(())
}
