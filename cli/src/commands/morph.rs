//! `knotdock morph`: morphological operations on solids.

use crate::arguments::options::{OfMachine, TypedOptions};
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use knotdock::geometry::Bracket;
use knotdock::geometry::morphology::difference::difference;
use knotdock::geometry::morphology::products::{product, quotient};
use knotdock::geometry::morphology::sweep::{SweepOptions, sample_count, sweep};
use knotdock::geometry::morphology::{
    MorphologyError, MorphologyOptions, closed, dilated, offset, opened,
};
use knotdock::options::SampleGrid;
use knotdock::options::values::{ABOVE_ZERO, DISTANCE, LENGTH, in_range};
use knotdock::threads;
use knotdock_structures::mesh::Figure;
use serde_json::json;

use crate::arguments::memory;
use crate::arguments::solid_output::{SolidOutput, Volumes};
use crate::inputs::poses::pose_file;
use crate::inputs::solids::{SolidArguments, SolidInput};
use crate::messages::console::Console;
use knotdock_structures::Error;

/// Grow, shrink, open, close, add, subtract and sweep solids: the result lies between two sets of balls.
///
/// A solid is a mesh, a molecule or a file of balls. Inner balls lie in the true result, outer balls hold it, and both
/// volumes are reported. Shrinking, opening, closing, differences and quotients sample the complement by balls; a finer
/// --complement-grid brings the two sets closer.
#[derive(Args, Debug)]
pub struct Morph {
    #[command(subcommand)]
    operation: Operation,
}

#[derive(Debug, Subcommand)]
enum Operation {
    /// Grow a solid by a distance, or shrink it by one below zero.
    Offset {
        /// The solid.
        #[arg(value_name = "SOLID")]
        first: String,
        /// Distance, in the unit of the file.
        #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = in_range::<f64>(LENGTH))]
        distance: f64,
        #[command(flatten)]
        common: Common,
    },
    /// Open A by B: what copies of B inside A cover.
    Open(Pair),
    /// Close A by B: what no copy of B mirrored outside A reaches.
    Close(Pair),
    /// Minkowski sum: all a + b.
    Sum(Pair),
    /// Minkowski difference: the translations that keep B inside A.
    Difference(Pair),
    /// All that a solid passes on a path of poses, geodesics between them.
    Sweep {
        /// The solid.
        #[arg(value_name = "SOLID")]
        first: String,
        /// Poses in order: a CSV file with columns qw, qx, qy, qz, tx, ty, tz, or - for standard input.
        #[arg(long, value_name = "FILE")]
        path: PathBuf,
        /// Most that a point of the solid moves between two samples; outer balls grow by half of it [default: 2% of the
        /// solid's longest edge].
        #[arg(long, value_name = "LENGTH", value_parser = in_range::<f64>(ABOVE_ZERO))]
        step: Option<f64>,
        /// How far each pose may vary, as a radius of geodesic balls: sqrt(2 angle^2 + shift^2), in radians and the
        /// file's unit.
        #[arg(long, value_name = "RADIUS", default_value_t = 0.0, value_parser = in_range::<f64>(DISTANCE))]
        tolerance: f64,
        #[command(flatten)]
        common: Common,
    },
    /// All points of a solid in any of the poses.
    Product(Poses),
    /// The points that lie in a solid in each of the poses.
    Quotient(Poses),
}

#[derive(Args, Debug)]
struct Pair {
    /// The solid; robot.yml:hand picks a link, FILE:H,L chains.
    #[arg(value_name = "A")]
    first: String,
    /// The other solid, in the same unit of length.
    #[arg(value_name = "B")]
    second: String,
    #[command(flatten)]
    common: Common,
}

#[derive(Args, Debug)]
struct Poses {
    /// The solid.
    #[arg(value_name = "SOLID")]
    first: String,
    /// Poses: a CSV file with columns qw, qx, qy, qz, tx, ty, tz, or - for standard input.
    #[arg(long, value_name = "FILE")]
    poses: PathBuf,
    #[command(flatten)]
    common: Common,
}

#[derive(Args, Debug)]
struct Common {
    #[command(flatten)]
    output: SolidOutput,
    #[command(flatten)]
    solids: SolidArguments,
    /// Nodes of the grid on which complements are sampled by balls, as 2^15 or 32768.
    #[arg(
        long,
        value_name = "COUNT",
        default_value = "2^15",
        help_heading = "Solids"
    )]
    complement_grid: SampleGrid,
    #[command(flatten)]
    machine: TypedOptions<OfMachine>,
}

/// Step of a sweep as a share of the solid's longest edge.
const STEP: f64 = 0.02;

impl Operation {
    fn common(&self) -> &Common {
        match self {
            Self::Offset { common, .. } | Self::Sweep { common, .. } => common,
            Self::Open(pair) | Self::Close(pair) | Self::Sum(pair) | Self::Difference(pair) => {
                &pair.common
            }
            Self::Product(poses) | Self::Quotient(poses) => &poses.common,
        }
    }

