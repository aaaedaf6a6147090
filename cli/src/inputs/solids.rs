//! Solids named on the command line: a mesh, a molecule or a file of balls, as balls between which its surface lies.

use std::path::Path;
use std::sync::Arc;

use clap::Args;
use serde_json::{Value, json};

use crate::arguments::options::{OfReading, OptionArguments};
use crate::inputs::checks::{room_to_read, room_to_sample};
use crate::inputs::molecules::Input;
use crate::messages::console::Console;
use crate::solid_files::balls::spheres;
use crate::tables::report::counted;
use knotdock::bounded_read::{MAX_TABLE, read_bounded};
use knotdock::mesh::{BallPart, SampledPart, Shape};
use knotdock::options::SampleGrid;
use knotdock::output::files::assemblies::Surface;
use knotdock::output::records::input_record::InputRecord;
use knotdock::output::records::manifest::InputEntry;
use knotdock_structures::ball_file::{self, BallFile};
use knotdock_structures::ball_solid::{BallSolid, MeshSampling};
use knotdock_structures::knots::KnotsError;
use knotdock_structures::mesh::{self, Figure, Mesh, MeshReport, Solid};
use knotdock_structures::molecule::{InputSpec, Molecule};
use knotdock_structures::{Ball, Error};

/// Options on solids.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Solids")]
pub struct SolidArguments {
    /// Nodes of the grid on which a mesh is sampled by balls, as 2^15 or 32768: the more, the closer its surface is
    /// known.
    #[arg(long, value_name = "COUNT", default_value = "2^15")]
    pub grid: SampleGrid,
    #[command(flatten)]
    pub input: OptionArguments<OfReading>,
}

/// A file as read, in words.
#[derive(Clone)]
pub struct ReadFile {
    /// File, the part of it that was read, and checksum.
    pub record: InputRecord,
    description: String,
    warnings: Vec<String>,
}

impl ReadFile {
    /// Describes what was read, under the name of its side, and warns.
    pub fn describe(&self, side: &str, console: Console) {
        console.say(format!("{side}: {}", self.description));
        for warning in &self.warnings {
            console.warn(format!("{}: {warning}", self.record.path.display()));
        }
    }
}

#[derive(Clone)]
pub struct SolidInput {
    file: ReadFile,
    /// Kind of the file: mesh, molecule or balls.
    kind: &'static str,
    pub solid: BallSolid,
    /// The mesh, if the solid is a closed one.
    pub mesh: Option<Arc<Solid>>,
    sampling: Option<MeshSampling>,
}

impl SolidInput {
    /// Reads `part.stl`, `molecule.pdb:A`, `knots.csv` or `robot.yml:hand` with at most `allowed` bytes of memory.
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
        let input = Input::of(&spec, &arguments.input.given()?.options.input.reading())?;
        Self::of_molecule(input.record, &input.molecule)
    }

    fn of_balls(spec: &InputSpec) -> Result<Self, Error> {
        let (file, BallFile { balls, weights, .. }) = read_balls(spec)?;
        let solid = BallSolid::from_balls(&balls, weights.as_deref())
            .map_err(|error| Error::input(error).at(&spec.path))?;
        Ok(Self {
            file,
            kind: "balls",
            solid,
            mesh: None,
            sampling: None,
        })
    }

    fn of_mesh(spec: &InputSpec, per_axis: usize) -> Result<Self, Error> {
        let MeshInput {
            mut file,
            solid: mesh,
            ..
        } = MeshInput::read(spec)?;
        let (solid, sampling) = BallSolid::from_mesh(&mesh, per_axis).map_err(|error| {
            Error::input(error)
                .at(&spec.path)
                .help("check that the mesh is closed and one solid, or sample it on a finer --grid")
        })?;
        if sampling.inward > sampling.grid_epsilon {
            file.warnings.push(format!(
                "the balls come within {} of the surface, not within {} as requested; a finer --grid comes closer",
                Figure(sampling.inward),
                Figure(sampling.grid_epsilon)
            ));
        }
        file.description += &format!(
            "\n  {} balls inside, the surface within {} of them",
            solid.inner().len(),
            Figure(solid.epsilon())
        );
        if let Some(reason) = sampling.indefinite {
            file.description +=
                &format!("\n  {reason}, so balls alone decide and poses may stay undecided");
        }
        Ok(Self {
            file,
            kind: "mesh",
            solid,
            mesh: mesh.mesh().is_closed().then(|| Arc::new(mesh)),
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
            file: ReadFile {
                record,
                description: molecule.report.to_string(),
                warnings: Vec::new(),
            },
            kind: "molecule",
            solid,
            mesh: None,
            sampling: None,
        })
    }

    pub fn path(&self) -> &Path {
        &self.file.record.path
    }

    /// What was read, for JSON.
    pub fn object(&self) -> Value {
        json!({
            "file": self.path().display().to_string(),
            "kind": self.kind,
            "balls": self.solid.inner().len(),
            "epsilon": self.solid.epsilon(),
            "grid_per_axis": self.sampling.map(|sampling| sampling.per_axis),
            "triangles_decide": self.solid.exact().is_some(),
            "volume_missed_by_balls": self.sampling.and_then(|sampling| sampling.missed),
            "warnings": self.file.warnings,
        })
    }
}

/// Reads solids in one unit of length; a text that is repeated is read once.
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
        input.file.describe(side, console);
    }
}

pub fn is_shape(path: &Path) -> bool {
    is_mesh(path) || ball_file::is_ball_file(path)
}

const ENDINGS: [&str; 4] = ["stl", "obj", "ply", "off"];

