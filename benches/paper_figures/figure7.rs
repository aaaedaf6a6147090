//! Figure 7: the gap function on a uniform grid, whole and from its m' dominant modes; the time of every step, the error of leaving out the
//! rest.

use crate::correlation::Grid;
use crate::report::{Figure, colour_of_grid, grid_name};
use crate::scene::Scene;
use crate::spectrum::Kernel;
use crate::table::{Cell, Table};
use crate::timing::{least, timed};
use knotdock::tradeoff::chart::{Axis, Panel, Series, Style};
use knotdock_scoring::transform::truncation::{Selection, total};
use std::hint::black_box;

/// Share of the peak from which two bodies count as colliding. A truncated function has no exact zeros to tell by.
const CONTACT: f64 = 1e-3;
/// Pairs of balls of which pairwise summation is timed; the time of all follows by their number.
const PAIRS: usize = 4_000_000;

/// The function of one grid size, and what its steps took, in seconds.
pub struct Whole {
    grid: Grid,
    spectra: [Vec<num_complex::Complex64>; 2],
    product: Vec<num_complex::Complex64>,
    values: Vec<f64>,
    peak: f64,
    rasterising: f64,
    forward: f64,
    multiplying: f64,
    inverse: f64,
    pairwise: f64,
}

/// Errors of a truncated function, as shares of the peak, and the share of the cube in which its verdict on collision is another.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// Root mean square.
    pub rms: f64,
    /// Largest.
    pub worst: f64,
    /// Share of grid points on the other side of `CONTACT`.
    pub verdict: f64,
}

/// Everything measured at one m'.
struct Row {
    per_axis: usize,
    modes: usize,
    dominant: Errors,
    low: Errors,
    size: [usize; 3],
    seconds: [f64; 2],
}

