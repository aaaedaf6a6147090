//! The nonequispaced discrete Fourier transform, direct and in f64: slow, plainly right, the reference for every fast path.

use num_complex::Complex64;
use std::f64::consts::PI;

/// sum_i c_i exp(-2 pi i (w.x_i + eta r_i)) at one lifted frequency (w, eta): O(knots).
pub fn ndft_4d(
    centers: &[[f64; 3]],
    radii: &[f64],
    weights: &[Complex64],
    w: [f64; 3],
    eta: f64,
) -> Complex64 {
    centers
        .iter()
        .zip(radii)
        .zip(weights)
        .map(|((x, r), c)| {
            let turns = w[0] * x[0] + w[1] * x[1] + w[2] * x[2] + eta * r;
            c * Complex64::cis(-2.0 * PI * turns)
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
