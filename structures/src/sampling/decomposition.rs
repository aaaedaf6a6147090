//! Spherical decomposition: B&I, Algorithm 1, with corrections of its listing.
//!
//! 1. **A1.** Nodes inside are taken by falling priority. Each gives the ball of its distance to the surface and
//!    marks the nodes in it as covered. It removes from the queue the nodes x' with r(x') <= r(x) and |x - x'| -
//!    (r(x) - r(x')) <= mu r(x'). This ends when every inside node is covered. Then [`super::cover`] adds balls until
//!    no point of the surface is farther than eps from A1.
//! 2. **A2** is A1 grown by eps.
//! 3. **A3** is A2 without the balls whose original is in the grown ball of one that is kept, the largest first.
//!
//! Differences from the listing, with reasons:
//!
//! - *r(x') <= r(x).* The listing takes |r(x) - r(x')|, by which a small ball strikes a larger one that contains it.
//! - *The queue cannot run dry too early.* With the above and mu <= 1, a struck node is covered:
//!   |x - x'| <= r(x) - (1 - mu) r(x').
//! - *One ball, not a union.* The paper's eq. 57 drops a ball in the union of the other grown balls. Its listing, its
//!   proof of Proposition 3 and this code drop a ball only if it is in a single other one: a stricter test, which keeps
//!   more balls.
//! - *Kept, and the largest first.* The listing drops a ball in any grown ball, even in its own. It also drops chains
//!   of balls each of which is in the next, so that nothing need be left near the first.
//! - *The surface is covered too.* Lemma 4 of the paper, d(x, X) <= eps for x in S, is false if the node nearest to x
//!   is outside S. Under a flat face just below a plane of nodes X ends sqrt(2) eps away. Its Propositions 1 to 3 rest
//!   on it.
//!
//! Let S(A) be the union of the balls. For a closed mesh then S(A1) in S in S(A2), and S(A1) in S(A3) in S(A2). Each
//! is within eps of S in the Hausdorff distance of solids. [`super::hausdorff`] measures it.

use crate::ball::Ball;
use crate::mesh::Solid;
use crate::neighbours::SpatialHash;
use crate::sampling::cover::{self, Covering};
use crate::sampling::grid::DepthField;
use crate::sampling::sample::SampleError;
use crate::sampling::skeletal_density::{Priority, priorities};

/// The protrusion factor mu and the order of the nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DecompositionOptions {
    /// Protrusion factor mu, from 0 (strike only balls that lie within another) to 1 (strike all that are covered).
    pub mu: f64,
    /// The order in which nodes are taken.
    pub priority: Priority,
}

impl Default for DecompositionOptions {
    fn default() -> Self {
        Self {
            mu: 0.25,
            priority: Priority::SkeletalDensity,
        }
    }
}

/// The three sets of balls, in the solid's unit, in the order in which they were found.
#[derive(Clone, Debug, PartialEq)]
pub struct Decomposition {
    /// Balls inside the solid.
    pub a1: Vec<Ball>,
    /// `a1` grown by eps.
    pub a2: Vec<Ball>,
    /// `a2` without those that others make redundant.
    pub a3: Vec<Ball>,
    /// Balls added to `a1` after the nodes were covered.
    pub covering: Covering,
}

/// Decomposes a solid into balls.
///
/// # Errors
/// [`SampleError::NothingInside`] when neither a node nor a point under the surface is inside the solid.
pub fn decompose(
    solid: &Solid,
    field: &DepthField,
    options: &DecompositionOptions,
) -> Result<Decomposition, SampleError> {
    let nodes = field.inside();
    let priorities = priorities(solid, field, &nodes, options.priority);
    decompose_in_order(solid, field, &nodes, &priorities, options.mu)
}

/// As [`decompose`], with the priority of each inside node given.
pub(crate) fn decompose_in_order(
    solid: &Solid,
    field: &DepthField,
    nodes: &[usize],
    priorities: &[f64],
    mu: f64,
) -> Result<Decomposition, SampleError> {
    let mut a1 = take_nodes(field, nodes, priorities, mu);
    let epsilon = field.grid.epsilon();
    let covering = cover::cover(solid, field, &mut a1);
    if a1.is_empty() {
        return Err(SampleError::NothingInside);
    }
    let a2: Vec<Ball> = a1.iter().map(|ball| ball.grown(epsilon)).collect();
    let a3 = reduce(&a1, epsilon)
        .into_iter()
        .map(|index| a2[index])
        .collect();
    Ok(Decomposition {
        a1,
        a2,
        a3,
        covering,
    })
}

