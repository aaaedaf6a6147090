//! `ensemble.json`: what an ensemble is of, its members, and what came of them.
//!
//! Each member has a run.json of its own, with all that a run records. Everything outside `timing` and `command` is the
//! same, byte for byte, for the same input, options and CPU feature level.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;

use knotdock::options::DockOptions;
use knotdock::output::records::input_record::InputRecord;
use knotdock::output::records::program::Program;

/// Name of the record in the directory of an ensemble.
pub const RECORD: &str = "ensemble.json";
/// Name of the folder in it that holds the members' runs.
pub use knotdock::output::files::own_files::MEMBERS;

/// Number of the layout of `ensemble.json`; it rises when an entry changes its meaning or goes.
pub const SCHEMA: u32 = 2;

/// A conformation of a side.
#[derive(Clone, Debug, Serialize)]
pub struct ConformationRecord {
    /// Its name in the tables.
    pub name: String,
    /// Its file.
    #[serde(flatten)]
    pub record: InputRecord,
    /// From its frame to that of the first conformation: qw, qx, qy, qz, tx, ty, tz (Å).
    pub to_first: [f64; 7],
    /// Backbone RMSD from the first, in Å.
    pub rmsd_from_first: f64,
    /// Residues that it shares with the first.
    pub residues_matched: usize,
}

/// A member.
#[derive(Clone, Debug, Serialize)]
pub struct MemberRecord {
    /// Its name, and that of the folder of its run.
    pub name: String,
    /// Name of the receptor's conformation.
    pub receptor_model: String,
    /// Name of the ligand's.
    pub ligand_model: String,
    /// Rows of its table.
    pub rows: usize,
    /// The best score of its poses; `null` where it has none.
    pub best_pose_score: Option<f64>,
}

/// Counts of what came out.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct EnsembleResults {
    /// Rows of the joint `poses.csv`.
    pub rows: usize,
    /// Clusters across members.
    pub clusters: usize,
    /// Poses that the members kept.
    pub poses: u64,
}

/// Cost. Differs from run to run.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct EnsembleTiming {
    /// Time on the clock from the first read to the last write, in seconds.
    pub wall_seconds: f64,
    /// Seconds that all members were expected to take.
    pub expected_seconds: f64,
    /// Members whose runs were there already.
    pub members_kept: usize,
}

/// `ensemble.json`.
#[derive(Debug, Serialize)]
pub struct EnsembleRecord<'a> {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Who wrote it.
    #[serde(flatten)]
    pub program: Program,
    /// Conformations of the receptor.
    pub receptor: Vec<ConformationRecord>,
    /// Conformations of the ligand.
    pub ligand: Vec<ConformationRecord>,
    /// The options of each run.
    pub options: &'a DockOptions,
    /// The members, in the order of docking.
    pub members: Vec<MemberRecord>,
    /// What came out.
    pub results: EnsembleResults,
    /// SHA-256 of the other files, by their paths from the directory; not those of the members.
    pub files: BTreeMap<String, String>,
    /// Cost.
    pub timing: EnsembleTiming,
    /// The command line.
    pub command: Vec<String>,
}

/// Whether a directory holds an ensemble.
pub fn is_ensemble(directory: &Path) -> bool {
    directory.join(RECORD).is_file()
}
