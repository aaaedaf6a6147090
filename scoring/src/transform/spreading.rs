//! The window that carries a knot onto a few points of a uniform grid: Kaiser-Bessel, with its transform in closed
//! form.
//!
//! phi(u) = I0(beta sqrt(1 - (2u / width)^2)) / I0(beta) for |u| <= width / 2 in grid cells. Values come from one
//! polynomial per grid point (in the knot's offset), so that one Horner chain fills the whole window.

use super::Real;
use knotdock_structures::numeric::chebyshev;
use std::f64::consts::PI;

/// Widest window, in grid points.
pub const MAX_WIDTH: usize = 16;

/// A Kaiser-Bessel window of a given width for a given oversampling.
#[derive(Clone, Debug)]
pub struct SpreadingKernel<T> {
    width: usize,
    beta: f64,
    /// [power][point]: polynomial in 2 f - 1, f in [0, 1), of the value at the window's point-th grid point.
    coefficients: Vec<[T; MAX_WIDTH]>,
}

impl<T: Real> SpreadingKernel<T> {
    /// A window of `width` points (2 to 16) for grids that are `oversampling` (> 1) times finer than the modes need.
    ///
    /// # Panics
    /// On any other width.
    pub fn new(width: usize, oversampling: f64) -> Self {
        assert!(
            (2..=MAX_WIDTH).contains(&width),
            "a window of {width} points; 2 to {MAX_WIDTH} are possible"
        );
        let w = width as f64;
        // Beatty, Nishimura, Pauly, IEEE Trans. Med. Imaging 24 (2005) 799, eq. 5.
        let beta = PI
            * ((w / oversampling).powi(2) * (oversampling - 0.5).powi(2) - 0.8)
                .max(0.1)
                .sqrt();
        let terms = width + 5;
        let nodes: Vec<f64> = chebyshev::nodes(terms).collect();
        let mut coefficients = vec![[T::zero(); MAX_WIDTH]; terms];
        #[allow(clippy::needless_range_loop)] // `point` is the lane of every row
        for point in 0..width {
            let values: Vec<f64> = nodes
                .iter()
                .map(|node| window(beta, w, 0.5 * (node + 1.0) + point as f64 - 0.5 * w))
                .collect();
            for (power, value) in chebyshev::monomials(&nodes, &values)
                .into_iter()
                .enumerate()
            {
                coefficients[power][point] = T::of(value);
            }
        }
        Self {
            width,
            beta,
            coefficients,
        }
    }

    /// The narrowest window whose error (of a transform, relative to the largest mode) is about `tolerance`.
    pub fn width_for(tolerance: f64, oversampling: f64) -> usize {
        let digits = (1.0 / tolerance).ln() / (PI * (1.0 - 1.0 / oversampling).sqrt());
        ((digits + 1.3).ceil() as usize).clamp(2, MAX_WIDTH)
    }

    /// Width in grid points.
    pub fn width(&self) -> usize {
        self.width
    }

    /// [power][point]: polynomials in 2 f - 1, f in [0, 1) the distance of the window's first point from its edge, of
    /// its points' values.
    #[cfg(feature = "gpu")]
    pub(crate) fn coefficients(&self) -> &[[T; MAX_WIDTH]] {
        &self.coefficients
    }

    /// Window values at the `width` grid points from ceil(u - width/2) on, for a knot at u in cells; returns the first
    /// point. There are at least `width` lanes; those beyond are zero.
    #[inline(always)]
    pub fn place<const LANES: usize>(&self, u: f64, values: &mut [T; LANES]) -> i64 {
        let (first, x) = self.first(u);
        *values = [T::zero(); LANES];
        for power in self.powers::<LANES>() {
            for point in 0..LANES {
                values[point] = values[point] * x + power[point];
            }
        }
        first
    }

    /// As [`Self::place`], with the derivatives of the values with respect to u, per cell.
    #[inline(always)]
    pub fn place_with_slope<const LANES: usize>(
        &self,
        u: f64,
        values: &mut [T; LANES],
        slopes: &mut [T; LANES],
    ) -> i64 {
        let (first, x) = self.first(u);
        *values = [T::zero(); LANES];
        *slopes = [T::zero(); LANES];
        for power in self.powers::<LANES>() {
            for point in 0..LANES {
                slopes[point] = slopes[point] * x + values[point];
                values[point] = values[point] * x + power[point];
            }
        }
        // The polynomial variable is 2 (first - low) - 1, and low grows with u.
        let minus_two = T::of(-2.0);
        for slope in slopes.iter_mut() {
            *slope = *slope * minus_two;
        }
        first
    }

