//! `knotdock collide`: contact of two solids at a pose, their distance or depth, and the force that separates them.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use csv::StringRecord;
use serde_json::{Map, Value, json};

use crate::arguments::machine::{Threads, default_limit};
use crate::arguments::output_file::check_outputs;
use crate::arguments::solid_output::shown_surface;
use crate::inputs::poses::{PoseArguments, pose_file};
use crate::inputs::solids::{SolidArguments, SolidInput, describe_solids, read_solids};
use crate::messages::console::Console;
use crate::report::{SolidsReport, Viewer, ViewerArguments};
use crate::solid_files::{place_all, write_text};
use crate::tables::field;
use crate::tables::report::counted;
use knotdock::geometry::collide::{CollisionReport, DEFAULT_MAX_MODES, Impact, Method, Verdict};
use knotdock::options::values::{DISTANCE, Range, duration, in_range};
use knotdock::output::files::whole_file::StagedFile;
use knotdock::table_text::cells::TableWriter;
use knotdock::{Collision, threads};
use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;
use knotdock_structures::mesh::Figure;

/// Collide two solids: hit or free at each pose, with bounds of the distance, the shared volume, force and torque.
///
/// A solid is a mesh (.stl, .obj, .ply, .off), a molecule (.pdb, .ent, .cif) or a file of balls (.csv, cuRobo .yml,
/// foam .json). Balls inside both that meet certify a hit, containment included. Balls that hold both and do not meet
/// certify that the pose is free. Between the two the triangles of closed meshes decide. With other solids the pose is
/// undecided, and a finer --grid says more.
#[derive(Args, Debug)]
pub struct Collide {
    /// The fixed solid; robot.yml:hand picks a link, FILE:H,L chains.
    #[arg(value_name = "A")]
    first: String,
    /// The solid that moves, in the same unit of length.
    #[arg(value_name = "B")]
    second: String,
    #[command(flatten)]
    poses: PoseArguments,
    /// Poses in order, with geodesics between: report bounds of the first time at which the solids meet.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["pose", "poses"])]
    path: Option<PathBuf>,
    /// Count poses as hits at which the solids are closer than this.
    #[arg(long, value_name = "DISTANCE", default_value_t = 0.0, value_parser = in_range::<f64>(DISTANCE))]
    margin: f64,
    /// Time for a pose, such as 1ms: bounds are the best known by then, which depend on the machine.
    #[arg(long, value_name = "TIME", value_parser = duration)]
    deadline: Option<f64>,
    /// How verdicts and forces are found.
    #[arg(long, value_enum, default_value_t = MethodName::Auto)]
    method: MethodName,
    /// The most Fourier modes that are summed, with their conjugates.
    #[arg(long, value_name = "COUNT", default_value_t = DEFAULT_MAX_MODES, value_parser = in_range::<usize>(Range::between(1.0, 1e6)))]
    modes: usize,
    /// What to compute beside the verdict; with commas between.
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = [Compute::Distance, Compute::Volume, Compute::Force])]
    compute: Vec<Compute>,
    /// The table to write, one row per pose.
    #[arg(short, long, value_name = "FILE.csv")]
    output: Option<PathBuf>,
    /// The report to write: the poses as a table and in three dimensions, in a page that opens in any browser.
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
    #[command(flatten)]
    viewer: ViewerArguments,
    /// Replace files that are there.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    solids: SolidArguments,
    #[command(flatten)]
    threads: Threads,
}

/// Names of [`Method`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MethodName {
    /// Balls, then triangles if balls leave a pose open; modes for forces where they cost less.
    Auto,
    /// Triangles, of closed meshes that do not cross themselves.
    Exact,
    /// Balls alone.
    Tree,
    /// Modes alone, which certify hits and never that a pose is free.
    Modes,
    /// Verdicts as auto; for forces pairs of balls or modes are summed, whichever cost less at the pose.
    Hybrid,
}

impl From<MethodName> for Method {
    fn from(name: MethodName) -> Self {
        match name {
            MethodName::Auto => Self::Auto,
            MethodName::Exact => Self::Exact,
            MethodName::Tree => Self::Tree,
            MethodName::Modes => Self::Modes,
            MethodName::Hybrid => Self::Hybrid,
        }
    }
}

