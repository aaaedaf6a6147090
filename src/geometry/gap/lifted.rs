//! The paper's own way from balls to a spectrum: a Fourier series along the radius, so that the sum over balls is a
//! four-dimensional transform of the points (x, y, z, r).

use super::expansion::{Candidate, Expansion, SampledSpectrum, Task, over_squares};
use super::ways::{Points, refused};
use knotdock_scoring::kernel::smooth_step_down;
use knotdock_scoring::transform::nufft::{Plan, SortedPoints, Workspace};
use knotdock_structures::Error;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Lengths by which the series' period exceeds the range of radii, as shares of that range.
const GAPS: [f64; 3] = [0.25, 0.5, 1.0];
/// Most modes of the series on either side of zero.
const MAX_ORDER: usize = 60;
/// Samples of a period.
const SAMPLES: usize = 256;

/// The Fourier series along the radius with the fewest modes that keep the tolerance, with `MAX_ORDER` if none do; and
/// its period. Its B_f(r) = exp(-2 pi i eta_f r), its A_f is the kernel's transform in four dimensions.
pub fn series(task: &Task) -> (Expansion, f64) {
    let [low, high] = task.body.radius_range();
    let range = (high - low).max(1e-3 * high);
    let mut best: Option<(usize, f64)> = None;
    let checked = SampledSpectrum::new(task);
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
    (Expansion { radial, kernel }, period)
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

/// A planned four-dimensional fast transform, with its buffers.
pub struct Fast {
    plan: Plan<f64, 4>,
    /// Radii in units of the series' period.
    heights: Vec<f64>,
    sorted: SortedPoints<4>,
    work: Workspace<f64, 4>,
    sums: Vec<Complex64>,
}

/// (x, y, z, r) of every ball, in units of the periods.
fn lifted(points: &Points, heights: &[f64]) -> Vec<[f64; 4]> {
    let balls = points.centers.iter().zip(heights);
    balls.map(|(x, r)| [x[0], x[1], x[2], *r]).collect()
}

/// Plans [`fast`] for balls of these radii and a series of this period.
///
/// # Errors
/// [`Error`] if a tolerance or a grid is out of reach.
pub fn planned(points: &Points, radii: &[f64], period: f64, tolerance: f64) -> Result<Fast, Error> {
    let heights: Vec<f64> = radii.iter().map(|radius| radius / period).collect();
    let [a, b, c] = points.frequencies.half();
    // The series has an odd number of modes, from -most to most, as the transform numbers them.
    let modes = [a, b, c, points.expansion.rank()];
    let plan = Plan::new(modes, tolerance, heights.len()).map_err(refused)?;
    Ok(Fast {
        sorted: plan.locate(&lifted(points, &heights)).map_err(refused)?,
        work: plan.workspace(),
        sums: vec![Complex64::default(); plan.mode_count()],
        heights,
        plan,
    })
}

/// One four-dimensional fast transform.
///
/// # Errors
/// [`Error`] if a centre is not finite.
pub fn fast(points: &Points, fast: &mut Fast) -> Result<Vec<Complex64>, Error> {
    let Fast {
        plan,
        heights,
        sorted,
        work,
        sums,
    } = fast;
    plan.locate_into(&lifted(points, heights), sorted)
        .map_err(refused)?;
    // The fourth coordinate carries the functions of the radius; that of frequency zero is one, so that its weights
    // are the phases alone.
    let functions = points.expansion.rank();
    plan.forward(sorted, &points.weights[functions / 2], work, sums)
        .map_err(refused)?;
    Ok(points.combined(|place, f| sums[place * functions + f]))
}
