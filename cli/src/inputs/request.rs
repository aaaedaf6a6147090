//! Request of a docking run, from the command line or from an earlier run's `run.json`.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::arguments::options::GivenOptions;
use crate::inputs::bodies::Bodies;
use crate::inputs::complex_sides::sides_of_model;
use crate::inputs::native::NativeFiles;
use crate::messages::console::Console;
use crate::records::recorded_run::RecordedRun;
use knotdock::dock::gaps::closer;
use knotdock::dock::pair::{GivenDefaults, Pair, PreparedPair, Sampling};
use knotdock::evaluate::{ChainChoice, Evaluator};
use knotdock::options::{DockOptions, MachineOptions};
use knotdock::output::files::staging::put_back;
use knotdock::output::records::input_record::NativeRecord;
use knotdock::output::records::manifest::Inputs;
use knotdock::output::records::program::{VERSION_WITH_COMMIT, cpu_features};
use knotdock::output::tables::poses::PoseTable;
use knotdock::pose_space::arrangement::Arrangement;
use knotdock_structures::Error;
use knotdock_structures::molecule::{ModelChoice, Molecule};

/// Options that follow from meshes unless they are given.
#[derive(Clone, Copy)]
pub struct GivenMeshOptions {
    /// The offset, if it is given.
    pub offset: Option<f64>,
    /// Which further ones are given.
    pub defaults: GivenDefaults,
    /// Whether one gap is searched: a length is given, the clock ends the search, or nothing is docked.
    pub fixes_gap: bool,
}

impl From<&GivenOptions> for GivenMeshOptions {
    fn from(given: &GivenOptions) -> Self {
        Self {
            offset: given.has("offset").then_some(given.options.kernel.offset),
            defaults: GivenDefaults {
                resolution: given.has("resolution"),
                cluster_radius: given.has("cluster_radius"),
                alpha: given.has("alpha"),
                rotations: ["rotations", "fine_rotations", "fine_share"]
                    .into_iter()
                    .any(|name| given.has(name)),
            },
            fixes_gap: ["offset", "resolution", "pass_length", "spacing"]
                .into_iter()
                .any(|name| given.has(name)),
        }
    }
}

/// The known complex, as far as it matches the molecules docked.
pub enum KnownComplex {
    /// Poses can be measured.
    Matched(Evaluator),
    /// They cannot, for this reason.
    Unmatched(String),
}

impl KnownComplex {
    /// The known complex that a run recorded, matched with its molecules. It measures the poses only if `table` has its
    /// figures.
    pub fn recorded(
        native: &NativeRecord,
        run: &Path,
        pair: [&Molecule; 2],
        table: &PoseTable,
    ) -> Self {
        let files = NativeFiles::recorded(native, run);
        let matched = files.and_then(|files| files.evaluator(pair, &ChainChoice::default()));
        let first = table.rows().first();
        let written = table.field(0, "irmsd").and_then(|field| field.parse().ok());
        let differs = |evaluator: &Evaluator| {
            let computed = first.map(|row| evaluator.evaluate(&row.pose).irmsd);
            let both = computed.zip(written);
            both.is_some_and(|(one, other): (f64, f64)| (one - other).abs() > 1e-3)
        };
        match matched {
            Ok(evaluator) if differs(&evaluator) => Self::Unmatched(
                "poses.csv was measured by another one, or by other chains of it".to_owned(),
            ),
            Ok(evaluator) => Self::Matched(evaluator),
            Err(error) => Self::Unmatched(error.message().to_owned()),
        }
    }

    /// What measures poses, if they can be measured.
    pub fn evaluator(&self) -> Option<&Evaluator> {
        self.matched().ok()
    }

