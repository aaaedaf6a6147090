//! A part of `knotdock dock` that is no molecule: a mesh, or a file of balls.

use std::path::Path;

use crate::solid_files::balls::spheres;
use knotdock::mesh::SampledPart;
use knotdock::mesh::shape::{BallPart, Shape};
use knotdock::output::files::assemblies::Surface;
use knotdock::output::records::input_record::InputRecord;
use knotdock::output::records::manifest::InputEntry;
use knotdock_structures::ball_file::is_ball_file;
use knotdock_structures::molecule::InputSpec;
use serde_json::json;

use crate::inputs::ball_files::BallFileInput;
use crate::inputs::meshes::{MeshInput, is_mesh};
use crate::messages::console::Console;
use knotdock_structures::Error;

/// Whether a file is a mesh or one of balls, by its name.
pub fn is_shape(path: &Path) -> bool {
    is_mesh(path) || is_ball_file(path)
}

/// A part as read.
pub enum ShapeInput {
    /// A mesh.
    Mesh(Box<MeshInput>),
    /// Balls.
    Balls(Box<BallInput>),
}

/// Balls as read.
pub struct BallInput {
    record: InputRecord,
    report: String,
    warnings: Vec<String>,
    part: BallPart,
    /// Their spheres, to be looked at.
    spheres: (Vec<[f64; 3]>, Vec<[u32; 3]>),
}

impl ShapeInput {
    /// Reads a mesh, or the balls of a file; of one with links those of the link behind the colon.
    pub fn read(spec: &InputSpec) -> Result<Self, Error> {
        if is_mesh(&spec.path) {
            return Ok(Self::Mesh(Box::new(MeshInput::read(spec)?)));
        }
        let input = BallFileInput::read(spec)?;
        let (report, warnings) = (input.report(), input.warnings());
        let BallFileInput { record, file } = input;
        Ok(Self::Balls(Box::new(BallInput {
            record,
            report,
            warnings,
            spheres: spheres(&file.balls),
            part: BallPart {
                balls: file.balls,
                // Weights of one are what `knotdock sample` writes where none were fitted.
                weights: file
                    .weights
                    .filter(|weights| weights.iter().any(|&weight| weight != 1.0)),
            },
        })))
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
            Self::Mesh(input) => Surface::from(&input.mesh),
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
                console.say(format!("{side}: {}, {weighted}", input.report));
                for warning in &input.warnings {
                    console.warn(format!("{}: {warning}", input.record.path.display()));
                }
            }
        }
    }

    /// The part for run.json, with how it was sampled.
    pub fn entry(&self, sampling: Option<&SampledPart>) -> Result<InputEntry, Error> {
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
