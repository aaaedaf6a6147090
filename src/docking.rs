//! Docking in memory: two molecules in, ranked poses out.
//!
//! ```
//! use knotdock::{DockOptions, Molecule};
//!
//! # fn main() -> Result<(), knotdock::Error> {
//! # let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/structures/examples");
//! # let file = |side: &str| format!("{folder}/1ppe_{side}_unbound.pdb");
//! # let directory = std::env::temp_dir().join(format!("knotdock-doc-{}", std::process::id()));
//! let receptor = Molecule::read(&file("receptor"))?;
//! let ligand = Molecule::read(&file("ligand"))?;
//! let mut options = DockOptions::default();
//! options.search.rotations = 100;
//! let run = knotdock::dock(&receptor, &ligand, &options)?;
//! assert!(run.poses()[0].score >= run.poses()[1].score);
//! assert!(run.complex(1)?.text.contains("ATOM"));
//! run.write(&directory)?;
//! assert!(directory.join("poses.csv").is_file());
//! # std::fs::remove_dir_all(&directory).unwrap();
//! # Ok(())
//! # }
//! ```

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;
use std::time::Instant;

use knotdock_structures::Error;
use knotdock_structures::molecule::Molecule;

use crate::dock::outcome::DockOutcome;
use crate::dock::pair::PreparedPair;
use crate::dock::plan::DockPlan;
use crate::dock::run::dock_until;
use crate::options::DockOptions;
use crate::output::files::complexes::{Complex, PosedPair, complex};
use crate::output::files::own_files::RUN;
use crate::output::files::staging::Staging;
use crate::output::records::input_record::InputRecord;
use crate::output::records::manifest::{InputEntry, Inputs};
use crate::output::run_contacts::{MAX_ROWS, RunContacts};
use crate::output::run_folder::{Bodies, Clock, FinishedRun};
use crate::output::tables::restraints;
use crate::output::tables::run_table::pose_rows;
use crate::output::top_complexes::TopComplexes;
use crate::progress::{NoProgress, Progress};
use crate::rank::ranking::RankedPose;
use crate::threads;

/// Docks a ligand to a receptor.
///
/// # Errors
/// [`Error`] for options or molecules that cannot be docked.
pub fn dock(receptor: &Molecule, ligand: &Molecule, options: &DockOptions) -> Result<Run, Error> {
    Docking::new(receptor, ligand).options(options).run()
}

/// A docking of two molecules. With [`SearchOptions::symmetry`](crate::options::SearchOptions::symmetry) the ligand is
/// the receptor again.
#[must_use]
pub struct Docking<'a> {
    molecules: [&'a Molecule; 2],
    options: DockOptions,
    progress: &'a dyn Progress,
    end: Option<Instant>,
}

impl<'a> Docking<'a> {
    /// A docking with the default options.
    pub fn new(receptor: &'a Molecule, ligand: &'a Molecule) -> Self {
        Self {
            molecules: [receptor, ligand],
            options: DockOptions::default(),
            progress: &NoProgress,
            end: None,
        }
    }

    /// Sets the options.
    pub fn options(self, options: &DockOptions) -> Self {
        Self {
            options: options.clone(),
            ..self
        }
    }

    /// Sets the receiver of progress, which can end the run.
    pub fn progress(self, progress: &'a dyn Progress) -> Self {
        Self { progress, ..self }
    }

    /// Sets a time by which the run ends: the search stops when the rest of the run just fits, at the pace measured so
    /// far. [`DockOptions::stopped`] of [`Run::options`] repeats such a run.
    pub fn deadline(self, end: Instant) -> Self {
        Self {
            end: Some(end),
            ..self
        }
    }

    /// Docks, on as many threads as the options state.
    ///
    /// # Errors
    /// [`Error`] for options or molecules that cannot be docked, and if the progress ends the run.
    pub fn run(self) -> Result<Run, Error> {
        let clock = Clock::start();
        let options = self.options.of_rings(true);
        threads::on(options.machine.thread_count(), || {
            let prepared = PreparedPair::molecules(self.molecules, &options)?;
            let PreparedPair { plan, points, .. } = &prepared;
            let outcome = dock_until(plan, points, self.end, self.progress)?;
            Ok(Run {
                molecules: self.molecules.map(Molecule::clone),
                options: options.changed(|options| options.stopped = outcome.stopped),
                prepared,
                outcome,
                clock,
                top: OnceLock::new(),
            })
        })?
    }
}

/// A docking run: ranked poses and their cost.
pub struct Run {
    molecules: [Molecule; 2],
    options: DockOptions,
    prepared: PreparedPair,
    outcome: DockOutcome,
    clock: Clock,
    /// The complexes that are written, once they were asked for.
    top: OnceLock<TopComplexes>,
}

impl Run {
    /// The poses, best first: one per cluster, or all with `no_cluster`.
    pub fn poses(&self) -> &[RankedPose] {
        &self.outcome.poses
    }

