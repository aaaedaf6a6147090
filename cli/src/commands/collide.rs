//! `knotdock collide`: whether two solids meet at a pose, how far apart or how deep they are, and what pushes them out.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::arguments::machine::Threads;
use crate::report::{SolidsReport, Viewer};
use crate::tables::collisions;
use crate::tables::report::counted;
use clap::{Args, ValueEnum};
use knotdock::geometry::collide::impact::{Impact, first_impact};
use knotdock::geometry::collide::{
    Answer, CollisionScene, Method, Quantities, Questions, Verdict, Ways, Workspace,
};
use knotdock::options::values::{DISTANCE, Range, duration, in_range};
use knotdock::output::files::whole_file::write_whole;
use knotdock::threads;
use knotdock_scoring::se3::Pose;
use knotdock_structures::mesh::Figure;
use serde_json::{Value, json};

use crate::arguments::memory;
use crate::arguments::output_file::{check_output, is_same};
use crate::arguments::solid_output::shown_surface;
use crate::arguments::viewer::ViewerArguments;
use crate::inputs::poses::{PoseArguments, pose_file};
use crate::inputs::solids::{SolidArguments, SolidInput};
use crate::messages::console::Console;
use knotdock_structures::Error;

/// Collide two solids: hit or free at each pose, with bounds of the distance, the shared volume, force and torque.
///
/// A solid is a mesh (.stl, .obj, .ply, .off), a molecule (.pdb, .ent, .cif) or a file of balls (.csv, cuRobo .yml,
/// foam .json). Balls inside both that meet certify a hit, containment included. Balls that hold both and do not meet
/// certify that the pose is free. Between the two it is undecided, and a finer --grid says more.
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
    #[arg(long, value_name = "COUNT", default_value_t = Ways::default().modes, value_parser = in_range::<usize>(Range::between(1.0, 1e6)))]
    modes: usize,
    /// What to compute beside the verdict; with commas between.
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = [Compute::Distance, Compute::Volume, Compute::Force])]
    compute: Vec<Compute>,
    /// The table to write, a row a pose.
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

/// [`Method`] by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MethodName {
    /// Trees, and modes for forces where they cost less.
    Auto,
    /// Trees alone.
    Tree,
    /// Modes alone, which certify hits and never that a pose is free.
    Modes,
    /// Trees cull, and pairs or modes are summed, whichever cost less.
    Hybrid,
}

impl From<MethodName> for Method {
    fn from(name: MethodName) -> Self {
        match name {
            MethodName::Auto => Self::Auto,
            MethodName::Tree => Self::Tree,
            MethodName::Modes => Self::Modes,
            MethodName::Hybrid => Self::Hybrid,
        }
    }
}

/// What may be computed of a pose.
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

/// How near a path comes before it counts as a hit, as a share of the smaller solid.
const TOLERANCE: f64 = 1e-6;

impl Collide {
    /// Answers.
    pub fn run(self, console: Console) -> Result<(), Error> {
        threads::on(self.threads.count(), || self.collide(console))?
    }

