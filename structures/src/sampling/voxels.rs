//! Uniform sampling: the ball about the cube of one spacing around every inside node, all of radius eps. B&I's own
//! baseline.

use crate::ball::Ball;
use crate::sampling::grid::DepthField;

/// The balls, in the order of the nodes.
pub fn voxels(field: &DepthField) -> Vec<Ball> {
    let radius = field.grid.epsilon();
    field
        .inside()
        .into_iter()
        .map(|node| Ball {
            center: field.grid.node(node),
            radius,
        })
        .collect()
}
