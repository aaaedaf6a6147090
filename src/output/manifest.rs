//! `run.json`: what was run, on what, by which program, and how well: enough to run it again.
//!
//! `docs/formats.md` describes each entry. Everything outside the objects `timing` and `machine` is the same, byte for
//! byte, for the same input, options and CPU feature level.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use knotdock_structures::molecule::{ChainMap, InputSpec};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};

use super::staging::{StagingError, write_whole};
use crate::evaluate::MatchReport;
use crate::search::outcome::MeasuredError;
use crate::search::{DockOptions, DockOutcome, DockPlan, StageTime};

/// Number of the layout of `run.json`; it rises when an entry changes its meaning or goes.
pub const SCHEMA: u32 = 1;

/// The program's version.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The git commit that the program was built from, or `unknown`.
pub const COMMIT: &str = env!("KNOTDOCK_COMMIT");

/// Version and commit as `--version` shows them.
pub const VERSION_WITH_COMMIT: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    " (",
    env!("KNOTDOCK_COMMIT"),
    ")"
);

/// Options that change how a run is carried out and never what comes of it; they are recorded under `machine`.
const MACHINE_OPTIONS: [&str; 2] = ["threads", "memory"];

/// An input file as recorded: what to read and how to know it again.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputRecord {
    /// Absolute path.
    pub path: PathBuf,
    /// Names of the chains that were picked; `null` for all.
    pub chains: Option<Vec<String>>,
    /// SHA-256 of the file as it lies on the disk, in hexadecimal.
    pub sha256: String,
}

/// Why a recorded file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum InputRecordError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file is not the one that the run read.
    #[error("{} has changed since the run: its SHA-256 is {found}, the run's was {expected}", path.display())]
    Changed {
        /// The file.
        path: PathBuf,
        /// The checksum recorded.
        expected: String,
        /// The checksum now.
        found: String,
    },
}

impl InputRecordError {
    /// The file in question.
    pub fn path(&self) -> &Path {
        match self {
            Self::Read { path, .. } | Self::Changed { path, .. } => path,
        }
    }
}

impl InputRecord {
    /// Records a file.
    ///
    /// # Errors
    /// [`InputRecordError::Read`].
    pub fn new(input: &InputSpec) -> Result<Self, InputRecordError> {
        Ok(Self {
            path: std::path::absolute(&input.path).unwrap_or_else(|_| input.path.clone()),
            chains: input.chains.clone(),
            sha256: sha256(&input.path)?,
        })
    }

    /// What to read.
    pub fn spec(&self) -> InputSpec {
        InputSpec {
            path: self.path.clone(),
            chains: self.chains.clone(),
        }
    }

    /// The same record with the path at which the file is found: where it was, or under its name in one of `folders`,
    /// for runs that were moved or copied together with their inputs.
    ///
    /// # Errors
    /// [`InputRecordError`] of the recorded path when no file with the recorded checksum is there or in the folders.
    pub fn locate(&self, folders: &[&Path]) -> Result<Self, InputRecordError> {
        let first = match self.verify(&self.path) {
            Ok(()) => return Ok(self.clone()),
            Err(error) => error,
        };
        let name = self.path.file_name().unwrap_or_default();
        folders
            .iter()
            .map(|folder| folder.join(name))
            .find(|path| self.verify(path).is_ok())
            .map(|path| Self {
                path,
                ..self.clone()
            })
            .ok_or(first)
    }

    /// Checks that a file is the one recorded.
    fn verify(&self, path: &Path) -> Result<(), InputRecordError> {
        let found = sha256(path)?;
        if found == self.sha256 {
            Ok(())
        } else {
            Err(InputRecordError::Changed {
                path: path.to_owned(),
                expected: self.sha256.clone(),
                found,
            })
        }
    }
}

/// SHA-256 of a file's bytes, in hexadecimal.
fn sha256(path: &Path) -> Result<String, InputRecordError> {
    let bytes = fs::read(path).map_err(|source| InputRecordError::Read {
        path: path.to_owned(),
        source,
    })?;
    Ok(Sha256::digest(&bytes)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect())
}

