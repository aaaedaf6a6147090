//! The gap function of two solids on a grid, by each way to compute it (B&I, sections 3.2 and 5.2).
//!
//! g(t) = integral of f_A(x) f_B(x - t) dx, f the sum of the bumps of a solid's balls. It is above zero where the
//! solids meet and zero elsewhere. The ways are
//!
//! - *pairs*: the sum over all pairs of balls of the integral of their bumps, at some points: the reference;
//! - *rasterise + FFT*: both functions on the grid, two transforms, a product, and one back ([`grid`]);
//! - *NDFT* and *NFFT*: the spectra from the balls without a grid, with the radius taken out by an [`expansion`]
//!   ([`ways`]), a product, and one transform back;
//! - *truncated*: of the grid's product only the m' modes of lowest frequency, transformed back.
//!
//! A truncated function rings about zero: only where it exceeds its residual do the solids meet for certain. The
//! Hausdorff error is the largest distance of a point of the obstacle from these points.
//!
//! Lengths are relative to the middle of A; B is turned before and about its own middle.

pub mod expansion;
pub use knotdock_scoring::gap_grid as grid;
pub mod lifted;
pub mod spectrum;
pub mod ways;

use std::time::Instant;

use knotdock_scoring::kernel::KernelOptions;
use knotdock_scoring::kernel::product::{Band, ProductKernel};
use knotdock_scoring::transform::modes::place;
use knotdock_scoring::transform::truncation::Selection;
use knotdock_structures::Error;
use knotdock_structures::sampling::Ball;
use knotdock_structures::sampling::ball_tree::BallTree;
use num_complex::Complex64;

use super::bracket::bounds;
use super::obstacle::reduce::reduced_sum;
use expansion::{Expansion, Task};
use grid::{Buffers, Grid};
use spectrum::{Body, FrequencyBox, Kernel};
use ways::Points;

/// Points at which all ways are compared with the pairs.
const CHECKED: usize = 24;
/// Pairs of balls that are summed for the reference at most.
const MAX_PAIRS: usize = 4_000_000;
/// Error of NDFT and NFFT that is allowed, as a share of the value at frequency zero.
const TOLERANCE: f64 = 1e-6;

/// One way, with its time and its error.
#[derive(Clone, Debug, PartialEq)]
pub struct GapWay {
    /// Name of the way.
    pub name: String,
    /// Modes that are kept, conjugates counted; `None` for pairs.
    pub modes: Option<usize>,
    /// Wall time of the whole function on the grid, in seconds.
    pub seconds: f64,
    /// Largest difference from the pairs at the points checked, as a share of the function's peak.
    pub residual: f64,
    /// Hausdorff error of the set in which a truncated function exceeds its residual, in the file's unit.
    pub hausdorff: Option<f64>,
}

/// Both bodies about their middles in one periodic cube that holds the sum of their extents.
struct Scene {
    bodies: [Body; 2],
    edge: f64,
    grid: Grid,
    kernel: Kernel,
}

/// Balls about the middle of their box.
fn body(balls: &[Ball]) -> Body {
    let (low, high) = bounds(balls);
    let centered = balls.iter().map(|ball| {
        let place = |axis: usize| ball.center[axis] - 0.5 * (low[axis] + high[axis]);
        [0, 1, 2].map(place)
    });
    Body {
        centers: centered.collect(),
        radii: balls.iter().map(|ball| ball.radius).collect(),
    }
}

