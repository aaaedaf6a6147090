//! Figure 9: one configuration from m' dominant modes: value and force at one relative place, with time and error.
//!
//! A new rotation needs a new spectrum of the peg's balls before that; its time is shown as well.

use crate::card::{Card, seconds};
use crate::report::{Figure, colour_of_grid, grid_name};
use crate::scene::Scene;
use crate::table::{Cell, Table};
use crate::timing::least;
use crate::whole::Whole;
use knotdock::geometry::gap::expansion::{Expansion, Task};
use knotdock::geometry::gap::spectrum::{FrequencyBox, Kernel};
use knotdock::geometry::gap::ways::{Points, fast, planned};
use knotdock_cli::plot::chart::{Axis, Panel, Series, Style};
use knotdock_scoring::gpu::WaveSums;
use knotdock_scoring::transform::truncation::Selection;
use knotdock_scoring::truncated::RotationSpectrum;
use nalgebra::Vector3;
use std::error::Error;

/// Configurations whose errors are measured.
const PLACES: usize = 200;
/// Configurations that are timed in one go: more where each takes less.
const WORK: usize = 200_000;
/// Configurations that the card computes together.
const TOGETHER: usize = 1_000_000;
/// Error of a new rotation's spectrum, as a share of its value at frequency zero.
const TOLERANCE: f64 = 1e-3;
/// Modes below which the paper computes a configuration in less than a millisecond.
const PAPER_MODES: f64 = 4096.0;

struct Row {
    per_axis: usize,
    power: u32,
    modes: usize,
    seconds: f64,
    turning: f64,
    rms: f64,
    worst: f64,
    /// Seconds of one configuration of many on the card.
    card: Option<f64>,
}

/// The function of the selected modes, ready for one configuration at a time.
pub fn prepared(whole: &Whole, selection: &Selection) -> RotationSpectrum {
    let grid = whole.grid();
    RotationSpectrum::from_spectrum(&grid.modes, selection, |mode| {
        grid.mode(whole.product(), mode)
    })
}

/// Grid points at which the bodies touch or overlap, spread over them, each with its place in the cube about the
/// origin and the whole function's value there.
pub fn places(whole: &Whole, count: usize) -> Vec<(Vector3<f64>, f64)> {
    let grid = whole.grid();
    let n = grid.per_axis;
    let h = grid.edge / n as f64;
    let touching: Vec<usize> = (0..whole.values().len())
        .filter(|&point| whole.values()[point] > 1e-4 * whole.peak())
        .collect();
    let step = (touching.len() / count.max(1)).max(1) | 1;
    let coordinate = |index: usize| {
        let signed = if 2 * index >= n {
            index as f64 - n as f64
        } else {
            index as f64
        };
        signed * h
    };
    touching
        .iter()
        .step_by(step)
        .map(|&point| {
            let place = [point / (n * n), point / n % n, point % n].map(coordinate);
            (Vector3::from(place), whole.values()[point])
        })
        .collect()
}

/// Seconds of the peg's spectrum at its m' lowest frequencies, by the fast transform after compressing the radius.
fn turning(scene: &Scene, kernel: &Kernel, power: u32) -> Result<f64, Box<dyn Error>> {
    let frequencies = FrequencyBox::of_power(power);
    let expansion = Expansion::compressed(&Task {
        body: &scene.peg,
        kernel,
        edge: scene.edge,
        frequencies,
        tolerance: 0.5 * TOLERANCE,
    });
    let points = Points::new(&scene.peg, scene.edge, frequencies, &expansion);
    let mut plan = planned(&points, 0.5 * TOLERANCE)?;
    fast(&points, &mut plan)?;
    Ok(least(|| fast(&points, &mut plan)))
}

/// Seconds of one configuration of a million on the card, or of fewer if there are many modes.
fn on_card(card: &Card, whole: &Whole, selection: &Selection) -> Option<f64> {
    let grid = whole.grid();
    let (mut frequencies, mut values) = (Vec::new(), Vec::new());
    for column in &grid.modes.columns {
        for (index, kx) in (-column.kx_max..=column.kx_max).enumerate() {
            let mode = column.start + index;
            if selection.keeps(mode) {
                // The conjugates are not held.
                let factor = if column.kz == 0 { 1.0 } else { 2.0 };
                frequencies.push([kx, column.ky, column.kz]);
                values.push(factor * grid.mode(whole.product(), mode));
            }
        }
    }
    let count = TOGETHER.min(card.most_sums(values.len()));
    // Spread over the cube by steps without a common measure.
    let places: Vec<[f64; 3]> = (0..count)
        .map(|index| [0.819_173, 0.671_044, 0.549_700].map(|step| (index as f64 * step).fract()))
        .collect();
    let seconds =
        card.measure(|gpu| seconds(&WaveSums::adjoint(gpu, &frequencies, &values, &places)?.job))?;
    Some(seconds / count as f64)
}

