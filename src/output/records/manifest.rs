//! `run.json`: the inputs, options, program and results of a run: enough to run it again.
//!
//! `docs/reference/run_json.md` describes each entry. Everything outside the objects `timing` and `machine` is the same, byte for
//! byte, for the same input, options and CPU feature level.

use std::collections::BTreeMap;

use knotdock_structures::Error;
use knotdock_structures::molecule::{ChainMap, Molecule};
use serde::Serialize;
use serde_json::Value;

use crate::dock::gaps::SearchedGap;
use crate::dock::outcome::{EffectCost, MeasuredError, SharpOutcome, StageTime};
use crate::dock::plan::DockPlan;
use crate::mesh::SampledPart;
use crate::options::DockOptions;
use crate::output::records::input_record::{InputRecord, NativeRecord};
use crate::output::records::program::Program;
use crate::priors::active_residues::AssumedSite;
use crate::rank::rescoring::ActingTerm;
use crate::redock::Redocking;
use crate::search::coarse_to_fine::FineSearched;
use crate::search::scan_engine::Adapter;
use knotdock_scoring::terms::effect::Effect;

/// Number of the layout of `run.json`; it rises when an entry changes its meaning or goes.
pub const SCHEMA: u32 = 3;

/// An input and the report of its reader.
#[derive(Clone, Debug, Serialize)]
pub struct InputEntry {
    /// The file.
    #[serde(flatten)]
    pub record: InputRecord,
    /// Atoms kept of a molecule.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub atoms: Option<usize>,
    /// Report on the sampling of a mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sampling: Option<SampledPart>,
    /// What was kept, dropped and altered.
    pub report: Value,
}

impl InputEntry {
    /// The entry of a molecule.
    pub fn of_molecule(record: InputRecord, molecule: &Molecule) -> Result<Self, Error> {
        let mut report = serde_json::to_value(&molecule.report).map_err(Error::machine)?;
        if let Some(report) = report.as_object_mut() {
            // The record has the path, and absolute: the one typed would differ when --rerun repeats the run.
            report.remove("file");
        }
        Ok(Self {
            record,
            atoms: Some(molecule.atoms.len()),
            sampling: None,
            report,
        })
    }
}

/// The inputs of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Inputs {
    /// What stays.
    pub receptor: InputEntry,
    /// What moves.
    pub ligand: InputEntry,
    /// The known answer, if one was given.
    pub native: Option<NativeRecord>,
}

/// Counts of the results.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Results {
    /// Rows of `poses.csv`.
    pub rows: usize,
    /// Clusters among all poses that were kept.
    pub clusters: usize,
    /// Poses that were kept.
    pub poses: usize,
    /// Rotations that were searched.
    pub rotations: usize,
}

/// Cost of an effect.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct EffectTime {
    /// The effect.
    pub effect: Effect,
    /// Its part of the milliseconds of a rotation; the parts of all effects add up to the whole.
    pub milliseconds_per_rotation: f64,
}

impl From<&EffectCost> for EffectTime {
    fn from(cost: &EffectCost) -> Self {
        Self {
            effect: cost.effect,
            milliseconds_per_rotation: cost.milliseconds_per_rotation,
        }
    }
}

/// Cost of the run. Differs from run to run.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Timing {
    /// Start of the run, in seconds since 1970-01-01 UTC.
    pub started_unix_seconds: u64,
    /// Time on the clock from the first read to the last write, in seconds.
    pub wall_seconds: f64,
    /// Stages of the search.
    pub stages: Vec<StageTime>,
    /// Cost of each effect.
    pub effects: Vec<EffectTime>,
    /// The most memory that the process held, in bytes; `null` where the system does not say.
    pub peak_memory_bytes: Option<u64>,
}

/// The chosen setting, with its expected cost and quality.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Chosen {
    /// Error that was requested.
    pub accuracy: Option<f64>,
    /// Seconds that were requested.
    pub budget_seconds: Option<f64>,
    /// Error that is expected, where the setting was chosen by it.
    pub predicted_error: Option<f64>,
    /// Gaps that were searched; `null` if there was one alone.
    pub gaps: Option<[SearchedGap; 2]>,
}

/// Machine, threads and memory of the run. Differs from machine to machine.
#[derive(Clone, Debug, Serialize)]
pub struct Machine {
    /// Operating system.
    pub system: &'static str,
    /// Processor architecture.
    pub architecture: &'static str,
    /// Hardware threads that the process may use.
    pub hardware_threads: usize,
    /// Threads that the search was given.
    pub threads: usize,
    /// Rotations that were in flight at once.
    pub rotations_in_flight: usize,
    /// Memory that the run was expected to take, in bytes.
    pub memory_estimate_bytes: u64,
    /// The stage that was expected to take it.
    pub memory_stage: &'static str,
    /// Memory that the run was given, in bytes; `null` for no limit.
    pub memory_limit_bytes: Option<u64>,
    /// The graphics processor that correlated; `null` where none did.
    pub adapter: Option<Adapter>,
    /// With `--engine auto` the reason why none did, if one failed; else `null`.
    pub adapter_failure: Option<String>,
    /// The command line.
    pub command: Vec<String>,
    /// The basis of settings that were chosen: by an accuracy, a time or a search for the gap.
    pub chosen: Option<Chosen>,
}

/// The errors that a run measured, as shares of the best score.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct ErrorRecord {
    #[serde(flatten)]
    pub measured: MeasuredError,
    /// Error of compressing the lifted axis to its rank, at the best poses of a few rotations.
    pub lifted_axis: f64,
}

/// `run.json`.
#[derive(Debug, Serialize)]
pub(crate) struct Manifest<'a> {
    pub schema: u32,
    #[serde(flatten)]
    pub program: Program,
    pub inputs: &'a Inputs,
    pub options: &'a DockOptions,
    pub plan: &'a DockPlan,
    pub rank: usize,
    pub effects: &'a [EffectCost],
    pub pose_terms: Vec<ActingTerm>,
    pub active_site: Option<&'a AssumedSite>,
    pub sharp: Option<SharpOutcome>,
    pub finer_search: Option<FineSearched>,
    pub error: ErrorRecord,
    pub results: Results,
    /// SHA-256 of each other file of the run, by its path from the directory.
    pub files: BTreeMap<String, String>,
    /// Chain names in the complexes; none of meshes.
    pub chains: Option<&'a ChainMap>,
    /// Report on the native's matching, or why it does not match, if there is one.
    #[serde(rename = "match")]
    pub matching: Option<&'a Value>,
    pub redocking: Option<&'a Redocking>,
    pub timing: Timing,
    pub machine: Machine,
}
