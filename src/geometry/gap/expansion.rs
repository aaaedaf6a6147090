//! Two ways to take the radius out of a ball's transform, so that sums over balls become sums of plain waves.
//!
//! Both write r^3 psi^(r |w|) = sum_f A_f(|w|) B_f(r).
//!
//! - [`Expansion::series`] is B&I's: a Fourier series along the fourth axis. Its B_f(r) = exp(-2 pi i eta_f r) makes
//!   the sum over balls a four-dimensional transform of the points (x, y, z, r). Its A_f is the kernel's transform in
//!   four dimensions.
//! - [`Expansion::compressed`] is ours: the fewest functions of the radius that suffice, from a singular value
//!   decomposition.
//!
//! A is computed beforehand for every |w| of a box, as in the paper, and costs no time here.

use super::spectrum::{Body, FrequencyBox, Kernel, exact, phase, square};
use knotdock_scoring::kernel::smooth_step_down;
use nalgebra::DMatrix;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Frequencies at which errors are measured.
const CHECKED: usize = 160;
/// Lengths by which the series' period exceeds the range of radii, as shares of that range.
const GAPS: [f64; 3] = [0.25, 0.5, 1.0];
/// Most modes of the series on either side of zero.
const MAX_ORDER: usize = 60;
/// Samples of a period.
const SAMPLES: usize = 256;
/// Frequencies and radii from which the compression is made, and its largest rank.
const NODES: usize = 96;
const RANK: usize = 24;

/// A sum of products of a function of the frequency and one of the radius.
pub struct Expansion {
    /// B_f(r_j): for every function one for each ball.
    pub radial: Vec<Vec<Complex64>>,
    /// A_f: \[square of the integer frequency\]\[f\].
    pub kernel: Vec<Complex64>,
    /// Period of the series along the radius; none where the expansion is no series.
    pub period: Option<f64>,
}

/// What an expansion is made for.
pub struct Task<'a> {
    /// The balls.
    pub body: &'a Body,
    /// Their bump.
    pub kernel: &'a Kernel,
    /// Edge of the periodic cube.
    pub edge: f64,
    /// The frequencies that are needed.
    pub frequencies: FrequencyBox,
    /// Largest error at any of them that is allowed, as a share of f^(0).
    pub tolerance: f64,
}

/// A candidate: its functions in the order in which they are taken in.
struct Candidate {
    radial: Vec<Vec<Complex64>>,
    /// A_f at each frequency that is checked.
    checked: Vec<Vec<Complex64>>,
}

impl Expansion {
    /// Number of functions: modes along the fourth axis, or the rank.
    pub fn len(&self) -> usize {
        self.radial.len()
    }

    /// Whether there are no functions.
    pub fn is_empty(&self) -> bool {
        self.radial.is_empty()
    }

    /// The Fourier series along the radius with the fewest modes that keep the tolerance; with `MAX_ORDER` where none
    /// do.
    pub fn series(task: &Task) -> Self {
        let [low, high] = task.body.radius_range();
        let range = (high - low).max(1e-3 * high);
        let mut best: Option<(usize, f64)> = None;
        let checked = Checked::new(task);
        for gap in GAPS {
            let period = (1.0 + gap) * range;
            // Zero first, then by pairs, so that the fewest are a first part of all.
            let order = (0..2 * MAX_ORDER as i32 + 1).map(in_pairs);
            let candidate = Candidate {
                radial: order.map(|k| waves(&task.body.radii, k, period)).collect(),
                checked: checked.each(|w| {
                    let all = series_at(task, w, low, high, period, MAX_ORDER);
                    (0..all.len())
                        .map(|f| all[centered(in_pairs(f as i32), MAX_ORDER)])
                        .collect()
                }),
            };
            let needed = candidate.needed(&checked, 2).unwrap_or(2 * MAX_ORDER + 1);
            if best.is_none_or(|(fewest, _)| needed < fewest) {
                best = Some((needed, period));
            }
        }
        let (count, period) = best.unwrap_or((1, range));
        let most = count / 2;
        let radial = (-(most as i32)..=most as i32)
            .map(|k| waves(&task.body.radii, k, period))
            .collect();
        let kernel = over_squares(task, |w| series_at(task, w, low, high, period, most));
        Self {
            radial,
            kernel,
            period: Some(period),
        }
    }