fn row(
    whole: &Whole,
    card: Option<&Card>,
    power: u32,
    selection: &Selection,
    places: &[(Vector3<f64>, f64)],
    turning: f64,
) -> Row {
    let prepared = prepared(whole, selection);
    let mut work = prepared.workspace();
    let errors: Vec<f64> = places
        .iter()
        .map(|(place, value)| (prepared.gradient(place, &mut work).0 - value).abs() / whole.peak())
        .collect();
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    let together = (WORK >> power).clamp(1, places.len());
    let seconds = least(|| {
        let values = places[..together]
            .iter()
            .map(|(place, _)| prepared.gradient(place, &mut work).0);
        values.sum::<f64>()
    });
    Row {
        per_axis: whole.grid().per_axis,
        power,
        modes: selection.modes(),
        seconds: seconds / together as f64,
        turning,
        rms: (squares / errors.len() as f64).sqrt(),
        worst: errors.iter().copied().fold(0.0, f64::max),
        card: card.and_then(|card| on_card(card, whole, selection)),
    }
}

/// The figure's table and picture, from one correlation a grid size.
///
/// # Errors
/// If a transform cannot be planned.
pub fn figure(
    correlations: &[(&Scene, &Kernel, &Whole)],
    card: Option<&Card>,
) -> Result<Figure, Box<dyn Error>> {
    let mut rows = Vec::new();
    for (scene, kernel, whole) in correlations {
        let places = places(whole, PLACES);
        for (power, [dominant, _]) in whole.selections() {
            let turning = turning(scene, kernel, power)?;
            rows.push(row(whole, card, power, &dominant, &places, turning));
        }
    }
    let wholes: Vec<&Whole> = correlations.iter().map(|(_, _, whole)| *whole).collect();
    Ok(Figure {
        name: "fig9",
        tables: vec![("configuration", table(&rows))],
        panels: panels(&wholes, &rows),
        columns: 2,
    })
}

fn table(rows: &[Row]) -> Table {
    Table {
        header: vec![
            "m",
            "m'",
            "modes kept",
            "one configuration (ms)",
            "ns a mode",
            "rms error",
            "largest error",
            "new rotation (ms)",
            "one of a million; card (ns)",
        ],
        rows: rows
            .iter()
            .map(|row| {
                vec![
                    Cell::Count(row.per_axis.pow(3)),
                    Cell::Count(1 << row.power),
                    Cell::Text(row.modes.to_string()),
                    Cell::Number(1e3 * row.seconds),
                    Cell::Number(1e9 * row.seconds / row.modes as f64),
                    Cell::Share(row.rms),
                    Cell::Share(row.worst),
                    Cell::Number(1e3 * row.turning),
                    row.card.map_or(Cell::None, |card| Cell::Number(1e9 * card)),
                ]
            })
            .collect(),
    }
}

fn panels(correlations: &[&Whole], rows: &[Row]) -> Vec<Panel> {
    let curve = |per_axis: usize, place: &dyn Fn(&Row) -> [f64; 2]| Series {
        name: grid_name(per_axis),
        colour: colour_of_grid(per_axis),
        style: Style::Line,
        labels: Vec::new(),
        points: rows
            .iter()
            .filter(|row| row.per_axis == per_axis && row.rms > 1e-9)
            .map(place)
            .collect(),
    };
    let all = |place: &dyn Fn(&Row) -> [f64; 2]| -> Vec<Series> {
        correlations
            .iter()
            .map(|whole| curve(whole.grid().per_axis, place))
            .collect()
    };
    let mut times = vec![Series {
        name: "one millisecond".to_owned(),
        colour: [0xaa, 0xaa, 0xaa],
        style: Style::Guide,
        labels: Vec::new(),
        points: vec![[1.0, 1.0], [1e9, 1.0]],
    }];
    times.extend(correlations.iter().map(|whole| Series {
        name: "a new rotation before it".to_owned(),
        style: Style::Thin,
        ..curve(whole.grid().per_axis, &|row| {
            [2f64.powi(row.power as i32), 1e3 * row.turning]
        })
    }));
    times.extend(all(&|row| [row.modes as f64, 1e3 * row.seconds]));
    times.push(Series {
        name: "paper: 1 ms at 2^12 modes".to_owned(),
        colour: [0xcc, 0, 0],
        style: Style::HollowDiscs,
        labels: Vec::new(),
        points: vec![[PAPER_MODES, 1.0]],
    });
    vec![
        Panel {
            title: "Time of one configuration".to_owned(),
            across: Axis::two("modes kept, m'"),
            up: Axis::ten("processor time, ms"),
            series: times,
        },
        Panel {
            title: "What the time buys".to_owned(),
            across: Axis::ten("processor time of one configuration, ms"),
            up: Axis::ten("rms error, share of the peak"),
            series: all(&|row| [1e3 * row.seconds, row.rms]),
        },
    ]
}