    fn name(&self) -> &'static str {
        match self {
            Self::Offset { .. } => "Offset",
            Self::Open(_) => "Opening",
            Self::Close(_) => "Closing",
            Self::Sum(_) => "Sum",
            Self::Difference(_) => "Difference",
            Self::Sweep { .. } => "Sweep",
            Self::Product(_) => "Product",
            Self::Quotient(_) => "Quotient",
        }
    }

    /// The solids named.
    fn solids(&self) -> Vec<&str> {
        match self {
            Self::Offset { first, .. } | Self::Sweep { first, .. } => vec![first],
            Self::Open(pair) | Self::Close(pair) | Self::Sum(pair) | Self::Difference(pair) => {
                vec![&pair.first, &pair.second]
            }
            Self::Product(poses) | Self::Quotient(poses) => vec![&poses.first],
        }
    }

    /// The file of poses.
    fn pose_file(&self) -> Option<&Path> {
        match self {
            Self::Sweep { path, .. } => Some(path),
            Self::Product(poses) | Self::Quotient(poses) => Some(&poses.poses),
            _ => None,
        }
    }
}

impl Morph {
    /// Computes.
    pub fn run(self, console: Console) -> Result<(), Error> {
        let threads = self
            .operation
            .common()
            .machine
            .options
            .machine
            .thread_count();
        threads::on(threads, || self.compute(console))?
    }

    fn compute(&self, console: Console) -> Result<(), Error> {
        let operation = &self.operation;
        let common = operation.common();
        let allowed = common
            .machine
            .options
            .machine
            .memory
            .or_else(memory::default_limit);
        let poses = operation.pose_file().map(pose_file).transpose()?;
        let inputs: Vec<SolidInput> = (operation.solids().into_iter())
            .map(|text| SolidInput::read(text, &common.solids, allowed))
            .collect::<Result<_, _>>()?;
        let mut read: Vec<&Path> = inputs.iter().map(SolidInput::path).collect();
        read.extend(operation.pose_file());
        common.output.check(&read, allowed, console)?;
        for (side, solid) in ["A", "B"].iter().zip(&inputs) {
            solid.describe(side, console);
        }
        let solids: Vec<Bracket> = inputs.iter().map(|input| (&input.solid).into()).collect();
        let options = MorphologyOptions {
            per_axis: common.complement_grid.per_axis,
            memory: allowed,
        };
        let found = result(operation, &solids, poses.as_deref(), &options, console)
            .map_err(|error| refused(&error))?;
        let volumes = Volumes::of(&found);
        volumes.describe(operation.name(), &found, console);
        let files = common
            .output
            .write((operation.name(), &volumes), &found, None)?;
        if !files.is_empty() {
            console.say(format!("Wrote {}", files.join(", ")));
        }
        let mut object = volumes.object(&found);
        object["operation"] = json!(operation.name().to_ascii_lowercase());
        object["a"] = json!(inputs.first().map(SolidInput::object));
        object["b"] = json!(inputs.get(1).map(SolidInput::object));
        object["poses"] = json!(poses.as_ref().map(Vec::len));
        object["files"] = json!(files);
        console.result(&object)
    }
}

/// The result of an operation on the solids that it names.
fn result(
    operation: &Operation,
    solids: &[Bracket],
    poses: Option<&[knotdock_scoring::se3::Pose]>,
    options: &MorphologyOptions,
    console: Console,
) -> Result<Bracket, MorphologyError> {
    let poses = poses.unwrap_or_default();
    match (operation, solids) {
        (Operation::Offset { distance, .. }, [a, ..]) => offset(a, *distance, options),
        (Operation::Open(_), [a, b, ..]) => opened(a, b, options),
        (Operation::Close(_), [a, b, ..]) => closed(a, b, options),
        (Operation::Sum(_), [a, b, ..]) => dilated(a, b, options),
        (Operation::Difference(_), [a, b, ..]) => difference(a, b, options),
        (Operation::Product(_), [a, ..]) => product(a, poses, options),
        (Operation::Quotient(_), [a, ..]) => quotient(a, poses, options),
        (
            Operation::Sweep {
                step, tolerance, ..
            },
            [a, ..],
        ) => {
            let (low, high) = a.bounds();
            let edges = (0..3).map(|axis| high[axis] - low[axis]);
            let sweeping = SweepOptions {
                step: step.unwrap_or(STEP * edges.fold(0.0, f64::max)),
                tolerance: *tolerance,
            };
            console.say(format!(
                "Path: {} poses, sampled at {}, no point moves more than {} between two",
                poses.len(),
                sample_count(a, poses, &sweeping),
                Figure(sweeping.step)
            ));
            sweep(a, poses, &sweeping, options)
        }
        // Each operation has read as many solids as it names.
        (_, _) => Ok(Bracket::exact(Vec::new())),
    }
}

fn refused(error: &MorphologyError) -> Error {
    let MorphologyError::Memory { needed, .. } = error;
    let least = knotdock::memory_size::as_size(knotdock::memory_size::named(*needed));
    Error::input(error).help(format!(
        "use a coarser --grid or --complement-grid, or fewer poses, or allow at least --memory {least}"
    ))
}
