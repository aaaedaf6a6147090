//! The two bodies of a run: molecules or meshes, and what differs between them.

use knotdock::dock::scene::ring_axis;
use knotdock::output::run_folder;
use std::path::Path;
use std::sync::Arc;

use crate::report::{ReportBodies, RunContacts};
use knotdock::dock::pair::{GivenLengths, Pair, PreparedPair, Sampling, sampled_defaults};
use knotdock::mesh::{MeshOptions, MeshPair, MeshSceneError};
use knotdock::options::DockOptions;
use knotdock::output::records::input_record::InputRecord;
use knotdock::output::records::manifest::InputEntry;
use knotdock::output::tables::poses::PoseTable;
use knotdock::pose_space::arrangement::Arrangement;
use knotdock_structures::Error;
use knotdock_structures::molecule::InputSpec;
use knotdock_structures::sampling::weights::FittedWeights;

use crate::inputs::molecules::{Input, folders_of, label};
use crate::inputs::room::{room_to_read, room_to_sample};
use crate::inputs::shapes::{ShapeInput, ball_file_of, is_shape};
use crate::inputs::traces::refuse_traces;
use crate::messages::console::Console;

/// The bodies as read.
pub enum Bodies {
    /// Two molecules, which stays first.
    Molecules(Box<[Input; 2]>),
    /// Two meshes or files of balls, likewise.
    Meshes(Box<[ShapeInput; 2]>),
}

/// Names of the two sides.
const SIDES: [&str; 2] = ["Receptor", "Ligand"];

impl Bodies {
    /// Reads two bodies of one kind as the command line names them.
    pub fn read(receptor: &str, ligand: &str, options: &DockOptions) -> Result<Self, Error> {
        Self::of([spec_of(receptor)?, spec_of(ligand)?], options)
    }

    /// Whether they are sampled on a grid.
    pub fn are_meshes(&self) -> bool {
        matches!(self, Self::Meshes(_))
    }

    /// Reads what a run recorded; see [`Input::recorded`].
    pub fn recorded(
        records: [&InputRecord; 2],
        run: &Path,
        options: &DockOptions,
    ) -> Result<Self, Error> {
        let folders = folders_of(run);
        let [receptor, ligand] = records;
        let specs = [
            receptor.locate(&folders)?.spec(),
            ligand.locate(&folders)?.spec(),
        ];
        Self::whatever(specs, options)
    }

    /// Reads two bodies of one kind that can be docked.
    pub fn of(specs: [InputSpec; 2], options: &DockOptions) -> Result<Self, Error> {
        let bodies = Self::whatever(specs, options)?;
        if let Self::Molecules(inputs) = &bodies {
            refuse_traces(["receptor", "ligand"].into_iter().zip(inputs.as_ref()))?;
        }
        Ok(bodies)
    }

    /// Reads two bodies of one kind, of an earlier run what it docked.
    fn whatever(specs: [InputSpec; 2], options: &DockOptions) -> Result<Self, Error> {
        let [receptor, ligand] = &specs;
        let are_meshes = [receptor, ligand].map(|spec| is_shape(&spec.path));
        if are_meshes[0] == are_meshes[1] {
            refuse_without_effect(options, are_meshes[0])?;
        }
        room_to_read(&specs, options.machine.memory)?;
        match are_meshes {
            [false, false] => {
                let molecules = Input::all(&specs, &options.input.reading())?;
                Ok(Self::Molecules(Box::new(molecules)))
            }
            [true, true] => Ok(Self::Meshes(Box::new([
                ShapeInput::read(receptor)?,
                ShapeInput::read(ligand)?,
            ]))),
            [first, _] => {
                let (mesh, other) = if first {
                    (receptor, ligand)
                } else {
                    (ligand, receptor)
                };
                Err(Error::input(format!(
                    "a mesh cannot be docked with a molecule, {}",
                    other.path.display()
                ))
                .at(&mesh.path)
                .help("dock two meshes in one unit of length, or two molecules"))
            }
        }
    }

    /// Reports what was read, with warnings; of a ring, the one molecule that it is made of. A line each, or all that is
    /// known where the console wants details.
    pub fn describe(&self, arrangement: Arrangement, console: Console) {
        match self {
            Self::Molecules(inputs) => {
                let [receptor, ligand] = inputs.as_ref();
                if arrangement.is_ring() {
                    let (what, suffix) = (arrangement.moved(), arrangement.suffix());
                    return say_read(&format!("Each {what}{suffix}"), receptor, console);
                }
                for (side, input) in SIDES.into_iter().zip([receptor, ligand]) {
                    say_read(side, input, console);
                }
            }
            Self::Meshes(inputs) => {
                for (side, input) in SIDES.into_iter().zip(inputs.as_ref()) {
                    input.describe(side, console);
                }
            }
        }
    }

