//! Connected regions of the space that a union of balls leaves free, in a padded box about it.
//!
//! Free nodes of the grid are joined to neighbours, along edges and diagonals, where the whole way is free: seen at
//! points between which the distance to the balls leaves no room for one. So a wall thinner than the spacing separates,
//! down to a hundredth of it. A gap narrower than the spacing may be missed: the count belongs to the grid.

use knotdock_structures::sampling::ball_tree::BallTree;

use crate::geometry::ball_field::BallField;

/// Halvings of an edge at most: between points so near, all of them free, nothing counts as closed.
const HALVINGS: u32 = 6;

/// Steps to the neighbours of a node, one of each opposite two: along edges and diagonals, so that some step leads away
/// from any surface nearly along its normal, out of dimples between balls.
fn steps() -> impl Iterator<Item = [isize; 3]> {
    (14..27).map(|number| [number / 9 - 1, number / 3 % 3 - 1, number % 3 - 1])
}

/// A component of the free nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// A node of it, the first.
    pub node: usize,
    /// Number of its nodes.
    pub nodes: usize,
}

/// The free regions, the largest first. The one around the balls is among them.
pub fn free_regions(field: &BallField, tree: &BallTree) -> Vec<Region> {
    let grid = field.grid;
    let mut sets = DisjointSets::new(field.depth.len());
    for node in 0..field.depth.len() {
        if !field.is_free(node) {
            continue;
        }
        let numbers = grid.numbers(node);
        for step in steps() {
            let moved = |axis: usize| numbers[axis].checked_add_signed(step[axis]);
            let (Some(x), Some(y), Some(z)) = (moved(0), moved(1), moved(2)) else {
                continue;
            };
            let next = [x, y, z];
            if (0..3).any(|axis| next[axis] >= grid.shape[axis]) {
                continue;
            }
            let other = (z * grid.shape[1] + y) * grid.shape[0] + x;
            if !field.is_free(other) || sets.find(node) == sets.find(other) {
                continue;
            }
            let axes = step.iter().filter(|&&part| part != 0).count();
            let length = grid.spacing * (axes as f64).sqrt();
            if is_free(
                tree,
                grid.place(numbers),
                grid.place(next),
                length,
                HALVINGS,
            ) {
                sets.join(node, other);
            }
        }
    }
    let mut sizes = vec![0usize; field.depth.len()];
    for node in (0..field.depth.len()).filter(|&node| field.is_free(node)) {
        sizes[sets.find(node)] += 1;
    }
    let found = sizes.iter().enumerate().filter(|(_, nodes)| **nodes > 0);
    let mut regions: Vec<Region> = found.map(|(node, &nodes)| Region { node, nodes }).collect();
    regions.sort_by(|a, b| b.nodes.cmp(&a.nodes).then(a.node.cmp(&b.node)));
    regions
}

/// Whether no ball reaches the segment from `a` to `b`, of this length.
fn is_free(tree: &BallTree, a: [f64; 3], b: [f64; 3], length: f64, halvings: u32) -> bool {
    let middle = [0, 1, 2].map(|axis| 0.5 * (a[axis] + b[axis]));
    let half = 0.5 * length;
    let distance = tree.distance_within(middle, 0.0, length);
    if distance >= half {
        return true;
    }
    let is_free = |from, to| is_free(tree, from, to, half, halvings - 1);
    distance > 0.0 && (halvings == 0 || is_free(a, middle) && is_free(middle, b))
}

/// Sets of numbers that are joined two by two, each represented by its least number.
struct DisjointSets(Vec<u32>);

impl DisjointSets {
    fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    fn find(&mut self, mut number: usize) -> usize {
        while self.0[number] as usize != number {
            // Every look shortens the way.
            self.0[number] = self.0[self.0[number] as usize];
            number = self.0[number] as usize;
        }
        number
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b)] = a.min(b) as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::ball_field::FieldGrid;
    use knotdock_structures::sampling::Ball;

    fn count(balls: &[Ball], cells: usize) -> usize {
        let tree = BallTree::new(balls);
        let grid = FieldGrid::about(balls, cells).unwrap();
        free_regions(&BallField::new(&tree, grid), &tree).len()
    }

    /// Balls on a spiral about a sphere of radius 1: a shell.
    fn shell(radius: f64) -> Vec<Ball> {
        let count = 2000;
        (0..count)
            .map(|i| {
                let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
                let angle = 2.399_963_229_728_653 * f64::from(i);
                let across = (1.0 - z * z).sqrt();
                Ball {
                    center: [across * angle.cos(), across * angle.sin(), z],
                    radius,
                }
            })
            .collect()
    }

    /// Of a shell the inside is free and does not reach the outside, even where its wall is thinner than a cell.
    #[test]
    fn a_shell_leaves_two_regions_and_a_solid_one() {
        assert_eq!(count(&shell(0.1), 40), 2);
        assert_eq!(count(&shell(0.08), 16), 2);
        // Filled, or with holes between the balls that are as wide as cells, one.
        let full = Ball {
            center: [0.0; 3],
            radius: 1.0,
        };
        assert_eq!(count(&[shell(0.1), vec![full]].concat(), 40), 1);
        assert_eq!(count(&shell(0.01), 60), 1);
    }
}
