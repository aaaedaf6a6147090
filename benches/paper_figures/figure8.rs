//! Figure 8: the bunny's spectrum at its m' lowest frequencies.
//!
//! One way is a rasterised grid of m points and its FFT. The others start from the balls themselves: the direct 4D sum
//! (NDFT), the 4D fast transform, and both after compressing the radius.

use crate::card::Card;
use crate::report::{Figure, grid_name};
use crate::scene::Scene;
use crate::table::{Cell, Table};
use crate::timing::timed;
use crate::ways_measured::{Measured, OfGrid, measure};
use knotdock::geometry::gap::spectrum::Kernel;
use knotdock_cli::plot::chart::Colour;
use knotdock_cli::plot::chart::{Axis, Panel, Series, Style};
use std::error::Error;

/// The ways in the order in which they are measured.
const NAMES: [&str; 4] = [
    "4D NDFT (the paper's way)",
    "4D NFFT",
    "NDFT, radius compressed",
    "NFFT, radius compressed (ours)",
];
const COLOURS: [Colour; 4] = [
    [0xd5, 0x5e, 0x00],
    [0xe6, 0x9f, 0x00],
    [0x56, 0xb4, 0xe9],
    [0x00, 0x72, 0xb2],
];

/// The figure's tables and picture.
///
/// # Errors
/// If a transform cannot be planned.
pub fn figure(scenes: &[(&Scene, &Kernel)], card: Option<&Card>) -> Result<Figure, Box<dyn Error>> {
    let mut grids = Vec::new();
    for (scene, kernel) in scenes {
        let (seconds, of_grid) = timed(|| measure(scene, kernel, card));
        eprintln!(
            "figure 8: {} points per axis, {seconds:.1} s",
            scene.per_axis
        );
        grids.push(of_grid?);
    }
    Ok(Figure {
        name: "fig8",
        tables: vec![("crossings", crossings(&grids)), ("times", times(&grids))],
        panels: grids.iter().map(panel).collect(),
        columns: 2,
    })
}

/// Up to which m' each way beats the grid, as a power of two.
fn crossings(grids: &[OfGrid]) -> Table {
    let mut header = vec!["m", "bunny's balls", "rasterise (ms)", "FFT (ms)"];
    header.extend([
        "4D NDFT wins up to m' =",
        "which is 4D modes",
        "4D NFFT",
        "NDFT; radius compressed",
        "NFFT; radius compressed",
    ]);
    let rows = grids.iter().map(|grid| {
        let power = |way: usize| {
            let first = grid.rows.first().map_or(0.0, |row| row.ways[way].seconds);
            Cell::Text(match grid.crossing(way) {
                Some(modes) => format!("2^{:.1}", modes.log2()),
                None if first < grid.raster() => "all".to_owned(),
                None => "none".to_owned(),
            })
        };
        let lifted = grid.crossing(0).map_or(Cell::None, |modes| {
            let below = grid
                .rows
                .iter()
                .rfind(|row| 2f64.powi(row.power as i32) <= modes);
            let per_mode = below.map_or(1, |row| row.lifted_modes);
            Cell::Text(format!("2^{:.1}", (modes * per_mode as f64).log2()))
        });
        vec![
            Cell::Count(grid.per_axis.pow(3)),
            Cell::Text(grid.balls.to_string()),
            Cell::Number(1e3 * grid.rasterising),
            Cell::Number(1e3 * grid.forward),
            power(0),
            lifted,
            power(1),
            power(2),
            power(3),
        ]
    });
    Table {
        header,
        rows: rows.collect(),
    }
}

fn times(grids: &[OfGrid]) -> Table {
    let header = vec![
        "m",
        "m'",
        "rasterise + FFT (ms)",
        "its error",
        "lifted modes",
        "4D NDFT (ms)",
        "4D NDFT; card (ms)",
        "4D NFFT (ms)",
        "its error",
        "rank",
        "NDFT; radius compressed (ms)",
        "NFFT; radius compressed (ms)",
        "its error",
        "scaled up",
    ];
    let time = |measured: &Measured| {
        let milliseconds = 1e3 * measured.seconds;
        if measured.scaled {
            Cell::Scaled(milliseconds)
        } else {
            Cell::Number(milliseconds)
        }
    };
    let mut rows = Vec::new();
    for grid in grids {
        for row in &grid.rows {
            let [literal, lifted, plain, ours] = &row.ways;
            let scaled: Vec<&str> = [(literal, "4D NDFT"), (plain, "NDFT")]
                .iter()
                .filter(|(way, _)| way.scaled)
                .map(|(_, name)| *name)
                .collect();
            rows.push(vec![
                Cell::Count(grid.per_axis.pow(3)),
                Cell::Count(1 << row.power),
                Cell::Number(1e3 * grid.raster()),
                Cell::Share(row.raster_error),
                Cell::Text(row.lifted_modes.to_string()),
                time(literal),
                row.card.as_ref().map_or(Cell::None, time),
                time(lifted),
                Cell::Share(lifted.error),
                Cell::Text(row.rank.to_string()),
                time(plain),
                time(ours),
                Cell::Share(ours.error),
                Cell::Text(scaled.join(" and ")),
            ]);
        }
    }
    Table { header, rows }
}

fn panel(grid: &OfGrid) -> Panel {
    let ends = [64.0, grid.per_axis.pow(3) as f64];
    let mut series = vec![
        Series {
            name: "paper: NDFT wins left of 2^16 (CPU), for m > 2^15".to_owned(),
            colour: [0xcc, 0x79, 0xa7],
            style: Style::Guide,
            labels: Vec::new(),
            points: vec![[2f64.powi(16), 1e-9], [2f64.powi(16), 1e9]],
        },
        Series {
            name: "paper: left of 2^12 (GPU), for m > 2^18".to_owned(),
            colour: [0xaa, 0xaa, 0xaa],
            style: Style::Guide,
            labels: Vec::new(),
            points: vec![[2f64.powi(12), 1e-9], [2f64.powi(12), 1e9]],
        },
        Series {
            name: "rasterise + 3D FFT".to_owned(),
            colour: [0, 0, 0],
            style: Style::Line,
            labels: Vec::new(),
            points: ends.map(|modes| [modes, 1e3 * grid.raster()]).to_vec(),
        },
    ];
    // A line of the paper's that does not hold at this grid size is left out.
    if grid.per_axis <= 64 {
        series.remove(1);
    }
    if grid.per_axis <= 32 {
        series.remove(0);
    }
    for way in 0..NAMES.len() {
        let curve = |scaled: bool| -> Vec<[f64; 2]> {
            let rows = grid
                .rows
                .iter()
                .filter(|row| row.ways[way].scaled == scaled);
            rows.map(|row| [2f64.powi(row.power as i32), 1e3 * row.ways[way].seconds])
                .collect()
        };
        let (measured, scaled) = (curve(false), curve(true));
        if !scaled.is_empty() {
            let joined = measured.last().copied().into_iter().chain(scaled);
            series.push(Series {
                name: "scaled up from a share".to_owned(),
                colour: COLOURS[way],
                style: Style::Dashed,
                labels: Vec::new(),
                points: joined.collect(),
            });
        }
        series.push(Series {
            name: NAMES[way].to_owned(),
            colour: COLOURS[way],
            style: Style::Line,
            labels: Vec::new(),
            points: measured,
        });
    }
    Panel {
        title: format!("{}, {} balls", grid_name(grid.per_axis), grid.balls),
        across: Axis::two("frequencies, m'"),
        up: Axis::ten("processor time, ms"),
        series,
    }
}
