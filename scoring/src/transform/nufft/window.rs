//! The Kaiser-Bessel window as piecewise polynomials, its shape chosen for the least aliasing.

use super::super::Real;
use super::super::spreading::{self, MAX_WIDTH};
use knotdock_structures::numeric::chebyshev;
use std::f64::consts::PI;

/// A window of a fixed width in grid cells.
#[derive(Clone, Debug)]
pub(super) struct Window<T> {
    pub(super) width: usize,
    shape: f64,
    /// [power, highest first][point]: polynomial in 2 f - 1, f in [0, 1), of the value at the window's point-th grid
    /// point.
    coefficients: Vec<[T; MAX_WIDTH]>,
}

impl<T: Real> Window<T> {
    /// A window whose polynomials are accurate to `accuracy`, relative to its peak.
    pub(super) fn new(width: usize, shape: f64, accuracy: f64) -> Self {
        let w = width as f64;
        let value = |point: usize, x: f64| {
            spreading::window(shape, w, 0.5 * (x + 1.0) + point as f64 - 0.5 * w)
        };
        let mut coefficients = Vec::new();
        for terms in 3..=width + 12 {
            coefficients = vec![[0.0; MAX_WIDTH]; terms];
            let nodes: Vec<f64> = chebyshev::nodes(terms).collect();
            for point in 0..width {
                let values: Vec<f64> = nodes.iter().map(|&x| value(point, x)).collect();
                let polynomial = chebyshev::monomials(&nodes, &values);
                for (row, power) in coefficients.iter_mut().zip(polynomial.iter().rev()) {
                    row[point] = *power;
                }
            }
            let worst = (0..width)
                .flat_map(|point| (0..=2 * terms).map(move |i| (point, i)))
                .map(|(point, i)| {
                    let x = i as f64 / terms as f64 - 1.0;
                    let sum = coefficients
                        .iter()
                        .fold(0.0, |sum, row| sum * x + row[point]);
                    (sum - value(point, x)).abs()
                })
                .fold(0.0, f64::max);
            if worst <= accuracy {
                break;
            }
        }
        Self {
            width,
            shape,
            coefficients: coefficients.iter().map(|row| row.map(T::of)).collect(),
        }
    }

    /// Values at the grid points from ceil(low) on, for a knot at low + width / 2; zero in the lanes beyond the width.
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // `lane` runs along both rows
    pub(super) fn values<const LANES: usize>(&self, low: f64) -> (usize, [T; LANES]) {
        let first = low.ceil();
        let x = T::of(2.0 * (first - low) - 1.0);
        let mut values = [T::zero(); LANES];
        for row in &self.coefficients {
            for lane in 0..LANES {
                values[lane] = values[lane] * x + row[lane];
            }
        }
        (first as usize, values)
    }

    /// Coefficients of its points, the highest power first.
    #[cfg(feature = "gpu")]
    pub(super) fn rows(&self) -> impl Iterator<Item = &[T]> {
        self.coefficients.iter().map(|row| &row[..self.width])
    }

    /// Transform of the window at `frequency` cycles per cell.
    pub(super) fn transform(&self, frequency: f64) -> f64 {
        let w = self.width as f64;
        w * profile(self.shape, w, frequency) / spreading::bessel_i0(self.shape)
    }
}

/// Shape of a window, and its errors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quality {
    /// The Kaiser-Bessel parameter.
    pub(super) shape: f64,
    /// Root mean square over the kept modes of aliases, relative to the mode, all axes together.
    pub(super) aliasing: f64,
    /// Factor by which dividing the window out lifts rounding errors.
    pub(super) rounding: f64,
    /// The window's transform at the last kept mode over that at 0.
    pub(super) edge: f64,
}

