//! Solids named on the command line: a mesh, a molecule or a file of balls, as balls between which its surface lies.

use std::path::Path;

use crate::arguments::options::{OfReading, TypedOptions};
use clap::Args;
use knotdock::options::SampleGrid;
use knotdock::output::records::input_record::InputRecord;
use knotdock_structures::Ball;
use knotdock_structures::ball_solid::{BallSolid, MeshSampling};
use knotdock_structures::knots::KnotsError;
use knotdock_structures::mesh::Figure;
use knotdock_structures::molecule::{InputSpec, Molecule};
use serde_json::{Value, json};

use crate::inputs::molecules::Input;
use crate::inputs::room::{room_to_read, room_to_sample};
use crate::inputs::shapes::{BallFileInput, MeshInput, ball_file_of, is_mesh};
use crate::messages::console::Console;
use knotdock_structures::Error;

/// Options on solids.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Solids")]
pub struct SolidArguments {
    /// Nodes of the grid on which a mesh is sampled by balls, as 2^15 or 32768: the more, the closer its surface is
    /// known.
    #[arg(long, value_name = "COUNT", default_value = "2^15")]
    pub grid: SampleGrid,
    #[command(flatten)]
    pub input: TypedOptions<OfReading>,
}

/// A solid as read.
#[derive(Clone)]
pub struct SolidInput {
    /// File, the part of it that was read, and checksum.
    pub record: InputRecord,
    /// Kind of the file: mesh, molecule or balls.
    kind: &'static str,
    /// The solid.
    pub solid: BallSolid,
    report: String,
    warnings: Vec<String>,
    sampling: Option<MeshSampling>,
}

impl SolidInput {
    /// Reads what `text` names: `part.stl`, `molecule.pdb:A`, `knots.csv`, `robot.yml:hand`. `allowed` is the memory
    /// that a process may take, in bytes.
    ///
    /// # Errors
    /// [`Error`] with file, line and remedy.
    pub fn read(
        text: &str,
        arguments: &SolidArguments,
        allowed: Option<u64>,
    ) -> Result<Self, Error> {
        if let Some(spec) = ball_file_of(text) {
            return Self::of_balls(&spec);
        }
        let spec = InputSpec::parse(text)?;
        room_to_read(std::slice::from_ref(&spec), allowed)?;
        if is_mesh(&spec.path) {
            room_to_sample(arguments.grid.per_axis, allowed)?;
            return Self::of_mesh(&spec, arguments.grid.per_axis);
        }
        let input = Input::of(&spec, &arguments.input.options.input.reading())?;
        Self::of_molecule(input.record, &input.molecule)
    }

    fn of_balls(spec: &InputSpec) -> Result<Self, Error> {
        let input = BallFileInput::read(spec)?;
        let file = &input.file;
        let solid = BallSolid::from_balls(&file.balls, file.weights.as_deref())
            .map_err(|error| Error::input(error).at(&spec.path))?;
        Ok(Self {
            kind: "balls",
            report: input.report(),
            warnings: input.warnings(),
            record: input.record,
            solid,
            sampling: None,
        })
    }

    fn of_mesh(spec: &InputSpec, per_axis: usize) -> Result<Self, Error> {
        let MeshInput {
            record,
            report,
            solid,
            ..
        } = MeshInput::read(spec)?;
        let (solid, sampling) = BallSolid::from_mesh(&solid, per_axis).map_err(|error| {
            Error::input(error)
                .at(&spec.path)
                .help("check that the mesh is closed and one solid, or sample it on a finer --grid")
        })?;
        let mut warnings = report.warnings();
        if sampling.inward > sampling.grid_epsilon {
            warnings.push(format!(
                "the balls come within {} of the surface, not within {} as asked; a finer --grid comes closer",
                Figure(sampling.inward),
                Figure(sampling.grid_epsilon)
            ));
        }
        Ok(Self {
            record,
            kind: "mesh",
            report: format!(
                "{report}\n  {} balls inside, the surface within {} of them",
                solid.inner().len(),
                Figure(solid.epsilon())
            ),
            warnings,
            solid,
            sampling: Some(sampling),
        })
    }

    fn of_molecule(record: InputRecord, molecule: &Molecule) -> Result<Self, Error> {
        let refused = |error: KnotsError| Error::input(error).at(&record.path);
        let knots = molecule.knots().map_err(refused)?;
        let balls = knots.centers.iter().zip(&knots.radii);
        let balls: Vec<Ball> = balls
            .map(|(&center, &radius)| Ball { center, radius })
            .collect();
        let solid = BallSolid::from_balls(&balls, None).map_err(refused)?;
        Ok(Self {
            record,
            kind: "molecule",
            report: molecule.report.to_string(),
            warnings: Vec::new(),
            solid,
            sampling: None,
        })
    }

    /// The path of the file.
    pub fn path(&self) -> &Path {
        &self.record.path
    }

    /// What was read, for JSON.
    pub fn object(&self) -> Value {
        json!({
            "file": self.record.path.display().to_string(),
            "kind": self.kind,
            "balls": self.solid.inner().len(),
            "epsilon": self.solid.epsilon(),
            "grid_per_axis": self.sampling.map(|sampling| sampling.per_axis),
            "volume_missed_by_balls": self.sampling.and_then(|sampling| sampling.missed),
            "warnings": self.warnings,
        })
    }
}

/// Reads solids in one unit of length; a text that is repeated is read once.
///
/// # Errors
/// As [`SolidInput::read`].
pub fn read_solids(
    texts: &[&str],
    arguments: &SolidArguments,
    allowed: Option<u64>,
) -> Result<Vec<SolidInput>, Error> {
    let mut solids: Vec<SolidInput> = Vec::with_capacity(texts.len());
    for (index, text) in texts.iter().enumerate() {
        let read = texts[..index].iter().position(|other| other == text);
        solids.push(match read {
            Some(other) => solids[other].clone(),
            None => SolidInput::read(text, arguments, allowed)?,
        });
    }
    Ok(solids)
}

/// Prints what was read of each solid, as A and B, and warns.
pub fn describe_solids(solids: &[SolidInput], console: Console) {
    for (side, input) in ["A", "B"].iter().zip(solids) {
        console.say(format!("{side}: {}", input.report));
        for warning in &input.warnings {
            console.warn(format!("{}: {warning}", input.record.path.display()));
        }
    }
}
