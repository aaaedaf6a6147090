//! Local feature size: the thickness of a solid.
//!
//! The local feature size at a point q of the surface is the radius of the largest ball inside the solid that touches
//! the surface at q. That is the distance from q to the inner medial axis; Amenta and Bern, Discrete Comput. Geom. 22,
//! 1999, take both sides of the surface.
//!
//! It is half the thickness of a plate and the radius of a rod, and falls to zero at edges and corners, of which every
//! polyhedron is full. So the feature size of a solid is the median over its surface: what is typical of it.

use rayon::prelude::*;

use crate::mesh::Solid;
use crate::sampling::grid::DepthField;
use crate::vector::{along, norm, subtract};

/// Number of points of the surface that are sampled, about.
const SAMPLES: usize = 1500;

/// Halvings of the interval in which a radius lies: to a thousandth of the longest side.
const HALVINGS: usize = 10;

/// A ball touches the surface at q alone as long as the surface is no nearer to its centre than this share of its
/// radius.
const TOUCHING: f64 = 0.98;

/// The median local feature size, in the solid's unit; zero when no node is inside.
pub fn feature_size(solid: &Solid, field: &DepthField) -> f64 {
    let h = field.grid.spacing();
    // Nodes on the surface itself do not say which way is in.
    let near: Vec<usize> = (0..field.depth.len())
        .filter(|&node| field.depth[node] > 1e-6 * h && field.depth[node] <= 1.5 * h)
        .collect();
    let stride = near.len().div_ceil(SAMPLES).max(1);
    let sampled: Vec<usize> = near.into_iter().step_by(stride).collect();
    let mut radii: Vec<f64> = sampled
        .par_iter()
        .map(|&node| touching(solid, field.grid.node(node), field.grid.half()).0)
        .collect();
    if radii.is_empty() {
        return field.depth.iter().copied().fold(0.0, f64::max);
    }
    let middle = radii.len() / 2;
    *radii.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Radius and centre of the largest ball inside that touches the surface at the point nearest to `inside`, no larger
/// than `most`.
pub(super) fn touching(solid: &Solid, inside: [f64; 3], most: f64) -> (f64, [f64; 3]) {
    let foot = solid.nearest(inside);
    let step = subtract(inside, foot);
    let depth = norm(step);
    if depth <= 0.0 {
        return (0.0, inside);
    }
    let center = |radius: f64| along(foot, radius / depth, step);
    let fits = |radius: f64| {
        // Past a thin wall the surface is far, too.
        solid.distance(center(radius)) >= TOUCHING * radius && solid.is_inside(center(radius))
    };
    // The ball about `inside` itself fits, and of balls that touch at one point each holds all smaller ones.
    let (mut low, mut high) = (depth, most.max(depth));
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if fits(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    (0.5 * (low + high), center(low))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::grid::Grid;
    use crate::test_support::cuboid;

    /// A plate is as thick as it is nearly everywhere on its surface. A cube's largest ball at a face is as large as
    /// its edges allow: over the surface the median of half - max(|u|, |v|), which is half (1 - 1 / sqrt 2).
    #[test]
    fn plates_and_cubes_have_the_sizes_known_by_hand() {
        for (half, expected) in [
            ([0.5, 0.5, 0.04], 0.04),
            ([0.5, 0.5, 0.5], 0.5 * (1.0 - 0.5f64.sqrt())),
        ] {
            let solid = cuboid(half);
            let field = DepthField::new(&solid, Grid::new(&solid, 40));
            let found = feature_size(&solid, &field);
            assert!(
                (found - expected).abs() < 0.1 * expected,
                "{found} for {expected}"
            );
        }
    }
}
