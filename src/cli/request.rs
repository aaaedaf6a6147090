//! What a docking run is asked for, whether on the command line or by an earlier run's `run.json`.

use std::path::{Path, PathBuf};

use knotdock::output::manifest::{COMMIT, Inputs, VERSION, VERSION_WITH_COMMIT, cpu_features};
use knotdock::output::recorded_run::RecordedRun;
use knotdock::output::run_options::RunOptions;

use super::console::Console;
use super::failure::Failure;
use super::input::Input;
use super::native::NativeFiles;

/// A run as asked for, by options or by a run.json.
pub struct Request {
    /// The molecule that stays.
    pub receptor: Input,
    /// The molecule that moves.
    pub ligand: Input,
    /// The known complex, if one was named.
    pub native: Option<NativeFiles>,
    /// What to do.
    pub options: RunOptions,
}

impl Request {
    /// What an earlier run was asked for, from its run.json.
    pub fn recorded(path: &Path, console: Console) -> Result<Self, Failure> {
        let run = RecordedRun::read(path)?;
        if (run.version.as_str(), run.commit.as_str()) != (VERSION, COMMIT) {
            console.warn(format!(
                "the run is of version {} ({}), this is {VERSION_WITH_COMMIT}: the poses may differ",
                run.version, run.commit
            ));
        }
        if run.cpu_features != cpu_features() {
            console.warn(format!(
                "the run was on {}, this is {}: last digits may differ",
                run.cpu_features,
                cpu_features()
            ));
        }
        Ok(Self {
            receptor: Input::recorded(&run.receptor, path, &run.options.reading)?,
            ligand: Input::recorded(&run.ligand, path, &run.options.reading)?,
            native: run
                .native
                .as_ref()
                .map(|native| NativeFiles::recorded(native, path))
                .transpose()?,
            options: run.options,
        })
    }

    /// The inputs for run.json.
    pub fn inputs(&self) -> Result<Inputs, Failure> {
        Ok(Inputs {
            receptor: self.receptor.entry()?,
            ligand: self.ligand.entry()?,
            native: self.native.as_ref().map(NativeFiles::record),
        })
    }

    /// The directory of a run that names none.
    pub fn directory(&self) -> PathBuf {
        PathBuf::from(format!(
            "knotdock_{}_{}",
            self.receptor.label(),
            self.ligand.label()
        ))
    }
}
