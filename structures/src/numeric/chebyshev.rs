//! Interpolation at Chebyshev nodes, as polynomials in powers of x.
//!
//! [`monomials`] serves one function at up to about 20 nodes; [`to_monomials`] serves many functions at the same few
//! nodes.

use std::f64::consts::PI;

/// The `count` Chebyshev nodes of [-1, 1], cos(pi (i + 1/2) / count), falling.
pub fn nodes(count: usize) -> impl ExactSizeIterator<Item = f64> {
    (0..count).map(move |i| (PI * (i as f64 + 0.5) / count as f64).cos())
}

/// Coefficients, lowest power first, of the polynomial through (nodes, values), by Newton's divided differences.
///
/// At Chebyshev nodes of [-1, 1] the polynomial follows a smooth function to about 1e-14 of its largest value for up to
/// 21 nodes, where building it from Lagrange polynomials loses half of the digits. Takes time proportional to the
/// square of the number of nodes.
///
/// # Panics
/// If there are fewer nodes than values.
pub fn monomials(nodes: &[f64], values: &[f64]) -> Vec<f64> {
    let count = values.len();
    let mut divided = values.to_vec();
    for order in 1..count {
        for i in (order..count).rev() {
            divided[i] = (divided[i] - divided[i - 1]) / (nodes[i] - nodes[i - order]);
        }
    }
    let mut polynomial = vec![0.0; count];
    for i in (0..count).rev() {
        for power in (1..count).rev() {
            polynomial[power] = polynomial[power - 1] - nodes[i] * polynomial[power];
        }
        polynomial[0] = divided[i] - nodes[i] * polynomial[0];
    }
    polynomial
}

/// Matrix (row a power, column a node) that turns values at `N` nodes into the coefficients of the polynomial through
/// them.
///
/// Built once and applied to thousands of functions, it saves the divisions of [`monomials`]. Its columns are Lagrange
/// polynomials: exact to rounding for up to about 8 nodes, and losing digits beyond.
pub fn to_monomials<const N: usize>(nodes: &[f64; N]) -> [[f64; N]; N] {
    let mut matrix = [[0.0; N]; N];
    for node in 0..N {
        // The Lagrange polynomial that is 1 at this node and 0 at the others.
        let mut polynomial = [0.0; N];
        polynomial[0] = 1.0;
        for (degree, other) in (0..N).filter(|&other| other != node).enumerate() {
            let scale = 1.0 / (nodes[node] - nodes[other]);
            for power in (0..=degree).rev() {
                let value = polynomial[power] * scale;
                polynomial[power + 1] += value;
                polynomial[power] = -nodes[other] * value;
            }
        }
        for power in 0..N {
            matrix[power][node] = polynomial[power];
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(polynomial: &[f64], x: f64) -> f64 {
        polynomial.iter().rev().fold(0.0, |sum, c| sum * x + c)
    }

    #[test]
    fn polynomials_are_found_again() {
        let given = [0.5, -2.0, 0.0, 3.0, 0.25];
        let nodes: Vec<f64> = nodes(given.len()).collect();
        let values: Vec<f64> = nodes.iter().map(|&x| value(&given, x)).collect();
        for (found, given) in monomials(&nodes, &values).iter().zip(given) {
            assert!((found - given).abs() < 1e-14);
        }
    }

    #[test]
    fn the_matrix_gives_the_same_polynomial() {
        let mut own = [0.0; 8];
        own.iter_mut().zip(nodes(8)).for_each(|(own, x)| *own = x);
        let values = own.map(|x| (2.0 * x).sin() + x * x);
        let matrix = to_monomials(&own);
        for (row, expected) in matrix.iter().zip(monomials(&own, &values)) {
            let sum: f64 = row.iter().zip(values).map(|(a, b)| a * b).sum();
            assert!((sum - expected).abs() < 1e-13);
        }
    }

    /// Many nodes, as the widest spreading windows have: the error must be that of rounding.
    #[test]
    fn a_smooth_function_is_followed_to_rounding_at_21_nodes() {
        let nodes: Vec<f64> = nodes(21).collect();
        let values: Vec<f64> = nodes.iter().map(|x| (1.5 * x).exp()).collect();
        let polynomial = monomials(&nodes, &values);
        for i in 0..=100 {
            let x = 0.02 * f64::from(i) - 1.0;
            assert!((value(&polynomial, x) - (1.5 * x).exp()).abs() < 3e-14);
        }
    }
}
