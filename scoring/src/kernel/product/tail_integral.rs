//! The tail integral of a bump, from which overlaps are built (see [`super::ProductKernel::overlap`]).

use knotdock_structures::numeric::Bump;
use knotdock_structures::numeric::double_exponential::{self, Node};

/// Integral from v to 1 of u psi(u) du by double-exponential quadrature, which takes in the bump's end however steep it
/// is.
pub(crate) struct TailIntegral {
    bump: Bump,
    /// Nodes of the unit interval and their weights.
    nodes: Vec<(Node, f64)>,
}

impl TailIntegral {
    /// Prepares the nodes.
    pub(crate) fn new(bump: Bump) -> Self {
        let step = 1.0 / 32.0;
        let nodes = double_exponential::nodes(step, 128)
            .map(|node| (node, node.slope * step))
            .filter(|&(_, weight)| weight > 1e-24)
            .collect();
        Self { bump, nodes }
    }

    /// The integral from v, 0 to 1, to 1.
    pub(crate) fn value(&self, v: f64) -> f64 {
        let length = 1.0 - v;
        self.nodes
            .iter()
            .map(|&(node, weight)| {
                let u = if node.at_start {
                    v + length * node.from_end
                } else {
                    1.0 - length * node.from_end
                };
                length * weight * u * self.bump.value(u)
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the trapezoidal rule. The integrand vanishes with all derivatives at its end and is odd about 0, so that
    /// few points from v = 0 on suffice.
    #[test]
    fn whole_tail_is_the_plane_integral_of_the_bump() {
        for alpha in [2.0, 4.0, 30.0] {
            let bump = Bump::new(alpha).unwrap();
            let tail = TailIntegral::new(bump);
            let step = 1e-5;
            for v in [0.0, 0.25, 0.9] {
                // Midpoints: second order at the start alone.
                let sum: f64 = (0..)
                    .map(|i| v + step * (f64::from(i) + 0.5))
                    .take_while(|&u| u < 1.0)
                    .map(|u| u * bump.value(u) * step)
                    .sum();
                assert!((tail.value(v) - sum).abs() < 1e-9, "alpha {alpha}, v {v}");
            }
            assert_eq!(tail.value(1.0), 0.0);
        }
    }
}
