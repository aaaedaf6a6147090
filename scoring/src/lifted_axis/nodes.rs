//! Lagrange polynomials on Chebyshev nodes over a range of radii, for the product kernel.

use crate::kernel::ProductKernel;
use crate::kernel::product::Body;
use knotdock_structures::numeric::chebyshev;

/// Most nodes of [`super::RadiusBasis::Nodes`], and most distinct radii that are carried as they are beside a product
/// kernel.
pub(super) const MAX_NODES: usize = 32;

/// Value at `radius` of the Lagrange polynomial that is 1 at node `index`.
pub(super) fn node_value(nodes: &[f64], index: usize, radius: f64) -> f64 {
    let own = nodes[index];
    nodes
        .iter()
        .enumerate()
        .filter(|&(other, _)| other != index)
        .map(|(_, node)| (radius - node) / (own - node))
        .product()
}

/// The fewest Chebyshev nodes over a range of radii that carry both bodies' transforms to `tolerance`, and the error
/// reached.
pub(super) fn nodes_for(
    kernel: &ProductKernel,
    radii: &[f64],
    w_max: f64,
    tolerance: f64,
) -> (Vec<f64>, f64) {
    let (Some(&low), Some(&high)) = (radii.first(), radii.last()) else {
        return (Vec::new(), 0.0);
    };
    if low == high {
        return (vec![low], 0.0);
    }
    let bodies = [Body::Solid, Body::Grown];
    let between = |i: usize, n: usize| low + (high - low) * i as f64 / n as f64;
    let mut reached = (Vec::new(), f64::INFINITY);
    for count in 2..=MAX_NODES {
        let nodes: Vec<f64> = chebyshev::nodes(count)
            .map(|x| 0.5 * (low + high) + 0.5 * (high - low) * x)
            .collect();
        let mut error = 0.0f64;
        for i in 0..=48 {
            let radius = between(i, 48);
            let values: Vec<f64> = (0..count).map(|m| node_value(&nodes, m, radius)).collect();
            for j in 0..=16 {
                let w = w_max * f64::from(j) / 16.0;
                for body in bodies {
                    let sum: f64 = nodes
                        .iter()
                        .zip(&values)
                        .map(|(&node, value)| value * kernel.spectrum(body, node, w))
                        .sum();
                    let scale = kernel.spectrum(body, high, 0.0);
                    error = error.max((sum - kernel.spectrum(body, radius, w)).abs() / scale);
                }
            }
        }
        reached = (nodes, error);
        if error <= tolerance {
            break;
        }
    }
    reached
}