/// Quantities of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Compute {
    /// The verdict alone.
    Verdict,
    /// Bounds of the signed distance, with witness points.
    Distance,
    /// The shared volume.
    Volume,
    /// Overlap energy, force and torque.
    Force,
}

impl Collide {
    pub fn run(self, console: Console) -> Result<(), Error> {
        threads::on(self.threads.count(), || self.collide(console))?
    }

    fn collide(&self, console: Console) -> Result<(), Error> {
        let poses = match &self.path {
            Some(path) => pose_file(path)?,
            None => self.poses.read()?,
        };
        let viewer = self.viewer.read()?;
        let names = [self.first.as_str(), &self.second];
        let solids = read_solids(&names, &self.solids, default_limit())?;
        let mut read: Vec<&Path> = solids.iter().map(SolidInput::path).collect();
        read.extend(self.poses.file());
        read.extend(self.path.as_deref());
        let files = [&self.output, &self.report].into_iter().flatten();
        check_outputs(files, &read, self.force, console)?;
        describe_solids(&solids, console);
        let [a, b] = [0, 1].map(|side| &solids[side].solid);
        let wants = |quantity| self.compute.contains(&quantity);
        let collision = Collision::new(a, b)
            .margin(self.margin)
            .method(self.method.into())
            .max_modes(self.modes)
            .deadline(self.deadline.map(Duration::from_secs_f64))
            .distance(wants(Compute::Distance))
            .shared_volume(wants(Compute::Volume))
            .force(wants(Compute::Force));
        collision.prepare()?;
        let start = Instant::now();
        let results = Results {
            reports: collision.at_each(&poses)?,
            seconds: start.elapsed().as_secs_f64(),
            impact: self.path.as_ref().map(|_| collision.first_impact(&poses)),
            band: collision.undecided_band(),
            solids,
            poses,
        };
        let mut staged = Vec::new();
        if let Some(file) = &self.output {
            let table = write_table(file, &results.poses, &results.reports)?;
            staged.push((table, file));
        }
        if let Some(file) = &self.report {
            let text = results.page(viewer.as_ref())?;
            staged.push((write_text(file, &text)?, file));
        }
        place_all(staged)?;
        console.say(match &results.reports[..] {
            [report] => format!("\n{}", one_pose(report)),
            _ => format!("\n{}", results.summary()),
        });
        if let Some(impact) = &results.impact {
            console.say(impact_text(impact, results.band));
        }
        if let Some(file) = &self.output {
            console.say(format!(
                "Wrote {} rows to {}",
                results.poses.len(),
                file.display()
            ));
        }
        console.result(&self.object(&results))
    }

    fn object(&self, results: &Results) -> Value {
        let rows = || objects(&results.poses, &results.reports);
        json!({
            "a": results.solids[0].object(),
            "b": results.solids[1].object(),
            "margin": self.margin,
            "undecided_band": results.band,
            "hit": results.count(Verdict::Hit),
            "free": results.count(Verdict::Free),
            "undecided": results.count(Verdict::Undecided),
            "seconds": results.seconds,
            "impact": results.impact.map(|impact| json!({
                "free_until": impact.free_until,
                "hit_by": impact.hit_by,
                "verdict": impact.verdict.name(),
                "quaternion": impact.pose.map(|pose| pose.quaternion()),
                "translation": impact.pose.map(|pose| <[f64; 3]>::from(pose.translation)),
                "distances": impact.steps,
            })),
            "table": self.output.as_ref().map(|file| file.display().to_string()),
            "poses": self.output.is_none().then(rows),
        })
    }
}

/// Collisions of two solids at many poses.
struct Results {
    solids: Vec<SolidInput>,
    poses: Vec<Pose>,
    reports: Vec<CollisionReport>,
    seconds: f64,
    impact: Option<Impact>,
    /// Largest gap that may stay undecided.
    band: f64,
}

impl Results {
    fn count(&self, verdict: Verdict) -> usize {
        let reports = self.reports.iter();
        reports.filter(|report| report.verdict == verdict).count()
    }

    /// The poses that may be undecided.
    fn undecided(&self) -> String {
        match self.band > 0.0 {
            true => format!("gaps below {}", Figure(self.band)),
            false => "contact within rounding".to_owned(),
        }
    }