/// An input with what its reader made of it.
#[derive(Clone, Debug, Serialize)]
pub struct InputEntry {
    /// The file.
    #[serde(flatten)]
    pub record: InputRecord,
    /// Atoms kept.
    pub atoms: usize,
    /// What was kept, dropped and altered.
    pub report: Value,
}

/// The native complex that the poses were measured against.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NativeRecord {
    /// One file with both partners.
    Complex(InputRecord),
    /// A file for each partner.
    Partners {
        /// File and chains of the receptor.
        receptor: InputRecord,
        /// File and chains of the ligand.
        ligand: InputRecord,
    },
}

/// The inputs of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Inputs {
    /// The molecule that stays.
    pub receptor: InputEntry,
    /// The molecule that moves.
    pub ligand: InputEntry,
    /// The known answer, if one was given.
    pub native: Option<NativeRecord>,
}

/// What a run was asked to do: the search's options and those of the output.
#[derive(Clone, Debug, PartialEq)]
pub struct RunOptions {
    /// Options of the search.
    pub dock: DockOptions,
    /// Every pose is listed, not one a cluster.
    pub no_cluster: bool,
    /// Number of complexes written to `top/`.
    pub write_top: usize,
}

impl RunOptions {
    /// The options as recorded, less those of the machine.
    fn record(&self) -> serde_json::Result<Map<String, Value>> {
        let mut options = object(serde_json::to_value(&self.dock)?);
        for name in MACHINE_OPTIONS {
            options.remove(name);
        }
        options.insert("no_cluster".to_owned(), self.no_cluster.into());
        options.insert("write_top".to_owned(), self.write_top.into());
        Ok(options)
    }

    /// Options from a record. Those of the machine take their defaults.
    fn from_record(record: &Map<String, Value>) -> Result<Self, String> {
        let mut dock = object(
            serde_json::to_value(DockOptions::default()).map_err(|error| error.to_string())?,
        );
        let mut no_cluster = false;
        let mut write_top = 0;
        for (name, value) in record {
            let fault = || format!("option `{name}` cannot be {value}");
            match name.as_str() {
                "no_cluster" => no_cluster = value.as_bool().ok_or_else(fault)?,
                "write_top" => {
                    write_top = value
                        .as_u64()
                        .and_then(|count| usize::try_from(count).ok())
                        .ok_or_else(fault)?;
                }
                known if dock.contains_key(known) && !MACHINE_OPTIONS.contains(&known) => {
                    dock.insert(name.clone(), value.clone());
                }
                _ => return Err(format!("option `{name}` is not known to this version")),
            }
        }
        Ok(Self {
            dock: serde_json::from_value(Value::Object(dock)).map_err(|error| error.to_string())?,
            no_cluster,
            write_top,
        })
    }
}

fn object(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(object) => object,
        _ => Map::new(),
    }
}

/// Counts of what came out.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Results {
    /// Rows of `poses.csv`.
    pub rows: usize,
    /// Clusters among all poses that were kept.
    pub clusters: usize,
    /// Poses that were kept.
    pub poses: usize,
}

/// What the run cost. Differs from run to run.
#[derive(Clone, Debug, Serialize)]
pub struct Timing {
    /// Start of the run, in seconds since 1970-01-01 UTC.
    pub started_unix_seconds: u64,
    /// Time on the clock from the first read to the last write, in seconds.
    pub wall_seconds: f64,
    /// Stages of the search.
    pub stages: Vec<StageTime>,
    /// The most memory that the process held, in bytes; `null` where the system does not say.
    pub peak_memory_bytes: Option<u64>,
}

/// Where and how the run was carried out. Differs from machine to machine.
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
    /// Memory that the search was given, in bytes; `null` for no limit.
    pub memory_limit_bytes: Option<u64>,
    /// The command line.
    pub command: Vec<String>,
}

