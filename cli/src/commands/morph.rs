//! `knotdock morph`: morphological operations on solids.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use serde_json::json;

use crate::arguments::machine::settled;
use crate::arguments::options::{OfMachine, OptionArguments};
use crate::arguments::solid_output::{SolidOutput, SolidResult};
use crate::inputs::poses::pose_file;
use crate::inputs::solids::{SolidArguments, SolidInput, describe_solids, read_solids};
use crate::messages::console::Console;
use knotdock::geometry::Bracket;
use knotdock::geometry::bracket::volume;
use knotdock::geometry::morphology::difference::difference;
use knotdock::geometry::morphology::exact_volume::{
    Copies, VolumeBounds, closed_volume, opened_volume,
};
use knotdock::geometry::morphology::products::{product, quotient};
use knotdock::geometry::morphology::sweep::{SweepOptions, sample_count, sweep};
use knotdock::geometry::morphology::{MorphologyOptions, closed, dilated, offset, opened};
use knotdock::options::SampleGrid;
use knotdock::options::values::{ABOVE_ZERO, DISTANCE, LENGTH, in_range};
use knotdock::threads;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;
use knotdock_structures::mesh::Figure;

/// Grow, shrink, open, close, add, subtract and sweep solids: the result is between two sets of balls.
///
/// A solid is a mesh, a molecule or a file of balls. Inner balls are in the true result, outer balls hold it, and both
/// volumes are reported. Shrinking, opening, closing, differences and quotients sample the complement by balls; a finer
/// --complement-grid brings the two sets closer. The volume of the true result has bounds of its own: of a closed mesh
/// its exact depth gives closer ones than the balls. A result that is proven empty is an answer: the exit code is 0.
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
    /// The points that are in a solid in each of the poses.
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
    /// Nodes of the grid on which complements are sampled by balls, as 2^15 or 32768; the more, the smaller are
    /// the cells by which the depth of meshes bounds volumes.
    #[arg(
        long,
        value_name = "COUNT",
        default_value = "2^15",
        help_heading = "Solids"
    )]
    complement_grid: SampleGrid,
    #[command(flatten)]
    machine: OptionArguments<OfMachine>,
}

/// Step of a sweep as a share of the solid's longest edge.
const STEP: f64 = 0.02;

/// The parts of an operation that all share.
struct Request<'a> {
    name: &'static str,
    solids: Vec<&'a str>,
    poses: Option<&'a Path>,
    common: &'a Common,
}

impl Operation {
    fn request(&self) -> Request<'_> {
        let (name, solids, poses, common) = match self {
            Self::Offset { first, common, .. } => ("Offset", vec![first], None, common),
            Self::Open(pair) => ("Opening", pair.solids(), None, &pair.common),
            Self::Close(pair) => ("Closing", pair.solids(), None, &pair.common),
            Self::Sum(pair) => ("Sum", pair.solids(), None, &pair.common),
            Self::Difference(pair) => ("Difference", pair.solids(), None, &pair.common),
            Self::Sweep {
                first,
                path,
                common,
                ..
            } => ("Sweep", vec![first], Some(path), common),
            Self::Product(a) => ("Product", vec![&a.first], Some(&a.poses), &a.common),
            Self::Quotient(a) => ("Quotient", vec![&a.first], Some(&a.poses), &a.common),
        };
        Request {
            name,
            solids: solids.into_iter().map(String::as_str).collect(),
            poses: poses.map(PathBuf::as_path),
            common,
        }
    }

    /// What an empty result means.
    fn emptiness(&self) -> String {
        match self {
            Self::Offset { distance, .. } => {
                format!("the solid is thinner than {}", Figure(-2.0 * distance))
            }
            Self::Open(_) => "no copy of B fits into A".to_owned(),
            Self::Difference(_) => "no translation keeps B inside A".to_owned(),
            Self::Quotient(_) => "no point is in the solid in every pose".to_owned(),
            Self::Close(_) | Self::Sum(_) | Self::Sweep { .. } | Self::Product(_) => {
                "it has no points".to_owned()
            }
        }
    }
}

impl Pair {
    fn solids(&self) -> Vec<&String> {
        vec![&self.first, &self.second]
    }
}

impl Morph {
    pub fn run(self, console: Console) -> Result<(), Error> {
        let machine = settled(
            &self
                .operation
                .request()
                .common
                .machine
                .given()?
                .options
                .machine,
        );
        let allowed = machine.memory;
        threads::on(machine.thread_count(), || self.compute(allowed, console))?
    }

