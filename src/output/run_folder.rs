//! The folder of a run: `poses.csv`, complexes, restraints, interface and `run.json`.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use knotdock_structures::Error;
use knotdock_structures::molecule::{ChainMap, Format, Molecule};
use serde_json::Value;

use crate::dock::memory::process;
use crate::dock::outcome::DockOutcome;
use crate::dock::plan::DockPlan;
use crate::options::DockOptions;
use crate::output::files::assemblies::{Surface, write_assemblies};
use crate::output::files::complexes::{PosedPair, WrittenBodies, write_complexes};
use crate::output::files::staging::Stage;
use crate::output::files::viewers::{
    CHIMERAX, PYMOL, ViewedComplex, chimerax_script, pymol_script,
};
use crate::output::files::whole_file::to_json;
use crate::output::records::manifest::{
    Chosen, EffectTime, ErrorRecord, Inputs, Machine, Manifest, Results, SCHEMA, Timing,
};
use crate::output::records::program::Program;
use crate::output::run_contacts::RunContacts;
use crate::output::tables::fields::Column;
use crate::output::tables::poses::PoseRow;
use crate::output::tables::restraints;
use crate::output::tables::run_table::{RunTable, pose_rows};
use crate::output::top_complexes::TopComplexes;
use crate::pose_space::arrangement::Arrangement;
use crate::redock::Redocking;
use crate::refine::Refined;
use crate::threads;

/// The start of a run.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    wall: SystemTime,
    monotonic: Instant,
}

impl Clock {
    /// A run that starts now.
    pub fn start() -> Self {
        Self {
            wall: SystemTime::now(),
            monotonic: Instant::now(),
        }
    }

    /// Seconds since the start.
    pub fn seconds(&self) -> f64 {
        self.monotonic.elapsed().as_secs_f64()
    }

    /// The time that many seconds after the start; `None` for one that clocks do not reach.
    pub fn after(&self, seconds: f64) -> Option<Instant> {
        let time = std::time::Duration::try_from_secs_f64(seconds).ok()?;
        self.monotonic.checked_add(time)
    }

    fn timing(&self, outcome: &DockOutcome) -> Timing {
        Timing {
            // A clock that is set before 1970 has no such seconds.
            started_unix_seconds: self
                .wall
                .duration_since(UNIX_EPOCH)
                .map_or(0, |since| since.as_secs()),
            wall_seconds: self.seconds(),
            stages: outcome.timing.clone(),
            effects: outcome.effects.iter().map(EffectTime::from).collect(),
            peak_memory_bytes: process::peak(),
        }
    }
}

/// The machine of a run, and how the plan uses it.
pub fn machine(plan: &DockPlan) -> Machine {
    Machine {
        system: std::env::consts::OS,
        architecture: std::env::consts::ARCH,
        hardware_threads: threads::or_all(None),
        threads: plan.options.machine.thread_count(),
        rotations_in_flight: plan.in_flight(),
        memory_limit_bytes: plan.options.machine.memory,
        memory_estimate_bytes: plan.memory_bytes(),
        memory_stage: plan.largest_stage(),
        adapter: None,
        adapter_failure: None,
        command: std::env::args_os()
            .map(|word| word.to_string_lossy().into_owned())
            .collect(),
        chosen: None,
    }
}