/// `run.json`.
#[derive(Debug, Serialize)]
pub struct Manifest<'a> {
    schema: u32,
    program: &'static str,
    version: &'static str,
    commit: &'static str,
    cpu_features: String,
    inputs: &'a Inputs,
    options: Map<String, Value>,
    plan: &'a DockPlan,
    effects: Value,
    error: MeasuredError,
    results: Results,
    chains: &'a ChainMap,
    #[serde(rename = "match")]
    matching: Option<&'a MatchReport>,
    timing: Timing,
    machine: Machine,
}

/// What [`Manifest::new`] puts together.
pub struct ManifestParts<'a> {
    /// The input files.
    pub inputs: &'a Inputs,
    /// What was asked for.
    pub options: &'a RunOptions,
    /// What was planned.
    pub plan: &'a DockPlan,
    /// What came out.
    pub outcome: &'a DockOutcome,
    /// Counts of it.
    pub results: Results,
    /// Chain names in the complexes.
    pub chains: &'a ChainMap,
    /// How the native was matched, if there is one.
    pub matching: Option<&'a MatchReport>,
    /// What it cost.
    pub timing: Timing,
    /// Where it ran.
    pub machine: Machine,
}

impl<'a> Manifest<'a> {
    /// The manifest of a finished run.
    ///
    /// # Errors
    /// When a part cannot be put into JSON, which would be a fault of this program.
    pub fn new(parts: ManifestParts<'a>) -> serde_json::Result<Self> {
        Ok(Self {
            schema: SCHEMA,
            program: "knotdock",
            version: VERSION,
            commit: COMMIT,
            cpu_features: cpu_features(),
            inputs: parts.inputs,
            options: parts.options.record()?,
            plan: parts.plan,
            effects: serde_json::to_value(&parts.outcome.effects)?,
            error: parts.outcome.error,
            results: parts.results,
            chains: parts.chains,
            matching: parts.matching,
            timing: parts.timing,
            machine: parts.machine,
        })
    }

    /// Writes the manifest, whole or not at all.
    ///
    /// # Errors
    /// [`StagingError`].
    pub fn write(&self, path: &Path) -> Result<(), StagingError> {
        write_whole(path, |file| {
            serde_json::to_writer_pretty(&mut *file, self)?;
            writeln!(file)
        })
    }
}

/// What later commands take from a `run.json`.
#[derive(Debug)]
pub struct RecordedRun {
    /// Version of the program that wrote it.
    pub version: String,
    /// Commit of the program that wrote it.
    pub commit: String,
    /// CPU feature level of the run.
    pub cpu_features: String,
    /// The receptor's file.
    pub receptor: InputRecord,
    /// The ligand's file.
    pub ligand: InputRecord,
    /// The native's files, if there was one.
    pub native: Option<NativeRecord>,
    /// The options.
    pub options: RunOptions,
}

/// Why a `run.json` cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RecordedRunError {
    /// The file cannot be opened.
    #[error("cannot read {}: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file is no manifest that this version understands.
    #[error("{} is not a run.json that this version can read: {message}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// 1-based line, where known.
        line: Option<u64>,
        /// What is wrong.
        message: String,
    },
}

impl RecordedRunError {
    /// The file in question.
    pub fn path(&self) -> &Path {
        match self {
            Self::Open { path, .. } | Self::Content { path, .. } => path,
        }
    }

    /// The 1-based line in question, where there is one.
    pub fn line(&self) -> Option<u64> {
        match self {
            Self::Open { .. } => None,
            Self::Content { line, .. } => *line,
        }
    }
}

