//! The radius taken out of a ball's transform, so that sums over balls become sums of plain waves.
//!
//! r^3 psi^(r |w|) = sum_f A_f(|w|) B_f(r), with the fewest functions B_f of the radius that suffice, from a singular
//! value decomposition. A is computed beforehand for every |w| of a box, as in the paper, and costs no time here. The
//! paper's own expansion, a Fourier series along the fourth axis, is [`series`](super::lifted::series).

use super::spectrum::{Body, FrequencyBox, Kernel, exact, phase, square};
use nalgebra::DMatrix;
use num_complex::Complex64;

/// Frequencies at which errors are measured.
const CHECKED: usize = 160;
/// Frequencies and radii from which the compression is made, and its largest rank.
const NODES: usize = 96;
const RANK: usize = 24;

/// A sum of products of a function of the frequency and one of the radius.
pub struct Expansion {
    /// B_f(r_j): for every function one for each ball.
    pub radial: Vec<Vec<Complex64>>,
    /// A_f: \[square of the integer frequency\]\[f\].
    pub kernel: Vec<Complex64>,
}

/// Body and accuracy that an expansion is made for.
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
pub(super) struct Candidate {
    /// B_f, as [`Expansion::radial`].
    pub radial: Vec<Vec<Complex64>>,
    /// A_f at each frequency that is checked.
    pub checked: Vec<Vec<Complex64>>,
}

impl Expansion {
    /// Number of functions.
    pub fn rank(&self) -> usize {
        self.radial.len()
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
            unreachable!("both factors were requested")
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
        let checked = SampledSpectrum::new(task);
        let mut candidate = Candidate {
            radial,
            checked: checked.each(|w| at(w, rank)),
        };
        let rank = candidate.needed(&checked, 1).unwrap_or(rank);
        candidate.radial.truncate(rank);
        Self {
            radial: candidate.radial,
            kernel: over_squares(task, |w| at(w, rank)),
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
        let functions = self.rank();
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

/// A function of |w| for every square that an integer frequency of the box can have.
pub(super) fn over_squares(task: &Task, at: impl Fn(f64) -> Vec<Complex64>) -> Vec<Complex64> {
    (0..=task.frequencies.largest_square())
        .flat_map(|square| at((square as f64).sqrt() / task.edge))
        .collect()
}

/// The body's spectrum at some frequencies, and the phases of all balls there.
pub(super) struct SampledSpectrum {
    lengths: Vec<f64>,
    exact: Vec<Complex64>,
    phases: Vec<Vec<Complex64>>,
    tolerance: f64,
}

impl SampledSpectrum {
    /// The spectrum at frequencies spread over the box.
    pub fn new(task: &Task) -> Self {
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

    /// A function of |w| at each of them.
    pub fn each(&self, at: impl Fn(f64) -> Vec<Complex64>) -> Vec<Vec<Complex64>> {
        self.lengths.iter().map(|&w| at(w)).collect()
    }
}

impl Candidate {
    /// The fewest functions that keep the tolerance at every frequency checked, one more than a multiple of `step`;
    /// `None` where all are too few.
    pub fn needed(&self, checked: &SampledSpectrum, step: usize) -> Option<usize> {
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