    /// Answers on the threads of the caller.
    fn collide(&self, console: Console) -> Result<(), Error> {
        let poses = match &self.path {
            Some(path) => pose_file(path)?,
            None => self.poses.read()?,
        };
        let viewer = self.viewer.read()?;
        let solids = self.read()?;
        self.check_output(&solids, console)?;
        for (side, solid) in ["A", "B"].iter().zip(&solids) {
            solid.describe(side, console);
        }
        let scene = CollisionScene::new(
            solids.each_ref().map(|input| input.solid.clone()),
            self.margin,
        );
        let ways = Ways {
            method: self.method.into(),
            modes: self.modes,
            deadline: self.deadline.map(Duration::from_secs_f64),
        };
        let questions = Questions::new(scene, self.quantities(), ways).map_err(Error::input)?;
        let start = Instant::now();
        let answers = questions.answers(&poses);
        let seconds = start.elapsed().as_secs_f64();
        let impact = self.path.is_some().then(|| impact(&questions, &poses));
        let staged = self.output.as_deref();
        let staged = staged.map(|file| collisions::write(file, &poses, &answers));
        let staged = staged.transpose()?;
        if let Some(file) = &self.report {
            let text = self.page(&solids, &questions, (&poses, &answers), viewer.as_ref())?;
            write_whole(file, |file| file.write_all(text.as_bytes()))?;
        }
        if let Some(staged) = staged {
            staged.place()?;
        }
        console.say(match &answers[..] {
            [answer] => format!("\n{}", one_pose(answer)),
            answers => format!("\n{}", summary(answers, &questions, seconds)),
        });
        if let Some(impact) = &impact {
            console.say(impact_text(impact, questions.scene().band()));
        }
        if let Some(file) = &self.output {
            console.say(format!(
                "Wrote {} rows to {}",
                answers.len(),
                file.display()
            ));
        }
        console.result(&self.object(&solids, &questions, &poses, &answers, impact, seconds))
    }

    fn read(&self) -> Result<[SolidInput; 2], Error> {
        let allowed = memory::default_limit();
        let first = SolidInput::read(&self.first, &self.solids, allowed)?;
        let second = if self.second == self.first {
            first.clone()
        } else {
            SolidInput::read(&self.second, &self.solids, allowed)?
        };
        Ok([first, second])
    }

    fn check_output(&self, solids: &[SolidInput; 2], console: Console) -> Result<(), Error> {
        let read: Vec<&Path> = solids
            .iter()
            .map(SolidInput::path)
            .chain(self.poses.file())
            .chain(self.path.as_deref())
            .collect();
        if let (Some(one), Some(other)) = (&self.output, &self.report)
            && is_same(one, other)
        {
            return Err(Error::input("the same file is named twice")
                .at(one)
                .help("give each output file its own name"));
        }
        for file in [&self.output, &self.report].into_iter().flatten() {
            check_output(file, read.iter().copied(), self.force, console)?;
        }
        Ok(())
    }

