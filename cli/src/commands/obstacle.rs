//! `knotdock obstacle`: the translations at which two solids meet.

use crate::arguments::options::{OfMachine, TypedOptions};
use std::path::Path;

use clap::Args;
use knotdock::geometry::Bracket;
use knotdock::geometry::ball_field::{BallField, FieldGrid};
use knotdock::geometry::gap::{GapWay, gap_ways};
use knotdock::geometry::obstacle::pairs::PairSums;
use knotdock::geometry::obstacle::regions::free_regions;
use knotdock::geometry::obstacle::{mirrored, sum};
use knotdock::options::values::{AT_LEAST_ONE, LENGTH, in_range};
use knotdock::output::files::whole_file::StagedFile;
use knotdock::threads;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::so3::{rotation_set, set_name};
use knotdock_structures::Ball;
use knotdock_structures::mesh::Figure;
use knotdock_structures::sampling::ball_tree::BallTree;
use serde_json::{Value, json};

use crate::arguments::solid_output::{Side, SolidOutput, Volumes, knots};
use crate::inputs::poses::rotation;
use crate::inputs::room::room_for_balls;
use crate::inputs::solids::{SolidArguments, SolidInput};
use crate::messages::console::Console;
use knotdock_structures::Error;

/// Compute the obstacle of two solids: the translations of B at which it meets A, at one rotation or over many.
///
/// A solid is a mesh, a molecule or a file of balls. The obstacle is A + (-R B), a union of balls again, a ball for each
/// pair. Inner balls lie in the true one and outer balls hold it. Free regions are the connected parts of what is left
/// free in a padded box: more than one means that B is caged somewhere, or cannot get somewhere.
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
    /// Many rotations, spread evenly: -o is then a table of volumes and free regions, a row a rotation.
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
    /// Write no ball that lies in another one; without it the table holds a ball for each pair.
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
    machine: TypedOptions<OfMachine>,
}

/// An obstacle with what is reported of it.
struct Found {
    solid: Bracket,
    volumes: Volumes,
    /// Free regions about the inner and the outer balls.
    regions: [usize; 2],
}

impl Obstacle {
    /// Computes.
    pub fn run(self, console: Console) -> Result<(), Error> {
        threads::on(self.machine.options.machine.thread_count(), || {
            self.compute(console)
        })?
    }

    fn compute(&self, console: Console) -> Result<(), Error> {
        let allowed = self
            .machine
            .options
            .machine
            .memory
            .or_else(crate::arguments::memory::default_limit);
        let turned = match &self.rotation {
            Some(text) => rotation(text)?,
            None => Pose::identity(),
        };
        let first = SolidInput::read(&self.first, &self.solids, allowed)?;
        let second = SolidInput::read(&self.second, &self.solids, allowed)?;
        let read = [first.path(), second.path()];
        self.output.check(&read, allowed, console)?;
        for (side, solid) in [("A", &first), ("B", &second)] {
            solid.describe(side, console);
        }
        let solids = [&first, &second].map(|input| Bracket::from(&input.solid));
        let pairs = solids[0].inner.len() as u64 * solids[1].inner.len() as u64;
        room_for_balls(pairs, allowed)?;
        let inputs = [first.object(), second.object()];
        match self.rotations {
            Some(count) => self.table(&solids, count, inputs, console),
            None => self.one(&solids, &turned, inputs, console),
        }
    }

    /// The obstacle at one rotation.
    fn one(
        &self,
        [a, b]: &[Bracket; 2],
        rotation: &Pose,
        [first, second]: [Value; 2],
        console: Console,
    ) -> Result<(), Error> {
        let found = self.found(a, b, rotation);
        let table = match (&self.output.output, self.reduce) {
            (Some(_), false) => {
                let mirror = mirrored(b, rotation);
                let balls: Vec<Ball> = self.pairs(a, &mirror).iter().collect();
                Some(knots(&balls, found.solid.origin)?)
            }
            _ => None,
        };
        let files = self
            .output
            .write(("Obstacle", &found.volumes), &found.solid, table)?;
        found.volumes.describe("Obstacle", &found.solid, console);
        let [inner, outer] = found.regions;
        console.say(format!(
            "  Free regions: {inner} about the inner balls, {outer} about the outer ones (grid of {} cells)",
            self.output.cells
        ));
        let ways = match self.gap_grid {
            Some(per_axis) => gap(a, &mirrored(b, rotation), per_axis, console)?,
            None => Vec::new(),
        };
        if !files.is_empty() {
            console.say(format!("Wrote {}", files.join(", ")));
        }
        let mut object = found.object();
        object["gap_function"] = json!(ways.iter().map(way_object).collect::<Vec<Value>>());
        object["a"] = first;
        object["b"] = second;
        object["offset"] = json!(self.offset);
        object["quaternion"] = json!(rotation.quaternion());
        object["files"] = json!(files);
        console.result(&object)
    }

