//! The depth of a union of balls on a grid, and its surface by surface nets. Volume grids and free regions are read
//! from the depth too.

use fast_surface_nets::ndshape::RuntimeShape;
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use knotdock_structures::sampling::Ball;
use knotdock_structures::sampling::ball_tree::BallTree;
use rayon::prelude::*;

use super::bracket::bounds;

/// Cells of free space about the balls, on every side.
const PADDING: usize = 2;

/// Bytes that a node of the grid takes.
pub const BYTES_A_NODE: u64 = 8;

/// Places of the nodes of a grid. Index (z ny + y) nx + x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldGrid {
    /// The node of the lowest coordinates, relative to the balls' origin.
    pub first: [f64; 3],
    /// Distance between neighbours.
    pub spacing: f64,
    /// Nodes along x, y and z.
    pub shape: [usize; 3],
}

impl FieldGrid {
    /// The grid about balls, with about `cells` cells along the longest edge of the box around them and two more on
    /// each side. `None` without balls.
    pub fn about(balls: &[Ball], cells: usize) -> Option<Self> {
        let (low, high) = bounds(balls);
        let extent = [0, 1, 2].map(|axis| high[axis] - low[axis]);
        let longest = extent.into_iter().fold(0.0, f64::max);
        if balls.is_empty() || !longest.is_finite() || longest <= 0.0 {
            return None;
        }
        let spacing = longest / cells.max(1) as f64;
        let along = |axis: usize| ((extent[axis] / spacing).ceil() as usize).clamp(1, cells.max(1));
        let shape = [0, 1, 2].map(|axis| along(axis) + 2 * PADDING + 1);
        let first = [0, 1, 2].map(|axis| {
            let beyond = along(axis) as f64 * spacing - extent[axis];
            low[axis] - 0.5 * beyond - PADDING as f64 * spacing
        });
        Some(Self {
            first,
            spacing,
            shape,
        })
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.shape.iter().product()
    }

    /// Place of the node with numbers along x, y and z.
    pub fn place(&self, numbers: [usize; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.first[axis] + self.spacing * numbers[axis] as f64)
    }

    /// Numbers of a node along x, y and z.
    pub fn numbers(&self, node: usize) -> [usize; 3] {
        let [nx, ny, _] = self.shape;
        [node % nx, node / nx % ny, node / (nx * ny)]
    }
}

/// The depth of a union of balls at the nodes of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct BallField {
    /// The grid.
    pub grid: FieldGrid,
    /// Depth at each node, above zero inside a ball: there in the ball that the node is deepest in, outside minus the
    /// distance to the nearest.
    pub depth: Vec<f32>,
}

impl BallField {
    /// Measures the depth at every node, rows in parallel.
    pub fn new(tree: &BallTree, grid: FieldGrid) -> Self {
        let nx = grid.shape[0];
        let step = grid.spacing * (1.0 + 1e-9);
        let mut depth = vec![0.0f32; grid.nodes()];
        depth
            .par_chunks_mut(nx)
            .enumerate()
            .for_each(|(row, depths)| {
                let [_, y, z] = grid.numbers(row * nx);
                // No step along the row adds more than its length to the distance.
                let mut most = f64::INFINITY;
                for (x, depth) in depths.iter_mut().enumerate() {
                    let distance =
                        tree.distance_within(grid.place([x, y, z]), f64::NEG_INFINITY, most);
                    most = distance + step;
                    *depth = -distance as f32;
                }
            });
        Self { grid, depth }
    }

    /// Whether a node is in no ball.
    pub fn is_free(&self, node: usize) -> bool {
        self.depth.get(node).is_some_and(|&depth| depth < 0.0)
    }
}

/// The surface at depth zero by naive surface nets (Gibson, MICCAI 1998), in the frame of the files, where the balls'
/// origin is at `origin`. Vertices are within a cell of the surface; features narrower than a cell may be missing.
pub fn surface(field: &BallField, origin: [f64; 3]) -> Surface {
    let grid = field.grid;
    let size = grid.shape.map(|count| count as u32);
    let shape = RuntimeShape::<u32, 3>::new(size);
    // It is below zero inside, in units of the spacing.
    let distances: Vec<f32> = (field.depth.iter())
        .map(|depth| -depth / grid.spacing as f32)
        .collect();
    let mut nets = SurfaceNetsBuffer::default();
    surface_nets(
        &distances,
        &shape,
        [0; 3],
        size.map(|count| count - 1),
        &mut nets,
    );
    let place = |position: &[f32; 3]| {
        [0, 1, 2].map(|axis| {
            let number = f64::from(position[axis]);
            origin[axis] + (grid.first[axis] + grid.spacing * number)
        })
    };
    Surface {
        positions: nets.positions.iter().map(place).collect(),
        triangles: (nets.indices.chunks_exact(3))
            .map(|corners| [corners[0], corners[1], corners[2]])
            .collect(),
    }
}

/// A mesh that was computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Places of the vertices.
    pub positions: Vec<[f64; 3]>,
    /// Triangles by the numbers of their vertices, from zero, anticlockwise from outside.
    pub triangles: Vec<[u32; 3]>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_of_one_ball() {
        let ball = Ball {
            center: [5.0, -1.0, 2.0],
            radius: 1.5,
        };
        let grid = FieldGrid::about(&[ball], 20).unwrap();
        assert_eq!(grid.shape, [25; 3]);
        let field = BallField::new(&BallTree::new(&[ball]), grid);
        for (node, depth) in field.depth.iter().enumerate() {
            let place = grid.place(grid.numbers(node));
            let square: f64 = (0..3).map(|k| (place[k] - ball.center[k]).powi(2)).sum();
            assert!((f64::from(*depth) - (1.5 - square.sqrt())).abs() < 1e-6);
        }
        assert!(FieldGrid::about(&[], 20).is_none());
    }

    #[test]
    fn the_surface_of_two_balls_is_closed_and_faces_outward() {
        let ball = |x: f64| Ball {
            center: [x, 0.0, 0.0],
            radius: 1.0,
        };
        let balls = [ball(0.0), ball(4.0)];
        let grid = FieldGrid::about(&balls, 60).unwrap();
        let field = BallField::new(&BallTree::new(&balls), grid);
        let found = surface(&field, [1e6, 0.0, -1e6]);
        let corners = |triangle: &[u32; 3]| triangle.map(|corner| found.positions[corner as usize]);
        let mut edges = std::collections::HashMap::new();
        let mut volume = 0.0;
        for triangle in &found.triangles {
            for side in 0..3 {
                let [a, b] = [triangle[side], triangle[(side + 1) % 3]];
                *edges.entry((a.min(b), a.max(b))).or_insert(0) += if a < b { 1 } else { -1 };
            }
            let [a, b, c] = corners(triangle).map(|[x, y, z]| [x - 1e6, y, z + 1e6]);
            volume += (a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]))
                / 6.0;
        }
        assert!(edges.values().all(|&sum| sum == 0), "an open edge");
        let exact = 8.0 / 3.0 * std::f64::consts::PI;
        assert!((volume / exact - 1.0).abs() < 0.03, "{volume} {exact}");
    }
}