/// The gap function of two sets of balls, none of them empty, B turned already, on `per_axis`^3 points; `per_axis` is a
/// multiple of four.
///
/// # Errors
/// [`Error`] if a transform cannot be planned.
pub fn gap_ways(first: &[Ball], second: &[Ball], per_axis: usize) -> Result<Vec<GapWay>, Error> {
    let scene = Scene::new([body(first), body(second)], per_axis)?;
    let points = scene.checked_points();
    let start = Instant::now();
    let exact = scene.by_pairs(&points)?;
    let share = points.len() as f64 / per_axis.pow(3) as f64;
    let pairs_seconds = start.elapsed().as_secs_f64() / share;
    let start = Instant::now();
    let spectra = scene.rasterised();
    let mut product = vec![Complex64::default(); spectra[0].len()];
    scene.grid.multiply(&spectra[0], &spectra[1], &mut product);
    let values = scene.back(&product);
    let fft_seconds = start.elapsed().as_secs_f64();
    let peak = values.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let residual = |values: &[f64]| {
        let errors = points
            .iter()
            .zip(&exact)
            .map(|(&at, exact)| (values[at] - exact).abs());
        errors.fold(0.0, f64::max) / peak
    };
    let all = (per_axis - 1).pow(3);
    let whole = |name: &str, seconds: f64, residual: f64| GapWay {
        name: name.to_owned(),
        modes: Some(all),
        seconds,
        residual,
        hausdorff: None,
    };
    let name = format!("pairs (timed at {} points)", points.len());
    let mut ways = vec![
        GapWay {
            modes: None,
            ..whole(&name, pairs_seconds, 0.0)
        },
        whole("rasterise + FFT", fft_seconds, residual(&values)),
    ];
    for name in ["NDFT", "NFFT"] {
        let start = Instant::now();
        let values = scene.back(&scene.without_grid(name == "NFFT")?);
        let seconds = start.elapsed().as_secs_f64();
        ways.push(whole(name, seconds, residual(&values)));
    }
    let blocked = scene.blocked();
    let mut most = all / 8;
    while most >= 64 {
        let selection = Selection::low_frequency(&scene.grid.modes, most);
        let truncation = scene.grid.truncate(&selection);
        let mut small = truncation.buffers();
        // With both spectra known: the modes kept, multiplied and transformed back on the least grid that holds them.
        let start = Instant::now();
        truncation.multiply(
            &scene.grid,
            spectra.each_ref().map(Vec::as_slice),
            &mut small,
        );
        truncation.inverse(&mut small);
        let seconds = start.elapsed().as_secs_f64();
        let mut kept = vec![Complex64::default(); product.len()];
        scene.grid.keep(&product, &selection, &mut kept);
        let truncated = scene.back(&kept);
        let worst = (truncated.iter().zip(&values))
            .map(|(truncated, value)| (truncated - value).abs())
            .fold(0.0, f64::max);
        ways.push(GapWay {
            modes: Some(selection.modes()),
            hausdorff: scene.hausdorff(&blocked, &truncated, worst),
            ..whole("truncated", seconds, residual(&truncated))
        });
        most /= 8;
    }
    Ok(ways)
}

impl Scene {
    fn new(bodies: [Body; 2], per_axis: usize) -> Result<Self, Error> {
        let extents = bodies.each_ref().map(Body::extent);
        let edges = (0..3).map(|axis| extents[0][axis] + extents[1][axis]);
        let edge = edges.fold(0.0, f64::max) * (1.0 + 2.0 / per_axis as f64);
        let largest = bodies.iter().map(|body| body.radius_range()[1]);
        let largest = largest.fold(0.0, f64::max);
        // The largest product of a radius and a frequency of the grid.
        let most = 0.5 * 3f64.sqrt() * per_axis as f64 / edge * largest;
        Ok(Self {
            bodies,
            edge,
            grid: Grid::new(per_axis, edge),
            kernel: Kernel::new(1.01 * most).map_err(Error::lasting)?,
        })
    }

    /// The translation of a point of the grid, about zero.
    fn translation(&self, point: usize) -> [f64; 3] {
        let n = self.grid.per_axis;
        [point / (n * n), point / n % n, point % n].map(|number| {
            let signed = if number >= n / 2 {
                number as f64 - n as f64
            } else {
                number as f64
            };
            signed * self.edge / n as f64
        })
    }

    /// Points spread over the grid, the origin first, as few as the pairs allow.
    fn checked_points(&self) -> Vec<usize> {
        let pairs = self.bodies[0].radii.len() * self.bodies[1].radii.len();
        let count = (MAX_PAIRS / pairs.max(1)).clamp(2, CHECKED);
        let n = self.grid.per_axis;
        // Steps by the golden ratio in each axis, within the inner half, where most solids meet.
        let at = |index: usize, ratio: f64| {
            let share = (index as f64 * ratio).fract() - 0.5;
            ((0.5 * share * n as f64).round() as i64).rem_euclid(n as i64) as usize
        };
        let point = |index: usize| {
            let [x, y, z] = [0.819_172_5, 0.671_043_6, 0.549_700_5].map(|ratio| at(index, ratio));
            (x * n + y) * n + z
        };
        std::iter::once(0).chain((1..count).map(point)).collect()
    }

    /// g at points by the sum over all pairs.
    fn by_pairs(&self, points: &[usize]) -> Result<Vec<f64>, Error> {
        let [a, b] = &self.bodies;
        let largest = a.radius_range()[1].max(b.radius_range()[1]);
        let kernel = ProductKernel::new(
            KernelOptions::default(),
            Band::Whole,
            largest,
            1.0 / largest,
        )
        .map_err(Error::lasting)?;
        Ok(points
            .iter()
            .map(|&point| {
                let t = self.translation(point);
                let mut sum = 0.0;
                for (x, &r) in a.centers.iter().zip(&a.radii) {
                    for (y, &s) in b.centers.iter().zip(&b.radii) {
                        let square = (0..3).map(|axis| (x[axis] - y[axis] - t[axis]).powi(2));
                        let distance = square.sum::<f64>().sqrt();
                        if distance < r + s {
                            sum += kernel.overlap(distance, r, s);
                        }
                    }
                }
                sum
            })
            .collect())
    }