    /// The report.
    fn page(
        &self,
        solids: &[SolidInput; 2],
        questions: &Questions,
        (poses, answers): (&[Pose], &[Answer]),
        viewer: Option<&Viewer>,
    ) -> Result<String, Error> {
        let [a, b] = solids.each_ref().map(|input| {
            let path = input.path().file_name().unwrap_or_default();
            path.to_string_lossy().into_owned()
        });
        let shown = solids
            .each_ref()
            .map(|input| shown_surface(&input.solid.outer(), input.solid.origin()));
        let [first, second] = shown;
        let (first, second) = (first?, second?);
        let (header, records) = collisions::table(poses, answers);
        let report = SolidsReport {
            title: format!("Collisions of {a} with {b}"),
            sentences: vec![
                format!("{a} (A) stands and {b} (B) moves."),
                format!(
                    "Of {}: hit {}, free {}, undecided {} (gaps below {}).",
                    counted(answers.len(), "pose"),
                    number_of(answers, Verdict::Hit),
                    number_of(answers, Verdict::Free),
                    number_of(answers, Verdict::Undecided),
                    Figure(questions.scene().band()),
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
            poses,
        };
        Ok(report.text(viewer))
    }

    fn quantities(&self) -> Quantities {
        let wants = |what| self.compute.contains(&what);
        Quantities {
            distance: wants(Compute::Distance),
            volume: wants(Compute::Volume),
            force: wants(Compute::Force),
        }
    }

    fn object(
        &self,
        solids: &[SolidInput; 2],
        questions: &Questions,
        poses: &[Pose],
        answers: &[Answer],
        impact: Option<Impact>,
        seconds: f64,
    ) -> Value {
        let rows = self
            .output
            .is_none()
            .then(|| collisions::objects(poses, answers));
        json!({
            "a": solids[0].object(),
            "b": solids[1].object(),
            "margin": self.margin,
            "undecided_band": questions.scene().band(),
            "hit": number_of(answers, Verdict::Hit),
            "free": number_of(answers, Verdict::Free),
            "undecided": number_of(answers, Verdict::Undecided),
            "seconds": seconds,
            "impact": impact.map(|impact| json!({
                "free_until": impact.free_until,
                "hit_by": impact.hit_by,
                "verdict": impact.verdict,
                "quaternion": impact.pose.map(|pose| pose.quaternion()),
                "translation": impact.pose.map(|pose| <[f64; 3]>::from(pose.translation)),
                "distances": impact.steps,
            })),
            "table": self.output.as_ref().map(|file| file.display().to_string()),
            "poses": rows,
        })
    }
}

fn impact(questions: &Questions, path: &[Pose]) -> Impact {
    let sizes = questions
        .scene()
        .solids()
        .each_ref()
        .map(|solid| solid.reach());
    let tolerance = TOLERANCE * sizes[0].min(sizes[1]);
    first_impact(questions.scene(), path, tolerance, &mut Workspace::new())
}

fn number_of(answers: &[Answer], verdict: Verdict) -> usize {
    let these = answers
        .iter()
        .filter(|answer| answer.found.verdict == verdict);
    these.count()
}

fn summary(answers: &[Answer], questions: &Questions, seconds: f64) -> String {
    let mut times: Vec<f64> = answers.iter().map(|answer| 1e6 * answer.seconds).collect();
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    format!(
        "{} poses: {} hit, {} free, {} undecided (gaps below {}); {:.0} poses a second; microseconds a pose: median {:.1}, \
         99% {:.1}, worst {:.1}",
        answers.len(),
        number_of(answers, Verdict::Hit),
        number_of(answers, Verdict::Free),
        number_of(answers, Verdict::Undecided),
        Figure(questions.scene().band()),
        answers.len() as f64 / seconds,
        at(0.5),
        at(0.99),
        at(1.0),
    )
}

fn one_pose(answer: &Answer) -> String {
    let point = |point: [f64; 3]| {
        format!(
            "({}, {}, {})",
            Figure(point[0]),
            Figure(point[1]),
            Figure(point[2])
        )
    };
    // A force or torque that vanishes is computed as some 1e-15 of the energy; that is shown as 0.
    let least = answer
        .contact
        .map_or(0.0, |contact| 1e-12 * contact.energy.abs());
    let without_rounding = |component: f64| {
        if component.abs() < least {
            0.0
        } else {
            component
        }
    };
    let mut lines = vec![format!(
        "Verdict: {} (certified by {})",
        answer.found.verdict.name(),
        answer.found.certificate.name()
    )];
    if let Some(bounds) = answer.bounds {
        let [a, b] = bounds.witnesses.map(point);
        lines.push(format!(
            "Signed distance: {} to {}; witness points {a} of A and {b} of B",
            Figure(bounds.low),
            Figure(bounds.high)
        ));
    }
    if let Some(volume) = answer.volume {
        lines.push(format!(
            "Shared volume: {} to {}",
            Figure(volume.value - volume.bound),
            Figure(volume.value + volume.bound)
        ));
    }
    if let Some(contact) = answer.contact {
        lines.push(format!(
            "Overlap energy {}; force on B {}, torque about its centre of mass {}",
            Figure(contact.energy),
            point(contact.force.map(without_rounding)),
            point(contact.torque.map(without_rounding))
        ));
    }
    lines.push(format!(
        "Took {:.1} microseconds, {} pairs of balls and {} modes",
        1e6 * answer.seconds,
        answer.ball_pairs,
        answer.modes
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
            let sharper = if band > 0.0 {
                format!(
                    ". At the first time the gap is below {}, which the balls leave open; a finer --grid narrows it",
                    Figure(band)
                )
            } else {
                String::new()
            };
            format!(
                "First impact: the path is free until time {} (in poses from the first), at pose \
                 {w},{x},{y},{z},{a},{b},{c}, and {then}{sharper}",
                Figure(impact.free_until)
            )
        }
    }
}
