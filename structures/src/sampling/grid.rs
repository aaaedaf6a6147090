//! The grid of nodes that a solid is sampled on, and the solid's depth at them.
//!
//! B&I, Algorithm 1, step 0: the cube of the bounding box's longest edge 2 L, centred on it, with n nodes along each
//! edge, both ends included. The spacing is h = 2 L / (n - 1), and no point of the cube is farther from a node than eps
//! = sqrt(3) L / (n - 1).
//!
//! The paper prints [-L, L) and eps = sqrt(3) L / n; its counts of inside nodes are those of n - 1.

use rayon::prelude::*;

use crate::mesh::Solid;

/// Nearer to the surface than this, in the solid's unit, a node counts as on it: the distance is rounding.
pub const ON_SURFACE: f64 = 1e-12;

/// The nodes of a cube. Index (z n + y) n + x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    per_axis: usize,
    half: f64,
}

impl Grid {
    /// The grid of a solid with `per_axis` nodes along each edge, at least two.
    pub fn new(solid: &Solid, per_axis: usize) -> Self {
        Self {
            per_axis: per_axis.max(2),
            half: solid.half_sides().into_iter().fold(0.0, f64::max),
        }
    }

    /// The grid of a cube of this edge about the origin, with `per_axis` nodes along each edge, at least two.
    pub fn of_edge(edge: f64, per_axis: usize) -> Self {
        Self {
            per_axis: per_axis.max(2),
            half: 0.5 * edge,
        }
    }

    /// The same nodes and more about them: at least `margin` on every side, in the solid's unit.
    #[must_use]
    pub fn padded(&self, margin: f64) -> Self {
        let more = (margin / self.spacing()).ceil().max(0.0);
        Self {
            per_axis: self.per_axis + 2 * more as usize,
            half: self.half + more * self.spacing(),
        }
    }

    /// Nodes along each edge, n.
    pub fn per_axis(&self) -> usize {
        self.per_axis
    }

    /// Number of nodes, m = n^3.
    pub fn nodes(&self) -> usize {
        self.per_axis * self.per_axis * self.per_axis
    }

    /// Half the edge of the cube, L, in the solid's unit.
    pub fn half(&self) -> f64 {
        self.half
    }

    /// Distance between neighbours, h, in the solid's unit.
    pub fn spacing(&self) -> f64 {
        2.0 * self.half / (self.per_axis - 1) as f64
    }

    /// The bound eps = sqrt(3) L / (n - 1) = sqrt(3) h / 2, in the solid's unit.
    pub fn epsilon(&self) -> f64 {
        3f64.sqrt() * self.half / (self.per_axis - 1) as f64
    }

    /// Coordinate of the nodes of one number, from 0 to n - 1, along an axis; the same but for its sign from both ends.
    pub fn coordinate(&self, number: usize) -> f64 {
        let last = (self.per_axis - 1) as f64;
        self.half * ((2.0 * number as f64 - last) / last)
    }

    /// Place of a node.
    pub fn node(&self, index: usize) -> [f64; 3] {
        self.numbers(index).map(|number| self.coordinate(number))
    }

    /// Numbers of a node along x, y and z.
    pub fn numbers(&self, index: usize) -> [usize; 3] {
        let n = self.per_axis;
        [index % n, index / n % n, index / (n * n)]
    }

    /// Index of the node with these numbers.
    pub fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.per_axis + y) * self.per_axis + x
    }

    /// Calls `visit` with the index of every node within `radius` of `center` (both in the solid's unit) and its
    /// squared distance; nodes that rounding puts on either side of the sphere count as within.
    pub fn visit_ball(&self, center: [f64; 3], radius: f64, mut visit: impl FnMut(usize, f64)) {
        let h = self.spacing();
        let limit = radius * radius * (1.0 + 1e-14);
        let range = |middle: f64, reach: f64| {
            let first = ((middle - reach + self.half) / h - 1e-9).ceil().max(0.0) as usize;
            let last = ((middle + reach + self.half) / h + 1e-9).floor();
            let end = if last < 0.0 {
                0
            } else {
                (last as usize + 1).min(self.per_axis)
            };
            first..end
        };
        for z in range(center[2], radius) {
            let dz = self.coordinate(z) - center[2];
            for y in range(center[1], radius) {
                let dy = self.coordinate(y) - center[1];
                let across = dz * dz + dy * dy;
                if across > limit {
                    continue;
                }
                for x in range(center[0], (limit - across).sqrt()) {
                    let dx = self.coordinate(x) - center[0];
                    let squared = across + dx * dx;
                    if squared <= limit {
                        visit(self.index([x, y, z]), squared);
                    }
                }
            }
        }
    }
}

/// The depth (signed distance, above zero inside) of a solid at the nodes of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthField {
    /// The grid.
    pub grid: Grid,
    /// Depth at each node, in the solid's unit; zero on the surface.
    pub depth: Vec<f64>,
}

impl DepthField {
    /// Measures the depth at every node, rows in parallel.
    ///
    /// Along a row the last distance plus the spacing bounds the next one. In a closed mesh two neighbours are on one
    /// side if their distances together exceed the spacing, so winding numbers are taken near the surface only.
    pub fn new(solid: &Solid, grid: Grid) -> Self {
        let h = grid.spacing();
        let closed = solid.mesh().is_closed();
        Self::by_rows(grid, |point, last: Option<f64>| {
            let distance = match last {
                Some(last) => solid.distance_within(point, last.abs() + h),
                None => solid.distance(point),
            };
            // On the surface the sign says nothing about the next node; zero plus any distance up to h asks again.
            let inside = match last {
                Some(last) if closed && last.abs() + distance > h * (1.0 + 1e-9) => last > 0.0,
                _ => solid.is_inside(point),
            };
            match distance {
                ..ON_SURFACE => 0.0,
                _ if inside => distance,
                _ => -distance,
            }
        })
    }

    /// The depth that a function gives, rows in parallel.
    ///
    /// `depth_within(point, most)` is the depth at a point, or `most` if it is more than that. The depths of two points
    /// differ by the length between them at most, so that each bounds the next one.
    pub fn of_depth(grid: Grid, depth_within: impl Fn([f64; 3], f64) -> f64 + Sync) -> Self {
        let h = grid.spacing();
        let rounding = grid.half() * 1e-12;
        Self::by_rows(grid, |point, last: Option<f64>| {
            let most = last.map_or(f64::INFINITY, |last| last + h + rounding);
            depth_within(point, most)
        })
    }

    /// Depths by the point of each node and the depth of the one before it in its row, rows in parallel.
    fn by_rows(grid: Grid, depth_at: impl Fn([f64; 3], Option<f64>) -> f64 + Sync) -> Self {
        let n = grid.per_axis();
        let mut depth = vec![0.0; grid.nodes()];
        let rows = depth.par_chunks_mut(n).enumerate();
        rows.for_each(|(row, depths)| {
            let mut last = None;
            for (x, depth) in depths.iter_mut().enumerate() {
                *depth = depth_at(grid.node(row * n + x), last);
                last = Some(*depth);
            }
        });
        Self { grid, depth }
    }

    /// The nodes strictly inside, X, in rising order.
    pub fn inside(&self) -> Vec<usize> {
        (0..self.depth.len())
            .filter(|&node| self.depth[node] > 0.0)
            .collect()
    }
}
