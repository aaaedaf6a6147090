//! Figure 7: the gap function on a uniform grid, whole and from its m' dominant modes.
//!
//! It shows the time of every step, and the error of leaving out the other modes.

use crate::card::{Card, seconds};
use crate::report::{Figure, colour_of_grid, grid_name};
use crate::scene::Scene;
use crate::table::{Cell, Table};
use crate::timing::{least, timed};
use crate::whole::{Errors, Whole};
use knotdock_cli::plot::chart::Colour;
use knotdock_cli::plot::chart::{Axis, Panel, Series, Style};
use knotdock_scoring::gpu::GapGrid;
use knotdock_scoring::transform::truncation::{Selection, total};

/// Everything measured at one m'.
struct Row {
    per_axis: usize,
    modes: usize,
    dominant: Errors,
    low: Errors,
    size: [usize; 3],
    seconds: [f64; 2],
}

fn row(whole: &Whole, [dominant, low]: &[Selection; 2]) -> Row {
    let grid = whole.grid();
    let truncation = grid.truncate(dominant);
    let mut buffers = truncation.buffers();
    let spectra = whole.spectra();
    let multiplying = least(|| truncation.multiply(grid, spectra, &mut buffers));
    let inverse = least(|| truncation.inverse(&mut buffers));
    Row {
        per_axis: grid.per_axis,
        modes: dominant.modes(),
        dominant: whole.errors(dominant),
        low: whole.errors(low),
        size: truncation.size,
        seconds: [multiplying, inverse],
    }
}

/// The figure's tables and picture, from one correlation a grid size.
pub fn figure(correlations: &[(&Scene, &Whole)], card: Option<&Card>) -> Figure {
    let mut rows = Vec::new();
    for (_, whole) in correlations {
        let (seconds, of_grid) = timed(|| {
            let selections = whole.selections();
            selections
                .map(|(power, pair)| (power, row(whole, &pair)))
                .collect::<Vec<_>>()
        });
        let modes = total(&whole.grid().modes);
        eprintln!("figure 7: {modes} modes, {seconds:.1} s");
        rows.extend(of_grid);
    }
    Figure {
        name: "fig7",
        tables: vec![
            ("steps", steps(correlations, card)),
            ("truncated", table(&rows)),
        ],
        panels: panels(correlations, &rows),
        columns: 3,
    }
}

/// Seconds on the card of rasterising, and of transforms and product.
fn on_card(card: &Card, scene: &Scene, whole: &Whole) -> Option<[f64; 2]> {
    let balls = [&scene.bunny, &scene.peg].map(|body| body.knots());
    let grid = whole.grid();
    card.measure(|gpu| {
        let gap = GapGrid::new(gpu, [&balls[0], &balls[1]], grid.per_axis, grid.edge)?;
        Ok([seconds(&gap.rasterise)?, seconds(&gap.correlate)?])
    })
}

fn steps(correlations: &[(&Scene, &Whole)], card: Option<&Card>) -> Table {
    let milliseconds = |seconds: f64| Cell::Number(1e3 * seconds);
    Table {
        header: vec![
            "m",
            "bunny's balls",
            "peg's balls",
            "rasterise both (ms)",
            "two FFTs (ms)",
            "multiply (ms)",
            "inverse FFT (ms)",
            "transforms and product (ms)",
            "pairwise sums of balls (ms)",
            "rasterise both; card (ms)",
            "transforms and product; card (ms)",
        ],
        rows: correlations
            .iter()
            .map(|(scene, whole)| {
                let on_card = card.and_then(|card| on_card(card, scene, whole));
                vec![
                    Cell::Count(whole.values().len()),
                    Cell::Text(scene.bunny.radii.len().to_string()),
                    Cell::Text(scene.peg.radii.len().to_string()),
                    milliseconds(whole.rasterising),
                    milliseconds(whole.forward),
                    milliseconds(whole.multiplying),
                    milliseconds(whole.inverse),
                    milliseconds(whole.total()),
                    milliseconds(whole.pairwise),
                    Cell::milliseconds(on_card.map(|[rasterising, _]| rasterising)),
                    Cell::milliseconds(on_card.map(|[_, correlating]| correlating)),
                ]
            })
            .collect(),
    }
}