/// Step 1 on the grid of any depth, the largest balls first: every node inside is in one of the balls, and no ball
/// reaches out of the solid.
pub fn cover_nodes(field: &DepthField, mu: f64) -> Vec<Ball> {
    let nodes = field.inside();
    let radii: Vec<f64> = nodes.iter().map(|&node| field.depth[node]).collect();
    take_nodes(field, &nodes, &radii, mu)
}

/// Symmetric solids have many nodes of one radius and density, which the last digits must not order: they change with
/// the unit and the place of the file. Numbers that differ by less than this share of the largest count as equal.
const TIES: f64 = 1e-9;

/// Numbers rounded to multiples of [`TIES`] of the largest.
fn rounded(numbers: &[f64]) -> Vec<f64> {
    let largest = numbers
        .iter()
        .fold(0.0, |most: f64, number| most.max(number.abs()));
    let unit = 1.0 / (TIES * largest.max(f64::MIN_POSITIVE));
    numbers
        .iter()
        .map(|number| (number * unit).round())
        .collect()
}

fn take_nodes(field: &DepthField, nodes: &[usize], priorities: &[f64], mu: f64) -> Vec<Ball> {
    // Ties: the larger ball, then the lower index, so that the order does not depend on the sort.
    let (priorities, radii) = (rounded(priorities), rounded(&field.depth));
    let mut queue: Vec<usize> = (0..nodes.len()).collect();
    queue.sort_unstable_by(|&a, &b| {
        priorities[b]
            .total_cmp(&priorities[a])
            .then(radii[nodes[b]].total_cmp(&radii[nodes[a]]))
            .then(nodes[a].cmp(&nodes[b]))
    });
    let mut struck = vec![false; field.depth.len()];
    let mut covered = vec![false; field.depth.len()];
    let mut left = nodes.len();
    let mut balls = Vec::new();
    for place in queue {
        if left == 0 {
            break;
        }
        let node = nodes[place];
        if struck[node] {
            continue;
        }
        let ball = Ball::new(field.grid.node(node), field.depth[node]);
        field
            .grid
            .visit_ball(ball.center, ball.radius, |other, squared| {
                let radius = field.depth[other];
                // A node on the ball's sphere may be on the surface.
                if radius <= 0.0 {
                    return;
                }
                if !covered[other] {
                    covered[other] = true;
                    left -= 1;
                }
                let beyond = squared.sqrt() - (ball.radius - radius);
                if radii[other] <= radii[node] && beyond <= mu * radius + TIES * ball.radius {
                    struck[other] = true;
                }
            });
        balls.push(ball);
    }
    // Whatever is struck was covered, and whatever is not was taken: see the module's second point.
    debug_assert_eq!(left, 0, "the queue ran dry before every node was covered");
    balls
}

