//! Balls about the cells of an octree (as the sphere trees of Hubbard and of Palmer and Grimsdale begin).
//!
//! The finest cells are the cubes of one spacing about the nodes. From the root down, a cell without inside nodes is
//! left out; one whose circumscribed ball reaches no farther than eps out of the solid gives that ball; any other is
//! cut in eight. The finest cells always give theirs, of radius eps, so every inside node is covered.

use rayon::prelude::*;

use crate::ball::Ball;
use crate::mesh::Solid;
use crate::sampling::grid::DepthField;

/// The balls, in depth-first order of the cells.
pub fn octree(solid: &Solid, field: &DepthField) -> Vec<Ball> {
    let side = field.grid.per_axis().next_power_of_two();
    descend(solid, field, [0; 3], side)
}

fn descend(solid: &Solid, field: &DepthField, corner: [usize; 3], side: usize) -> Vec<Ball> {
    let grid = field.grid;
    let n = grid.per_axis();
    if corner.iter().any(|&number| number >= n) {
        return Vec::new();
    }
    if side == 1 {
        let node = grid.index(corner);
        let ball = Ball::new(grid.node(node), grid.epsilon());
        return Vec::from_iter((field.depth[node] > 0.0).then_some(ball));
    }
    // Beyond the last node there is nothing inside; a cell that reaches there is cut.
    if corner.iter().all(|&number| number + side <= n) {
        let center = corner
            .map(|number| 0.5 * (grid.coordinate(number) + grid.coordinate(number + side - 1)));
        let radius = grid.epsilon() * side as f64;
        // The depth at the node beside the middle bounds that of the middle.
        let beside = field.depth[grid.index(corner.map(|number| number + side / 2))];
        if beside + 2.0 * grid.epsilon() >= radius && solid.depth(center) + grid.epsilon() >= radius
        {
            return vec![Ball { center, radius }];
        }
    }
    let half = side / 2;
    let below = |child: usize| {
        let corner =
            [0, 1, 2].map(|axis| corner[axis] + if child >> axis & 1 == 1 { half } else { 0 });
        descend(solid, field, corner, half)
    };
    if side >= 16 {
        (0..8usize).into_par_iter().flat_map_iter(below).collect()
    } else {
        (0..8).flat_map(below).collect()
    }
}
