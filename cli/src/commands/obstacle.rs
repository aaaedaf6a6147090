//! `knotdock obstacle`: the translations at which two solids meet.

use std::path::Path;

use clap::Args;
use serde_json::{Value, json};

use crate::arguments::machine::settled;
use crate::arguments::options::{OfMachine, OptionArguments};
use crate::arguments::solid_output::{SolidOutput, SolidResult, knots};
use crate::inputs::checks::room_for_balls;
use crate::inputs::poses::rotation;
use crate::inputs::solids::{SolidArguments, SolidInput, describe_solids, read_solids};
use crate::messages::console::Console;
use crate::tables::report::text_table;
use knotdock::geometry::Bracket;
use knotdock::geometry::ball_field::{BallField, FieldGrid};
use knotdock::geometry::gap::{GapWay, gap_ways};
use knotdock::geometry::morphology::exact_volume::Copies;
use knotdock::geometry::obstacle::regions::free_regions;
use knotdock::geometry::obstacle::{mirrored, pair_sums, sum};
use knotdock::options::values::{AT_LEAST_ONE, LENGTH, in_range};
use knotdock::output::files::whole_file::StagedFile;
use knotdock::threads;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::so3::{rotation_set, set_name};
use knotdock_structures::mesh::Figure;
use knotdock_structures::sampling::ball_tree::BallTree;
use knotdock_structures::{Ball, Error};

/// Compute the obstacle of two solids: the translations of B at which it meets A, at one rotation or over many.
///
/// A solid is a mesh, a molecule or a file of balls. The obstacle is A + (-R B), a union of balls again, a ball for
/// each pair. Inner balls are in the true one and outer balls hold it. Free regions are the connected parts of the free
/// space in a padded box: more than one means that B is caged somewhere, or cannot get somewhere.
#[derive(Args, Debug)]
pub struct Obstacle {
    /// The fixed solid; robot.yml:hand picks a link, FILE:H,L chains.
    #[arg(value_name = "A")]
    first: String,
    /// The solid that moves, in the same unit of length.
    #[arg(value_name = "B")]
    second: String,
    /// Rotation of B, a unit quaternion [default: as the file stands].
    #[arg(
        long,
        value_name = "QW,QX,QY,QZ",
        allow_hyphen_values = true,
        conflicts_with = "rotations"
    )]
    rotation: Option<String>,
    /// Many rotations, spread evenly: -o is then a table of volumes and free regions, one row per rotation.
    #[arg(long, value_name = "COUNT", value_parser = in_range::<usize>(AT_LEAST_ONE), conflicts_with_all = ["surface", "volume_grid", "picture", "report", "set", "reduce"])]
    rotations: Option<usize>,
    /// Length added to each radius, another slice of the lifted obstacle: a clearance, or, below zero, an overlap that
    /// is allowed.
    #[arg(
        long,
        value_name = "LENGTH",
        default_value_t = 0.0,
        allow_negative_numbers = true,
        value_parser = in_range::<f64>(LENGTH)
    )]
    offset: f64,
    /// Write no ball that is in another one; without it the table holds a ball for each pair.
    #[arg(long)]
    reduce: bool,
    /// Compute the gap function on a grid of N points an axis by each way too, with residuals and times; N is rounded up
    /// to a multiple of four.
    #[arg(long, value_name = "COUNT", value_parser = in_range::<usize>(AT_LEAST_ONE), conflicts_with = "rotations")]
    gap_grid: Option<usize>,
    #[command(flatten)]
    output: SolidOutput,
    #[command(flatten)]
    solids: SolidArguments,
    #[command(flatten)]
    machine: OptionArguments<OfMachine>,
}

/// An obstacle at one rotation.
struct RotatedObstacle {
    quaternion: [f64; 4],
    result: SolidResult,
    /// Free regions about the inner and the outer balls.
    regions: [usize; 2],
}

impl Obstacle {
    pub fn run(self, console: Console) -> Result<(), Error> {
        let machine = settled(&self.machine.given()?.options.machine);
        let allowed = machine.memory;
        threads::on(machine.thread_count(), || self.compute(allowed, console))?
    }