impl RecordedRun {
    /// Reads a `run.json`.
    ///
    /// # Errors
    /// [`RecordedRunError`].
    pub fn read(path: &Path) -> Result<Self, RecordedRunError> {
        #[derive(Deserialize)]
        struct File {
            schema: u32,
            program: String,
            version: String,
            commit: String,
            cpu_features: String,
            inputs: FileInputs,
            options: Map<String, Value>,
        }
        #[derive(Deserialize)]
        struct FileInputs {
            receptor: InputRecord,
            ligand: InputRecord,
            native: Option<NativeRecord>,
        }
        let text = fs::read(path).map_err(|source| RecordedRunError::Open {
            path: path.to_owned(),
            source,
        })?;
        let content = |line, message| RecordedRunError::Content {
            path: path.to_owned(),
            line,
            message,
        };
        let file: File = serde_json::from_slice(&text).map_err(|error| {
            let line = u64::try_from(error.line()).ok().filter(|&line| line > 0);
            content(line, error.to_string())
        })?;
        if file.program != "knotdock" {
            return Err(content(None, format!("it was written by {}", file.program)));
        }
        if file.schema != SCHEMA {
            return Err(content(
                None,
                format!("its schema is {}, this version's is {SCHEMA}", file.schema),
            ));
        }
        Ok(Self {
            version: file.version,
            commit: file.commit,
            cpu_features: file.cpu_features,
            receptor: file.inputs.receptor,
            ligand: file.inputs.ligand,
            native: file.inputs.native,
            options: RunOptions::from_record(&file.options)
                .map_err(|message| content(None, message))?,
        })
    }
}

/// The instruction sets on which the transforms' code paths turn, which the last bits of a score can depend on.
pub fn cpu_features() -> String {
    #[cfg(target_arch = "x86_64")]
    let found = [
        ("sse4.1", std::arch::is_x86_feature_detected!("sse4.1")),
        ("avx", std::arch::is_x86_feature_detected!("avx")),
        ("fma", std::arch::is_x86_feature_detected!("fma")),
        ("avx2", std::arch::is_x86_feature_detected!("avx2")),
    ];
    #[cfg(not(target_arch = "x86_64"))]
    let found: [(&str, bool); 0] = [];
    let names = found.iter().filter(|(_, on)| *on).map(|(name, _)| *name);
    std::iter::once(std::env::consts::ARCH)
        .chain(names)
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_survive_the_record_and_those_of_the_machine_do_not() {
        let options = RunOptions {
            dock: DockOptions {
                rotations: 17,
                lambda: 0.1 + 0.2,
                spacing: Some(1.0 / 3.0),
                cluster_radius: None,
                threads: 7,
                memory: Some(99),
                ..DockOptions::default()
            },
            no_cluster: true,
            write_top: 3,
        };
        let text = serde_json::to_string(&options.record().unwrap()).unwrap();
        let record: Map<String, Value> = serde_json::from_str(&text).unwrap();
        let expected = RunOptions {
            dock: DockOptions {
                threads: DockOptions::default().threads,
                memory: DockOptions::default().memory,
                ..options.dock.clone()
            },
            ..options
        };
        assert_eq!(RunOptions::from_record(&record), Ok(expected));
        for name in MACHINE_OPTIONS {
            assert!(!record.contains_key(name));
        }
    }

    #[test]
    fn an_option_of_a_later_version_is_refused_not_ignored() {
        let mut record = RunOptions::from_record(&Map::new())
            .unwrap()
            .record()
            .unwrap();
        record.insert("charges".to_owned(), true.into());
        assert!(
            RunOptions::from_record(&record)
                .unwrap_err()
                .contains("charges")
        );
    }

    #[test]
    fn a_changed_input_is_noticed() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("input.pdb");
        fs::write(&path, "abc").unwrap();
        let record = InputRecord::new(&InputSpec::whole(&path)).unwrap();
        // FIPS 180-2, appendix B.1
        assert_eq!(
            record.sha256,
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
        assert_eq!(record.locate(&[]).unwrap(), record);
        let moved = root.path().join("moved");
        fs::create_dir(&moved).unwrap();
        fs::rename(&path, moved.join("input.pdb")).unwrap();
        assert!(matches!(
            record.locate(&[root.path()]),
            Err(InputRecordError::Read { .. })
        ));
        assert_eq!(
            record.locate(&[root.path(), &moved]).unwrap().path,
            moved.join("input.pdb")
        );
        fs::write(&path, "abd").unwrap();
        assert!(matches!(
            record.locate(&[root.path()]),
            Err(InputRecordError::Changed { .. })
        ));
    }
}
