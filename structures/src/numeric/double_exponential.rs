//! Double-exponential quadrature on the unit interval (Takahasi & Mori, Publ. RIMS 9 (1974) 721).
//!
//! x = (1 + tanh(pi/2 sinh t)) / 2 makes the integrand vanish doubly exponentially at both ends of the line of t. The
//! trapezoidal rule there converges fast however steep the integrand is at 0 and 1. The bump function needs it: it has
//! an essential singularity at 1 and a cusp at 0.

use std::f64::consts::PI;

/// A node of the rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Distance from the nearer end of the interval, without cancellation.
    pub from_end: f64,
    /// Whether the nearer end is 0, not 1.
    pub at_start: bool,
    /// dx/dt, which times the step in t is the node's weight.
    pub slope: f64,
}

impl Node {
    /// Place of the node, 0 to 1.
    pub fn x(&self) -> f64 {
        if self.at_start {
            self.from_end
        } else {
            1.0 - self.from_end
        }
    }
}

/// The nodes at t = k `step`, for k from -`half` to `half`, rising. Beyond |t| = 4 weights are below 1e-36.
pub fn nodes(step: f64, half: i64) -> impl Iterator<Item = Node> {
    (-half..=half).map(move |k| {
        let t = k as f64 * step;
        let s = 0.5 * PI * t.sinh();
        let from_end = 1.0 / (1.0 + (2.0 * s.abs()).exp());
        Node {
            from_end,
            at_start: s < 0.0,
            slope: PI * t.cosh() * from_end * (1.0 - from_end),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integrals with singular ends that are known in closed form.
    #[test]
    fn singular_ends_cost_no_accuracy() {
        let step = 1.0 / 64.0;
        let integral = |function: &dyn Fn(f64) -> f64| -> f64 {
            nodes(step, 256)
                .map(|node| function(node.x()) * node.slope * step)
                .filter(|term| term.is_finite())
                .sum()
        };
        assert!((integral(&|_| 1.0) - 1.0).abs() < 1e-14);
        assert!((integral(&|x| x.sqrt()) - 2.0 / 3.0).abs() < 1e-14);
        assert!((integral(&|x| x.ln()) + 1.0).abs() < 1e-14);
        assert!((integral(&|x| (1.0 - x * x).sqrt()) - PI / 4.0).abs() < 1e-14);
    }
}