    fn page(&self, viewer: Option<&Viewer>) -> Result<String, Error> {
        let [a, b] = [0, 1].map(|side| {
            let name = self.solids[side].path().file_name();
            name.unwrap_or_default().to_string_lossy()
        });
        let shown = |side: usize| {
            let solid = &self.solids[side].solid;
            shown_surface(&solid.outer(), solid.origin())
        };
        let (first, second) = (shown(0)?, shown(1)?);
        let (header, records) = header_and_records(&self.poses, &self.reports);
        let report = SolidsReport {
            title: format!("Collisions of {a} with {b}"),
            sentences: vec![
                format!("{a} (A) stands and {b} (B) moves."),
                format!(
                    "Of {}: hit {}, free {}, undecided {} ({}).",
                    counted(self.reports.len(), "pose"),
                    self.count(Verdict::Hit),
                    self.count(Verdict::Free),
                    self.count(Verdict::Undecided),
                    self.undecided(),
                ),
            ],
            names: ["A", "B"],
            surfaces: [(&first).into(), (&second).into()],
            caption: "Poses of B. Choose a row to see it.",
            header,
            records,
            main: &[
                "pose",
                "verdict",
                "distance_low",
                "distance_high",
                "overlap_volume",
                "overlap_energy",
            ],
            poses: &self.poses,
        };
        Ok(report.text(viewer))
    }

    fn summary(&self) -> String {
        let times = self.reports.iter().map(|report| 1e6 * report.seconds);
        let mut times: Vec<f64> = times.collect();
        times.sort_by(f64::total_cmp);
        let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
        format!(
            "{} poses: {} hit, {} free, {} undecided ({}); {:.0} poses a second; microseconds a pose: median \
             {:.1}, 99% {:.1}, worst {:.1}",
            self.reports.len(),
            self.count(Verdict::Hit),
            self.count(Verdict::Free),
            self.count(Verdict::Undecided),
            self.undecided(),
            self.reports.len() as f64 / self.seconds,
            at(0.5),
            at(0.99),
            at(1.0),
        )
    }
}

fn one_pose(report: &CollisionReport) -> String {
    let point = |point: [f64; 3]| {
        let [x, y, z] = point.map(Figure);
        format!("({x}, {y}, {z})")
    };
    // A force or torque that vanishes is computed as some 1e-15 of the energy; that is shown as 0.
    let energy = report.contact.map_or(0.0, |contact| contact.energy);
    let without_rounding = |component: f64| match component.abs() < 1e-12 * energy.abs() {
        true => 0.0,
        false => component,
    };
    let mut lines = vec![format!(
        "Verdict: {} (certified by {})",
        report.verdict.name(),
        report.certificate.name()
    )];
    if let Some(bounds) = report.distance {
        let [a, b] = bounds.witnesses.map(point);
        lines.push(format!(
            "Signed distance: {} to {}; witness points {a} of A and {b} of B",
            Figure(bounds.low),
            Figure(bounds.high)
        ));
    }
    if let Some(tolerance) = report.pose_tolerance.filter(|&tolerance| tolerance > 0.0) {
        lines.push(format!(
            "Every pose within {} of this one is {}, too (by sqrt(2 angle² + shift²), in radians and the unit of length)",
            Figure(tolerance),
            report.verdict.name()
        ));
    }
    if let Some(volume) = report.shared_volume {
        lines.push(format!(
            "Shared volume: {} to {}",
            Figure(volume.value - volume.bound),
            Figure(volume.value + volume.bound)
        ));
    }
    if let Some(contact) = report.contact {
        lines.push(format!(
            "Overlap energy {}; force on B {}, torque about its centre of mass {}",
            Figure(contact.energy),
            point(contact.force.map(without_rounding)),
            point(contact.torque.map(without_rounding))
        ));
    }
    lines.push(format!(
        "Took {:.1} microseconds, {} pairs of balls and {} modes",
        1e6 * report.seconds,
        report.ball_pairs,
        report.modes
    ));
    lines.join("\n")
}

