//! knotdock beside parry3d and coal: microseconds of a verdict, of a distance, and of force and torque.

use crate::measured::{Spread, Times};
use crate::peers::{CoalRow, Parry, coal, python};
use crate::report::Figure;
use crate::table::{Cell, Table};
use crate::{Options, Setting, path};
use knotdock::Collision;
use knotdock::geometry::collide::{DistanceBounds, Verdict, Workspace};
use knotdock_cli::plot::chart::{Axis, Colour, Panel, Series, Style};
use std::error::Error;
use std::fs;
use std::time::Instant;

/// Runs of each question; the fastest counts.
const RUNS: usize = 3;
/// Poses of a batch that are in memory at a time.
const CHUNK: usize = 100_000;
const PROGRAMS: [(&str, Colour); 3] = [
    ("knotdock", [0x00, 0x72, 0xb2]),
    ("parry3d", [0xe6, 0x9f, 0x00]),
    ("coal", [0x00, 0x9e, 0x73]),
];
const QUESTIONS: [&str; 3] = ["verdict", "distance", "force and torque"];

/// Times of the three questions.
type AllTimes = [Times; 3];

/// What the programs say, and how long it takes them.
struct Answers {
    /// knotdock's verdict of every pose.
    verdicts: Vec<Verdict>,
    /// Its bounds.
    bounds: Vec<DistanceBounds>,
    ours: AllTimes,
    parry: AllTimes,
    coal: Option<AllTimes>,
}

/// The tables and the picture.
pub fn figure(setting: &Setting, options: &Options) -> Result<Figure, Box<dyn Error>> {
    let per_axis = 2f64.powf(f64::from(options.grid) / 3.0).round() as usize;
    let start = Instant::now();
    let [a, b] = &setting.balls(per_axis)?;
    let collision = Collision::new(a, b).force(true);
    collision.prepare()?;
    println!(
        "2^{} nodes: {} and {} inner balls, eps {:.3}% of the standing mesh's edge, made in {:.1} s",
        options.grid,
        a.inner().len(),
        b.inner().len(),
        100.0 * a.epsilon() / setting.edge(),
        start.elapsed().as_secs_f64()
    );
    let answers = answers(setting, options, &collision)?;
    Ok(Figure {
        name: "collide",
        tables: vec![
            ("times", times(&answers, options.stride)),
            ("batch", batch(setting, options, &collision)?),
        ],
        panels: panels(&answers),
        columns: 2,
    })
}

fn answers(
    setting: &Setting,
    options: &Options,
    collision: &Collision,
) -> Result<Answers, Box<dyn Error>> {
    let path = &setting.path;
    let mut work = Workspace::default();
    let verdict =
        |pose: usize, work: &mut Workspace| collision.query(&path[pose], work).certificate();
    let distance =
        |pose: usize, work: &mut Workspace| collision.query(&path[pose], work).distance();
    let verdicts = (0..path.len()).map(|pose| verdict(pose, &mut work).verdict());
    let verdicts = verdicts.collect();
    let bounds = (0..path.len()).map(|pose| distance(pose, &mut work));
    let bounds = bounds.collect();
    let ours = [
        Times::of(path.len(), 1, RUNS, |pose| verdict(pose, &mut work)),
        Times::of(path.len(), 1, RUNS, |pose| distance(pose, &mut work)),
        Times::of(path.len(), 1, RUNS, |pose| {
            collision.query(&path[pose], &mut work).contact()
        }),
    ];
    let parry = Parry::new(setting.meshes.each_ref())?;
    let parry_times = [
        Times::of(path.len(), options.stride, RUNS, |i| parry.meet(&path[i])),
        Times::of(path.len(), options.stride, RUNS, |i| {
            parry.distance(&path[i])
        }),
        Times::of(path.len(), options.stride, RUNS, |i| {
            parry.contact(&path[i])
        }),
    ];
    let mut answers = Answers {
        verdicts,
        bounds,
        ours,
        parry: parry_times,
        coal: None,
    };
    let mut wrong = 0;
    for pose in (0..path.len()).step_by(options.stride) {
        let gap = parry.distance(&path[pose])?;
        wrong += usize::from(answers.contradicts(pose, parry.meet(&path[pose])?, gap));
    }
    let table = options.out.join("path.csv");
    fs::write(&table, path::csv(path))?;
    let python = options.python.clone().unwrap_or_else(python);
    match coal(&python, &setting.files, &table, options.stride, RUNS) {
        Err(reason) => println!("without coal: {reason}"),
        Ok(rows) => {
            for (row, pose) in rows.iter().zip((0..).step_by(options.stride)) {
                wrong += usize::from(answers.contradicts(pose, row.meet, row.distance));
            }
            answers.coal = Some(coal_times(&rows, options.stride));
        }
    }
    println!("answers that contradict parry3d's or coal's: {wrong}");
    Ok(answers)
}

impl Answers {
    /// Whether surfaces that meet, or have such a gap, contradict what knotdock says of a pose. Surfaces with a gap may
    /// belong to solids of which one holds the other.
    fn contradicts(&self, pose: usize, meet: bool, gap: f64) -> bool {
        let (verdict, bounds) = (self.verdicts[pose], self.bounds[pose]);
        // Theirs are good to about a millionth.
        let rounding = 1e-6 * (1.0 + gap);
        match verdict {
            Verdict::Free if meet => true,
            Verdict::Free => gap < bounds.low - rounding || gap > bounds.high + rounding,
            Verdict::Undecided => bounds.high < 0.0 || (meet && bounds.low > 0.0),
            Verdict::Hit => bounds.low > 0.0,
        }
    }
}