    /// Computes with `allowed` bytes of memory.
    fn compute(&self, allowed: Option<u64>, console: Console) -> Result<(), Error> {
        let request = self.operation.request();
        let common = request.common;
        let poses = request.poses.map(pose_file).transpose()?;
        let inputs = read_solids(&request.solids, &common.solids, allowed)?;
        let mut read: Vec<&Path> = inputs.iter().map(SolidInput::path).collect();
        read.extend(request.poses);
        common.output.check(&read, allowed, console)?;
        describe_solids(&inputs, console);
        let solids: Vec<Bracket> = inputs.iter().map(|input| (&input.solid).into()).collect();
        let options = MorphologyOptions {
            per_axis: common.complement_grid.per_axis,
            memory: allowed,
        };
        let solid = self.result(
            &solids,
            poses.as_deref().unwrap_or_default(),
            &options,
            console,
        )?;
        let known = self.known_volume(
            &inputs,
            poses.as_deref().unwrap_or_default(),
            &solid,
            common,
        );
        let result = SolidResult::new(request.name, solid, known, self.operation.emptiness());
        result.describe(console);
        let files = common.output.write(&result, None)?;
        if !files.is_empty() {
            console.say(format!("Wrote {}", files.join(", ")));
        }
        let mut object = result.object();
        object["operation"] = json!(request.name.to_ascii_lowercase());
        object["a"] = json!(inputs.first().map(SolidInput::object));
        object["b"] = json!(inputs.get(1).map(SolidInput::object));
        object["poses"] = json!(poses.as_ref().map(Vec::len));
        object["files"] = json!(files);
        console.result(&object)
    }

    /// Bounds of the volume of a result, from the exact depth of meshes, or from A if that is none.
    fn known_volume(
        &self,
        inputs: &[SolidInput],
        poses: &[Pose],
        result: &Bracket,
        common: &Common,
    ) -> VolumeBounds {
        let per_axis = common.complement_grid.per_axis;
        let (Some(a), Some(b)) = (inputs.first(), inputs.last()) else {
            return [0.0, f64::INFINITY];
        };
        match (&self.operation, &a.mesh, &b.mesh) {
            (Operation::Offset { distance, .. }, Some(mesh), _) => {
                Copies::offset(mesh, *distance).volume(result, per_axis)
            }
            (Operation::Open(_), Some(mesh), _) => opened_volume(mesh, &b.solid, per_axis),
            (Operation::Close(_), Some(mesh), _) => closed_volume(mesh, &b.solid, per_axis),
            // The larger mesh is taken exactly, since the balls of the smaller one come closer to it.
            (Operation::Sum(_), Some(mesh), other)
                if other.is_none() || a.solid.epsilon() >= b.solid.epsilon() =>
            {
                Copies::sum(mesh, &b.solid, other.as_deref()).volume(result, per_axis)
            }
            (Operation::Sum(_), _, Some(mesh)) => {
                Copies::sum(mesh, &a.solid, a.mesh.as_deref()).volume(result, per_axis)
            }
            (Operation::Difference(_), Some(mesh), _) => {
                Copies::difference(mesh, &b.solid).volume(result, per_axis)
            }
            (Operation::Product(_), Some(mesh), _) => {
                Copies::product(mesh, poses).volume(result, per_axis)
            }
            (Operation::Quotient(_), Some(mesh), _) => {
                Copies::quotient(mesh, poses).volume(result, per_axis)
            }
            // These are no larger than A.
            (Operation::Open(_) | Operation::Difference(_) | Operation::Quotient(_), None, _) => {
                [0.0, volume(&a.solid.outer()).0]
            }
            _ => [0.0, f64::INFINITY],
        }
    }

    fn result(
        &self,
        solids: &[Bracket],
        poses: &[Pose],
        options: &MorphologyOptions,
        console: Console,
    ) -> Result<Bracket, Error> {
        let (a, b) = match solids {
            [a] => (a, a),
            [a, b, ..] => (a, b),
            [] => return Err(Error::lasting("the operation has no solids")),
        };
        match &self.operation {
            Operation::Offset { distance, .. } => offset(a, *distance, options),
            Operation::Open(_) => opened(a, b, options),
            Operation::Close(_) => closed(a, b, options),
            Operation::Sum(_) => dilated(a, b, options),
            Operation::Difference(_) => difference(a, b, options),
            Operation::Product(_) => product(a, poses, options),
            Operation::Quotient(_) => quotient(a, poses, options),
            Operation::Sweep {
                step, tolerance, ..
            } => {
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
        }
    }
}