    /// The expansion of least rank that keeps the tolerance; of rank `RANK` where none does.
    pub fn compressed(task: &Task) -> Self {
        let [low, high] = task.body.radius_range();
        let width = ((high - low) / NODES as f64).max(1e-9 * high);
        let mut balls = [0.0; NODES];
        for radius in &task.body.radii {
            balls[(((radius - low) / width) as usize).min(NODES - 1)] += 1.0;
        }
        let nodes: Vec<(f64, f64)> = (0..NODES)
            .map(|index| low + (index as f64 + 0.5) * width)
            .zip(balls)
            .filter(|(_, balls)| *balls > 0.0)
            .map(|(radius, balls)| (radius, f64::sqrt(balls)))
            .collect();
        let w_most = (task.frequencies.largest_square() as f64).sqrt() / task.edge;
        let w_of = |row: usize| w_most * row as f64 / (NODES - 1) as f64;
        let matrix = DMatrix::from_fn(NODES, nodes.len(), |row, column| {
            let (radius, weight) = nodes[column];
            weight * task.kernel.of_ball(w_of(row), radius)
        });
        let decomposed = matrix.svd(true, true);
        let (Some(u), Some(v_t)) = (decomposed.u, decomposed.v_t) else {
            // Both were requested.
            return Self::series(task);
        };
        let rank = RANK.min(nodes.len());
        let radial: Vec<Vec<Complex64>> = (0..rank)
            .map(|q| {
                let inverse = 1.0 / decomposed.singular_values[q].max(f64::MIN_POSITIVE);
                let at = |&radius: &f64| {
                    let rows =
                        (0..NODES).map(|row| u[(row, q)] * task.kernel.of_ball(w_of(row), radius));
                    Complex64::from(rows.sum::<f64>() * inverse)
                };
                task.body.radii.iter().map(at).collect()
            })
            .collect();
        let at = |w: f64, rank: usize| -> Vec<Complex64> {
            (0..rank)
                .map(|q| {
                    let columns = nodes.iter().enumerate().map(|(column, &(radius, weight))| {
                        v_t[(q, column)] * weight * task.kernel.of_ball(w, radius)
                    });
                    Complex64::from(columns.sum::<f64>())
                })
                .collect()
        };
        let checked = Checked::new(task);
        let mut candidate = Candidate {
            radial,
            checked: checked.each(|w| at(w, rank)),
        };
        let rank = candidate.needed(&checked, 1).unwrap_or(rank);
        candidate.radial.truncate(rank);
        Self {
            radial: candidate.radial,
            kernel: over_squares(task, |w| at(w, rank)),
            period: None,
        }
    }

    /// Sum over f of A_f(|w|) times the f-th sum over balls, at every frequency held of a box. `value(place, f)`
    /// gives the f-th sum.
    pub fn combine(
        &self,
        frequencies: FrequencyBox,
        output: &mut [Complex64],
        value: impl Fn(usize, usize) -> Complex64,
    ) {
        let functions = self.len();
        frequencies.for_each(|place, square| {
            let kernel = &self.kernel[square * functions..(square + 1) * functions];
            output[place] = kernel
                .iter()
                .enumerate()
                .map(|(f, kernel)| kernel * value(place, f))
                .sum();
        });
    }
}

/// Indices 0, 1, -1, 2, -2, ...
fn in_pairs(index: i32) -> i32 {
    if index % 2 == 1 {
        (index + 1) / 2
    } else {
        -index / 2
    }
}

fn centered(k: i32, most: usize) -> usize {
    (k + most as i32) as usize
}

