//! The complement of a union of balls in a cube, as balls.
//!
//! The depth of a point in the complement is its distance to the union, and Algorithm 1 samples it as that of any solid
//! ([`cover_nodes`]).
//!
//! - [`inside`]: balls that reach no ball of the union. Every free node is in one of them.
//! - [`holding`]: balls that hold all of the cube that the union leaves free. Let eps be the reach of a node's cell.
//!   Nodes with a depth of more than eps are covered by balls of the depth less eps, which grow by eps and then hold
//!   the cells, and still reach no ball of the union. Of the other cells near the surface, each is halved along its
//!   axes twice. The parts that no single ball of either set holds get a ball around them. Only these reach
//!   into the union, by less than 2 eps.

use knotdock_structures::sampling::Ball;
use knotdock_structures::sampling::ball_tree::BallTree;
use knotdock_structures::sampling::decomposition::cover_nodes;
use knotdock_structures::sampling::grid::{DepthField, Grid};
use rayon::prelude::*;

use super::held_cells::HeldCells;
use crate::geometry::bracket::{bounds, shifted};

/// The protrusion factor mu of Algorithm 1.
const MU: f64 = 0.25;
/// Times that a cell near the surface is halved.
const HALVINGS: u32 = 2;

/// A cube with a grid of nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cube {
    /// Its middle.
    pub center: [f64; 3],
    /// Half of its edge.
    pub half: f64,
    /// Nodes along each edge.
    pub per_axis: usize,
}

impl Cube {
    /// The cube about a box, `cells` cells wider on each side.
    pub fn about((low, high): ([f64; 3], [f64; 3]), per_axis: usize, cells: f64) -> Self {
        let half = (0..3).map(|axis| 0.5 * (high[axis] - low[axis]));
        let half = half.fold(0.0, f64::max);
        let across = (per_axis.max(8) - 1) as f64;
        Self {
            center: [0, 1, 2].map(|axis| 0.5 * (low[axis] + high[axis])),
            half: half * across / (across - 2.0 * cells),
            per_axis: per_axis.max(8),
        }
    }

    /// The cube wider by a length on each side, with nodes as dense.
    #[must_use]
    pub fn wider(&self, by: f64) -> Self {
        let share = 1.0 + by / self.half;
        Self {
            half: self.half + by,
            per_axis: ((self.per_axis - 1) as f64 * share).ceil() as usize + 1,
            ..*self
        }
    }

    fn grid(&self) -> Grid {
        Grid::of_edge(2.0 * self.half, self.per_axis)
    }

    /// Balls relative to the middle.
    fn inward(&self, balls: &[Ball]) -> Vec<Ball> {
        let by = self.center.map(|part| -part);
        balls.iter().map(|ball| shifted(ball, by)).collect()
    }

    /// Balls relative to the middle's own origin.
    fn outward(&self, balls: Vec<Ball>) -> Vec<Ball> {
        let balls = balls.iter().map(|ball| shifted(ball, self.center));
        balls.collect()
    }
}

/// The balls of a union, the larger ones best first, that make a difference within a cube: the others meet only cells of
/// its grid that single balls hold.
pub fn needed_in(cube: &Cube, balls: impl Iterator<Item = Ball>) -> Vec<Ball> {
    let mut cells = HeldCells::new(cube.grid());
    let by = cube.center.map(|part| -part);
    balls
        .filter(|ball| cells.takes(&shifted(ball, by)))
        .collect()
}

/// The distance to a union of balls at the nodes of a grid; infinite without balls. Up to `enough` it says no more than
/// "within".
fn distances(tree: &BallTree, grid: Grid, enough: f64) -> DepthField {
    DepthField::of_depth(grid, |point, most| {
        tree.distance_within(point, enough, most)
    })
}

