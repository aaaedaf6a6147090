//! A body's spectrum at its m' lowest frequencies: what each way takes, with no larger an error than the grid's.

use crate::card::{Card, seconds};
use crate::crossing::crossing;
use crate::scene::Scene;
use crate::timing::least;
use knotdock::geometry::gap::expansion::{Expansion, Task};
use knotdock::geometry::gap::grid::Grid;
use knotdock::geometry::gap::lifted;
use knotdock::geometry::gap::spectrum::{FrequencyBox, Kernel, exact};
use knotdock::geometry::gap::ways::{Points, direct, fast, planned};
use knotdock_scoring::gpu::WaveSums;
use knotdock_scoring::transform::direct::forward as direct_sums;
use num_complex::Complex64;
use std::error::Error;

/// Bounds of the error that the ways without a grid are allowed, as a share of the value at frequency zero. Between
/// them it is the grid's own error at the same frequencies, so that like is compared with like: half for the expansion,
/// half for the transform.
const TOLERANCE: [f64; 2] = [1e-6, 1e-2];
/// Multiplications above which only a share of the direct sums is timed: about a third of a second.
const SHARE: f64 = 4e8;
/// Frequencies at which errors are measured.
const CHECKED: usize = 300;

/// One way at one m'.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// Processor time.
    pub seconds: f64,
    /// Largest error at the frequencies checked, as a share of the value at frequency zero; not a number where only a
    /// share was done.
    pub error: f64,
    /// Whether the time was scaled up from a share of the work.
    pub scaled: bool,
}

/// Everything measured at one m'.
pub struct Row {
    /// m' as a power of two.
    pub power: u32,
    /// Modes of the series along the radius.
    pub lifted_modes: usize,
    /// Rank of the compressed radius.
    pub rank: usize,
    /// Error of the grid at these frequencies.
    pub raster_error: f64,
    /// 4D NDFT, 4D NFFT, NDFT and NFFT with the radius compressed.
    pub ways: [Measured; 4],
    /// The 4D sums on the card, without the product.
    pub card: Option<Measured>,
}

/// Everything measured at one grid size.
pub struct OfGrid {
    /// Grid points per axis.
    pub per_axis: usize,
    /// The bunny's balls.
    pub balls: usize,
    /// Seconds of sampling the body.
    pub rasterising: f64,
    /// Seconds of its transform.
    pub forward: f64,
    /// By rising m'.
    pub rows: Vec<Row>,
}

impl OfGrid {
    /// Seconds of the grid's way, whatever m'.
    pub fn raster(&self) -> f64 {
        self.rasterising + self.forward
    }

    /// m' up to which a way needs less time than the grid.
    pub fn crossing(&self, way: usize) -> Option<f64> {
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

/// Measures all ways at all m' of one grid size.
///
/// # Errors
/// If a transform cannot be planned.
pub fn measure(
    scene: &Scene,
    kernel: &Kernel,
    card: Option<&Card>,
) -> Result<OfGrid, Box<dyn Error>> {
    let body = &scene.bunny;
    let grid = Grid::new(scene.per_axis, scene.edge);
    let mut buffers = grid.buffers();
    let rasterising = least(|| grid.rasterise(&body.knots(), &kernel.bump, &mut buffers));
    let forward = least(|| grid.forward(&mut buffers));
    grid.rasterise(&body.knots(), &kernel.bump, &mut buffers);
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
        let (series, period) = lifted::series(&task);
        let points = Points::new(body, scene.edge, frequencies, &series);
        let lifted = {
            let mut plan = lifted::planned(&points, &body.radii, period, tolerance)?;
            let values = lifted::fast(&points, &mut plan)?;
            checked(least(|| lifted::fast(&points, &mut plan)), &values)
        };
        // The direct sums differ from the fast ones by the transform's tolerance alone; if they take too long a share
        // is timed.
        let literal = by_direct_sums(&points, &reference, &places);
        let heights: Vec<f64> = body.radii.iter().map(|radius| radius / period).collect();
        let card = card.and_then(|card| on_card(card, &points, &heights));
        let compressed = Expansion::compressed(&task);
        let points = Points::new(body, scene.edge, frequencies, &compressed);
        let mut plan = planned(&points, tolerance)?;
        let values = fast(&points, &mut plan)?;
        let ours = checked(least(|| fast(&points, &mut plan)), &values);
        rows.push(Row {
            power,
            lifted_modes: series.rank(),
            rank: compressed.rank(),
            raster_error,
            ways: [
                literal,
                lifted,
                by_direct_sums(&points, &reference, &places),
                ours,
            ],
            card,
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

/// The direct 4D sums on the card, of all frequencies or the first of them.
fn on_card(card: &Card, points: &Points, heights: &[f64]) -> Option<Measured> {
    let lifted: Vec<[f64; 4]> = (points.centers.iter().zip(heights))
        .map(|([x, y, z], r)| [*x, *y, *z, *r])
        .collect();
    let (held, rank) = (points.frequencies.count() / 2, points.expansion.rank());
    let timed = (held * rank).min(card.most_sums(lifted.len()));
    let frequencies: Vec<[i32; 4]> = (0..timed)
        .map(|index| {
            let [x, y, z] = points.frequencies.frequency(index / rank);
            [x, y, z, (index % rank) as i32 - (rank / 2) as i32]
        })
        .collect();
    let weights = vec![Complex64::new(1.0, 0.0); lifted.len()];
    let seconds =
        card.measure(|gpu| seconds(&WaveSums::forward(gpu, &lifted, &weights, &frequencies)?.job))?;
    Some(Measured {
        seconds: seconds * (held * rank) as f64 / timed as f64,
        error: f64::NAN,
        scaled: timed < held * rank,
    })
}

/// The direct sums: all of them, or the time of a share, with no error then.
fn by_direct_sums(points: &Points, reference: &[Complex64], places: &[usize]) -> Measured {
    let share = SHARE / direct_cost(points);
    let planes = points.frequencies.half()[0];
    if share >= 1.0 {
        let values = direct(points);
        return Measured {
            seconds: least(|| direct(points)),
            error: error(reference, |index| values[places[index]]),
            scaled: false,
        };
    }
    let timed_planes = ((share * planes as f64) as usize).max(1);
    let seconds = least(|| direct_share(points, timed_planes));
    Measured {
        seconds: seconds * planes as f64 / timed_planes as f64,
        error: f64::NAN,
        scaled: timed_planes < planes,
    }
}

/// Multiplications of the direct sums: balls, frequencies held, functions.
fn direct_cost(points: &Points) -> f64 {
    points.centers.len() as f64
        * (points.frequencies.count() / 2) as f64
        * points.expansion.rank() as f64
}

/// A share of the direct sums: the frequencies of `planes` of the a values of kx, nothing of it kept. The work is the
/// same for every kx, so that all take a / `planes` times its time. (Fewer values of kz would not do: the phases of x
/// and y are multiplied once for all of them.)
fn direct_share(points: &Points, planes: usize) -> f64 {
    let [_, b, c] = points.frequencies.half();
    let sums = direct_sums(&points.centers, &points.weights, [planes, b, c]);
    let share = FrequencyBox {
        size: [planes, b, 2 * c],
    };
    let mut output = vec![Complex64::default(); planes * b * c];
    points
        .expansion
        .combine(share, &mut output, |place, f| sums[f][place]);
    output[0].re
}
