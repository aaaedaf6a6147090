//! A part of `knotdock dock` that is no molecule: a mesh, or a file of balls.

use std::path::Path;

use knotdock::bounded_read::{MAX_TABLE, read_bounded};
use knotdock::mesh::SampledPart;
use knotdock::mesh::shape::{BallPart, Shape};
use knotdock::output::files::assemblies::Surface;
use knotdock::output::files::balls::spheres;
use knotdock::output::records::input_record::InputRecord;
use knotdock::output::records::manifest::InputEntry;
use knotdock_structures::ball_file::{self, is_ball_file};
use knotdock_structures::molecule::InputSpec;
use serde_json::json;

use crate::cli::inputs::meshes::{MeshInput, is_mesh};
use crate::cli::messages::console::Console;
use crate::cli::messages::failure::Failure;

/// Whether a file is a mesh or one of balls, by its name.
pub fn is_shape(path: &Path) -> bool {
    is_mesh(path) || is_ball_file(path)
}

/// A part as read.
pub enum ShapeInput {
    /// A mesh.
    Mesh(MeshInput),
    /// Balls.
    Balls(BallInput),
}

/// Balls as read.
pub struct BallInput {
    record: InputRecord,
    part: BallPart,
    /// Their spheres, to be looked at.
    spheres: (Vec<[f64; 3]>, Vec<[u32; 3]>),
}

impl ShapeInput {
    /// Reads a mesh, or the balls of a file; of one with links those of the link behind the colon.
    pub fn read(spec: &InputSpec) -> Result<Self, Failure> {
        if is_mesh(&spec.path) {
            return MeshInput::read(spec).map(Self::Mesh);
        }
        let bytes = read_bounded(&spec.path, MAX_TABLE).map_err(|error| {
            Failure::input(format!("cannot read the balls: {error}"))
                .at(&spec.path)
                .remedy("check the name, the permissions and the size of the file")
        })?;
        let group = spec.chains.as_ref().and_then(|chains| chains.first());
        let file = ball_file::parse(&spec.path, &bytes, group.map(String::as_str))?;
        Ok(Self::Balls(BallInput {
            record: InputRecord::new(spec, &bytes),
            spheres: spheres(&file.balls),
            part: BallPart {
                balls: file.balls,
                // Weights of one are what `knotdock sample` writes where none were fitted.
                weights: file
                    .weights
                    .filter(|weights| weights.iter().any(|&weight| weight != 1.0)),
            },
        }))
    }

    /// The file.
    pub fn record(&self) -> &InputRecord {
        match self {
            Self::Mesh(input) => &input.record,
            Self::Balls(input) => &input.record,
        }
    }

    /// What is docked.
    pub fn shape(&self) -> Shape<'_> {
        match self {
            Self::Mesh(input) => Shape::Solid(&input.solid),
            Self::Balls(input) => Shape::Balls(&input.part),
        }
    }

    /// What is shown of it in assemblies.
    pub fn surface(&self) -> Surface<'_> {
        match self {
            Self::Mesh(input) => (&input.mesh).into(),
            Self::Balls(input) => Surface {
                positions: &input.spheres.0,
                triangles: &input.spheres.1,
            },
        }
    }

    /// Reports what was read, with warnings.
    pub fn describe(&self, side: &str, console: Console) {
        match self {
            Self::Mesh(input) => {
                console.say(format!("{side}: {}", input.report));
                for warning in input.report.warnings() {
                    console.warn(format!("{}: {warning}", input.record.path.display()));
                }
            }
            Self::Balls(input) => {
                let weighted = match input.part.weights {
                    Some(_) => "weighted",
                    None => "without weights",
                };
                let count = input.part.balls.len();
                console.say(format!("{side}: {count} balls, {weighted}"));
            }
        }
    }

    /// The part for run.json, with how it was sampled.
    pub fn entry(&self, sampling: Option<&SampledPart>) -> Result<InputEntry, Failure> {
        match self {
            Self::Mesh(input) => input.entry(sampling),
            Self::Balls(input) => Ok(InputEntry {
                record: input.record.clone(),
                atoms: None,
                sampling: sampling.cloned(),
                report: json!({
                    "balls": input.part.balls.len(),
                    "weighted": input.part.weights.is_some(),
                }),
            }),
        }
    }
}
