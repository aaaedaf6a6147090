//! Figure 8: the bunny's spectrum at its m' lowest frequencies, by a rasterised grid of m points and its FFT, and from the balls
//! themselves: by the direct 4D sum (NDFT), by the 4D fast transform, and by both after compressing the radius.

use crate::correlation::Grid;
use crate::crossing::crossing;
use crate::lifted::{Expansion, Task};
use crate::report::Figure;
use crate::scene::Scene;
use crate::spectrum::{FrequencyBox, Kernel, exact};
use crate::table::{Cell, Table};
use crate::timing::{least, timed};
use crate::ways::{Points, direct, direct_share, fast_3d, fast_4d, plan_3d, plan_4d};
use knotdock::tradeoff::chart::{Axis, Panel, Series, Style};
use knotdock::tradeoff::drawing::Colour;
use num_complex::Complex64;
use std::error::Error;

/// Bounds of the error that the ways without a grid are allowed, as a share of the value at frequency zero. Between them it is what the
/// grid itself makes at the same frequencies, so that like is compared with like: half for the expansion, half for the transform.
const TOLERANCE: [f64; 2] = [1e-6, 1e-2];
/// Multiplications above which only a share of the direct sums is timed: about a third of a second.
const SHARE: f64 = 4e8;
/// Frequencies at which errors are measured.
const CHECKED: usize = 300;

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

/// One way at one m'.
#[derive(Clone, Copy, Debug)]
struct Measured {
    seconds: f64,
    error: f64,
    scaled: bool,
}

struct Row {
    power: u32,
    lifted_modes: usize,
    rank: usize,
    /// Error of the grid at these frequencies.
    raster_error: f64,
    /// In the order of `NAMES`.
    ways: [Measured; 4],
}

struct OfGrid {
    per_axis: usize,
    balls: usize,
    rasterising: f64,
    forward: f64,
    rows: Vec<Row>,
}

impl OfGrid {
    fn raster(&self) -> f64 {
        self.rasterising + self.forward
    }

    /// m' up to which a way needs less time than the grid.
    fn crossing(&self, way: usize) -> Option<f64> {
        crossing(&self.curve(way), self.raster())
    }

    fn curve(&self, way: usize) -> Vec<[f64; 2]> {
        let rows = self.rows.iter();
        rows.map(|row| [2f64.powi(row.power as i32), row.ways[way].seconds])
            .collect()
    }
}

/// Largest error of values at chosen places of a box, as a share of the value at frequency zero, which is the first.
fn error(reference: &[Complex64], value: impl Fn(usize) -> Complex64) -> f64 {
    let errors = reference
        .iter()
        .enumerate()
        .map(|(index, exact)| (exact - value(index)).norm());
    errors.fold(0.0, f64::max) / reference[0].norm()
}

fn measure(scene: &Scene, kernel: &Kernel) -> Result<OfGrid, Box<dyn Error>> {
    let body = &scene.bunny;
    let grid = Grid::new(scene.per_axis, scene.edge);
    let mut buffers = grid.buffers();
    let rasterising = least(|| grid.rasterise(body, kernel, &mut buffers));
    let forward = least(|| grid.forward(&mut buffers));
    grid.rasterise(body, kernel, &mut buffers);
    grid.forward(&mut buffers);
    let mut rows = Vec::new();
    for power in 6..=scene.per_axis.pow(3).ilog2() {
        let frequencies = FrequencyBox::of_power(power);
        let places = frequencies.sample(CHECKED);
        let at = |index: usize| frequencies.frequency(places[index]);
        let reference: Vec<Complex64> = (0..places.len())
            .map(|index| exact(body, kernel, scene.edge, at(index)))
            .collect();
        let raster_error = error(&reference, |index| {
            grid.transform_at(&buffers.spectrum, at(index))
        });
        let tolerance = 0.5 * raster_error.clamp(TOLERANCE[0], TOLERANCE[1]);
        let task = Task {
            body,
            kernel,
            edge: scene.edge,
            frequencies,
            tolerance,
        };
        let checked = |seconds: f64, values: &[Complex64]| Measured {
            seconds,
            error: error(&reference, |index| values[places[index]]),
            scaled: false,
        };
        // What one way holds is freed before the next begins: the 4D transform of the largest box takes a gigabyte.
        let series = Expansion::series(&task);
        let points = Points::new(body, scene.edge, frequencies, &series);
        let (literal, lifted) = {
            let mut fast = plan_4d(&points, tolerance)?;
            let values = fast_4d(&points, &mut fast)?;
            let seconds = least(|| fast_4d(&points, &mut fast));
            let lifted = checked(seconds, &values);
            // The direct sums differ from the fast ones by the transform's tolerance alone; where they take too long a share is timed.
            (by_direct_sums(&points, &reference, &places), lifted)
        };
        let compressed = Expansion::compressed(&task);
        let points = Points::new(body, scene.edge, frequencies, &compressed);
        let mut fast = plan_3d(&points, tolerance)?;
        let values = fast_3d(&points, &mut fast)?;
        let ours = checked(least(|| fast_3d(&points, &mut fast)), &values);
        rows.push(Row {
            power,
            lifted_modes: series.len(),
            rank: compressed.len(),
            raster_error,
            ways: [
                literal,
                lifted,
                by_direct_sums(&points, &reference, &places),
                ours,
            ],
        });
    }
    Ok(OfGrid {
        per_axis: scene.per_axis,
        balls: body.radii.len(),
        rasterising,
        forward,
        rows,
    })
}

/// The direct sums: all of them, or the time of a share, with no error then.
fn by_direct_sums(points: &Points, reference: &[Complex64], places: &[usize]) -> Measured {
    let share = SHARE / points.direct_cost();
    let layers = points.layers();
    if share >= 1.0 {
        let values = direct(points);
        return Measured {
            seconds: least(|| direct(points)),
            error: error(reference, |index| values[places[index]]),
            scaled: false,
        };
    }
    let timed_layers = ((share * layers as f64) as usize).max(1);
    let seconds = least(|| direct_share(points, timed_layers));
    Measured {
        seconds: seconds * layers as f64 / timed_layers as f64,
        error: f64::NAN,
        scaled: timed_layers < layers,
    }
}

/// The figure's tables and picture.
///
/// # Errors
/// Where a transform cannot be planned.
pub fn figure(scenes: &[(&Scene, &Kernel)]) -> Result<Figure, Box<dyn Error>> {
    let mut grids = Vec::new();
    for (scene, kernel) in scenes {
        let (seconds, of_grid) = timed(|| measure(scene, kernel));
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
            points: vec![[2f64.powi(16), 1e-9], [2f64.powi(16), 1e9]],
        },
        Series {
            name: "paper: left of 2^12 (GPU), for m > 2^18".to_owned(),
            colour: [0xaa, 0xaa, 0xaa],
            style: Style::Guide,
            points: vec![[2f64.powi(12), 1e-9], [2f64.powi(12), 1e9]],
        },
        Series {
            name: "rasterise + 3D FFT".to_owned(),
            colour: [0, 0, 0],
            style: Style::Line,
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
                points: joined.collect(),
            });
        }
        series.push(Series {
            name: NAMES[way].to_owned(),
            colour: COLOURS[way],
            style: Style::Line,
            points: measured,
        });
    }
    Panel {
        title: format!(
            "{}, {} balls",
            crate::report::grid_name(grid.per_axis),
            grid.balls
        ),
        across: Axis::two("frequencies, m'"),
        up: Axis::ten("processor time, ms"),
        series,
    }
}
