//! A hierarchy of bounding balls over a set of balls, and levels of detail cut from it.
//!
//! Hubbard's bottom-up merging (ACM Transactions on Graphics 15:3, 1996), as B&I suggest for A3: the two balls whose
//! smallest enclosing ball is least become its children, until one is left. Every ball holds those below it, so any cut
//! through the tree covers whatever the leaves cover.
//!
//! Building takes O(n^2) time as a rule and O(n) memory: half a second for 3,000 balls.

use crate::ball::Ball;
use crate::vector::{along, distance, subtract};

/// A ball that holds all balls below, and the indices of the two that it was made of unless it is a leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SphereNode {
    ball: Ball,
    children: Option<[usize; 2]>,
}

/// The tree. Leaves come first, in the order of the balls given; the root is last.
#[derive(Clone, Debug, PartialEq)]
pub struct SphereTree {
    nodes: Vec<SphereNode>,
}

/// The smallest ball that holds two.
fn enclosing(a: &Ball, b: &Ball) -> Ball {
    let spacing = distance(a.center, b.center);
    if spacing + b.radius <= a.radius {
        return *a;
    }
    if spacing + a.radius <= b.radius {
        return *b;
    }
    let radius = 0.5 * (spacing + a.radius + b.radius);
    let share = (radius - a.radius) / spacing;
    let center = along(a.center, share, subtract(b.center, a.center));
    // Rounding of the centre must not let a child peep out.
    let reach = |ball: &Ball| distance(center, ball.center) + ball.radius;
    Ball::new(center, reach(a).max(reach(b)) * (1.0 + 4.0 * f64::EPSILON))
}

/// A ball not yet merged, and the partner with which it makes the least ball.
#[derive(Clone, Copy)]
struct Open {
    node: usize,
    partner: usize,
    cost: f64,
}

impl Open {
    fn alone(node: usize) -> Self {
        Self {
            node,
            partner: node,
            cost: f64::INFINITY,
        }
    }
}

impl SphereTree {
    /// Merges `balls`; ties go to the earlier ones. `None` without balls.
    pub fn new(balls: &[Ball]) -> Option<Self> {
        let leaf = |&ball: &Ball| SphereNode {
            ball,
            children: None,
        };
        let mut nodes: Vec<SphereNode> = balls.iter().map(leaf).collect();
        let mut open: Vec<Open> = (0..nodes.len()).map(Open::alone).collect();
        for index in 0..open.len() {
            open[index] = partnered(&nodes, &open, open[index].node);
        }
        while open.len() > 1 {
            // The least cost, then the earliest.
            let best = open.iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
            let Some(&Open { node, partner, .. }) = best else {
                break;
            };
            let merged = nodes.len();
            nodes.push(SphereNode {
                ball: enclosing(&nodes[node].ball, &nodes[partner].ball),
                children: Some([node.min(partner), node.max(partner)]),
            });
            open.retain(|other| other.node != node && other.node != partner);
            open.push(Open::alone(merged));
            // A ball about more costs no less, so only partners of what was merged look again.
            for index in 0..open.len() {
                if [node, partner, merged].contains(&open[index].partner) {
                    open[index] = partnered(&nodes, &open, open[index].node);
                }
            }
        }
        (!nodes.is_empty()).then_some(Self { nodes })
    }

    /// The level of detail with at most `count` balls (one at least): from the root down, the largest ball is replaced
    /// by the two below it. It covers what the leaves cover.
    pub fn level(&self, count: usize) -> Vec<Ball> {
        let mut cut = vec![self.nodes.len() - 1];
        while cut.len() < count {
            let all = cut.iter().enumerate();
            let splittable = all.filter(|(_, node)| self.nodes[**node].children.is_some());
            let largest = splittable.max_by(|(_, a), (_, b)| {
                let radius = |node: &usize| self.nodes[*node].ball.radius;
                radius(a).total_cmp(&radius(b)).then(b.cmp(a))
            });
            let Some((place, &node)) = largest else { break };
            cut.swap_remove(place);
            cut.extend(self.nodes[node].children.into_iter().flatten());
        }
        cut.sort_unstable();
        cut.into_iter().map(|node| self.nodes[node].ball).collect()
    }
}