    /// The options, with the place where a run within a time stopped.
    pub fn options(&self) -> &DockOptions {
        &self.options
    }

    /// The plan.
    pub fn plan(&self) -> &DockPlan {
        &self.prepared.plan
    }

    /// Effects, errors and times.
    pub fn outcome(&self) -> &DockOutcome {
        &self.outcome
    }

    /// The complex of a rank, from 1: refined, or with the option `raw`, and of rings, as it was searched.
    ///
    /// # Errors
    /// [`Error`] for a rank that the run does not have.
    pub fn complex(&self, rank: usize) -> Result<Complex, Error> {
        let rows = pose_rows(&self.outcome.poses);
        let row = rank.checked_sub(1).and_then(|index| rows.get(index));
        let row = row.ok_or_else(|| {
            Error::input(format!("there is no rank {rank}"))
                .help(format!("name a rank from 1 to {}", rows.len()))
        })?;
        let molecules = self.molecules.each_ref();
        let kind = (molecules, self.options.search.symmetry.into());
        let rows = std::slice::from_ref(row);
        self.on_threads(|| {
            let top = TopComplexes::new(Bodies::Molecules(molecules), rows, &self.options)?;
            match PosedPair::of(kind, (rows, top.refined())).first() {
                Some(pair) => complex(pair),
                None => unreachable!("a row gives a pair"),
            }
        })
    }

    /// The complexes that are written.
    fn top(&self) -> Result<&TopComplexes, Error> {
        if let Some(top) = self.top.get() {
            return Ok(top);
        }
        let rows = pose_rows(&self.outcome.poses);
        let bodies = Bodies::Molecules(self.molecules.each_ref());
        let rows = self.options.output.top(&rows);
        let made = self.on_threads(|| TopComplexes::new(bodies, rows, &self.options))?;
        Ok(self.top.get_or_init(|| made))
    }

    /// The table of poses as CSV text: `poses.csv`.
    ///
    /// # Errors
    /// [`Error`] if a row cannot be written as text.
    pub fn table(&self) -> Result<String, Error> {
        self.finished(self.top()?, |run| {
            let mut text = Vec::new();
            run.table().write_to(&mut text).map_err(Error::machine)?;
            String::from_utf8(text).map_err(Error::machine)
        })
    }

    /// The record of the run: inputs, options, effects, errors and times, as in `run.json` but for its list of files.
    ///
    /// # Errors
    /// [`Error`] if the file of a molecule cannot be read again for its checksum.
    pub fn record(&self) -> Result<String, Error> {
        self.finished(&TopComplexes::default(), |run| {
            Ok(run.record(BTreeMap::new(), None)?.to_string())
        })
    }

    /// Writes the run into a directory that holds no other: what `knotdock dock` writes but for the report page.
    ///
    /// # Errors
    /// [`Error`] for a directory that holds something else or cannot be written.
    pub fn write(&self, directory: impl AsRef<Path>) -> Result<(), Error> {
        let staging = Staging::open(RUN, directory.as_ref(), false)?;
        self.finished(self.top()?, |run| run.stage(staging.stage()))?;
        staging.commit()
    }

    /// Does work on the threads of the options.
    fn on_threads<T: Send>(
        &self,
        work: impl FnOnce() -> Result<T, Error> + Send,
    ) -> Result<T, Error> {
        threads::on(self.options.machine.thread_count(), work)?
    }

    /// Hands the parts of the run to a function, on the threads of the options.
    fn finished<T: Send>(
        &self,
        top: &TopComplexes,
        read: impl FnOnce(FinishedRun<'_>) -> Result<T, Error> + Send,
    ) -> Result<T, Error> {
        let (plan, outcome) = (&self.prepared.plan, &self.outcome);
        let [receptor, ligand] = self
            .molecules
            .each_ref()
            .map(|molecule| InputEntry::of_molecule(InputRecord::of_molecule(molecule)?, molecule));
        let inputs = Inputs {
            receptor: receptor?,
            ligand: ligand?,
            native: None,
        };
        let met = restraints::met(plan, &outcome.poses);
        let further: Vec<_> = met.into_iter().chain(top.clashes()).collect();
        let molecules = self.molecules.each_ref();
        let arrangement = self.options.search.symmetry.into();
        let run = FinishedRun {
            bodies: Bodies::Molecules(molecules),
            inputs: &inputs,
            options: &self.options,
            plan,
            outcome,
            top,
            further: &further,
            contacts: None,
            matching: None,
            redocking: None,
            chosen: None,
            clock: &self.clock,
        };
        self.on_threads(|| {
            let shown = run.table().first(MAX_ROWS);
            let ph = self.options.terms.ph;
            let contacts = RunContacts::of(molecules, &shown, arrangement, ph);
            read(FinishedRun {
                contacts: Some(&contacts),
                ..run
            })
        })
    }
}
