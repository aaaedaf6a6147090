//! Balls of one radius on a lattice: a solid as a smooth density of limited resolution.
//!
//! Cubic cells, k nodes wide, tile the grid evenly about its middle; k need not be whole. Every cell with nodes inside
//! the solid gives one ball, at the mean of these nodes, so that a cell which the surface cuts has its ball where its share of the solid
//! is. With weights fitted to the nodes ([`super::weights`]) the summed bumps then count volume: about one inside and
//! zero outside, however the lattice lies.
//!
//! The balls are no cover and no packing: for these take [`super::decomposition`]. They are what a correlation of known
//! resolution needs: cells narrower than half the finest wavelength it keeps are to it as good as the nodes themselves,
//! at 1 / k^3 of their number.

use crate::ball::Ball;
use crate::sampling::grid::DepthField;

/// The balls, in rising order of their cells; `per_cell` is k, at least one, and `radius` in the solid's unit.
pub fn lattice(field: &DepthField, per_cell: f64, radius: f64) -> Vec<Ball> {
    let k = per_cell.max(1.0);
    let n = field.grid.per_axis() as f64;
    // Cells overhang the grid alike at both ends, so that a solid and its mirror image give mirror images but for nodes
    // halfway between two cells.
    let count = (n / k).ceil();
    let overhang = 0.5 * (count * k - n);
    let cells = count as usize;
    let mut sums = vec![([0.0f64; 3], 0usize); cells * cells * cells];
    for node in field.inside() {
        let [x, y, z] = field
            .grid
            .numbers(node)
            .map(|number| ((number as f64 + 0.5 + overhang) / k) as usize);
        let (sum, count) = &mut sums[(z * cells + y) * cells + x];
        let place = field.grid.node(node);
        for axis in 0..3 {
            sum[axis] += place[axis];
        }
        *count += 1;
    }
    sums.into_iter()
        .filter(|(_, count)| *count > 0)
        .map(|(sum, count)| Ball::new(sum.map(|value| value / count as f64), radius))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::Bump;
    use crate::sampling::grid::Grid;
    use crate::sampling::weights;
    use crate::test_support::cuboid;

    /// Cells of one node are the nodes; larger ones, of a whole number of nodes or not, leave none out.
    #[test]
    fn every_inside_node_is_in_one_cell() {
        let solid = cuboid([0.5, 0.4, 0.23]);
        let field = DepthField::new(&solid, Grid::new(&solid, 20));
        let inside = field.inside();
        let single = lattice(&field, 1.0, 0.1);
        assert_eq!(single.len(), inside.len());
        for (ball, &node) in single.iter().zip(&inside) {
            assert_eq!(ball.center, field.grid.node(node));
        }
        for k in [2.0f64, 2.48, 3.0, 7.0, 40.0] {
            let balls = lattice(&field, k, 0.1);
            let largest = k.ceil().powi(3) as usize;
            assert!(balls.len() * largest >= inside.len() && balls.len() < inside.len());
            // Inside a convex solid means stay inside it.
            assert!(balls.iter().all(|ball| solid.is_inside(ball.center)));
        }
    }

    /// With fitted weights the sum of the bumps is one in the depths to a quarter (cells show), and its integral the volume
    /// to a tenth; to a half and to 0.15 if cells are no whole number of nodes wide.
    #[test]
    fn fitted_weights_count_volume() {
        let solid = cuboid([0.5, 0.45, 0.4]);
        let field = DepthField::new(&solid, Grid::new(&solid, 40));
        let volume = solid.mesh().volume();
        let bump = Bump::new(2.0).unwrap();
        for k in [2.0, 2.6, 3.0, 3.54] {
            let cell = k * field.grid.spacing();
            let balls = lattice(&field, k, 1.3 * cell);
            let fitted = weights::fit(&field, &balls, bump, volume);
            let (with_fitted, with_unit) = (fitted.volume_fitted, fitted.volume_unit);
            let (off, most) = match k.fract() == 0.0 {
                true => (0.1, 0.25),
                false => (0.15, 0.5),
            };
            assert!((with_fitted - 1.0).abs() < off, "{k}: {with_fitted}");
            assert!(with_unit > 2.0, "{with_unit}");
            for (index, &depth) in field.depth.iter().enumerate() {
                if depth < 3.0 * cell {
                    continue;
                }
                let place = field.grid.node(index);
                let sum: f64 = balls
                    .iter()
                    .zip(&fitted.weights)
                    .map(|(ball, weight)| {
                        let d = crate::vector::distance(ball.center, place);
                        weight * bump.value(d / ball.radius)
                    })
                    .sum();
                assert!((sum - 1.0).abs() < most, "{k}: {sum} at depth {depth}");
            }
        }
    }
}
