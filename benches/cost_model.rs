//! Predicted against measured: time and error of dockings, by the built-in cost model and by one fitted here.
//!
//!     cargo bench --bench cost_model [-- RECEPTOR LIGAND [RECEPTOR LIGAND ...]]
//!
//! docks the example pair, and then any pairs of structure files that are named.
//!
//! Printed are, for each rung of the ladder of accuracies and for three numbers of rotations, the seconds on the clock that both models
//! expect and those that the search took, and the error expected and made.

use std::error::Error;
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
        "\n{}\n{:39}{:>9} {:>7} {:>7} {:>16} {:>7}",
        files.join(" "),
        "setting",
        "built-in",
        "fitted",
        "took",
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
        let clock = std::time::Instant::now();
        let plan: DockPlan = plan(&receptor, &ligand, &options)?;
        let outcome = dock(&plan, &molecule_points(&ligand), &Silent)?;
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
            expected(fitted),
            error.map_or(String::new(), |error| format!("{error:.0e}")),
            outcome.error.rms,
        );
    }
    Ok(())
}