/// The best shape for `width` points on axes of which each has (modes, grid points).
pub(super) fn best(width: usize, axes: &[(usize, usize)]) -> Quality {
    let w = width as f64;
    let samples: Vec<Vec<(f64, f64)>> = axes.iter().map(|&(n, fine)| samples(n, fine)).collect();
    let band = samples
        .iter()
        .flatten()
        .fold(0.0, |band: f64, &(frequency, _)| band.max(frequency));
    // Beatty, Nishimura, Pauly, IEEE Trans. Med. Imaging 24 (2005) 799, eq. 5 has about this shape, for the largest
    // error.
    let scale = PI * w * (1.0 - band);
    let (mut low, mut high) = (0.5 * scale, 1.1 * scale);
    const SECTION: f64 = 0.618_033_988_749_894_9;
    let mut inner = [high - SECTION * (high - low), low + SECTION * (high - low)];
    let mut errors = inner.map(|shape| aliasing(shape, w, &samples));
    for _ in 0..16 {
        if errors[0] < errors[1] {
            high = inner[1];
            inner = [high - SECTION * (high - low), inner[0]];
            errors = [aliasing(inner[0], w, &samples), errors[0]];
        } else {
            low = inner[0];
            inner = [inner[1], low + SECTION * (high - low)];
            errors = [errors[1], aliasing(inner[1], w, &samples)];
        }
    }
    let shape = 0.5 * (low + high);
    let square = |frequency: f64| profile(shape, w, frequency).powi(2);
    let all = (0..32)
        .map(|i| square((f64::from(i) + 0.5) / 64.0))
        .sum::<f64>()
        / 32.0;
    let lifts = samples.iter().map(|axis| {
        all * axis
            .iter()
            .map(|&(frequency, share)| share / square(frequency))
            .sum::<f64>()
    });
    Quality {
        shape,
        aliasing: aliasing(shape, w, &samples),
        rounding: lifts.product::<f64>().sqrt(),
        edge: profile(shape, w, band) / profile(shape, w, 0.0),
    }
}

/// Frequencies of an axis's modes, cycles per cell, and their shares: all of few, else some, denser towards the last,
/// where aliases are strongest.
fn samples(modes: usize, fine: usize) -> Vec<(f64, f64)> {
    let half = modes / 2;
    if half <= 24 {
        // k = -half .. modes - half - 1.
        let share = |k: usize| usize::from(k <= half) + usize::from(k > 0 && k + half < modes);
        return (0..=half)
            .map(|k| {
                let count = if k == 0 { 1 } else { share(k) };
                (k as f64 / fine as f64, count as f64 / modes as f64)
            })
            .collect();
    }
    const COUNT: usize = 24;
    let band = half as f64 / fine as f64;
    (0..COUNT)
        .map(|i| {
            let s = (i as f64 + 0.5) / COUNT as f64;
            (band * (1.0 - s * s), 2.0 * s / COUNT as f64)
        })
        .collect()
}

/// Root of the sum over axes of the mean square of aliases over the window's transform.
fn aliasing(shape: f64, width: f64, axes: &[Vec<(f64, f64)>]) -> f64 {
    let of_mode = |frequency: f64| {
        let aliases: f64 = (1..=4)
            .flat_map(|l| [f64::from(l), -f64::from(l)])
            .map(|l| profile(shape, width, frequency + l).powi(2))
            .sum();
        aliases / profile(shape, width, frequency).powi(2)
    };
    let total: f64 = axes
        .iter()
        .flatten()
        .map(|&(frequency, share)| share * of_mode(frequency))
        .sum();
    total.sqrt()
}

/// The window's transform up to a factor: sinh(sqrt z) / sqrt z with z = shape^2 - (pi width frequency)^2.
fn profile(shape: f64, width: f64, frequency: f64) -> f64 {
    let z = shape * shape - (PI * width * frequency).powi(2);
    let root = z.abs().sqrt();
    if root < 1e-6 {
        1.0
    } else if z > 0.0 {
        root.sinh() / root
    } else {
        root.sin() / root
    }
}
