//! The two bodies of a run: molecules or meshes, and their differences.

use std::path::Path;
use std::sync::Arc;

use crate::inputs::checks::{refuse_traces, room_to_read, room_to_sample};
use crate::inputs::molecules::{Input, folders_of, label};
use crate::inputs::native::NativeFiles;
use crate::inputs::request::GivenMeshOptions;
use crate::inputs::solids::{ShapeInput, ball_file_of, is_shape};
use crate::messages::console::Console;
use knotdock::dock::gaps::{self, CLOSER};
use knotdock::dock::pair::{Pair, PreparedPair, Sampling, sampled_defaults};
use knotdock::dock::scene::ring_axis;
use knotdock::mesh::samplers::Sampler;
use knotdock::mesh::{MeshOptions, MeshPair, Shape};
use knotdock::options::DockOptions;
use knotdock::output::records::input_record::InputRecord;
use knotdock::output::records::manifest::InputEntry;
use knotdock::output::run_contacts::RunContacts;
use knotdock::output::run_folder;
use knotdock::output::tables::poses::PoseTable;
use knotdock::pose_space::arrangement::Arrangement;
use knotdock_structures::Error;
use knotdock_structures::mesh::Solid;
use knotdock_structures::molecule::InputSpec;

pub enum Bodies {
    /// Two molecules, which stays first.
    Molecules(Box<[Input; 2]>),
    /// Two meshes or files of balls, likewise.
    Meshes(Box<[ShapeInput; 2]>),
}

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
        let [receptor, ligand] = records.map(|record| record.locate(&folders));
        let specs = [receptor?.spec(), ligand?.spec()];
        Self::read_any(specs, options)
    }

    /// Reads two bodies of one kind that can be docked.
    pub fn of(specs: [InputSpec; 2], options: &DockOptions) -> Result<Self, Error> {
        let bodies = Self::read_any(specs, options)?;
        if let Self::Molecules(inputs) = &bodies {
            refuse_traces(["receptor", "ligand"].into_iter().zip(inputs.as_ref()))?;
        }
        Ok(bodies)
    }

    /// Reads two bodies of one kind, of an earlier run what it docked.
    fn read_any(specs: [InputSpec; 2], options: &DockOptions) -> Result<Self, Error> {
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

    /// Reports inputs and warnings, for rings of the one molecule: one line each, or with details.
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
                    input.file.describe(side, console);
                }
            }
        }
    }

    /// Plans their docking. Options that follow from the meshes are filled in; `given` has those that do not.
    pub fn plan(
        &self,
        options: &mut DockOptions,
        given: GivenMeshOptions,
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
                let (sampling, closer) = sampled(inputs, options, given, console)?;
                let closer = closer.map(Arc::new);
                // The closer gap needs more memory, so that a refusal of it names what suffices.
                if let Some(closer) = &closer {
                    let options = gaps::closer(options, given.defaults.cluster_radius);
                    PreparedPair::meshes(Arc::clone(closer), &options)?;
                }
                Ok(PreparedPair {
                    closer,
                    ..PreparedPair::meshes(Arc::new(sampling), options)?
                })
            }
        }
    }

    /// Both molecules where they are, as the known complex.
    pub fn as_known(&self) -> Option<NativeFiles> {
        match self {
            Self::Molecules(inputs) => Some(NativeFiles::of_pair(inputs)),
            Self::Meshes(_) => None,
        }
    }

    pub fn pair(&self) -> Pair<'_> {
        match self {
            Self::Molecules(inputs) => {
                Pair::Molecules(inputs.each_ref().map(|input| &input.molecule))
            }
            Self::Meshes(inputs) => Pair::Meshes(inputs.each_ref().map(ShapeInput::shape)),
        }
    }

    /// Both as solids; `None` for molecules and balls of files.
    pub fn solids(&self) -> Option<[&Solid; 2]> {
        let Self::Meshes(inputs) = self else {
            return None;
        };
        match inputs.each_ref().map(ShapeInput::shape) {
            [Shape::Solid(receptor), Shape::Solid(ligand)] => Some([receptor, ligand]),
            _ => None,
        }
    }

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
        let (arrangement, ph) = (options.search.symmetry.into(), options.terms.ph);
        Some(RunContacts::of(molecules, table, arrangement, ph))
    }

    /// Receptor and ligand for run.json.
    pub fn entries(&self, sampling: Option<&Sampling>) -> Result<[InputEntry; 2], Error> {
        match self {
            Self::Molecules(inputs) => {
                let [receptor, ligand] = inputs.each_ref().map(Input::entry);
                Ok([receptor?, ligand?])
            }
            Self::Meshes(inputs) => Ok([0, 1].map(|side| {
                inputs[side].entry(sampling.map(|sampling| &sampling.pair.parts[side]))
            })),
        }
    }

    pub fn records(&self) -> [&InputRecord; 2] {
        match self {
            Self::Molecules(inputs) => inputs.each_ref().map(|input| &input.record),
            Self::Meshes(inputs) => inputs.each_ref().map(|input| &input.file.record),
        }
    }

    /// Names for directories.
    pub fn labels(&self) -> [String; 2] {
        self.records()
            .map(|record| label(&record.path, record.chains.as_deref()))
    }
}

