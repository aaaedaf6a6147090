//! Request of a docking run, from the command line or from an earlier run's `run.json`.

use std::path::{Path, PathBuf};

use crate::records::recorded_run::RecordedRun;
use knotdock::dock::pair::{GivenLengths, PreparedPair, Sampling};
use knotdock::evaluate::Evaluator;
use knotdock::options::{DockOptions, MachineOptions};
use knotdock::output::files::staging::put_back;
use knotdock::output::records::manifest::Inputs;
use knotdock::output::records::program::{VERSION_WITH_COMMIT, cpu_features};
use knotdock::pose_space::arrangement::Arrangement;
use serde_json::{Value, json};

use crate::arguments::options::GivenOptions;
use crate::inputs::bodies::Bodies;
use crate::inputs::native::{NativeFiles, announce};
use crate::messages::console::Console;
use knotdock_structures::Error;

/// The offset, where it is given, and which further options are that follow from the meshes.
pub fn lengths(given: &GivenOptions) -> (Option<f64>, GivenLengths) {
    let offset = given.has("offset").then_some(given.options.kernel.offset);
    let lengths = GivenLengths {
        resolution: given.has("resolution"),
        cluster_radius: given.has("cluster_radius"),
        alpha: given.has("alpha"),
    };
    (offset, lengths)
}

/// The known complex, as far as it matches the molecules docked.
pub enum Known {
    /// Poses can be measured.
    Matched(Evaluator),
    /// They cannot, for this reason.
    Unmatched(String),
}

impl Known {
    /// What measures poses, if they can be measured.
    pub fn evaluator(&self) -> Option<&Evaluator> {
        match self {
            Self::Matched(evaluator) => Some(evaluator),
            Self::Unmatched(_) => None,
        }
    }

    /// The report on the match as JSON, or why there is none.
    pub fn entry(&self) -> Result<Value, Error> {
        match self {
            Self::Matched(evaluator) => {
                serde_json::to_value(evaluator.report()).map_err(Error::machine)
            }
            Self::Unmatched(error) => Ok(json!({ "error": error })),
        }
    }
}

/// A requested run, by options or by a run.json.
pub struct Request {
    /// What stays and what moves.
    pub bodies: Bodies,
    /// The known complex, if one was named.
    pub native: Option<NativeFiles>,
    /// What to do; of meshes, lengths that are not given follow from them.
    pub options: DockOptions,
    /// The offset, where it is given.
    pub offset: Option<f64>,
    /// Further lengths that are given.
    pub given: GivenLengths,
    /// Whether a number of rotations is none that was typed: it stands for an angle, or an earlier run had it.
    pub is_angle: bool,
}

impl Request {
    /// Reads what is docked with some options.
    pub fn read(
        [receptor, ligand]: [&String; 2],
        native: Option<NativeFiles>,
        given: GivenOptions,
    ) -> Result<Self, Error> {
        let bodies = Bodies::read(receptor, ligand, &given.options)?;
        Ok(Self::of(bodies, native, given))
    }

    /// The docking of what has been read, with some options.
    pub fn of(bodies: Bodies, native: Option<NativeFiles>, given: GivenOptions) -> Self {
        let (offset, lengths) = lengths(&given);
        Self {
            bodies,
            native,
            offset,
            given: lengths,
            is_angle: given.by_angle() || !given.has("rotations"),
            options: given.options,
        }
    }

    /// The request of an earlier run, from its run.json, on this machine.
    pub fn recorded(path: &Path, machine: MachineOptions, console: Console) -> Result<Self, Error> {
        if let Some(directory) = path.parent() {
            put_back(directory)?;
        }
        let mut run = RecordedRun::read(path)?;
        run.options.machine = machine;
        if !run.is_of_this_program() {
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
            bodies: Bodies::recorded([&run.receptor, &run.ligand], path, &run.options)?,
            native: run
                .native
                .as_ref()
                .map(|native| NativeFiles::recorded(native, path))
                .transpose()?,
            offset: Some(run.options.kernel.offset),
            given: GivenLengths {
                resolution: true,
                cluster_radius: true,
                alpha: true,
            },
            is_angle: true,
            options: run.options,
        })
    }

    /// Plans the run; of meshes, options that follow from them are filled in.
    pub fn plan(&mut self, console: Console) -> Result<PreparedPair, Error> {
        let (offset, given) = (self.offset, self.given);
        self.bodies.plan(&mut self.options, offset, given, console)
    }

    /// Matches the known complex, if there is one, with the molecules. One that does not match costs a warning, not the
    /// docking.
    pub fn known(&self, console: Console) -> Result<Option<Known>, Error> {
        match (&self.native, &self.bodies) {
            (Some(native), Bodies::Molecules(inputs)) => {
                let [receptor, ligand] = inputs.as_ref();
                Ok(Some(
                    match native.evaluator(&receptor.molecule, &ligand.molecule) {
                        Ok(evaluator) => {
                            native.warn(console);
                            announce(&evaluator, console);
                            Known::Matched(evaluator)
                        }
                        Err(failure) => {
                            console.warn(format!(
                                "no pose is measured: {}; {}",
                                failure.in_one_line(),
                                "`knotdock evaluate` measures the run by another known complex"
                            ));
                            Known::Unmatched(failure.message().to_owned())
                        }
                    },
                ))
            }
            (Some(_), Bodies::Meshes(_)) => Err(Error::input(
                "a known complex is for molecules, and these are meshes",
            )
            .help("leave --native, --native-receptor and --native-ligand out")),
            (None, _) => Ok(None),
        }
    }

    /// The inputs for run.json, with how meshes were sampled.
    pub fn inputs(&self, sampling: Option<&Sampling>) -> Result<Inputs, Error> {
        let [receptor, ligand] = self.bodies.entries(sampling)?;
        Ok(Inputs {
            receptor,
            ligand,
            native: self.native.as_ref().map(NativeFiles::record),
        })
    }

    /// What the run puts together.
    pub fn arrangement(&self) -> Arrangement {
        self.options.search.symmetry.into()
    }

    /// The directory of a run that names none.
    pub fn directory(&self) -> PathBuf {
        let [receptor, ligand] = self.bodies.labels();
        let partner = match self.arrangement() {
            Arrangement::Pair => ligand,
            Arrangement::Ring(symmetry) => symmetry.to_string(),
        };
        PathBuf::from(format!("knotdock_{receptor}_{partner}"))
    }
}