    /// Computes with `allowed` bytes of memory.
    fn compute(&self, allowed: Option<u64>, console: Console) -> Result<(), Error> {
        let rotated = self
            .rotation
            .as_deref()
            .map_or(Ok(Pose::identity()), rotation)?;
        let names = [self.first.as_str(), &self.second];
        let inputs = read_solids(&names, &self.solids, allowed)?;
        let read: Vec<&Path> = inputs.iter().map(SolidInput::path).collect();
        self.output.check(&read, allowed, console)?;
        describe_solids(&inputs, console);
        let [a, b] = [0, 1].map(|side| Bracket::from(&inputs[side].solid));
        room_for_balls(a.inner.len() as u64 * b.inner.len() as u64, allowed)?;
        let objects = json!({
            "a": inputs[0].object(),
            "b": inputs[1].object(),
            "offset": self.offset,
        });
        match self.rotations {
            Some(count) => self.at_rotations(&a, &b, count, objects, console),
            None => {
                let copies = inputs[0]
                    .mesh
                    .as_ref()
                    .map(|mesh| Copies::obstacle(mesh, &inputs[1].solid, &rotated, self.offset));
                self.at_rotation(&a, &b, &rotated, copies.as_ref(), objects, console)
            }
        }
    }

    /// Computes the obstacle at one rotation; `copies` of a mesh A bound its volume, `inputs` are part of the result.
    fn at_rotation(
        &self,
        a: &Bracket,
        b: &Bracket,
        rotation: &Pose,
        copies: Option<&Copies<'_>>,
        inputs: Value,
        console: Console,
    ) -> Result<(), Error> {
        let mirror = mirrored(b, rotation);
        let obstacle = self.obstacle(a, b, rotation, copies);
        let table = match (&self.output.output, self.reduce) {
            (Some(_), false) => {
                let (first, second) = (self.output.chosen(a), self.output.chosen(&mirror));
                let balls: Vec<Ball> = pair_sums(first, second, self.offset).collect();
                Some(knots(&balls, obstacle.result.solid.origin)?)
            }
            _ => None,
        };
        let files = self.output.write(&obstacle.result, table)?;
        obstacle.result.describe(console);
        let [inner, outer] = obstacle.regions;
        console.say(format!(
            "  Free regions: {inner} about the inner balls, {outer} about the outer ones (grid of {} cells)",
            self.output.cells
        ));
        let ways = match self.gap_grid {
            Some(per_axis) => gap(a, &mirror, per_axis, console)?,
            None => Vec::new(),
        };
        if !files.is_empty() {
            console.say(format!("Wrote {}", files.join(", ")));
        }
        let mut object = obstacle.object();
        object["gap_function"] = ways.iter().map(way_object).collect();
        for input in ["a", "b", "offset"] {
            object[input] = inputs[input].clone();
        }
        object["quaternion"] = json!(obstacle.quaternion);
        object["files"] = json!(files);
        console.result(&object)
    }

    fn obstacle(
        &self,
        a: &Bracket,
        b: &Bracket,
        rotation: &Pose,
        copies: Option<&Copies<'_>>,
    ) -> RotatedObstacle {
        let solid = sum(a, &mirrored(b, rotation), self.offset);
        let regions = |balls: &[Ball]| match FieldGrid::about(balls, self.output.cells) {
            // If nothing is blocked, all space is one region.
            None => 1,
            Some(grid) => {
                let tree = BallTree::new(balls);
                free_regions(&BallField::new(&tree, grid), &tree).len()
            }
        };
        let known = copies.map(|copies| copies.volume(&solid, self.solids.grid.per_axis));
        let result = SolidResult::new(
            "Obstacle",
            solid,
            known.unwrap_or([0.0, f64::INFINITY]),
            "the offset takes all radii to zero or below".to_owned(),
        );
        let solid = &result.solid;
        RotatedObstacle {
            quaternion: rotation.quaternion(),
            regions: match solid.is_exact() {
                true => [regions(&solid.inner); 2],
                false => [regions(&solid.inner), regions(&solid.outer)],
            },
            result,
        }
    }