/// Two bodies in the poses of a run.
#[derive(Clone, Copy)]
pub enum Bodies<'a> {
    /// Molecules.
    Molecules([&'a Molecule; 2]),
    /// Surfaces of meshes, or of the spheres of balls.
    Solids([Surface<'a>; 2]),
}

impl Bodies<'_> {
    /// Writes the bodies in the poses of rows into a folder, for rings all copies; molecules as they were refined, if they
    /// were, and in a format, if one is given.
    pub fn write(
        self,
        (rows, refined): (&[PoseRow], &[Refined]),
        arrangement: Arrangement,
        (folder, format): (&Path, Option<Format>),
    ) -> Result<WrittenBodies, Error> {
        match self {
            Self::Molecules(molecules) => {
                let kind = (molecules, arrangement);
                let pairs = PosedPair::of(kind, (rows, refined));
                write_complexes(kind, &pairs, (folder, format))
            }
            Self::Solids([receptor, ligand]) => Ok(WrittenBodies {
                names: write_assemblies(receptor, ligand, rows, folder)?,
                chains: None,
            }),
        }
    }
}

/// A finished run as it is written.
pub struct FinishedRun<'a> {
    /// The bodies.
    pub bodies: Bodies<'a>,
    /// The input files.
    pub inputs: &'a Inputs,
    /// The options.
    pub options: &'a DockOptions,
    /// The plan.
    pub plan: &'a DockPlan,
    /// The outcome.
    pub outcome: &'a DockOutcome,
    /// The complexes that are written, refined.
    pub top: &'a TopComplexes,
    /// Columns of the table after those of the search.
    pub further: &'a [Column],
    /// The contacts of the first rows, of molecules.
    pub contacts: Option<&'a RunContacts<'a>>,
    /// Report on the match with a known complex, if there is one.
    pub matching: Option<Value>,
    /// The comparison with a predicted complex that was docked again.
    pub redocking: Option<&'a Redocking>,
    /// The basis of the plan, if an accuracy or a time was requested.
    pub chosen: Option<&'a Chosen>,
    /// The start of the run.
    pub clock: &'a Clock,
}

/// Files of a run that were staged.
#[derive(Clone, Debug)]
pub struct StagedRun {
    /// Names of the complexes in `top/`.
    pub complexes: Vec<String>,
    /// `run.json`.
    pub record: Value,
}

impl<'a> FinishedRun<'a> {
    /// The table of poses.
    pub fn table(&self) -> RunTable<'a> {
        let choice = (self.plan.sharp(), self.options.output.diagnostics);
        RunTable::new(&self.outcome.poses, choice, self.further)
    }

    /// Writes tables, complexes and record into the staging folder of a run.
    pub fn stage(&self, staging: &Stage) -> Result<StagedRun, Error> {
        let Self {
            options,
            plan,
            outcome,
            ..
        } = self;
        if !plan.restraints.is_empty() {
            staging.write("restraints.csv", |file| {
                restraints::write_to(plan, &outcome.poses, file)
            })?;
        }
        staging.write("poses.csv", |file| self.table().write_to(file))?;
        let rows = pose_rows(&outcome.poses);
        let top = options.output.top(&rows);
        let arrangement = options.search.symmetry.into();
        let folder = staging.folder().join("top");
        let complexes = (top, self.top.refined());
        let written = self.bodies.write(complexes, arrangement, (&folder, None))?;
        if let Some(chains) = &written.chains {
            let names = written.names.iter().zip(top);
            let viewed: Vec<ViewedComplex> = names
                .map(|(name, row)| ViewedComplex::new(row.rank, name, chains))
                .collect();
            write_scripts(staging, &viewed)?;
        }
        if let Some(contacts) = self.contacts {
            staging.write("interface.csv", |file| contacts.write_shares(file))?;
        }
        let record = self.record(staging.checksums()?, written.chains.as_ref())?;
        staging.write("run.json", |file| to_json(file, &record))?;
        Ok(StagedRun {
            complexes: written.names,
            record,
        })
    }

    /// `run.json`, with the checksums of the other files by their paths and the chain names in the complexes.
    pub fn record(
        &self,
        files: BTreeMap<String, String>,
        chains: Option<&ChainMap>,
    ) -> Result<Value, Error> {
        let (plan, outcome) = (self.plan, self.outcome);
        let manifest = Manifest {
            schema: SCHEMA,
            program: Program::this(),
            inputs: self.inputs,
            options: self.options,
            plan,
            rank: outcome.rank,
            effects: &outcome.effects,
            pose_terms: plan.rescoring().acting(),
            active_site: plan.active_site(),
            sharp: outcome.sharp,
            finer_search: outcome.fine,
            error: ErrorRecord {
                measured: outcome.error,
                lifted_axis: outcome.rank_error,
            },
            results: Results {
                poses: outcome.poses_kept,
                clusters: outcome.clusters.len(),
                rows: outcome.poses.len(),
                rotations: outcome.searched,
            },
            files,
            chains,
            matching: self.matching.as_ref(),
            redocking: self.redocking,
            timing: self.clock.timing(outcome),
            machine: Machine {
                chosen: self.chosen.cloned(),
                adapter: outcome.adapter.clone(),
                adapter_failure: outcome.adapter_failure.clone(),
                ..machine(plan)
            },
        };
        serde_json::to_value(manifest).map_err(Error::machine)
    }
}

/// Writes the scripts that show complexes in other programs, if there are any.
pub fn write_scripts(staging: &Stage, complexes: &[ViewedComplex]) -> Result<(), Error> {
    if !complexes.is_empty() {
        staging.write(PYMOL, |file| {
            file.write_all(pymol_script(complexes).as_bytes())
        })?;
        staging.write(CHIMERAX, |file| {
            file.write_all(chimerax_script(complexes).as_bytes())
        })?;
    }
    Ok(())
}