    /// Plans their docking. Options that follow from the meshes are filled in; `given` says which lengths are not
    /// among these.
    pub fn plan(
        &self,
        options: &mut DockOptions,
        offset: Option<f64>,
        given: GivenLengths,
        console: Console,
    ) -> Result<PreparedPair, Error> {
        match self {
            Self::Molecules(inputs) => {
                let molecules = inputs.each_ref().map(|input| &input.molecule);
                ring_axis(molecules[0], options)
                    .map_err(|error| error.at(&inputs[0].record.path))?;
                PreparedPair::molecules(molecules, options)
            }
            Self::Meshes(_) if options.search.symmetry.is_some() => Err(Error::input(
                "--symmetry needs a molecule, and this is a mesh",
            )
            .help("dock two meshes, without --symmetry")),
            Self::Meshes(inputs) => {
                let sampling = sampled(inputs, options, (offset, given), console)?;
                PreparedPair::meshes(Arc::new(sampling), options)
            }
        }
    }

    /// Samples meshes, as [`Self::plan`] does; `None` of molecules.
    pub fn sampling(
        &self,
        options: &mut DockOptions,
        (offset, given): (Option<f64>, GivenLengths),
        console: Console,
    ) -> Result<Option<Sampling>, Error> {
        match self {
            Self::Molecules(_) => Ok(None),
            Self::Meshes(inputs) => sampled(inputs, options, (offset, given), console).map(Some),
        }
    }

    /// What is docked.
    pub fn pair(&self) -> Pair<'_> {
        match self {
            Self::Molecules(inputs) => {
                Pair::Molecules(inputs.each_ref().map(|input| &input.molecule))
            }
            Self::Meshes(inputs) => Pair::Meshes(inputs.each_ref().map(ShapeInput::shape)),
        }
    }

    /// The bodies as they are written.
    pub fn placed(&self) -> run_folder::Bodies<'_> {
        match self {
            Self::Molecules(inputs) => {
                run_folder::Bodies::Molecules(inputs.each_ref().map(|input| &input.molecule))
            }
            Self::Meshes(inputs) => {
                run_folder::Bodies::Solids(inputs.each_ref().map(ShapeInput::surface))
            }
        }
    }

    /// The contacts of molecules in the poses of a table.
    pub fn contacts(&self, table: &PoseTable, options: &DockOptions) -> Option<RunContacts<'_>> {
        let Self::Molecules(inputs) = self else {
            return None;
        };
        let molecules = inputs.each_ref().map(|input| &input.molecule);
        let arrangement = Arrangement::from(options.search.symmetry);
        Some(RunContacts::of(
            molecules,
            table,
            arrangement,
            options.terms.ph,
        ))
    }

    /// What a report shows of them.
    pub fn shown<'a>(&'a self, contacts: Option<&'a RunContacts<'a>>) -> ReportBodies<'a> {
        match (self, contacts) {
            (Self::Molecules(inputs), Some(contacts)) => {
                let molecules = inputs.each_ref().map(|input| &input.molecule);
                ReportBodies::Molecules(molecules, contacts)
            }
            (Self::Meshes(inputs), _) => {
                ReportBodies::Solids(inputs.each_ref().map(ShapeInput::surface))
            }
            (Self::Molecules(_), None) => unreachable!("molecules come with their contacts"),
        }
    }

    /// Receptor and ligand for run.json.
    pub fn entries(&self, sampling: Option<&Sampling>) -> Result<[InputEntry; 2], Error> {
        let [receptor, ligand] = match self {
            Self::Molecules(inputs) => inputs.each_ref().map(Input::entry),
            Self::Meshes(inputs) => {
                let [receptor, ligand] = inputs.as_ref();
                let part = |index: usize| sampling.map(|sampling| &sampling.pair.parts[index]);
                return Ok([receptor.entry(part(0)), ligand.entry(part(1))]);
            }
        };
        Ok([receptor?, ligand?])
    }

    /// The files of receptor and ligand.
    pub fn records(&self) -> [&InputRecord; 2] {
        match self {
            Self::Molecules(inputs) => inputs.each_ref().map(|input| &input.record),
            Self::Meshes(inputs) => inputs.each_ref().map(|input| &input.record),
        }
    }

    /// Names for directories.
    pub fn labels(&self) -> [String; 2] {
        self.records()
            .map(|record| label(&record.path, record.chains.as_deref()))
    }
}