    /// Computes the obstacles at `count` rotations, one row each; `inputs` are part of the result.
    fn at_rotations(
        &self,
        a: &Bracket,
        b: &Bracket,
        count: usize,
        inputs: Value,
        console: Console,
    ) -> Result<(), Error> {
        let rows = rotation_set(count).into_iter().map(|rotation| {
            let pose = Pose {
                rotation,
                ..Pose::identity()
            };
            self.obstacle(a, b, &pose, None)
        });
        let rows: Vec<RotatedObstacle> = rows.collect();
        if let Some(path) = &self.output.output {
            write_rows(&rows, path)?.place()?;
            console.say(format!("Wrote {} rows to {}", rows.len(), path.display()));
        }
        let range = |value: fn(&SolidResult) -> (f64, f64)| {
            let values = rows.iter().map(|row| value(&row.result).0);
            let least = values.clone().fold(f64::INFINITY, f64::min);
            let most = values.fold(f64::NEG_INFINITY, f64::max);
            format!("{} to {}", Figure(least), Figure(most))
        };
        console.say(format!(
            "\n{count} rotations ({}):\n  volume of the inner balls {}, of the outer balls {}",
            set_name(count),
            range(|result| result.inner_volume),
            range(|result| result.outer_volume),
        ));
        let caged = rows.iter().filter(|row| row.regions[0] > 1).count();
        console.say(format!(
            "  {caged} rotations leave more than one free region about the inner balls"
        ));
        let mut object = inputs;
        let objects = rows.iter().map(|row| {
            let mut object = row.object();
            object["quaternion"] = json!(row.quaternion);
            object
        });
        object["rotations"] = objects.collect();
        let table = self.output.output.as_ref();
        object["table"] = json!(table.map(|path| path.display().to_string()));
        console.result(&object)
    }
}

/// Most points per axis of a gap function.
const MAX_GAP_GRID: usize = 256;

/// The gap function of the inner balls by each way, printed as a table.
fn gap(
    a: &Bracket,
    mirror: &Bracket,
    per_axis: usize,
    console: Console,
) -> Result<Vec<GapWay>, Error> {
    if per_axis > MAX_GAP_GRID {
        return Err(
            Error::input(format!("--gap-grid {per_axis} is more than {MAX_GAP_GRID}"))
                .help(format!("give at most {MAX_GAP_GRID}")),
        );
    }
    let per_axis = per_axis.max(16).next_multiple_of(4);
    // The mirror image of -R B is R B.
    let rotated = mirror.inner.iter().map(|ball| Ball {
        center: ball.center.map(|part| 0.0 - part),
        radius: ball.radius,
    });
    let ways = gap_ways(&a.inner, &rotated.collect::<Vec<_>>(), per_axis)?;
    let lines = ways.iter().map(|way| {
        let farthest = way.hausdorff.map(|error| format!("{error:.4e}"));
        vec![
            way.name.to_owned(),
            way.modes.map_or("-".to_owned(), |modes| modes.to_string()),
            format!("{:.4e}", way.seconds),
            format!("{:.2e}", way.residual),
            farthest.unwrap_or("-".to_owned()),
        ]
    });
    console.say(format!(
        "\nGap function of the inner balls on {per_axis}^3 points; residuals as shares of its peak:\n{}",
        text_table("way|modes|seconds|residual|Hausdorff", lines)
    ));
    Ok(ways)
}

fn way_object(way: &GapWay) -> Value {
    json!({
        "way": way.name,
        "modes": way.modes,
        "seconds": way.seconds,
        "residual": way.residual,
        "hausdorff": way.hausdorff,
    })
}

impl RotatedObstacle {
    fn object(&self) -> Value {
        let mut object = self.result.object();
        object["inner"]["free_regions"] = json!(self.regions[0]);
        object["outer"]["free_regions"] = json!(self.regions[1]);
        object
    }
}

fn write_rows(rows: &[RotatedObstacle], path: &Path) -> Result<StagedFile, Error> {
    StagedFile::write(path, |file| {
        writeln!(
            file,
            "rotation,qw,qx,qy,qz,balls_inner,balls_outer,volume_inner,volume_outer,free_regions_inner,\
             free_regions_outer"
        )?;
        for (number, row) in (1..).zip(rows) {
            let ([w, x, y, z], result) = (row.quaternion, &row.result);
            writeln!(
                file,
                "{number},{w:?},{x:?},{y:?},{z:?},{},{},{:?},{:?},{},{}",
                result.solid.inner.len(),
                result.solid.outer.len(),
                result.inner_volume.0,
                result.outer_volume.0,
                row.regions[0],
                row.regions[1]
            )?;
        }
        Ok(())
    })
}
