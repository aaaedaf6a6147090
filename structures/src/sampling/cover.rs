//! Balls added so that no point of the solid is farther than eps from the balls inside it.
//!
//! Covering every inside node is not enough (see [`super::decomposition`]), and a needle or a shell may have none.
//! Samples of the surface are spaced by a tenth of eps at most. A sample farther than nine tenths of eps from all
//! balls gets the ball of the deepest point that lies within that distance under it. Then inside points on a grid of
//! half the spacing that are farther than eps get balls, too.

use rayon::prelude::*;

use crate::ball::Ball;
use crate::mesh::{Probe, Solid, SurfaceSample};
use crate::neighbours::SpatialHash;
use crate::sampling::ball_tree::BallTree;
use crate::sampling::grid::DepthField;
use crate::vector::{along, distance};

/// Distance between a surface point and the nearest sample, as a share of eps.
pub const SAMPLE_SPACING: f64 = 0.1;

/// Counts of the balls added.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Covering {
    /// Balls added under the surface.
    pub surface_balls: usize,
    /// Balls added at points inside.
    pub interior_balls: usize,
    /// Samples under which no point is inside: the surface there bounds nothing, as in open meshes.
    pub unreachable: usize,
}

/// Adds balls to `balls` until every sample of the surface, and then every inside point of the half grid, is near
/// enough.
pub fn cover(solid: &Solid, field: &DepthField, balls: &mut Vec<Ball>) -> Covering {
    let epsilon = field.grid.epsilon();
    let reach = epsilon * (1.0 - SAMPLE_SPACING);
    let mut covering = Covering::default();
    let tree = BallTree::new(balls);
    let far: Vec<Vec<(usize, SurfaceSample)>> = solid.search(|block| {
        let mut far = Vec::new();
        let is_near = |point, reach| tree.distance(point, reach) <= reach;
        block.samples(
            epsilon * SAMPLE_SPACING,
            |point, piece| piece < reach && is_near(point, reach - piece),
            |triangle, sample| {
                if !is_near(sample.point, reach) {
                    far.push((triangle, sample));
                }
            },
        );
        far
    });
    let mut added = Added::new(2.0 * epsilon);
    let closed = solid.mesh().is_closed();
    let mut probe = (0, Probe::default());
    for (triangle, sample) in far.into_iter().flatten() {
        if added.is_near(sample.point, reach) {
            continue;
        }
        if probe.0 != triangle {
            probe = (triangle, Probe::default());
        }
        // Under the surface of a closed mesh that bounds a solid there is some of it at once.
        if closed && !probe.1.is_under(solid, &sample, reach) {
            covering.unreachable += 1;
            continue;
        }
        match deepest_under(solid, &sample, reach) {
            Some(ball) => {
                added.push(ball);
                balls.push(ball);
                covering.surface_balls += 1;
            }
            None => covering.unreachable += 1,
        }
    }
    let tree = BallTree::new(balls);
    let mut added = Added::new(3.0 * epsilon);
    for point in far_inside(solid, field, &tree) {
        if added.is_near(point, epsilon) {
            continue;
        }
        let ball = Ball::new(point, solid.distance(point));
        if ball.radius > 0.0 {
            added.push(ball);
            balls.push(ball);
            covering.interior_balls += 1;
        }
    }
    covering
}

/// Points of the grid of half the spacing that are inside and farther than eps from the balls.
///
/// Such a point is on an edge, a face or in the middle of a cell, so no node at the cell's corners about it is farther
/// than eps. Inside nodes are covered, so none of these may be inside, and between it and each of them the surface
/// passes.
fn far_inside(solid: &Solid, field: &DepthField, tree: &BallTree) -> Vec<[f64; 3]> {
    let grid = field.grid;
    let n = grid.per_axis();
    let epsilon = grid.epsilon();
    let half = grid.spacing() / 2.0;
    (0..grid.nodes())
        .into_par_iter()
        .flat_map_iter(|node| {
            let numbers = grid.numbers(node);
            let place = grid.node(node);
            let mut far = Vec::new();
            // A bit an axis: half a spacing on from the node.
            for shift in 1..8usize {
                let is_shifted = |axis: usize| shift >> axis & 1 == 1;
                if (0..3).any(|axis| is_shifted(axis) && numbers[axis] + 1 == n) {
                    continue;
                }
                let away = half * f64::from(shift.count_ones()).sqrt() * (1.0 + 1e-9);
                let corners = (0..8usize).filter(|corner| corner & !shift == 0);
                let crossed = corners
                    .map(|corner| {
                        grid.index([0, 1, 2].map(|axis| numbers[axis] + (corner >> axis & 1)))
                    })
                    .all(|corner| (-away..=0.0).contains(&field.depth[corner]));
                if crossed {
                    let point = [0, 1, 2]
                        .map(|axis| place[axis] + if is_shifted(axis) { half } else { 0.0 });
                    if tree.distance(point, epsilon) > epsilon && solid.is_inside(point) {
                        far.push(point);
                    }
                }
            }
            far
        })
        .collect()
}

/// The ball at the deepest point along the inward normal that is no farther than `reach` from a sample.
fn deepest_under(solid: &Solid, sample: &SurfaceSample, reach: f64) -> Option<Ball> {
    // Even steps find the middle of a part about as thick as eps; halving ones that of a far thinner part.
    let even = (1..=16).map(|step| f64::from(step) / 16.0);
    let halving = (5..=40).map(|step| 0.5f64.powi(step));
    let mut best: Option<Ball> = None;
    for share in even.chain(halving) {
        let center = along(sample.point, -share * reach, sample.normal);
        let radius = solid.distance_within(center, share * reach);
        // Rounding leaves a distance to what the sample lies on.
        if radius > 1e-14 && best.is_none_or(|best| radius > best.radius) && solid.is_inside(center)
        {
            best = Some(Ball { center, radius });
        }
    }
    best
}

/// Balls added so far, by cells of their centres: a point within reach of one is at most a cell from its centre.
struct Added(SpatialHash<Ball>);

impl Added {
    fn new(cell: f64) -> Self {
        Self(SpatialHash::new(cell))
    }

    fn push(&mut self, ball: Ball) {
        self.0.push(ball.center, ball);
    }

    /// Whether `point` is within `reach` of a ball, for balls whose radius plus `reach` is no more than a cell.
    fn is_near(&self, point: [f64; 3], reach: f64) -> bool {
        self.0
            .around(point)
            .any(|ball| distance(ball.center, point) - ball.radius <= reach)
    }
}