/// Step 3: which balls to keep, in rising order.
pub(crate) fn reduce(balls: &[Ball], epsilon: f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..balls.len()).collect();
    let radii: Vec<f64> = balls.iter().map(|ball| ball.radius).collect();
    let radii = rounded(&radii);
    order.sort_by(|&a, &b| radii[b].total_cmp(&radii[a]).then(a.cmp(&b)));
    // Balls up to four eps are looked up in cells of their reach; the few larger ones are tried in turn.
    let mut large: Vec<Ball> = Vec::new();
    let mut small = SpatialHash::new(5.0 * epsilon);
    let mut kept = Vec::new();
    for index in order {
        let ball = balls[index];
        let mut near = small.around(ball.center);
        if large.iter().any(|other| other.holds(&ball))
            || near.any(|other: &Ball| other.holds(&ball))
        {
            continue;
        }
        drop(near);
        kept.push(index);
        let grown = ball.grown(epsilon);
        if ball.radius > 4.0 * epsilon {
            large.push(grown);
        } else {
            small.push(ball.center, grown);
        }
    }
    kept.sort_unstable();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::grid::Grid;
    use crate::test_support::{cuboid, cuboid_between};

    /// As printed, |r(x) - r(x')| lets a small ball strike a larger one that contains it: with the smallest balls taken
    /// first the middle of the cube then goes missing. And whatever the order and mu, every node must end up covered.
    #[test]
    fn a_small_ball_never_strikes_a_larger_one() {
        let solid = cuboid([0.5; 3]);
        let field = DepthField::new(&solid, Grid::new(&solid, 11));
        let nodes = field.inside();
        let smallest_first: Vec<f64> = nodes.iter().map(|&node| -field.depth[node]).collect();
        let jumbled: Vec<f64> = nodes
            .iter()
            .map(|&node| (node as f64 * 0.754_877_666).fract())
            .collect();
        for mu in [0.0, 0.25, 1.0] {
            for priorities in [&smallest_first, &jumbled] {
                let balls = take_nodes(&field, &nodes, priorities, mu);
                for &node in &nodes {
                    let place = field.grid.node(node);
                    let tree = crate::sampling::ball_tree::BallTree::new(&balls);
                    assert!(
                        tree.distance(place, 1e-12) <= 1e-12,
                        "mu {mu}: node {node} is not covered"
                    );
                }
            }
            // The ball that touches all faces is in no other, so nothing may strike it before every node is covered.
            let balls = take_nodes(&field, &nodes, &jumbled, 0.0);
            assert!(balls.iter().any(|ball| ball.radius == 0.5));
        }
    }

    /// A box has thousands of ties. In another unit and at another place it is the same box.
    #[test]
    fn balls_do_not_depend_on_the_unit_or_the_place() {
        let corners = |scale: f64, shift: f64| {
            let corner = |x: f64, by: f64| x * scale + by * shift;
            cuboid_between(
                [corner(-1.5, 0.3), corner(-1.0, 0.7), corner(-0.5, -0.2)],
                [corner(1.5, 0.3), corner(1.0, 0.7), corner(0.5, -0.2)],
            )
        };
        let balls = |scale: f64, shift: f64| {
            let solid = corners(scale, shift);
            let field = DepthField::new(&solid, Grid::new(&solid, 24));
            let found = decompose(&solid, &field, &DecompositionOptions::default()).unwrap();
            let unit = solid.frame().unit / scale;
            let scaled = |ball: &Ball| Ball::new(ball.center.map(|x| x * unit), ball.radius * unit);
            [&found.a1, &found.a3].map(|set| set.iter().map(scaled).collect::<Vec<_>>())
        };
        let first = balls(1.0, 0.0);
        for (scale, shift) in [(1e3, 0.0), (0.7, 0.0), (1.0, 1.0), (1e3, 1e3)] {
            for (one, other) in first.iter().zip(balls(scale, shift)) {
                assert_eq!(one.len(), other.len(), "{scale} {shift}");
                for (one, other) in one.iter().zip(&other) {
                    let off = crate::vector::distance(one.center, other.center);
                    let off = off + (one.radius - other.radius).abs();
                    assert!(off < 1e-10, "{scale} {shift}: {one:?} {other:?}");
                }
            }
        }
    }

    /// As printed, step 3 drops every ball, since each is in its own growth. If each ball of a chain is in the growth
    /// of the next one, it keeps only the last, so that nothing is left near the first.
    #[test]
    fn what_is_dropped_lies_in_a_ball_that_is_kept() {
        let epsilon = 0.1;
        let one = [Ball::new([0.0; 3], 1.0)];
        assert_eq!(reduce(&one, epsilon), [0]);
        let chain: Vec<Ball> = (0..20)
            .map(|i| f64::from(i) * 0.08)
            .map(|x| Ball::new([x, 0.0, 0.0], 1.0 + 0.01 * x))
            .collect();
        for pair in chain.windows(2) {
            assert!(pair[1].grown(epsilon).holds(&pair[0]));
        }
        for scale in [1.0, 0.1] {
            // Above and below the size from which balls are kept separate.
            let balls: Vec<Ball> = chain
                .iter()
                .map(|ball| Ball::new(ball.center, scale * ball.radius))
                .collect();
            let kept = reduce(&balls, epsilon);
            assert!(kept.len() < balls.len());
            for ball in &balls {
                assert!(
                    kept.iter()
                        .any(|&index| balls[index].grown(epsilon).holds(ball))
                );
            }
        }
    }
}