/// What a text names: of a file of balls, a link may stand behind a colon.
pub fn spec_of(text: &str) -> Result<InputSpec, Error> {
    match ball_file_of(text) {
        Some(spec) => Ok(spec),
        None => Ok(InputSpec::parse(text)?),
    }
}

/// Reports what was read of a molecule: a line and warnings, or all that is known.
fn say_read(what: &str, input: &Input, console: Console) {
    let report = &input.molecule.report;
    if console.verbose {
        return console.say(format!("{what}: {report}"));
    }
    console.say(format!("{what}: {}", report.brief()));
    for warning in &report.warnings {
        console.warn(format!("{}: {warning}", report.file));
    }
}

/// Refuses the first option that is given and has no effect on such bodies: what was meant by it would not happen. An
/// option at its default is no different from one that is not given. Weights of effects that are off are not refused:
/// they say what the effect would weigh.
fn refuse_without_effect(options: &DockOptions, are_meshes: bool) -> Result<(), Error> {
    let Some(option) = options.without_effect(are_meshes) else {
        return Ok(());
    };
    let (of, these, remedy) = if are_meshes {
        let remedy = "leave it out: meshes are scored by shape alone";
        ("molecules", "meshes", remedy)
    } else {
        let remedy = "leave it out: the balls of a molecule are its atoms";
        ("meshes", "molecules", remedy)
    };
    let long = option.long();
    Err(Error::input(format!("--{long} is for {of}, and these are {these}")).help(remedy))
}

/// Meshes as balls. Options that follow from them are filled in, and what was made is said.
fn sampled(
    inputs: &[ShapeInput; 2],
    options: &mut DockOptions,
    (offset, given): (Option<f64>, GivenLengths),
    console: Console,
) -> Result<Sampling, Error> {
    let sampler = *options.sampling.sampler.get_or_insert_default();
    if !given.alpha {
        options.kernel.alpha = sampler.alpha();
    }
    let sampling = MeshOptions {
        sampler,
        per_axis: options
            .sampling
            .sample_grid
            .get_or_insert_default()
            .per_axis,
        weights: *options.sampling.sample_weights.get_or_insert_default(),
        offset,
        alpha: options.kernel.alpha,
    };
    room_to_sample(sampling.per_axis, options.machine.memory)?;
    let solids = inputs.each_ref().map(ShapeInput::shape);
    let sampling = Sampling::of(solids, &sampling).map_err(|error| mesh_failure(error, inputs))?;
    sampled_defaults(&sampling.pair, options, given);
    console.say(match console.verbose {
        true => sampling_text(&sampling.pair),
        false => brief_sampling_text(&sampling.pair),
    });
    Ok(sampling)
}

/// An error that names the mesh at fault.
fn mesh_failure(error: MeshSceneError, inputs: &[ShapeInput; 2]) -> Error {
    match error.part {
        Some(part) => error.error.at(&inputs[part].record.path),
        None => error.error,
    }
}

/// The sampling of the meshes in a line.
fn brief_sampling_text(pair: &MeshPair) -> String {
    let [receptor, ligand] = pair.parts.each_ref();
    format!(
        "Sampled by {} and {} balls, whose surfaces are known within {:.2e} and {:.2e}; looks for a gap of {:.3e}",
        receptor.balls, ligand.balls, receptor.epsilon, ligand.epsilon, pair.offset
    )
}

/// Report on the sampling of the meshes.
fn sampling_text(pair: &MeshPair) -> String {
    let [receptor, ligand] = pair.parts.each_ref().map(|part| {
        let fitted = |fit: &FittedWeights| {
            format!(
                "off one inside by {:.2} rms, integral {:.3} of the volume",
                fit.rms_fitted, fit.volume_fitted
            )
        };
        let weights = match (&part.weights, &part.skin_weights) {
            (Some(fit), None) => format!("weights fitted ({})", fitted(fit)),
            (Some(fit), Some(skin)) => format!(
                "weights fitted ({}; grown balls {})",
                fitted(fit),
                fitted(skin)
            ),
            (None, _) => "weights of one".to_owned(),
        };
        let (low, high) = (part.smallest_radius, part.radius);
        let radii = match part.per_cell {
            Some(k) => format!("radius {high:.4e}, one for {k} x {k} x {k} nodes"),
            None => format!("radius {low:.4e} to {high:.4e}"),
        };
        format!(
            "{} balls of {radii}; eps {:.4e}, feature size {:.4e}; {weights}",
            part.balls, part.epsilon, part.feature_size,
        )
    });
    format!(
        "\nReceptor: {receptor}\nLigand: {ligand}\nOffset r0 {:.6e}, the gap looked for; {}",
        pair.offset,
        pair.sampler.makes()
    )
}
