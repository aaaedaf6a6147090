//! Solids named on the command line: a mesh, a molecule or a file of balls, as balls between which its surface lies.

use std::path::{Path, PathBuf};

use clap::Args;
use knotdock::bounded_read::{MAX_TABLE, read_bounded};
use knotdock::options::InputOptions;
use knotdock::options::SampleGrid;
use knotdock::output::records::input_record::InputRecord;
use knotdock_structures::Ball;
use knotdock_structures::ball_file::{self, BallFile};
use knotdock_structures::ball_solid::{BallSolid, MeshSampling};
use knotdock_structures::knots::KnotsError;
use knotdock_structures::mesh::Figure;
use knotdock_structures::molecule::{InputSpec, Molecule};
use serde_json::{Value, json};

use crate::cli::inputs::meshes::{MeshInput, is_mesh};
use crate::cli::inputs::molecules::Input;
use crate::cli::inputs::room::{room_to_read, room_to_sample};
use crate::cli::messages::console::Console;
use crate::cli::messages::failure::Failure;

/// Options on solids.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Solids")]
pub struct SolidArguments {
    /// Nodes of the grid on which a mesh is sampled by balls, as 2^15 or 32768: the more, the closer its surface is
    /// known.
    #[arg(long, value_name = "M", default_value = "2^15")]
    pub grid: SampleGrid,
    #[command(flatten)]
    pub input: InputOptions,
}

/// What kind of file a solid came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolidKind {
    /// Sampled by Algorithm 1.
    Mesh,
    /// A ball an atom.
    Molecule,
    /// Balls as they are.
    Balls,
}

/// A solid as read.
#[derive(Clone)]
pub struct SolidInput {
    /// File, the part of it that was read, and checksum.
    pub record: InputRecord,
    /// What kind of file it was.
    pub kind: SolidKind,
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
    /// [`Failure`] with file, line and remedy.
    pub fn read(
        text: &str,
        arguments: &SolidArguments,
        allowed: Option<u64>,
    ) -> Result<Self, Failure> {
        if let Some((path, group)) = ball_file_of(text) {
            return Self::of_balls(&path, group.as_deref());
        }
        let spec = InputSpec::parse(text)?;
        room_to_read(std::slice::from_ref(&spec), allowed)?;
        if is_mesh(&spec.path) {
            room_to_sample(arguments.grid.per_axis, allowed)?;
            return Self::of_mesh(&spec, arguments.grid.per_axis);
        }
        let input = Input::of(&spec, &arguments.input.reading())?;
        Self::of_molecule(input.record, &input.molecule)
    }

    fn of_balls(path: &Path, group: Option<&str>) -> Result<Self, Failure> {
        let bytes = read_bounded(path, MAX_TABLE).map_err(|error| {
            Failure::input(format!("cannot read the balls: {error}"))
                .at(path)
                .remedy("check the name, the permissions and the size of the file")
        })?;
        let file = ball_file::parse(path, &bytes, group)?;
        let solid = BallSolid::from_balls(&file.balls, file.weights.as_deref())
            .map_err(|error| Failure::input(error).at(path))?;
        let spec = InputSpec {
            path: path.to_owned(),
            chains: group.map(|group| vec![group.to_owned()]),
        };
        Ok(Self {
            record: InputRecord::new(&spec, &bytes),
            kind: SolidKind::Balls,
            report: balls_text(&file),
            warnings: switched_off(&file).into_iter().collect(),
            solid,
            sampling: None,
        })
    }

    fn of_mesh(spec: &InputSpec, per_axis: usize) -> Result<Self, Failure> {
        let MeshInput {
            record,
            report,
            solid,
            ..
        } = MeshInput::read(spec)?;
        let (solid, sampling) = BallSolid::from_mesh(&solid, per_axis).map_err(|error| {
            Failure::input(error).at(&spec.path).remedy(
                "check that the mesh is closed and one solid, or sample it on a finer --grid",
            )
        })?;
        let mut warnings = report.warnings();
        if sampling.inward > sampling.grid_epsilon {
            warnings.push(format!(
                "balls come only within {} of the surface, not within {}; a finer --grid may",
                Figure(sampling.inward),
                Figure(sampling.grid_epsilon)
            ));
        }
        Ok(Self {
            record,
            kind: SolidKind::Mesh,
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

    fn of_molecule(record: InputRecord, molecule: &Molecule) -> Result<Self, Failure> {
        let refused = |error: KnotsError| Failure::input(error).at(&record.path);
        let knots = molecule.knots().map_err(refused)?;
        let balls = knots.centers.iter().zip(&knots.radii);
        let balls: Vec<Ball> = balls
            .map(|(&center, &radius)| Ball { center, radius })
            .collect();
        let solid = BallSolid::from_balls(&balls, None).map_err(refused)?;
        Ok(Self {
            record,
            kind: SolidKind::Molecule,
            report: molecule.report.to_string(),
            warnings: Vec::new(),
            solid,
            sampling: None,
        })
    }

    /// Reports what was read under the name `side`, with warnings.
    pub fn describe(&self, side: &str, console: Console) {
        console.say(format!("{side}: {}", self.report));
        for warning in &self.warnings {
            console.warn(format!("{}: {warning}", self.record.path.display()));
        }
    }

    /// The path of the file.
    pub fn path(&self) -> &Path {
        &self.record.path
    }

    /// What was read, for JSON.
    pub fn object(&self) -> Value {
        json!({
            "file": self.record.path.display().to_string(),
            "kind": match self.kind {
                SolidKind::Mesh => "mesh",
                SolidKind::Molecule => "molecule",
                SolidKind::Balls => "balls",
            },
            "balls": self.solid.inner().len(),
            "epsilon": self.solid.epsilon(),
            "grid_per_axis": self.sampling.map(|sampling| sampling.per_axis),
            "volume_missed_by_balls": self.sampling.and_then(|sampling| sampling.missed),
            "warnings": self.warnings,
        })
    }
}

/// The file of balls that a text names, and the link picked of it.
pub fn ball_file_of(text: &str) -> Option<(PathBuf, Option<String>)> {
    let whole = Path::new(text);
    if ball_file::is_ball_file(whole) {
        return Some((whole.to_owned(), None));
    }
    let (path, group) = text.rsplit_once(':')?;
    let is_of_balls = ball_file::is_ball_file(Path::new(path)) && !group.is_empty();
    is_of_balls.then(|| (path.into(), Some(group.to_owned())))
}

fn balls_text(file: &BallFile) -> String {
    let count = file.balls.len();
    let of = file.group.as_ref().map(|group| format!(" of {group}"));
    let balls = if count == 1 { "ball" } else { "balls" };
    format!("{count} {balls}{}", of.unwrap_or_default())
}

fn switched_off(file: &BallFile) -> Option<String> {
    let count = file.switched_off;
    (count > 0).then(|| {
        format!("left out {count} spheres whose radius is not above zero, by which they are switched off")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_balls_are_known_by_their_names() {
        let found =
            |text| ball_file_of(text).map(|(path, group)| (path.display().to_string(), group));
        assert_eq!(found("a/knots.csv"), Some(("a/knots.csv".into(), None)));
        let hand = ("robot.yml".to_owned(), Some("hand".to_owned()));
        assert_eq!(found("robot.yml:hand"), Some(hand));
        assert_eq!(found("robot.yml:"), None);
        assert_eq!(found("molecule.pdb:A"), None);
        assert_eq!(found("part.stl"), None);
    }
}