fn impact_text(impact: &Impact, band: f64) -> String {
    match &impact.pose {
        None => format!(
            "The path is free to its end, time {}",
            Figure(impact.free_until)
        ),
        Some(pose) => {
            let [w, x, y, z] = pose.quaternion();
            let [a, b, c]: [f64; 3] = pose.translation.into();
            let then = match impact.hit_by {
                Some(time) => format!("the solids have met by time {}", Figure(time)),
                None => "no balls inside both are known to meet later".to_owned(),
            };
            let sharper = match band > 0.0 {
                true => format!(
                    ". At the first time the gap is below {}, which the balls leave open; a finer --grid narrows it",
                    Figure(band)
                ),
                false => String::new(),
            };
            format!(
                "First impact: the path is free until time {} (in poses from the first), at pose \
                 {w},{x},{y},{z},{a},{b},{c}, and {then}{sharper}",
                Figure(impact.free_until)
            )
        }
    }
}

/// The columns, in order.
#[rustfmt::skip]
const COLUMNS: [&str; 32] = [
    "pose", "qw", "qx", "qy", "qz", "tx", "ty", "tz", "verdict", "certified_by", "distance_low", "distance_high",
    "witness_a_x", "witness_a_y", "witness_a_z", "witness_b_x", "witness_b_y", "witness_b_z", "pose_tolerance",
    "overlap_volume", "overlap_volume_bound", "overlap_energy", "force_x", "force_y", "force_z", "torque_x", "torque_y",
    "torque_z", "energy_bound", "ball_pairs", "modes", "microseconds",
];

/// The values of each row; `null` for quantities that were not computed. Poses are numbered from 1.
fn table_rows<'a>(
    poses: &'a [Pose],
    reports: &'a [CollisionReport],
) -> impl Iterator<Item = Vec<Value>> + use<'a> {
    let rows = (1usize..).zip(poses).zip(reports);
    rows.map(|((number, pose), report)| {
        let translation: [f64; 3] = pose.translation.into();
        let distance = report.distance;
        let witness = |side: usize| vector(distance.map(|distance| distance.witnesses[side]));
        let volume = report.shared_volume;
        let contact = report.contact;
        let mut row = vec![json!(number)];
        row.extend(pose.quaternion().map(Value::from));
        row.extend(translation.map(Value::from));
        row.push(json!(report.verdict.name()));
        row.push(json!(report.certificate.name()));
        row.push(json!(distance.map(|distance| distance.low)));
        row.push(json!(distance.map(|distance| distance.high)));
        row.extend(witness(0));
        row.extend(witness(1));
        row.push(json!(report.pose_tolerance));
        row.push(json!(volume.map(|volume| volume.value)));
        row.push(json!(volume.map(|volume| volume.bound)));
        row.push(json!(contact.map(|contact| contact.energy)));
        row.extend(vector(contact.map(|contact| contact.force)));
        row.extend(vector(contact.map(|contact| contact.torque)));
        row.push(json!(contact.map(|contact| contact.bound)));
        row.push(json!(report.ball_pairs));
        row.push(json!(report.modes));
        row.push(json!((report.seconds * 1e7).round() / 10.0));
        row
    })
}

fn vector(vector: Option<[f64; 3]>) -> [Value; 3] {
    [0, 1, 2].map(|axis| json!(vector.map(|vector| vector[axis])))
}

fn write_table(
    path: &Path,
    poses: &[Pose],
    reports: &[CollisionReport],
) -> Result<StagedFile, Error> {
    StagedFile::write(path, |file| {
        let mut table = TableWriter::new(file);
        table.row(COLUMNS)?;
        for row in table_rows(poses, reports) {
            table.row(row.iter().map(field))?;
        }
        table.flush()
    })
}

/// The header and the rows, as they are written.
fn header_and_records(
    poses: &[Pose],
    reports: &[CollisionReport],
) -> (StringRecord, Vec<StringRecord>) {
    let records = table_rows(poses, reports).map(|row| row.iter().map(field).collect());
    (COLUMNS.iter().collect(), records.collect())
}

/// The rows as JSON objects with the names of the columns.
fn objects(poses: &[Pose], reports: &[CollisionReport]) -> Vec<Value> {
    let object = |row| {
        COLUMNS
            .map(str::to_owned)
            .into_iter()
            .zip(row)
            .collect::<Map<_, _>>()
    };
    table_rows(poses, reports)
        .map(|row| object(row).into())
        .collect()
}
