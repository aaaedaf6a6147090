//! Balls about points of the medial axis, the locus of the largest balls inside (Blum, 1967), as sphere trees for
//! collision have been built (Hubbard, ACM Trans. Graph. 15, 1996; Bradshaw and O'Sullivan, ACM Trans. Graph. 23, 2004).
//!
//! Nodes inside are taken from the deepest up. One that no ball holds gives the largest ball inside that touches the
//! surface where the node is nearest to it ([`feature_size`](super::feature_size)). Balls are grown by eps, and those
//! that others make redundant are left out, as in Algorithm 1.

use crate::ball::Ball;
use crate::mesh::Solid;
use crate::sampling::decomposition::reduce;
use crate::sampling::feature_size::touching;
use crate::sampling::grid::DepthField;
use crate::vector::distance;

/// The balls, grown by eps.
pub fn medial_balls(solid: &Solid, field: &DepthField) -> Vec<Ball> {
    let grid = field.grid;
    let mut nodes = field.inside();
    nodes.sort_unstable_by(|&a, &b| field.depth[b].total_cmp(&field.depth[a]).then(a.cmp(&b)));
    let mut held = vec![false; field.depth.len()];
    let mut balls = Vec::new();
    for node in nodes {
        if held[node] {
            continue;
        }
        let place = grid.node(node);
        let (_, center) = touching(solid, place, grid.half());
        // The largest ball is found to some percent; what is inside of it is exact.
        let medial = Ball::new(center, solid.depth(center));
        let ball = match distance(center, place) < medial.radius {
            true => medial,
            false => Ball::new(place, field.depth[node]),
        };
        grid.visit_ball(ball.center, ball.radius, |other, _| held[other] = true);
        balls.push(ball);
    }
    let grown = |index: usize| balls[index].grown(grid.epsilon());
    reduce(&balls, grid.epsilon())
        .into_iter()
        .map(grown)
        .collect()
}
