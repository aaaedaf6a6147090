//! What the balls' accuracy costs: the path with solids of 2^9 to 2^18 nodes, decided by balls alone, and by triangles.

use crate::Setting;
use crate::measured::Times;
use crate::report::Figure;
use crate::table::{Cell, Table};
use knotdock::Collision;
use knotdock::geometry::collide::{Method, Verdict, Workspace};
use knotdock_cli::plot::chart::{Axis, Panel, Series, Style};
use nalgebra::Vector3;
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
    /// Power of two of the nodes.
    power: u32,
    method: Method,
    /// As a share of the longest edge.
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
    /// Median of the energy over the exact one, at poses that meet.
    energy: f64,
    /// Median of the force's angle to the exact one there, in degrees.
    degrees: f64,
}

/// The table and the picture.
pub fn figure(setting: &Setting) -> Result<Figure, Box<dyn Error>> {
    let mut rows = Vec::new();
    for power in 9..=18 {
        rows.push(row(setting, power, Method::Tree)?);
    }
    let exact = row(setting, 15, Method::Auto)?;
    Ok(Figure {
        name: "collide_accuracy",
        panels: panels(&rows),
        tables: vec![("table", table(rows.iter().chain([&exact])))],
        columns: 2,
    })
}

fn row(setting: &Setting, power: u32, method: Method) -> Result<Row, Box<dyn Error>> {
    let start = Instant::now();
    let [a, b] = &setting.balls(2f64.powf(f64::from(power) / 3.0).round() as usize)?;
    let collision = Collision::new(a, b).force(true).method(method);
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
    let bands: Vec<f64> = taken
        .clone()
        .map(|pose| {
            let bounds = collision.query(&path[pose], &mut work).distance();
            bounds.high - bounds.low
        })
        .collect();
    let verdict = Times::of(path.len(), STRIDE, RUNS, |pose| {
        collision.query(&path[pose], &mut work).certificate()
    });
    let distance = Times::of(path.len(), STRIDE, RUNS, |pose| {
        collision.query(&path[pose], &mut work).distance()
    });
    let force = Times::of(path.len(), STRIDE, RUNS, |pose| {
        collision.query(&path[pose], &mut work).contact()
    });
    let exact = Collision::new(a, b).force(true);
    let (mut energies, mut degrees) = (Vec::new(), Vec::new());
    for pose in taken.clone() {
        let truth = exact.query(&path[pose], &mut work).contact();
        let ours = collision.query(&path[pose], &mut work).contact();
        let (Some(truth), Some(ours)) = (truth, ours) else {
            continue;
        };
        if truth.energy > 0.0 {
            let (force, other) = (Vector3::from(truth.force), Vector3::from(ours.force));
            energies.push(ours.energy / truth.energy);
            degrees.push(force.angle(&other).to_degrees());
        }
    }
    let spreads = [&verdict, &distance, &force].map(|times| times.spread(|_| true));
    Ok(Row {
        power,
        method,
        epsilon: a.epsilon() / setting.edge(),
        balls: a.inner().len(),
        making,
        undecided: undecided as f64 / taken.len() as f64,
        band: median(bands) / setting.edge(),
        micros: spreads.map(|spread| spread.map_or(f64::NAN, |spread| spread.median)),
        most: spreads[0].map_or(f64::NAN, |spread| spread.most),
        energy: median(energies),
        degrees: median(degrees),
    })
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(f64::NAN)
}

fn table<'a>(rows: impl Iterator<Item = &'a Row>) -> Table {
    let percent = |share: f64| Cell::Text(format!("{:.2}%", 100.0 * share));
    let row = |row: &Row| {
        vec![
            Cell::Text(match row.method {
                Method::Tree => format!("2^{}", row.power),
                _ => format!("2^{}, triangles", row.power),
            }),
            percent(row.epsilon),
            Cell::Text(row.balls.to_string()),
            Cell::Number(row.making),
            percent(row.undecided),
            percent(row.band),
            Cell::Number(row.micros[0]),
            Cell::Number(row.most),
            Cell::Number(row.micros[1]),
            Cell::Number(row.micros[2]),
            Cell::Number(row.energy),
            Cell::Number(row.degrees),
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
            "energy / shared volume",
            "force off (degrees)",
        ],
        rows: rows.map(row).collect(),
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