/// The file and parts that a text names; for a file of balls, the link after a colon.
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

/// Refuses the first option that differs from its default and has no effect on such bodies.
fn refuse_without_effect(options: &DockOptions, are_meshes: bool) -> Result<(), Error> {
    let Some(option) = options.without_effect(are_meshes) else {
        return Ok(());
    };
    let long = option.long();
    Err(match are_meshes {
        true => Error::input(format!("--{long} is for molecules, and these are meshes"))
            .help("leave it out: meshes are scored by shape alone"),
        false => Error::input(format!("--{long} is for meshes, and these are molecules"))
            .help("leave it out: the balls of a molecule are its atoms"),
    })
}

/// Meshes as balls, and for a closer gap if the gap is searched. Options that follow from them are filled in, and the
/// sampling is reported.
pub fn sampled(
    inputs: &[ShapeInput; 2],
    options: &mut DockOptions,
    GivenMeshOptions {
        offset,
        defaults,
        fixes_gap,
    }: GivenMeshOptions,
    console: Console,
) -> Result<(Sampling, Option<Sampling>), Error> {
    let sampler = *options.sampling.sampler.get_or_insert_default();
    if !defaults.alpha {
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
        lambda: options.kernel.lambda,
        resolution: defaults.resolution.then_some(options.kernel.resolution),
        pass_length: options.kernel.pass_length,
        memory: options.machine.memory,
    };
    room_to_sample(sampling.per_axis, options.machine.memory)?;
    let solids = inputs.each_ref().map(ShapeInput::shape);
    // The other sampler has balls of every size, so that a closer gap takes several times as long.
    let share = (!fixes_gap && sampler == Sampler::Lattice).then_some(CLOSER);
    let sampled =
        Sampling::of_gaps(solids, &sampling, share).map_err(|error| match error.part {
            Some(part) => error.error.at(&inputs[part].file.record.path),
            None => error.error,
        })?;
    let pair = &sampled.0.pair;
    sampled_defaults(pair, options, defaults);
    console.say(match console.verbose {
        true => sampling_text(pair),
        false => brief_sampling_text(pair),
    });
    Ok(sampled)
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
        let weights = match (&part.weights, &part.double_skin) {
            (Some(fit), _) => format!(
                "weights fitted (off one inside by {:.2} rms, integral {:.3} of the volume)",
                fit.rms_fitted, fit.volume_fitted
            ),
            (None, Some(skin)) => format!(
                "weights fitted (double skin off by {:.2} of {:.2} rms near the surface, {} steps)",
                skin.rms, skin.rms_of_target, skin.steps
            ),
            (None, None) => "weights of one".to_owned(),
        };
        let (low, high) = (part.smallest_radius, part.radius);
        let radii = match part.per_cell {
            Some(k) => format!("radius {high:.4e}, one for each cell of {k:.2} nodes"),
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
