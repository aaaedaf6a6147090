//! Parts that are no molecules, meshes and files of balls: read, recorded, described.

use std::path::Path;

use knotdock::bounded_read::{MAX_TABLE, read_bounded};
use knotdock::mesh::{BallPart, SampledPart, Shape};
use knotdock::output::files::assemblies::Surface;
use knotdock::output::records::input_record::InputRecord;
use knotdock::output::records::manifest::InputEntry;
use knotdock_structures::Error;
use knotdock_structures::ball_file::{self, BallFile};
use knotdock_structures::mesh::{self, Mesh, MeshReport, Solid};
use knotdock_structures::molecule::InputSpec;
use serde_json::{Value, json};

use crate::messages::console::Console;
use crate::solid_files::balls::spheres;

/// Whether a file is a mesh or one of balls, by its name.
pub fn is_shape(path: &Path) -> bool {
    is_mesh(path) || ball_file::is_ball_file(path)
}

/// Endings of mesh files.
const ENDINGS: [&str; 4] = ["stl", "obj", "ply", "off"];

/// Whether a file is a mesh, by its name.
pub fn is_mesh(path: &Path) -> bool {
    path.extension().is_some_and(|ending| {
        let ending = ending.to_string_lossy().to_ascii_lowercase();
        ENDINGS.contains(&ending.as_str())
    })
}

/// A mesh as read.
pub struct MeshInput {
    /// File and checksum.
    pub record: InputRecord,
    /// The surface.
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
                .help("leave out the colon and what follows it"));
        }
        let bytes = mesh::file_bytes(&spec.path)?;
        let (mesh, report) = mesh::read_bytes(&spec.path, &bytes)?;
        let solid = Solid::new(&mesh).map_err(|error| error.at(&spec.path))?;
        Ok(Self {
            record: InputRecord::new(spec, &bytes),
            mesh,
            report,
            solid,
        })
    }
}

/// A file of balls as read.
pub struct BallFileInput {
    /// File, link and checksum.
    pub record: InputRecord,
    /// Its balls.
    pub file: BallFile,
}

impl BallFileInput {
    /// Reads the balls of a file; of a file with links, those of the link named in place of a chain.
    pub fn read(spec: &InputSpec) -> Result<Self, Error> {
        let bytes = read_bounded(&spec.path, MAX_TABLE).map_err(|error| {
            Error::input(format!("cannot read the balls: {error}"))
                .at(&spec.path)
                .help("check the name, the permissions and the size of the file")
        })?;
        let link = spec.chains.as_ref().and_then(|chains| chains.first());
        Ok(Self {
            record: InputRecord::new(spec, &bytes),
            file: ball_file::parse(&spec.path, &bytes, link.map(String::as_str))?,
        })
    }

    /// The number of balls and their link, as text.
    pub fn report(&self) -> String {
        let count = self.file.balls.len();
        let balls = if count == 1 { "ball" } else { "balls" };
        match &self.file.group {
            Some(link) => format!("{count} {balls} of {link}"),
            None => format!("{count} {balls}"),
        }
    }

    /// Warnings about the file.
    pub fn warnings(&self) -> Vec<String> {
        let count = self.file.switched_off;
        let off = (count > 0).then(|| {
            format!(
                "left out {count} spheres whose radius is not above zero, by which they are switched off"
            )
        });
        off.into_iter().collect()
    }
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
    /// File, link and checksum.
    pub record: InputRecord,
    description: String,
    warnings: Vec<String>,
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
                record: input.record,
                description: input.report.to_string(),
                warnings: input.report.warnings(),
                report: serde_json::to_value(&input.report).map_err(Error::machine)?,
                content: Content::Mesh(Box::new((input.mesh, input.solid))),
            });
        }
        let input = BallFileInput::read(spec)?;
        let (description, warnings) = (input.report(), input.warnings());
        let BallFile { balls, weights, .. } = input.file;
        // `knotdock sample` writes weights of one if none were fitted.
        let weights = weights.filter(|weights| weights.iter().any(|&weight| weight != 1.0));
        let weighted = match weights {
            Some(_) => "weighted",
            None => "without weights",
        };
        Ok(Self {
            record: input.record,
            description: format!("{description}, {weighted}"),
            warnings,
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

    /// Prints what was read, and warns.
    pub fn describe(&self, side: &str, console: Console) {
        console.say(format!("{side}: {}", self.description));
        for warning in &self.warnings {
            console.warn(format!("{}: {warning}", self.record.path.display()));
        }
    }

    /// The part for run.json, with how it was sampled.
    pub fn entry(&self, sampling: Option<&SampledPart>) -> InputEntry {
        InputEntry {
            record: self.record.clone(),
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
