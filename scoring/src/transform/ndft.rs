//! The discrete Fourier transform of points anywhere (NDFT), direct and in f64: slow, the reference that every fast
//! path is tested against.

use num_complex::Complex64;
use std::f64::consts::PI;

/// Type 1 in any number of dimensions: f_k = sum_j c_j exp(-2 pi i k.x_j) for all `modes`, O(points x modes).
///
/// Points are in units of the period; modes run from -floor(n/2) on each axis and stand row-major, the last axis
/// fastest, as in [`super::nufft`].
pub fn forward<const D: usize>(
    points: &[[f64; D]],
    weights: &[Complex64],
    modes: [usize; D],
) -> Vec<Complex64> {
    let mut output = vec![Complex64::default(); modes.iter().product()];
    for (point, weight) in points.iter().zip(weights) {
        for (sum, wave) in output.iter_mut().zip(waves(point, modes)) {
            *sum += weight * wave;
        }
    }
    output
}

/// Type 2 transform, the adjoint of [`forward`]: v_j = sum_k f_k exp(+2 pi i k.x_j), O(points x modes).
pub fn adjoint<const D: usize>(
    points: &[[f64; D]],
    values: &[Complex64],
    modes: [usize; D],
) -> Vec<Complex64> {
    let at = |point| {
        values
            .iter()
            .zip(waves(point, modes))
            .map(|(value, wave)| value * wave.conj())
            .sum()
    };
    points.iter().map(at).collect()
}

/// exp(-2 pi i k.x) at one point for all modes.
fn waves<const D: usize>(point: &[f64; D], modes: [usize; D]) -> Vec<Complex64> {
    let mut waves = vec![Complex64::new(1.0, 0.0)];
    for (x, n) in point.iter().zip(modes) {
        // Whole periods go first, so that a point many periods away keeps the digits that it has.
        let x = x - x.round();
        let of_axis: Vec<Complex64> = (0..n)
            .map(|index| Complex64::cis(-2.0 * PI * (index as f64 - (n / 2) as f64) * x))
            .collect();
        waves = waves
            .iter()
            .flat_map(|outer| of_axis.iter().map(move |inner| outer * inner))
            .collect();
    }
    waves
}

/// [`forward`] at one frequency of any list: O(points).
pub fn at_frequency<const D: usize>(
    points: &[[f64; D]],
    weights: &[Complex64],
    frequency: [i32; D],
) -> Complex64 {
    let waves = points.iter().zip(weights);
    waves
        .map(|(point, weight)| weight * wave(point, &frequency))
        .sum()
}

/// [`adjoint`] at one point, of modes at any frequencies: O(modes).
pub fn at_point<const D: usize>(
    frequencies: &[[i32; D]],
    modes: &[Complex64],
    point: [f64; D],
) -> Complex64 {
    let waves = frequencies.iter().zip(modes);
    waves.map(|(k, mode)| mode * wave(&point, k).conj()).sum()
}

/// exp(-2 pi i k.x).
fn wave<const D: usize>(point: &[f64; D], k: &[i32; D]) -> Complex64 {
    // Whole periods go first, as above.
    let axes = point.iter().zip(k);
    let turns: f64 = axes.map(|(x, &k)| f64::from(k) * (x - x.round())).sum();
    Complex64::cis(-2.0 * PI * turns)
}

/// sum_i c_i exp(-2 pi i (w.x_i + eta r_i)) at one lifted frequency (w, eta): O(knots).
///
/// Weights are real, those of knots, or complex, those of the affinity function.
pub fn ndft_4d<W: Copy + Into<Complex64>>(
    centers: &[[f64; 3]],
    radii: &[f64],
    weights: &[W],
    w: [f64; 3],
    eta: f64,
) -> Complex64 {
    centers
        .iter()
        .zip(radii)
        .zip(weights)
        .map(|((x, r), &c)| {
            let turns = w[0] * x[0] + w[1] * x[1] + w[2] * x[2] + eta * r;
            c.into() * Complex64::cis(-2.0 * PI * turns)
        })
        .sum()
}

/// sum_i c_i exp(-2 pi i w.x_i) at one frequency w.
pub fn ndft_3d(centers: &[[f64; 3]], weights: &[f64], w: [f64; 3]) -> Complex64 {
    centers
        .iter()
        .zip(weights)
        .map(|(x, &c)| {
            let turns = w[0] * x[0] + w[1] * x[1] + w[2] * x[2];
            Complex64::cis(-2.0 * PI * turns) * c
        })
        .sum()
}
