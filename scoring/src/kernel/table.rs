//! Radial functions as piecewise polynomials on equal panels: one multiply, one truncation and a Horner chain a value.

use knotdock_structures::numeric::chebyshev;

/// Coefficients a panel holds: polynomials of degree 7.
pub(crate) const TERMS: usize = 8;

/// `LANES` functions of one variable on [0, end], each a polynomial of degree 7 on each of equally wide panels, fitted
/// at Chebyshev nodes. Beyond `end` every function is 0.
#[derive(Clone, Debug)]
pub struct Table<const LANES: usize> {
    end: f64,
    panels_per_unit: f64,
    /// [panel][power][lane]
    coefficients: Vec<[[f64; LANES]; TERMS]>,
}

impl<const LANES: usize> Table<LANES> {
    /// Fits `function` on [0, end] with panels no wider than `panel`.
    pub fn fit(end: f64, panel: f64, mut function: impl FnMut(f64) -> [f64; LANES]) -> Self {
        let count = (end / panel).ceil().max(1.0) as usize;
        let width = end / count as f64;
        let fit = PanelFit::new();
        let panel = |index: usize| {
            let middle = width * (index as f64 + 0.5);
            fit.coefficients(middle, 0.5 * width, &mut function)
        };
        Self::of(end, (0..count).map(panel).collect())
    }

    /// The table of some panels' coefficients, [panel][power][lane], which share [0, end] equally.
    pub(crate) fn of(end: f64, coefficients: Vec<[[f64; LANES]; TERMS]>) -> Self {
        Self {
            end,
            panels_per_unit: coefficients.len() as f64 / end,
            coefficients,
        }
    }

    /// End of the range, beyond which the functions are 0.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Coefficients [power][lane] of the panel that has x >= 0, and the argument of its polynomials; `None` beyond the
    /// end.
    #[inline(always)]
    pub(crate) fn panel(&self, x: f64) -> Option<(&[[f64; LANES]; TERMS], f64)> {
        let scaled = x * self.panels_per_unit;
        let panel = self.coefficients.get(scaled as usize)?;
        Some((panel, 2.0 * (scaled - (scaled as usize) as f64) - 1.0))
    }

    /// All lanes at x >= 0.
    #[inline(always)]
    pub fn value(&self, x: f64) -> [f64; LANES] {
        let Some((panel, u)) = self.panel(x) else {
            return [0.0; LANES];
        };
        let mut sum = panel[TERMS - 1];
        for power in (0..TERMS - 1).rev() {
            for lane in 0..LANES {
                sum[lane] = sum[lane] * u + panel[power][lane];
            }
        }
        sum
    }

    /// All lanes at x >= 0, and their slopes.
    pub fn value_and_slope(&self, x: f64) -> ([f64; LANES], [f64; LANES]) {
        let (mut sum, mut slope) = ([0.0; LANES], [0.0; LANES]);
        let Some((panel, u)) = self.panel(x) else {
            return (sum, slope);
        };
        for terms in panel.iter().rev() {
            for lane in 0..LANES {
                slope[lane] = slope[lane] * u + sum[lane];
                sum[lane] = sum[lane] * u + terms[lane];
            }
        }
        (sum, slope.map(|slope| 2.0 * self.panels_per_unit * slope))
    }
}

/// Interpolation at the Chebyshev nodes of a panel.
pub(crate) struct PanelFit {
    /// The nodes on [-1, 1].
    nodes: [f64; TERMS],
    /// [power][node]: turns values at the nodes into monomial coefficients.
    inverse: [[f64; TERMS]; TERMS],
}

impl PanelFit {
    pub(crate) fn new() -> Self {
        let mut nodes = [0.0; TERMS];
        for (own, node) in nodes.iter_mut().zip(chebyshev::nodes(TERMS)) {
            *own = -node;
        }
        let inverse = chebyshev::to_monomials(&nodes);
        Self { nodes, inverse }
    }

    /// Coefficients [power][lane] in (x - middle) / half_width of the polynomials that agree with `function` at the
    /// nodes.
    pub(crate) fn coefficients<const LANES: usize>(
        &self,
        middle: f64,
        half_width: f64,
        mut function: impl FnMut(f64) -> [f64; LANES],
    ) -> [[f64; LANES]; TERMS] {
        self.through(&self.at_nodes(middle, half_width, &mut function))
    }

    /// Something at the nodes of a panel.
    pub(crate) fn at_nodes<V>(
        &self,
        middle: f64,
        half_width: f64,
        mut function: impl FnMut(f64) -> V,
    ) -> [V; TERMS] {
        std::array::from_fn(|node| function(middle + half_width * self.nodes[node]))
    }

    /// Coefficients [power][lane] of the polynomials that have these values at the nodes.
    pub(crate) fn through<const LANES: usize>(
        &self,
        values: &[[f64; LANES]; TERMS],
    ) -> [[f64; LANES]; TERMS] {
        std::array::from_fn(|power| {
            std::array::from_fn(|lane| {
                (0..TERMS)
                    .map(|node| self.inverse[power][node] * values[node][lane])
                    .sum()
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_degree_seven_are_exact() {
        let polynomial = |x: f64| 1.0 - 2.0 * x + 0.5 * x.powi(4) - 0.25 * x.powi(7);
        let table = Table::<2>::fit(2.0, 0.3, |x| [polynomial(x), x]);
        for i in 0..200 {
            let x = 0.01 * f64::from(i);
            let value = table.value(x);
            assert!((value[0] - polynomial(x)).abs() < 1e-11);
            assert!((value[1] - x).abs() < 1e-13);
        }
        assert_eq!(table.value(2.0), [0.0, 0.0]);
    }
}