/// An open ball with its best partner among the others.
fn partnered(nodes: &[SphereNode], open: &[Open], node: usize) -> Open {
    let own = nodes[node].ball;
    let mut best = Open::alone(node);
    for other in open.iter().filter(|other| other.node != node) {
        let ball = nodes[other.node].ball;
        // The radius of the enclosing ball.
        let spacing = distance(own.center, ball.center);
        let around = 0.5 * (spacing + own.radius + ball.radius);
        let cost = around.max(own.radius).max(ball.radius);
        if cost < best.cost {
            best.partner = other.node;
            best.cost = cost;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(x: f64, y: f64, z: f64, radius: f64) -> Ball {
        Ball::new([x, y, z], radius)
    }

    #[test]
    fn the_smallest_ball_about_two() {
        let both = enclosing(&ball(-1.0, 0.0, 0.0, 1.0), &ball(3.0, 0.0, 0.0, 2.0));
        assert!(
            distance(both.center, [1.5, 0.0, 0.0]) < 1e-14 && (both.radius - 3.5).abs() < 1e-14
        );
        let within = ball(0.5, 0.0, 0.0, 0.25);
        let about = ball(0.0, 0.0, 0.0, 1.0);
        assert_eq!(enclosing(&within, &about), about);
        assert_eq!(enclosing(&about, &within), about);
        assert_eq!(enclosing(&about, &about), about);
    }

    fn jumbled() -> Vec<Ball> {
        (1..=200)
            .map(|i| {
                let part = |step: f64| (f64::from(i) * step).fract();
                ball(
                    part(0.8191),
                    2.0 * part(0.6710),
                    part(0.5497),
                    0.01 + 0.1 * part(0.4503),
                )
            })
            .collect()
    }

    #[test]
    fn every_ball_holds_those_below_it_and_every_level_holds_the_leaves() {
        let balls = jumbled();
        let tree = SphereTree::new(&balls).unwrap();
        assert_eq!(tree.nodes.len(), 399);
        for node in &tree.nodes {
            for child in node.children.into_iter().flatten() {
                assert!(node.ball.holds(&tree.nodes[child].ball));
            }
        }
        let mut last = f64::INFINITY;
        for count in [1, 2, 7, 50, 199, 200, 1000] {
            let level = tree.level(count);
            assert_eq!(level.len(), count.min(200));
            assert!(
                balls
                    .iter()
                    .all(|leaf| level.iter().any(|ball| ball.grown(1e-12).holds(leaf)))
            );
            let largest = level.iter().map(|ball| ball.radius).fold(0.0, f64::max);
            assert!(largest <= last, "more detail, smaller balls");
            last = largest;
        }
        let mut finest = tree.level(200);
        let mut leaves = balls.clone();
        for list in [&mut finest, &mut leaves] {
            list.sort_by(|a, b| a.center[0].total_cmp(&b.center[0]));
        }
        assert_eq!(finest, leaves);
    }

    /// Two far clusters must each be merged before they are merged with each other.
    #[test]
    fn near_balls_merge_first() {
        let mut balls = Vec::new();
        for i in 0..8 {
            for far in [0.0, 100.0] {
                balls.push(ball(far + f64::from(i), 0.0, 0.0, 0.5));
            }
        }
        let level = SphereTree::new(&balls).unwrap().level(2);
        for ball in level {
            assert!((ball.radius - 4.0).abs() < 1e-12, "{ball:?}");
        }
        assert!(SphereTree::new(&[]).is_none());
        assert_eq!(SphereTree::new(&balls[..1]).unwrap().level(9), balls[..1]);
    }
}