    /// What measures poses, or why they cannot be measured.
    pub fn matched(&self) -> Result<&Evaluator, &str> {
        match self {
            Self::Matched(evaluator) => Ok(evaluator),
            Self::Unmatched(reason) => Err(reason),
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

pub struct Request {
    pub bodies: Bodies,
    /// The known complex, if one was named.
    pub native: Option<NativeFiles>,
    /// Whether the known complex is the prediction that the molecules are from.
    pub is_from_model: bool,
    /// What to do; a plan of meshes fills in defaults for them.
    pub options: DockOptions,
    /// Options that are given and do not follow from meshes.
    pub given: GivenMeshOptions,
    /// Whether a number of rotations is none that was typed: it stands for an angle, or an earlier run had it.
    pub is_angle: bool,
}

impl Request {
    /// The docking of bodies with some options.
    pub fn of(bodies: Bodies, native: Option<NativeFiles>, given: GivenOptions) -> Self {
        let options = match bodies.pair() {
            Pair::Molecules([_, ligand]) => {
                let options = given.options.clone();
                options.of_ligand(ligand, |name| given.has(name))
            }
            Pair::Meshes(_) => given.options.clone(),
        };
        Self {
            bodies,
            native,
            is_from_model: false,
            given: (&given).into(),
            is_angle: given.by_angle() || !given.has("rotations"),
            options,
        }
    }

    /// The docking of the two sides of a predicted complex, which words name.
    pub fn from_model(words: &[String], given: GivenOptions) -> Result<Self, Error> {
        const WHOLE: &str = "--from-model";
        let options = &given.options;
        let refused = |name: &str, remedy: &str| {
            Err(Error::input(format!("--{name} does not work with {WHOLE}")).help(remedy))
        };
        let copy = "write the complex that is meant into its own file, and give that";
        if options.search.symmetry.is_some() {
            return refused(
                "symmetry",
                "dock one chain: `knotdock dock model.cif:A --symmetry C2`",
            );
        } else if options.input.model != ModelChoice::default() {
            return refused("model", copy);
        } else if options.input.assembly.is_some() {
            return refused("assembly", copy);
        }
        let sides = sides_of_model(words, &options.input.reading())?;
        let bodies = Bodies::of(sides, options)?;
        let native = bodies.as_known();
        Ok(Self {
            is_from_model: true,
            ..Self::of(bodies, native, given)
        })
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
        let bodies = Bodies::recorded(run.inputs.pair(), path, &run.options)?;
        let is_from_model = run.redocking.is_some();
        Ok(Self {
            native: match (&run.inputs.native, is_from_model) {
                (_, true) => bodies.as_known(),
                (Some(native), false) => Some(NativeFiles::recorded(native, path)?),
                (None, false) => None,
            },
            bodies,
            is_from_model,
            given: GivenMeshOptions {
                offset: Some(run.options.kernel.offset),
                defaults: GivenDefaults {
                    resolution: true,
                    cluster_radius: true,
                    alpha: true,
                    rotations: true,
                },
                fixes_gap: true,
            },
            is_angle: true,
            options: run.options,
        })
    }

    /// Plans the run; of meshes, options that follow from them are filled in.
    pub fn plan(&mut self, console: Console) -> Result<PreparedPair, Error> {
        self.bodies.plan(&mut self.options, self.given, console)
    }

    /// Options and plan at the closer gap, if the gap of meshes is searched.
    pub fn closer_gap(
        &self,
        prepared: &mut PreparedPair,
    ) -> Result<Option<(DockOptions, PreparedPair)>, Error> {
        let Some(sampling) = prepared.closer.take() else {
            return Ok(None);
        };
        let options = closer(&self.options, self.given.defaults.cluster_radius);
        let prepared = PreparedPair::meshes(sampling, &options)?;
        Ok(Some((options, prepared)))
    }

    /// Matches the known complex, if there is one; a mismatch is a warning.
    pub fn known(&self, console: Console) -> Result<Option<KnownComplex>, Error> {
        match (&self.native, &self.bodies) {
            (Some(native), Bodies::Molecules(inputs)) => {
                let pair = inputs.each_ref().map(|input| &input.molecule);
                let matched = native.matched(pair, console).map(KnownComplex::Matched);
                if self.is_from_model {
                    let remedy = "give two sides that touch, as in `--from-model model.cif H,L A`, or dock two files";
                    return matched.map(Some).map_err(|error| error.help(remedy));
                }
                Ok(Some(matched.unwrap_or_else(|failure| {
                    console.warn(format!(
                        "no pose is measured: {}; `knotdock evaluate` measures the run by another known complex",
                        failure.in_one_line()
                    ));
                    KnownComplex::Unmatched(failure.message().to_owned())
                })))
            }
            (Some(_), Bodies::Meshes(_)) => Err(Error::input(
                "a known complex is for molecules, and these are meshes",
            )
            .help("leave --native, --native-receptor and --native-ligand out")),
            (None, _) => Ok(None),
        }
    }

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
