//! `knotdock se3`: distance and geodesics of poses, and sets of tolerated ones.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use serde_json::json;

use crate::arguments::output_file::check_outputs;
use crate::inputs::poses::{pose, write_list};
use crate::messages::console::Console;
use knotdock::geometry::motion::{angle, distance, geodesic_ball, path};
use knotdock::options::values::{AT_LEAST_ONE, DISTANCE, in_range};
use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;

/// Measure and sample rigid motions: distance, geodesics, geodesic balls as sets of tolerance.
///
/// A pose is seven numbers, qw,qx,qy,qz,tx,ty,tz: a unit quaternion and a translation. The distance of two is
/// sqrt(2 angle^2 + shift^2), the angle in radians and the shift in the file's unit (Behandish and Ilies, eq. 59).
#[derive(Args, Debug)]
pub struct Se3 {
    #[command(subcommand)]
    operation: Operation,
}

#[derive(Debug, Subcommand)]
enum Operation {
    /// The distance of two poses.
    Distance {
        /// The first pose.
        #[arg(value_name = "P", allow_hyphen_values = true)]
        first: String,
        /// The second pose.
        #[arg(value_name = "Q", allow_hyphen_values = true)]
        second: String,
    },
    /// Poses evenly spaced on the geodesic from one pose to another.
    Interpolate {
        /// The first pose.
        #[arg(value_name = "P", allow_hyphen_values = true)]
        first: String,
        /// The last pose.
        #[arg(value_name = "Q", allow_hyphen_values = true)]
        second: String,
        /// Steps: one pose more is written.
        #[arg(long, value_name = "COUNT", default_value_t = 10, value_parser = in_range::<usize>(AT_LEAST_ONE))]
        steps: usize,
        #[command(flatten)]
        output: PoseOutput,
    },
    /// Poses within a distance of one, evenly spread, that pose first: a set of tolerance for `morph product`.
    Ball {
        /// The pose in the middle.
        #[arg(value_name = "P", allow_hyphen_values = true)]
        center: String,
        /// Distance up to which poses are taken.
        #[arg(long, value_name = "RADIUS", value_parser = in_range::<f64>(DISTANCE))]
        radius: f64,
        /// Number of poses.
        #[arg(long, value_name = "COUNT", default_value_t = 100, value_parser = in_range::<usize>(AT_LEAST_ONE))]
        count: usize,
        #[command(flatten)]
        output: PoseOutput,
    },
}

#[derive(Args, Debug)]
struct PoseOutput {
    /// The table of poses to write, with columns qw, qx, qy, qz, tx, ty and tz.
    #[arg(short, long, value_name = "FILE.csv")]
    output: PathBuf,
    /// Replace a file that is there.
    #[arg(long)]
    force: bool,
}

const MAX_POSES: usize = 10_000_000;

impl PoseOutput {
    fn write(&self, poses: &[Pose], console: Console) -> Result<(), Error> {
        write_list(&self.output, poses)?.place()?;
        console.say(format!(
            "Wrote {} poses to {}",
            poses.len(),
            self.output.display()
        ));
        Ok(())
    }

    fn check(&self, count: usize, console: Console) -> Result<(), Error> {
        if count > MAX_POSES {
            return Err(
                Error::input(format!("{count} poses are more than {MAX_POSES}"))
                    .help(format!("take at most {MAX_POSES}")),
            );
        }
        check_outputs([&self.output], &[], self.force, console)
    }
}

impl Se3 {
    pub fn run(self, console: Console) -> Result<(), Error> {
        match &self.operation {
            Operation::Distance { first, second } => {
                let [p, q] = [pose(first)?, pose(second)?];
                let shift = (q.translation - p.translation).norm();
                let (turn, length) = (angle(&p, &q), distance(&p, &q));
                console.say(format!(
                    "Distance {length:?}: angle {turn:?} radians ({:?} degrees), shift {shift:?}",
                    turn.to_degrees()
                ));
                console.result(&json!({ "distance": length, "angle": turn, "shift": shift }))
            }
            Operation::Interpolate {
                first,
                second,
                steps,
                output,
            } => {
                output.check(*steps, console)?;
                let [p, q] = [pose(first)?, pose(second)?];
                let poses = path(&p, &q, *steps);
                output.write(&poses, console)?;
                console.result(&json!({
                    "poses": poses.len(),
                    "distance": distance(&p, &q),
                    "table": output.output.display().to_string(),
                }))
            }
            Operation::Ball {
                center,
                radius,
                count,
                output,
            } => {
                output.check(*count, console)?;
                let poses = geodesic_ball(&pose(center)?, *radius, *count);
                output.write(&poses, console)?;
                console.result(&json!({
                    "poses": poses.len(),
                    "radius": radius,
                    "table": output.output.display().to_string(),
                }))
            }
        }
    }
}