    /// The spectra of both functions on the grid.
    fn rasterised(&self) -> [Vec<Complex64>; 2] {
        let mut buffers = self.grid.buffers();
        self.bodies.each_ref().map(|body| {
            self.grid
                .rasterise(&body.knots(), &self.kernel.bump, &mut buffers);
            self.grid.forward(&mut buffers);
            buffers.spectrum.clone()
        })
    }

    /// The product of the spectra of both functions, from the balls alone.
    fn without_grid(&self, fast: bool) -> Result<Vec<Complex64>, Error> {
        let n = self.grid.per_axis;
        let frequencies = FrequencyBox { size: [n; 3] };
        let mut spectra = Vec::with_capacity(2);
        for body in &self.bodies {
            let task = Task {
                body,
                kernel: &self.kernel,
                edge: self.edge,
                frequencies,
                tolerance: TOLERANCE,
            };
            let expansion = Expansion::compressed(&task);
            let points = Points::new(body, self.edge, frequencies, &expansion);
            spectra.push(if fast {
                ways::fast(&points, &mut ways::planned(&points, TOLERANCE)?)?
            } else {
                ways::direct(&points)
            });
        }
        let mut product = vec![Complex64::default(); n * n * (n / 2 + 1)];
        let volume = self.edge.powi(3);
        for (index, (a, b)) in spectra[0].iter().zip(&spectra[1]).enumerate() {
            let [kx, ky, kz] = frequencies.frequency(index);
            // The Nyquist planes stay zero, as on the grid.
            if kx.unsigned_abs() as usize == n / 2 || ky.unsigned_abs() as usize == n / 2 {
                continue;
            }
            product[(kz as usize * n + place(ky, n)) * n + place(kx, n)] = a * b.conj() / volume;
        }
        Ok(product)
    }

    /// The function whose modes these are.
    fn back(&self, product: &[Complex64]) -> Vec<f64> {
        let mut buffers: Buffers = self.grid.buffers();
        buffers.spectrum.copy_from_slice(product);
        self.grid.inverse(&mut buffers);
        buffers.grid
    }

    /// Whether two balls meet, at every point.
    fn blocked(&self) -> Vec<bool> {
        let balls = |body: &Body, sign: f64| -> Vec<Ball> {
            let balls = body.centers.iter().zip(&body.radii);
            balls
                .map(|(center, &radius)| Ball {
                    center: center.map(|part| sign * part),
                    radius,
                })
                .collect()
        };
        let [a, b] = [balls(&self.bodies[0], 1.0), balls(&self.bodies[1], -1.0)];
        let tree = BallTree::new(&reduced_sum(&a, &b, 0.0));
        let points = 0..self.grid.per_axis.pow(3);
        points
            .map(|point| tree.contains(self.translation(point)))
            .collect()
    }

    /// Largest distance of a blocked point from those whose value exceeds `level`; `None` if none does.
    fn hausdorff(&self, blocked: &[bool], values: &[f64], level: f64) -> Option<f64> {
        let point = |index: usize| Ball {
            center: self.translation(index),
            radius: 0.0,
        };
        let above: Vec<Ball> = (0..values.len())
            .filter(|&index| values[index] > level)
            .map(point)
            .collect();
        if above.is_empty() {
            return None;
        }
        let tree = BallTree::new(&above);
        let far = (0..values.len())
            .filter(|&index| blocked[index] && values[index] <= level)
            .map(|index| tree.distance(point(index).center, 0.0));
        Some(far.fold(0.0, f64::max))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_ways_agree_on_a_few_balls() {
        let cloud = |count: u32, step: f64| -> Vec<Ball> {
            (1..=count)
                .map(|i| {
                    let part = |factor: f64| (f64::from(i) * factor * step).fract();
                    Ball {
                        center: [part(0.8191), part(0.671), part(0.5497)],
                        radius: 0.25 + 0.1 * part(0.45),
                    }
                })
                .collect()
        };
        let found = gap_ways(&cloud(12, 1.0), &cloud(9, 1.7), 32).unwrap();
        let named = |name: &str| found.iter().find(|way| way.name == name).unwrap();
        // A grid of three points per radius has an error, which falls with its spacing.
        for (name, bound) in [("rasterise + FFT", 6e-3), ("NDFT", 1e-3), ("NFFT", 1e-3)] {
            assert!(named(name).residual < bound, "{name}: {:?}", named(name));
        }
        let finer = gap_ways(&cloud(12, 1.0), &cloud(9, 1.7), 48).unwrap();
        let raster = finer.iter().find(|way| way.name == "rasterise + FFT");
        assert!(raster.unwrap().residual < 0.5 * named("rasterise + FFT").residual);
        let errors: Vec<f64> = found.iter().filter_map(|way| way.hausdorff).collect();
        assert!(errors.len() >= 2 && errors.is_sorted(), "{errors:?}");
    }
}
