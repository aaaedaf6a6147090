//! What accuracy costs: the path with bunnies of 2^9 to 2^21 nodes.

use crate::Setting;
use crate::measured::Times;
use crate::report::Figure;
use crate::table::{Cell, Table};
use knotdock::Collision;
use knotdock::geometry::collide::{Verdict, Workspace};
use knotdock_cli::plot::chart::{Axis, Panel, Series, Style};
use std::error::Error;
use std::time::Instant;

/// Every how manieth pose of the path is taken.
const STRIDE: usize = 5;
/// Runs of each question; the fastest counts.
const RUNS: usize = 3;
const BLUE: [u8; 3] = [0x00, 0x72, 0xb2];
const GREEN: [u8; 3] = [0x00, 0x9e, 0x73];
const ORANGE: [u8; 3] = [0xe6, 0x9f, 0x00];

struct Row {
    power: u32,
    /// As a share of the bunny's longest edge.
    epsilon: f64,
    balls: usize,
    /// Seconds of sampling.
    making: f64,
    undecided: f64,
    /// Median of the gap between the bounds of the distance, as a share of the edge.
    band: f64,
    /// Median microseconds of verdict, distance, and force and torque.
    micros: [f64; 3],
    /// 99% of the verdicts' microseconds.
    most: f64,
}

/// The table and the picture.
pub fn figure(setting: &Setting) -> Result<Figure, Box<dyn Error>> {
    let rows = (9..=21).map(|power| row(setting, power));
    let rows = rows.collect::<Result<Vec<_>, _>>()?;
    Ok(Figure {
        name: "collide_accuracy",
        tables: vec![("table", table(&rows))],
        panels: panels(&rows),
        columns: 2,
    })
}

fn row(setting: &Setting, power: u32) -> Result<Row, Box<dyn Error>> {
    let start = Instant::now();
    let solid = setting.balls(2f64.powf(f64::from(power) / 3.0).round() as usize)?;
    let collision = Collision::new(&solid, &solid).force(true);
    collision.prepare()?;
    let making = start.elapsed().as_secs_f64();
    let mut work = Workspace::default();
    let path = &setting.path;
    let taken = (0..path.len()).step_by(STRIDE);
    let verdicts = taken.clone().map(|pose| {
        let mut query = collision.query(&path[pose], &mut work);
        query.certificate().verdict()
    });
    let undecided = verdicts
        .filter(|verdict| *verdict == Verdict::Undecided)
        .count();
    let mut bands: Vec<f64> = taken
        .clone()
        .map(|pose| {
            let bounds = collision.query(&path[pose], &mut work).distance();
            bounds.high - bounds.low
        })
        .collect();
    bands.sort_by(f64::total_cmp);
    let verdict = Times::of(path.len(), STRIDE, RUNS, |pose| {
        collision.query(&path[pose], &mut work).certificate()
    });
    let distance = Times::of(path.len(), STRIDE, RUNS, |pose| {
        collision.query(&path[pose], &mut work).distance()
    });
    let force = Times::of(path.len(), STRIDE, RUNS, |pose| {
        collision.query(&path[pose], &mut work).contact()
    });
    let spreads = [&verdict, &distance, &force].map(|times| times.spread(|_| true));
    Ok(Row {
        power,
        epsilon: solid.epsilon() / setting.mesh.extent(),
        balls: solid.inner().len(),
        making,
        undecided: undecided as f64 / taken.len() as f64,
        band: bands[bands.len() / 2] / setting.mesh.extent(),
        micros: spreads.map(|spread| spread.map_or(f64::NAN, |spread| spread.median)),
        most: spreads[0].map_or(f64::NAN, |spread| spread.most),
    })
}

fn table(rows: &[Row]) -> Table {
    let percent = |share: f64| Cell::Text(format!("{:.2}%", 100.0 * share));
    let row = |row: &Row| {
        vec![
            Cell::Count(1 << row.power),
            percent(row.epsilon),
            Cell::Text(row.balls.to_string()),
            Cell::Number(row.making),
            percent(row.undecided),
            percent(row.band),
            Cell::Number(row.micros[0]),
            Cell::Number(row.most),
            Cell::Number(row.micros[1]),
            Cell::Number(row.micros[2]),
        ]
    };
    Table {
        header: vec![
            "m",
            "eps / edge",
            "inner balls",
            "made in (s)",
            "undecided",
            "distance known to",
            "verdict (µs)",
            "99%",
            "distance (µs)",
            "force and torque (µs)",
        ],
        rows: rows.iter().map(row).collect(),
    }
}

fn panels(rows: &[Row]) -> Vec<Panel> {
    let curve = |name: &str, colour, place: &dyn Fn(&Row) -> [f64; 2]| Series {
        name: name.to_owned(),
        colour,
        style: Style::Line,
        labels: Vec::new(),
        points: rows.iter().map(place).collect(),
    };
    vec![
        Panel {
            title: "What the time buys".to_owned(),
            across: Axis::ten("median wall time of a verdict, µs"),
            up: Axis::ten("share of the path, or of the edge"),
            series: vec![
                curve("undecided poses", ORANGE, &|row| {
                    [row.micros[0], row.undecided]
                }),
                curve("eps / edge", BLUE, &|row| [row.micros[0], row.epsilon]),
            ],
        },
        Panel {
            title: "What a finer grid costs".to_owned(),
            across: Axis::two("nodes, m"),
            up: Axis::ten("median wall time, µs"),
            series: [
                ("verdict", BLUE),
                ("distance", GREEN),
                ("force and torque", ORANGE),
            ]
            .into_iter()
            .enumerate()
            .map(|(question, (name, colour))| {
                curve(name, colour, &|row| {
                    [f64::from(row.power).exp2(), row.micros[question]]
                })
            })
            .collect(),
        },
    ]
}