fn table(rows: &[(u32, Row)]) -> Table {
    Table {
        header: vec![
            "m",
            "m'",
            "modes kept",
            "rms error",
            "largest error",
            "other verdict",
            "rms error; lowest modes",
            "largest error; lowest modes",
            "grid of the inverse",
            "multiply (ms)",
            "inverse FFT (ms)",
        ],
        rows: rows
            .iter()
            .map(|(power, row)| {
                let [x, y, z] = row.size;
                vec![
                    Cell::Count(row.per_axis.pow(3)),
                    Cell::Count(1 << power),
                    Cell::Text(row.modes.to_string()),
                    Cell::Share(row.dominant.rms),
                    Cell::Share(row.dominant.worst),
                    Cell::Share(row.dominant.verdict),
                    Cell::Share(row.low.rms),
                    Cell::Share(row.low.worst),
                    Cell::Text(format!("{x}x{y}x{z}")),
                    Cell::Number(1e3 * row.seconds[0]),
                    Cell::Number(1e3 * row.seconds[1]),
                ]
            })
            .collect(),
    }
}

fn panels(correlations: &[(&Scene, &Whole)], rows: &[(u32, Row)]) -> Vec<Panel> {
    let across = || Axis::two("modes kept, m'");
    let [errors, times] = curves(correlations, rows);
    vec![
        Panel {
            title: "Error of m' dominant modes".to_owned(),
            across: across(),
            up: Axis::ten("rms (dashed: largest), share of peak"),
            series: errors,
        },
        Panel {
            title: "Product and inverse FFT over m' modes".to_owned(),
            across: across(),
            up: Axis::ten("processor time, ms"),
            series: times,
        },
        Panel {
            title: "The whole correlation".to_owned(),
            across: Axis::two("grid points, m"),
            up: Axis::ten("processor time, ms"),
            series: step_times(correlations),
        },
    ]
}

/// Error and processor time over m', by grid.
fn curves(correlations: &[(&Scene, &Whole)], rows: &[(u32, Row)]) -> [Vec<Series>; 2] {
    let curve = |whole: &Whole, style, name: &str, value: &dyn Fn(&Row) -> f64| Series {
        name: name.to_owned(),
        colour: colour_of_grid(whole.grid().per_axis),
        style,
        labels: Vec::new(),
        points: rows
            .iter()
            .filter(|(_, row)| row.per_axis == whole.grid().per_axis)
            .map(|(power, row)| [2f64.powi(*power as i32), value(row)])
            // All modes leave rounding alone, which says nothing and takes half of the axis.
            .filter(|point| point[1] > 1e-9)
            .collect(),
    };
    let mut errors = Vec::new();
    let mut times = Vec::new();
    for (_, whole) in correlations {
        let name = grid_name(whole.grid().per_axis);
        errors.push(curve(whole, Style::Line, &name, &|row| row.dominant.rms));
        errors.push(curve(whole, Style::Thin, "largest error", &|row| {
            row.dominant.worst
        }));
        times.push(curve(whole, Style::Line, &name, &|row| {
            1e3 * row.seconds.iter().sum::<f64>()
        }));
    }
    [errors, times]
}

/// Processor time of each step over the grid's size, beside the paper's.
fn step_times(correlations: &[(&Scene, &Whole)]) -> Vec<Series> {
    let step = |name: &str, colour, style, value: &dyn Fn(&Whole) -> f64| Series {
        name: name.to_owned(),
        colour,
        style,
        labels: Vec::new(),
        points: correlations
            .iter()
            .map(|(_, whole)| [whole.values().len() as f64, 1e3 * value(whole)])
            .collect(),
    };
    let paper = |name: &str, colour, point| Series {
        name: name.to_owned(),
        colour,
        style: Style::HollowDiscs,
        labels: Vec::new(),
        points: vec![point],
    };
    let line =
        |name: &str, colour, value: &dyn Fn(&Whole) -> f64| step(name, colour, Style::Line, value);
    const RED: Colour = [0xcc, 0x33, 0x11];
    const BROWN: Colour = [0x8b, 0x5a, 0x2b];
    vec![
        paper("paper: FFTs and product, K20c", RED, [2f64.powi(21), 80.0]),
        paper("paper: pairwise, 32 cores", BROWN, [2f64.powi(18), 104.0]),
        line("rasterise both", [0x99; 3], &|whole| whole.rasterising),
        line("two FFTs", [0x00, 0x72, 0xb2], &|whole| whole.forward),
        line("multiply", [0xcc, 0x79, 0xa7], &|whole| whole.multiplying),
        line("inverse FFT", [0x77, 0x33, 0x88], &|whole| whole.inverse),
        step("pairwise sums of balls", BROWN, Style::Dashed, &|whole| {
            whole.pairwise
        }),
        line("FFTs and product", RED, &Whole::total),
    ]
}