/// Balls that no ball of the union reaches and that hold all free nodes of the cube.
pub fn inside(union: &[Ball], cube: &Cube) -> Vec<Ball> {
    let tree = BallTree::new(&cube.inward(union));
    cube.outward(cover_nodes(&distances(&tree, cube.grid(), 0.0), MU))
}

/// Balls that, with the union, hold all of the cube.
pub fn holding(union: &[Ball], cube: &Cube) -> Vec<Ball> {
    let tree = BallTree::new(&cube.inward(union));
    let grid = cube.grid();
    let epsilon = grid.epsilon() * (1.0 + 1e-9);
    let mut field = distances(&tree, grid, -1.0001 * epsilon);
    let near: Vec<usize> = (0..grid.nodes())
        .filter(|&node| field.depth[node].abs() <= epsilon)
        .collect();
    for depth in &mut field.depth {
        *depth -= epsilon;
    }
    let free = cover_nodes(&field, MU);
    let mut balls: Vec<Ball> = free.iter().map(|ball| ball.grown(epsilon)).collect();
    let free = BallTree::new(&balls);
    let half = 0.5 * grid.spacing() * (1.0 + 1e-9);
    let of_cells: Vec<Option<Ball>> = near
        .par_iter()
        .map(|&node| {
            let center = grid.node(node);
            let is_held = |ball: &Ball| free.holds(ball) || tree.holds(ball);
            let mut left = Vec::new();
            unheld(&is_held, center, half, HALVINGS, &mut left);
            (!left.is_empty()).then(|| around(bounds(&left)))
        })
        .collect();
    balls.extend(of_cells.into_iter().flatten());
    cube.outward(balls)
}

/// Lists the parts of the cube of half edge `half` about `center` that no single ball holds, each as the ball inside it.
fn unheld(
    is_held: &impl Fn(&Ball) -> bool,
    center: [f64; 3],
    half: f64,
    halvings: u32,
    left: &mut Vec<Ball>,
) {
    let radius = half * 3f64.sqrt();
    if is_held(&Ball { center, radius }) {
        return;
    }
    if halvings == 0 {
        let radius = half;
        left.push(Ball { center, radius });
        return;
    }
    let quarter = 0.5 * half;
    for corner in 0..8u32 {
        let middle = [0, 1, 2].map(|axis| {
            let sign = if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
            center[axis] + sign * quarter
        });
        unheld(is_held, middle, quarter, halvings - 1, left);
    }
}

/// The ball around a box.
fn around((low, high): ([f64; 3], [f64; 3])) -> Ball {
    let extent = [0, 1, 2].map(|axis| 0.5 * (high[axis] - low[axis]));
    Ball {
        center: [0, 1, 2].map(|axis| 0.5 * (low[axis] + high[axis])),
        radius: (extent.iter().map(|part| part * part).sum::<f64>()).sqrt(),
    }
}

/// Upper bound of the distance of a point of the outer union from the inner one; infinite if only the latter is empty,
/// zero if both are.
///
/// Every point of the outer union has a node within eps, at which the outer distance is eps at most. So eps more than
/// the largest inner distance of such nodes is the bound.
pub fn hausdorff_bound(inner: &[Ball], outer: &[Ball], per_axis: usize) -> f64 {
    if outer.is_empty() {
        return 0.0;
    }
    if inner.is_empty() {
        return f64::INFINITY;
    }
    let cube = Cube::about(bounds(outer), per_axis, 0.0);
    let grid = cube.grid();
    let epsilon = grid.epsilon() * (1.0 + 1e-9);
    let [outer, inner] = [outer, inner].map(|balls| BallTree::new(&cube.inward(balls)));
    let outward = distances(&outer, grid, epsilon);
    let farthest = (0..grid.nodes())
        .into_par_iter()
        .filter(|&node| outward.depth[node] <= epsilon)
        .map(|node| inner.distance(grid.node(node), 0.0))
        .reduce(|| f64::NEG_INFINITY, f64::max);
    (farthest + epsilon).max(0.0)
}