/// Phases exp(-2 pi i k r / period) of every radius.
fn waves(radii: &[f64], k: i32, period: f64) -> Vec<Complex64> {
    let turns = f64::from(k) / period;
    radii
        .iter()
        .map(|radius| Complex64::cis(-2.0 * PI * turns * radius))
        .collect()
}

/// Coefficients k = -most..=most of the series in r at one frequency. Between the largest radius and the smallest of
/// the next period the transform is led over smoothly from one continuation to the other, so that the series falls
/// faster than any power.
fn series_at(task: &Task, w: f64, low: f64, high: f64, period: f64, most: usize) -> Vec<Complex64> {
    let gap = period - (high - low);
    let samples: Vec<f64> = (0..SAMPLES)
        .map(|index| {
            let radius = low + period * index as f64 / SAMPLES as f64;
            if radius <= high {
                return task.kernel.of_ball(w, radius);
            }
            let share = smooth_step_down((radius - high) / gap, 0.0, 1.0);
            share * task.kernel.of_ball(w, radius)
                + (1.0 - share) * task.kernel.of_ball(w, radius - period)
        })
        .collect();
    (-(most as i64)..=most as i64)
        .map(|k| {
            // f(r) = sum_k A_k exp(-2 pi i k r / period), with r = low + period index / SAMPLES.
            let turn = Complex64::cis(2.0 * PI * k as f64 / SAMPLES as f64);
            let mut wave = Complex64::cis(2.0 * PI * k as f64 * low / period) / SAMPLES as f64;
            let mut sum = Complex64::default();
            for sample in &samples {
                sum += wave * sample;
                wave *= turn;
            }
            sum
        })
        .collect()
}

/// A function of |w| for every square that an integer frequency of the box can have.
fn over_squares(task: &Task, at: impl Fn(f64) -> Vec<Complex64>) -> Vec<Complex64> {
    (0..=task.frequencies.largest_square())
        .flat_map(|square| at((square as f64).sqrt() / task.edge))
        .collect()
}

/// Frequencies with what stands there, and the phases of all balls.
struct Checked {
    lengths: Vec<f64>,
    exact: Vec<Complex64>,
    phases: Vec<Vec<Complex64>>,
    tolerance: f64,
}

impl Checked {
    fn new(task: &Task) -> Self {
        let places = task.frequencies.sample(CHECKED);
        let all = || {
            places
                .iter()
                .map(|&place| task.frequencies.frequency(place))
        };
        let exact: Vec<Complex64> = all()
            .map(|k| exact(task.body, task.kernel, task.edge, k))
            .collect();
        let centers = &task.body.centers;
        let phases = all()
            .map(|k| {
                let waves = centers
                    .iter()
                    .map(|x| Complex64::cis(phase(x, k, task.edge)));
                waves.collect()
            })
            .collect();
        Self {
            lengths: all()
                .map(|k| (square(k) as f64).sqrt() / task.edge)
                .collect(),
            tolerance: task.tolerance * exact[0].norm(),
            exact,
            phases,
        }
    }

    fn each(&self, at: impl Fn(f64) -> Vec<Complex64>) -> Vec<Vec<Complex64>> {
        self.lengths.iter().map(|&w| at(w)).collect()
    }
}

impl Candidate {
    /// The fewest functions that keep the tolerance at every frequency checked, one more than a multiple of `step`;
    /// `None` where all are too few.
    fn needed(&self, checked: &Checked, step: usize) -> Option<usize> {
        let mut left = checked.exact.clone();
        for (f, radial) in self.radial.iter().enumerate() {
            for (index, left) in left.iter_mut().enumerate() {
                let waves = checked.phases[index].iter().zip(radial);
                let sum: Complex64 = waves.map(|(wave, radial)| wave * radial).sum();
                *left -= sum * self.checked[index][f];
            }
            let kept = || left.iter().all(|left| left.norm() <= checked.tolerance);
            if f % step == 0 && kept() {
                return Some(f + 1);
            }
        }
        None
    }
}