    /// The window's first point for a knot at u in cells, and the variable of the polynomials.
    #[inline(always)]
    fn first(&self, u: f64) -> (i64, T) {
        let low = u - 0.5 * self.width as f64;
        let first = low.ceil();
        (first as i64, T::of(2.0 * (first - low) - 1.0))
    }

    /// Coefficients of the first points, the highest power first.
    #[inline(always)]
    fn powers<const LANES: usize>(&self) -> impl Iterator<Item = &[T; LANES]> {
        const { assert!(LANES <= MAX_WIDTH) };
        assert!(self.width <= LANES, "a window wider than its lanes");
        let powers = self.coefficients.iter().rev();
        powers.filter_map(|power| power.first_chunk())
    }

    /// Transform of the window at `frequency` cycles per cell.
    pub fn transform(&self, frequency: f64) -> f64 {
        let w = self.width as f64;
        let z = self.beta * self.beta - (PI * w * frequency).powi(2);
        let shape = if z > 0.0 {
            z.sqrt().sinh() / z.sqrt()
        } else if z < 0.0 {
            (-z).sqrt().sin() / (-z).sqrt()
        } else {
            1.0
        };
        w * shape / bessel_i0(self.beta)
    }
}

/// The window at u cells from its centre, for |u| <= width / 2.
pub(super) fn window(beta: f64, width: f64, u: f64) -> f64 {
    let x = 2.0 * u / width;
    bessel_i0(beta * (1.0 - x * x).max(0.0).sqrt()) / bessel_i0(beta)
}

/// Modified Bessel function of the first kind, order 0, by its power series (all terms positive: no cancellation).
pub(super) fn bessel_i0(x: f64) -> f64 {
    let quarter = 0.25 * x * x;
    let (mut term, mut sum, mut k) = (1.0, 1.0, 0.0);
    while term > 1e-18 * sum {
        k += 1.0;
        term *= quarter / (k * k);
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_follow_the_window_and_its_slope() {
        for width in [4, 7, 12] {
            let kernel = SpreadingKernel::<f64>::new(width, 2.0);
            let (mut values, mut slopes) = ([0.0; MAX_WIDTH], [0.0; MAX_WIDTH]);
            for i in 0..50 {
                let u = 3.0 + 0.02 * f64::from(i) + 0.003;
                let first = kernel.place_with_slope(u, &mut values, &mut slopes);
                let mut plain = [0.0; MAX_WIDTH];
                assert_eq!(first, kernel.place(u, &mut plain));
                for point in 0..width {
                    let x = (first + point as i64) as f64 - u;
                    let exact = window(kernel.beta, width as f64, x);
                    assert!(
                        (values[point] - exact).abs() < 1e-6,
                        "width {width}: {} {exact}",
                        values[point]
                    );
                    assert!((values[point] - plain[point]).abs() < 1e-14);
                }
                let h = 1e-5;
                let (mut up, mut down) = ([0.0; MAX_WIDTH], [0.0; MAX_WIDTH]);
                if kernel.place(u + h, &mut up) == kernel.place(u - h, &mut down) {
                    for point in 0..width {
                        assert!(
                            ((up[point] - down[point]) / (2.0 * h) - slopes[point]).abs() < 1e-6
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn transform_is_that_of_the_window() {
        let kernel = SpreadingKernel::<f64>::new(6, 2.0);
        for frequency in [0.0, 0.1, 0.25, 0.5] {
            let steps = 20_000;
            let brute: f64 = (0..steps)
                .map(|i| {
                    let u = -3.0 + 6.0 * (f64::from(i) + 0.5) / f64::from(steps);
                    window(kernel.beta, 6.0, u) * (2.0 * PI * frequency * u).cos() * 6.0
                        / f64::from(steps)
                })
                .sum();
            assert!((brute - kernel.transform(frequency)).abs() < 1e-6);
        }
    }
}