impl Whole {
    /// Correlates a scene and times every step.
    pub fn new(scene: &Scene, kernel: &Kernel) -> Self {
        let grid = Grid::new(scene.per_axis, scene.edge);
        let mut buffers = grid.buffers();
        let mut rasterising = 0.0;
        let mut forward = 0.0;
        let spectra = [&scene.bunny, &scene.peg].map(|body| {
            rasterising += least(|| grid.rasterise(body, kernel, &mut buffers));
            // The transform takes the same time whatever it is given.
            forward += least(|| grid.forward(&mut buffers));
            grid.rasterise(body, kernel, &mut buffers);
            grid.forward(&mut buffers);
            buffers.spectrum.clone()
        });
        let mut product = buffers.spectrum.clone();
        let multiplying = least(|| grid.multiply(&spectra[0], &spectra[1], &mut product));
        let inverse = least(|| grid.inverse(&mut buffers));
        buffers.spectrum.copy_from_slice(&product);
        grid.inverse(&mut buffers);
        let values = buffers.grid;
        Self {
            peak: values.iter().fold(0.0, |peak, value| peak.max(value.abs())),
            pairwise: pairwise(scene),
            grid,
            spectra,
            product,
            values,
            rasterising,
            forward,
            multiplying,
            inverse,
        }
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Spectrum of the function, Nyquist planes zero.
    pub fn product(&self) -> &[num_complex::Complex64] {
        &self.product
    }

    /// The function at the grid's points.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Its largest value.
    pub fn peak(&self) -> f64 {
        self.peak
    }

    /// What a selection of modes makes of the function.
    pub fn errors(&self, selection: &Selection) -> Errors {
        let mut buffers = self.grid.buffers();
        self.grid
            .keep(&self.product, selection, &mut buffers.spectrum);
        self.grid.inverse(&mut buffers);
        let (mut squares, mut worst, mut other) = (0.0, 0.0f64, 0usize);
        let contact = CONTACT * self.peak;
        for (value, truncated) in self.values.iter().zip(&buffers.grid) {
            let error = (value - truncated).abs();
            squares += error * error;
            worst = worst.max(error);
            other += usize::from((*value > contact) != (*truncated > contact));
        }
        let points = self.values.len() as f64;
        Errors {
            rms: (squares / points).sqrt() / self.peak,
            worst: worst / self.peak,
            verdict: other as f64 / points,
        }
    }

    /// Selections of at most 2^6, 2^7, ... modes, each with the power of two: dominant ones, and those of lowest frequency.
    pub fn selections(&self) -> impl Iterator<Item = (u32, [Selection; 2])> {
        let magnitudes = self.grid.magnitudes(&self.product);
        let modes = &self.grid.modes;
        let last = self.values.len().ilog2();
        (6..=last).map(move |power| {
            let most = 1 << power;
            let dominant = Selection::by_magnitude(modes, &magnitudes, most);
            (power, [dominant, Selection::low_frequency(modes, most)])
        })
    }

    fn row(&self, [dominant, low]: &[Selection; 2]) -> Row {
        let truncation = self.grid.truncate(dominant);
        let mut buffers = truncation.buffers();
        let spectra = [&self.spectra[0][..], &self.spectra[1][..]];
        let multiplying = least(|| truncation.multiply(&self.grid, spectra, &mut buffers));
        let inverse = least(|| truncation.inverse(&mut buffers));
        Row {
            per_axis: self.grid.per_axis,
            modes: dominant.modes(),
            dominant: self.errors(dominant),
            low: self.errors(low),
            size: truncation.size,
            seconds: [multiplying, inverse],
        }
    }

    fn total(&self) -> f64 {
        self.forward + self.multiplying + self.inverse
    }
}

/// Seconds of forming the sum of every two balls, one of each body: the Minkowski sum in four dimensions.
fn pairwise(scene: &Scene) -> f64 {
    let rows = (PAIRS / scene.peg.radii.len()).clamp(1, scene.bunny.radii.len());
    let mut sums = vec![[0.0; 4]; rows * scene.peg.radii.len()];
    let balls = || scene.bunny.centers.iter().zip(&scene.bunny.radii);
    let seconds = least(|| {
        let rows = balls().zip(sums.chunks_exact_mut(scene.peg.radii.len()));
        for ((x, r), row) in rows {
            let others = scene.peg.centers.iter().zip(&scene.peg.radii);
            for (sum, (y, s)) in row.iter_mut().zip(others) {
                *sum = [x[0] - y[0], x[1] - y[1], x[2] - y[2], r + s];
            }
        }
        black_box(&mut sums);
    });
    seconds * scene.bunny.radii.len() as f64 / rows as f64
}

/// The figure's tables and picture, from one correlation a grid size.
pub fn figure(correlations: &[(&Scene, &Whole)]) -> Figure {
    let mut rows = Vec::new();
    for (_, whole) in correlations {
        let (seconds, of_grid) = timed(|| {
            let selections = whole.selections();
            selections
                .map(|(power, pair)| (power, whole.row(&pair)))
                .collect::<Vec<_>>()
        });
        let modes = total(&whole.grid.modes);
        eprintln!("figure 7: {modes} modes, {seconds:.1} s");
        rows.extend(of_grid);
    }
    Figure {
        name: "fig7",
        tables: vec![("steps", steps(correlations)), ("truncated", table(&rows))],
        panels: panels(correlations, &rows),
        columns: 3,
    }
}

fn steps(correlations: &[(&Scene, &Whole)]) -> Table {
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
        ],
        rows: correlations
            .iter()
            .map(|(scene, whole)| {
                vec![
                    Cell::Count(whole.values.len()),
                    Cell::Text(scene.bunny.radii.len().to_string()),
                    Cell::Text(scene.peg.radii.len().to_string()),
                    milliseconds(whole.rasterising),
                    milliseconds(whole.forward),
                    milliseconds(whole.multiplying),
                    milliseconds(whole.inverse),
                    milliseconds(whole.total()),
                    milliseconds(whole.pairwise),
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
    let curve = |whole: &Whole, style, suffix: &str, value: &dyn Fn(&Row) -> f64| Series {
        name: format!("{}{suffix}", grid_name(whole.grid.per_axis)),
        colour: colour_of_grid(whole.grid.per_axis),
        style,
        points: rows
            .iter()
            .filter(|(_, row)| row.per_axis == whole.grid.per_axis)
            .map(|(power, row)| [2f64.powi(*power as i32), value(row)])
            // All modes leave rounding alone, which says nothing and takes half of the axis.
            .filter(|point| point[1] > 1e-9)
            .collect(),
    };
    let across = || Axis::two("modes kept, m'");
    let mut errors = Vec::new();
    let mut times = Vec::new();
    for (_, whole) in correlations {
        errors.push(curve(whole, Style::Line, "", &|row| row.dominant.rms));
        errors.push(curve(whole, Style::Guide, ", largest error", &|row| row.dominant.worst));
        times.push(curve(whole, Style::Line, "", &|row| {
            1e3 * row.seconds.iter().sum::<f64>()
        }));
    }
    let step = |name: &str, colour, style, value: &dyn Fn(&Whole) -> f64| Series {
        name: name.to_owned(),
        colour,
        style,
        points: correlations
            .iter()
            .map(|(_, whole)| [whole.values.len() as f64, 1e3 * value(whole)])
            .collect(),
    };
    let steps = vec![
        step("rasterise both", [0x99, 0x99, 0x99], Style::Line, &|whole| whole.rasterising),
        step("two FFTs", [0x56, 0xb4, 0xe9], Style::Line, &|whole| whole.forward),
        step("multiply", [0x8b, 0x5a, 0x2b], Style::Line, &|whole| whole.multiplying),
        step("inverse FFT", [0xaa, 0x33, 0x77], Style::Line, &|whole| whole.inverse),
        step("pairwise sums of balls", [0xe6, 0x9f, 0x00], Style::Dashed, &|whole| whole.pairwise),
        Series {
            name: "paper: FFTs and product on a K20c".to_owned(),
            colour: [0xcc, 0, 0],
            style: Style::HollowDiscs,
            points: vec![[2f64.powi(21), 80.0]],
        },
        step("FFTs and product", [0, 0, 0], Style::Line, &Whole::total),
    ];
    vec![
        Panel {
            title: "Error of m' dominant modes".to_owned(),
            across: across(),
            up: Axis::ten("rms, share of the peak"),
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
            series: steps,
        },
    ]
}