fn coal_times(rows: &[CoalRow], stride: usize) -> AllTimes {
    [0, 1, 2].map(|question| Times {
        poses: (0..rows.len()).map(|row| row * stride).collect(),
        micros: rows.iter().map(|row| row.micros[question]).collect(),
    })
}

/// A row for each question and kind of pose.
fn times(answers: &Answers, stride: usize) -> Table {
    const KINDS: [(&str, Option<Verdict>); 4] = [
        ("all", None),
        ("free", Some(Verdict::Free)),
        ("undecided", Some(Verdict::Undecided)),
        ("hit", Some(Verdict::Hit)),
    ];
    let mut rows = Vec::new();
    for (number, question) in QUESTIONS.into_iter().enumerate() {
        for (kind, verdict) in KINDS {
            let keep = |pose: usize| verdict.is_none_or(|kind| answers.verdicts[pose] == kind);
            let kept = (0..answers.verdicts.len()).filter(|&pose| keep(pose));
            let share = kept.count() as f64 / answers.verdicts.len() as f64;
            if share == 0.0 {
                continue;
            }
            let ours = answers.ours[number].spread(keep);
            // The ratio is of the same poses.
            let same = answers.ours[number].spread(|pose| pose % stride == 0 && keep(pose));
            let parry = answers.parry[number].spread(keep);
            let coal = answers.coal.as_ref();
            let coal = coal.and_then(|times| times[number].spread(keep));
            let ratio = |theirs: Option<Spread>| match (theirs, same) {
                (Some(theirs), Some(ours)) => Cell::Number(theirs.median / ours.median),
                _ => Cell::None,
            };
            let mut row = vec![
                Cell::Text(question.to_owned()),
                Cell::Text(kind.to_owned()),
                Cell::Text(format!("{:.1}%", 100.0 * share)),
            ];
            for spread in [ours, parry, coal] {
                row.extend(cells(spread));
            }
            row.extend([ratio(parry), ratio(coal)]);
            rows.push(row);
        }
    }
    Table {
        header: vec![
            "question",
            "poses",
            "share",
            "knotdock: median (µs)",
            "99%",
            "worst",
            "parry3d: median",
            "99%",
            "worst",
            "coal: median",
            "99%",
            "worst",
            "parry3d / knotdock",
            "coal / knotdock",
        ],
        rows,
    }
}

fn cells(spread: Option<Spread>) -> [Cell; 3] {
    spread.map_or([Cell::None, Cell::None, Cell::None], |spread| {
        [spread.median, spread.most, spread.worst].map(Cell::Number)
    })
}

/// Poses a second of many verdicts, the path over and over.
fn batch(
    setting: &Setting,
    options: &Options,
    collision: &Collision,
) -> Result<Table, Box<dyn Error>> {
    let verdicts = collision.clone().force(false);
    let poses: Vec<_> = setting.path.iter().cycle().take(CHUNK).copied().collect();
    let mut rows = Vec::new();
    for (what, collision) in [
        ("verdict", &verdicts),
        ("verdict, force, torque", collision),
    ] {
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new();
            let pool = pool.num_threads(threads).build()?;
            let start = Instant::now();
            let mut done = 0;
            while done < options.batch {
                let chunk = &poses[..CHUNK.min(options.batch - done)];
                done += pool.install(|| collision.at_each(chunk))?.len();
            }
            let seconds = start.elapsed().as_secs_f64();
            rows.push(vec![
                Cell::Text(what.to_owned()),
                Cell::Text(threads.to_string()),
                Cell::Text(done.to_string()),
                Cell::Number(seconds),
                Cell::Number(done as f64 / seconds),
            ]);
        }
    }
    Ok(Table {
        header: vec!["answers", "threads", "poses", "seconds", "poses a second"],
        rows,
    })
}

/// For each of the first two questions, the share of poses that take longer than a time.
fn panels(answers: &Answers) -> Vec<Panel> {
    let all = [
        Some(&answers.ours),
        Some(&answers.parry),
        answers.coal.as_ref(),
    ];
    let panel = |question: usize| {
        let series = all.into_iter().zip(PROGRAMS);
        let series = series.filter_map(|(times, (name, colour))| {
            let mut micros = times?[question].micros.clone();
            micros.sort_by(f64::total_cmp);
            let count = micros.len();
            let step = count.div_ceil(200).max(1);
            let points = (0..count).step_by(step);
            Some(Series {
                name: name.to_owned(),
                colour,
                style: Style::Line,
                labels: Vec::new(),
                points: points
                    .map(|rank| [micros[rank], 1.0 - rank as f64 / count as f64])
                    .collect(),
            })
        });
        Panel {
            title: format!("Poses that take longer: {}", QUESTIONS[question]),
            across: Axis::ten("wall time of one pose, µs"),
            up: Axis::ten("share of the path"),
            series: series.collect(),
        }
    };
    vec![panel(0), panel(1)]
}