    /// Every pair of the set that is written.
    fn pairs<'a>(&self, a: &'a Bracket, mirror: &'a Bracket) -> PairSums<'a> {
        match self.output.set {
            Side::Inner => PairSums::new(&a.inner, &mirror.inner, self.offset),
            Side::Outer => PairSums::new(&a.outer, &mirror.outer, self.offset),
        }
    }

    fn found(&self, a: &Bracket, b: &Bracket, rotation: &Pose) -> Found {
        let solid = sum(a, &mirrored(b, rotation), self.offset);
        let regions = |balls: &[Ball]| match FieldGrid::about(balls, self.output.cells) {
            // Where nothing is blocked all space is one region.
            None => 1,
            Some(grid) => {
                let tree = BallTree::new(balls);
                free_regions(&BallField::new(&tree, grid), &tree).len()
            }
        };
        Found {
            volumes: Volumes::of(&solid),
            regions: match solid.is_exact() {
                true => [regions(&solid.inner); 2],
                false => [regions(&solid.inner), regions(&solid.outer)],
            },
            solid,
        }
    }

    /// A row for each of `count` rotations.
    fn table(
        &self,
        [a, b]: &[Bracket; 2],
        count: usize,
        [first, second]: [Value; 2],
        console: Console,
    ) -> Result<(), Error> {
        let mut rows = Vec::with_capacity(count);
        for rotation in rotation_set(count) {
            let pose = Pose {
                rotation,
                ..Pose::identity()
            };
            let found = self.found(a, b, &pose);
            rows.push((pose.quaternion(), found));
        }
        if let Some(path) = &self.output.output {
            write_rows(&rows, path)?.place()?;
            console.say(format!("Wrote {} rows to {}", rows.len(), path.display()));
        }
        let range = |value: fn(&Found) -> f64| {
            let values = rows.iter().map(|(_, found)| value(found));
            let least = values.clone().fold(f64::INFINITY, f64::min);
            let most = values.fold(f64::NEG_INFINITY, f64::max);
            format!("{} to {}", Figure(least), Figure(most))
        };
        console.say(format!(
            "\n{count} rotations ({}):\n  volume of the inner balls {}, of the outer balls {}",
            set_name(count),
            range(|found| found.volumes.inner.0),
            range(|found| found.volumes.outer.0),
        ));
        let caged = rows
            .iter()
            .filter(|(_, found)| found.regions[0] > 1)
            .count();
        console.say(format!(
            "  {caged} rotations leave more than one free region about the inner balls"
        ));
        let objects = rows.iter().map(|(quaternion, found)| {
            let mut object = found.object();
            object["quaternion"] = json!(quaternion);
            object
        });
        console.result(&json!({
            "a": first,
            "b": second,
            "offset": self.offset,
            "rotations": objects.collect::<Vec<Value>>(),
            "table": self.output.output.as_ref().map(|path| path.display().to_string()),
        }))
    }
}

/// Most points an axis of a gap function.
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
    let turned: Vec<Ball> = (mirror.inner.iter())
        .map(|ball| Ball {
            center: ball.center.map(|part| 0.0 - part),
            radius: ball.radius,
        })
        .collect();
    let ways = gap_ways(&a.inner, &turned, per_axis).map_err(Error::machine)?;
    console.say(format!(
        "\nGap function of the inner balls on {per_axis}^3 points; residuals as shares of its peak:\n  {:<28}{:>10}{:>13}{:>13}{:>13}",
        "way", "modes", "seconds", "residual", "Hausdorff"
    ));
    for way in &ways {
        let modes = way.modes.map_or("-".to_owned(), |modes| modes.to_string());
        let farthest = way
            .hausdorff
            .map_or("-".to_owned(), |error| format!("{error:.4e}"));
        console.say(format!(
            "  {:<28}{modes:>10}{:>13.4e}{:>13.2e}{farthest:>13}",
            way.name, way.seconds, way.residual
        ));
    }
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

impl Found {
    fn object(&self) -> Value {
        let mut object = self.volumes.object(&self.solid);
        object["inner"]["free_regions"] = json!(self.regions[0]);
        object["outer"]["free_regions"] = json!(self.regions[1]);
        object
    }
}

fn write_rows(rows: &[([f64; 4], Found)], path: &Path) -> Result<StagedFile, Error> {
    let written = StagedFile::write(path, |file| {
        writeln!(
            file,
            "rotation,qw,qx,qy,qz,balls_inner,balls_outer,volume_inner,volume_outer,free_regions_inner,\
             free_regions_outer"
        )?;
        for (number, ([w, x, y, z], found)) in rows.iter().enumerate() {
            writeln!(
                file,
                "{},{w:?},{x:?},{y:?},{z:?},{},{},{:?},{:?},{},{}",
                number + 1,
                found.solid.inner.len(),
                found.solid.outer.len(),
                found.volumes.inner.0,
                found.volumes.outer.0,
                found.regions[0],
                found.regions[1]
            )?;
        }
        Ok(())
    });
    Ok(written?)
}
