//! Predicted against measured: time and error of dockings, by the built-in cost model and by one fitted here.
//!
//!     cargo bench --bench cost_model [-- RECEPTOR LIGAND [RECEPTOR LIGAND ...]]
//!
//! docks the example pair, and then any pairs of structure files that are named.
//!
//! A line of the table is a rung of the ladder of accuracies at one of three numbers of rotations. It has the seconds
//! on the clock that both models expect, those that the search took, and the error expected and made. Each docking is
//! done three times, or until they have taken a minute. `pace` is the time of a fixed piece of work just before and
//! after a docking, divided by its time beside the calibration. The fitted model expects a machine at its pace during
//! the calibration. So `share` compares the time taken, converted to that pace, with the expected time. Printed are
//! the median share of the dockings, and the time and pace of the docking that had it.

mod pace;

use std::error::Error;
use std::path::Path;

use knotdock::dock::plan::{DockPlan, plan};
use knotdock::dock::run::{dock, molecule_points};
use knotdock::options::DockOptions;
use knotdock::progress::NoProgress;
use knotdock::tradeoff::calibrate::calibrate;
use knotdock::tradeoff::cost_model::{CostModel, LADDER, Workload};
use knotdock_structures::molecule::{InputSpec, Molecule, ReadOptions, read};
use pace::Pace;

/// Dockings of a setting, and seconds after which no further one starts.
const MAX_DOCKINGS: usize = 3;
const ENOUGH_SECONDS: f64 = 60.0;

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
    let pace = Pace::new(threads);
    // Memory is touched and the processor awake after one.
    pace.seconds();
    let before = pace.seconds();
    let fitted = calibrate(threads, &NoProgress)?;
    let machine = Machine {
        threads,
        fitted,
        // The model is of the fastest of its rounds.
        at_fit: before.min(pace.seconds()),
        pace,
    };
    println!(
        "{threads} threads, pace {:.3} s; fitted here: {:?}",
        machine.at_fit, machine.fitted
    );
    for files in std::iter::once(&example).chain(pairs) {
        pair(files, &machine)?;
    }
    Ok(())
}

/// What is known of the machine.
struct Machine {
    threads: usize,
    fitted: CostModel,
    pace: Pace,
    /// Seconds of the pace's work about the calibration.
    at_fit: f64,
}

/// A docking's time.
#[derive(Clone, Copy)]
struct Time {
    seconds: f64,
    pace: f64,
}

impl Time {
    /// Seconds at the pace of the calibration.
    fn even(self) -> f64 {
        self.seconds / self.pace
    }
}

/// Docks a pair at each setting.
fn pair(files: &[String; 2], machine: &Machine) -> Result<(), Box<dyn Error>> {
    let threads = machine.threads;
    let [receptor, ligand] = [molecule(&files[0])?, molecule(&files[1])?];
    println!(
        "\n{}\n{:39}{:>9} {:>7} {:>7} {:>7} {:>7} {:>16} {:>7}",
        files.join(" "),
        "setting",
        "built-in",
        "fitted",
        "took",
        "pace",
        "share",
        "error expected",
        "made"
    );
    let default =
        DockOptions::default().changed(|options| options.machine.threads = threads.into());
    let few = default.changed(|options| options.search.rotations = 600);
    let counts = [600, 1800, 3600]
        .map(|rotations| default.changed(|options| options.search.rotations = rotations));
    let mut settings: Vec<(DockOptions, Option<f64>)> =
        counts.map(|options| (options, None)).to_vec();
    for rung in LADDER {
        let mut options = few.clone();
        rung.apply(&mut options);
        settings.push((options, Some(rung.error)));
    }
    for (options, error) in settings {
        let (mut times, mut spent) = (Vec::new(), 0.0);
        let (plan, outcome) = loop {
            let before = machine.pace.seconds();
            let clock = std::time::Instant::now();
            let plan: DockPlan = plan(&receptor, &ligand, &options)?;
            let outcome = dock(&plan, &molecule_points(&ligand), &NoProgress)?;
            let seconds = clock.elapsed().as_secs_f64();
            let pace = 0.5 * (before + machine.pace.seconds()) / machine.at_fit;
            times.push(Time { seconds, pace });
            spent += seconds;
            if times.len() == MAX_DOCKINGS || spent > ENOUGH_SECONDS {
                break (plan, outcome);
            }
        };
        times.sort_by(|a, b| a.even().total_cmp(&b.even()));
        let median = times[(times.len() - 1) / 2];
        let work = Workload::of(&plan);
        let expected = |model: &CostModel| model.seconds(&work, options.search.rotations, threads);
        println!(
            "{:5} rotations, {:6} at {:.2} Å, rank {} ({:.0}) {:8.2} {:7.2} {:7.2} {:7.2} {:7.2} {:>16} {:7.1e}",
            options.search.rotations,
            options.kernel.tolerance,
            plan.spacing,
            outcome.rank,
            work.rank,
            expected(&CostModel::BUILT_IN),
            expected(&machine.fitted),
            median.seconds,
            median.pace,
            median.even() / expected(&machine.fitted),
            error.map_or(String::new(), |error| format!("{error:.0e}")),
            outcome.error.rms,
        );
    }
    Ok(())
}