pub fn is_mesh(path: &Path) -> bool {
    path.extension().is_some_and(|ending| {
        let ending = ending.to_string_lossy().to_ascii_lowercase();
        ENDINGS.contains(&ending.as_str())
    })
}

pub struct MeshInput {
    pub file: ReadFile,
    pub mesh: Mesh,
    /// What the file held.
    pub report: MeshReport,
    /// What it bounds.
    pub solid: Solid,
}

impl MeshInput {
    /// Reads a mesh; chains cannot be picked of one.
    pub fn read(spec: &InputSpec) -> Result<Self, Error> {
        if spec.chains.is_some() {
            return Err(Error::input("a mesh has no chains to pick")
                .at(&spec.path)
                .help("leave out the colon and the rest"));
        }
        let bytes = mesh::file_bytes(&spec.path)?;
        let (mesh, report) = mesh::read_bytes(&spec.path, &bytes)?;
        let solid = Solid::new(&mesh).map_err(|error| error.at(&spec.path))?;
        Ok(Self {
            file: ReadFile {
                record: InputRecord::new(spec, &bytes),
                description: report.to_string(),
                warnings: report.warnings(),
            },
            mesh,
            report,
            solid,
        })
    }
}

/// Reads the balls of a file; of a file with links, those of the link named in place of a chain.
fn read_balls(spec: &InputSpec) -> Result<(ReadFile, BallFile), Error> {
    let bytes = read_bounded(&spec.path, MAX_TABLE).map_err(|error| {
        Error::input(format!("cannot read the balls: {error}"))
            .at(&spec.path)
            .help("check the name, the permissions and the size of the file")
    })?;
    let link = spec.chains.as_ref().and_then(|chains| chains.first());
    let file = ball_file::parse(&spec.path, &bytes, link.map(String::as_str))?;
    let balls = counted(file.balls.len(), "ball");
    let off = (file.switched_off > 0).then(|| {
        format!(
            "left out {} spheres whose radius is not above zero, by which they are switched off",
            file.switched_off
        )
    });
    let read = ReadFile {
        record: InputRecord::new(spec, &bytes),
        description: match &file.group {
            Some(link) => format!("{balls} of {link}"),
            None => balls,
        },
        warnings: off.into_iter().collect(),
    };
    Ok((read, file))
}

/// The file of balls that a text names, with the link picked of it; `None` where it names something else.
pub fn ball_file_of(text: &str) -> Option<InputSpec> {
    if ball_file::is_ball_file(Path::new(text)) {
        return Some(InputSpec::whole(text));
    }
    let (path, link) = text.rsplit_once(':')?;
    let is_of_balls = ball_file::is_ball_file(Path::new(path)) && !link.is_empty();
    is_of_balls.then(|| InputSpec {
        chains: Some(vec![link.to_owned()]),
        ..InputSpec::whole(path)
    })
}

/// A part of `knotdock dock` that is no molecule.
pub struct ShapeInput {
    pub file: ReadFile,
    /// For run.json.
    report: Value,
    content: Content,
}

enum Content {
    Mesh(Box<(Mesh, Solid)>),
    Balls {
        part: BallPart,
        /// Vertices and triangles of their spheres, for views.
        spheres: (Vec<[f64; 3]>, Vec<[u32; 3]>),
    },
}

impl ShapeInput {
    /// Reads a mesh, or the balls of a file; of a file with links, those of the link after the colon.
    pub fn read(spec: &InputSpec) -> Result<Self, Error> {
        if is_mesh(&spec.path) {
            let input = MeshInput::read(spec)?;
            return Ok(Self {
                file: input.file,
                report: serde_json::to_value(&input.report).map_err(Error::machine)?,
                content: Content::Mesh(Box::new((input.mesh, input.solid))),
            });
        }
        let (mut file, BallFile { balls, weights, .. }) = read_balls(spec)?;
        // `knotdock sample` writes weights of one if none were fitted.
        let weights = weights.filter(|weights| weights.iter().any(|&weight| weight != 1.0));
        file.description += match weights {
            Some(_) => ", weighted",
            None => ", without weights",
        };
        Ok(Self {
            file,
            report: json!({ "balls": balls.len(), "weighted": weights.is_some() }),
            content: Content::Balls {
                spheres: spheres(&balls),
                part: BallPart { balls, weights },
            },
        })
    }

    /// Content that is docked.
    pub fn shape(&self) -> Shape<'_> {
        match &self.content {
            Content::Mesh(mesh) => Shape::Solid(&mesh.1),
            Content::Balls { part, .. } => Shape::Balls(part),
        }
    }

    /// Surface that is shown in assemblies.
    pub fn surface(&self) -> Surface<'_> {
        match &self.content {
            Content::Mesh(mesh) => Surface::from(&mesh.0),
            Content::Balls { spheres, .. } => Surface {
                positions: &spheres.0,
                triangles: &spheres.1,
            },
        }
    }

    /// The part for run.json, with how it was sampled.
    pub fn entry(&self, sampling: Option<&SampledPart>) -> InputEntry {
        InputEntry {
            record: self.file.record.clone(),
            atoms: None,
            sampling: sampling.cloned(),
            report: self.report.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_balls_are_known_by_their_names() {
        let found =
            |text| ball_file_of(text).map(|spec| (spec.path.display().to_string(), spec.chains));
        assert_eq!(found("a/knots.csv"), Some(("a/knots.csv".into(), None)));
        let hand = ("robot.yml".to_owned(), Some(vec!["hand".to_owned()]));
        assert_eq!(found("robot.yml:hand"), Some(hand));
        assert_eq!(found("robot.yml:"), None);
        assert_eq!(found("molecule.pdb:A"), None);
        assert_eq!(found("part.stl"), None);
    }
}
