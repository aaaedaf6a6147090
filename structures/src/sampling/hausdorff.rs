//! Fit of a set of balls to a solid: Hausdorff distances both ways, and volumes missed and outside.
//!
//! *Inward*, from S to S(A): the farthest that a point of the solid is from the balls. It is taken over samples of
//! the surface spaced by eps / 10 at most, and over the inside points of a grid of 8 m points. The grid is every node
//! moved by a quarter of the spacing in each of the eight directions. Samples with nothing of the solid on either
//! side are not points of it. A point between samples may be farther, so the distance measured is a lower bound. The
//! upper one holds for closed meshes. The cells about the grid's points are halved until each is outside the solid, or
//! its middle is so near to the balls that none of its points is farther.
//!
//! *Outward*, from S(A) to S: the farthest that a point of the balls is from the solid. It is taken over the same
//! grid's points in the balls, and over the point of each ball's sphere on the far side of the surface point nearest to
//! its centre. If that leaves room, the whole sphere is searched (`outward`). A ball of radius R at depth d reaches
//! no farther out than R - d, which is reported as the bound.
//!
//! Solids, not their boundaries, are compared, as in the paper's propositions.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use crate::ball::Ball;
use crate::mesh::{Solid, is_beside};
use crate::sampling::ball_tree::BallTree;
use crate::sampling::beyond::volume_beyond;
use crate::sampling::cover::SAMPLE_SPACING;
use crate::sampling::grid::DepthField;
use crate::sampling::outward::farthest;
use crate::vector::{along, distance, subtract};

/// How much farther out than measured a point of a ball's sphere may be, as a share of eps.
const OUTWARD_TOLERANCE: f64 = 0.01;

/// How far above the inward distance measured its upper bound may be without more search, as a share of eps.
const INWARD_TOLERANCE: f64 = 1.0 / 32.0;
/// Times that a cell is halved for the upper bound; the last ones reach [`INWARD_TOLERANCE`] / 2 from their middles.
const HALVINGS: u32 = 5;

/// Result of [`HausdorffMeter::measure`]. Lengths and volumes are in the solid's unit and its cube.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fit {
    /// Farthest distance of a point of the solid from the balls that was found: a lower bound.
    pub hausdorff_inward: f64,
    /// No point of the solid is farther from the balls than this; `None` for meshes that are not closed.
    pub inward_bound: Option<f64>,
    /// Farthest distance of a point of the balls from the solid.
    pub hausdorff_outward: f64,
    /// No point of the balls can be farther from the solid than this.
    pub outward_bound: f64,
    /// Volume of the solid that no ball covers.
    pub volume_missed: f64,
    /// Volume of the balls outside the solid.
    pub volume_outside: f64,
    /// Inside nodes that no ball covers.
    pub nodes_missed: usize,
}

/// A solid with data for measuring sets of balls.
pub struct HausdorffMeter<'a> {
    solid: &'a Solid,
    field: &'a DepthField,
    fine: FineGrid,
    /// For each row of the fine grid along x, one bit per point: inside the solid.
    inside: Vec<u64>,
}

/// The grid of 8 m points: two about each node along each axis, and a margin of one spacing about the cube, since balls
/// may reach beyond it.
#[derive(Clone, Copy)]
struct FineGrid {
    per_axis: usize,
    words: usize,
    first: f64,
    step: f64,
}

impl FineGrid {
    fn new(field: &DepthField) -> Self {
        let spacing = field.grid.spacing();
        let per_axis = 2 * (field.grid.per_axis() + 2);
        Self {
            per_axis,
            words: per_axis.div_ceil(64),
            first: -field.grid.half() - 1.25 * spacing,
            step: 0.5 * spacing,
        }
    }

    fn coordinate(&self, number: usize) -> f64 {
        self.first + self.step * number as f64
    }

    fn rows(&self) -> usize {
        self.per_axis * self.per_axis
    }

    fn point(&self, row: usize, x: usize) -> [f64; 3] {
        [x, row % self.per_axis, row / self.per_axis].map(|number| self.coordinate(number))
    }

    /// Numbers, from the first to before the end, of the coordinates within `reach` of `middle`.
    fn range(&self, middle: f64, reach: f64) -> (usize, usize) {
        let low = ((middle - reach - self.first) / self.step).ceil().max(0.0);
        let high = ((middle + reach - self.first) / self.step).floor();
        if high < low {
            return (0, 0);
        }
        (low as usize, (high as usize + 1).min(self.per_axis))
    }
}

impl<'a> HausdorffMeter<'a> {
    /// Finds which points of the fine grid are inside.
    pub fn new(solid: &'a Solid, field: &'a DepthField) -> Self {
        let fine = FineGrid::new(field);
        let n = field.grid.per_axis();
        let quarter = 0.5 * field.grid.epsilon() * (1.0 + 1e-9);
        let closed = solid.mesh().is_closed();
        let mut inside = vec![0u64; fine.rows() * fine.words];
        inside
            .par_chunks_mut(fine.words)
            .enumerate()
            .for_each(|(row, words)| {
                // Two fine points are about each node; the outermost two on either side are about none.
                let node_of =
                    |number: usize| (number / 2).checked_sub(1).filter(|&number| number < n);
                let (y, z) = (node_of(row % fine.per_axis), node_of(row / fine.per_axis));
                let (Some(y), Some(z)) = (y, z) else { return };
                for x in 2..fine.per_axis - 2 {
                    let depth = field.depth[field.grid.index([x / 2 - 1, y, z])];
                    let is_inside = if closed && depth.abs() > quarter {
                        depth > 0.0
                    } else {
                        solid.is_inside(fine.point(row, x))
                    };
                    if is_inside {
                        words[x / 64] |= 1 << (x % 64);
                    }
                }
            });
        Self {
            solid,
            field,
            fine,
            inside,
        }
    }

    /// Volume of the solid as the fine grid counts it, in the solid's unit cubed, or the grid itself where the fine one
    /// has no point inside, as of a thin plate.
    pub fn volume(&self) -> f64 {
        let ones = self.inside.iter().map(|word| u64::from(word.count_ones()));
        let count: u64 = ones.sum();
        match count {
            0 => self.field.inside().len() as f64 * self.field.grid.spacing().powi(3),
            _ => count as f64 * self.fine.step.powi(3),
        }
    }

    /// Measures a set of balls.
    pub fn measure(&self, balls: &[Ball]) -> Fit {
        let tree = BallTree::new(balls);
        let covered = self.covered(balls);
        let cell = self.fine.step.powi(3);
        let rows = (0..self.fine.rows()).into_par_iter();
        let rows = rows.map(|row| self.measure_row(row, &covered, &tree));
        let (missed, outside, inner, outer) = rows.reduce(
            || (0, 0, 0.0, 0.0),
            |a, b| (a.0 + b.0, a.1 + b.1, f64::max(a.2, b.2), f64::max(a.3, b.3)),
        );
        let inward = f64::max(inner, self.surface_distance(&tree));
        let touching: Vec<(f64, f64)> = balls.par_iter().map(|ball| self.outward(ball)).collect();
        let seen = touching.iter().map(|(seen, _)| *seen).fold(outer, f64::max);
        let bounds = || touching.iter().map(|(_, bound)| *bound);
        let bound = bounds().fold(0.0, f64::max);
        let bounded: Vec<(f64, Ball)> = bounds().zip(balls.iter().copied()).collect();
        let grid = self.field.grid;
        let tolerance = OUTWARD_TOLERANCE * grid.epsilon();
        let seen = farthest(self.solid, bounded, seen, tolerance);
        let last = self.fine.coordinate(self.fine.per_axis - 1) + 0.5 * self.fine.step;
        let beyond = volume_beyond(balls, -last, last, self.fine.step);
        let is_missed = |&node: &usize| {
            self.field.depth[node] > 0.0 && tree.distance(grid.node(node), 0.0) > 1e-12
        };
        let nodes_missed = (0..grid.nodes()).into_par_iter().filter(is_missed).count();
        Fit {
            hausdorff_inward: inward,
            inward_bound: self.inward_bound(&tree, inward),
            hausdorff_outward: seen,
            outward_bound: bound,
            volume_missed: missed as f64 * cell,
            volume_outside: outside as f64 * cell + beyond,
            nodes_missed,
        }
    }

    /// Which points of the fine grid are in a ball, a bit each, slab by slab.
    fn covered(&self, balls: &[Ball]) -> Vec<u64> {
        let fine = self.fine;
        let mut covered = vec![0u64; fine.rows() * fine.words];
        let slab = fine.per_axis * fine.words;
        covered
            .par_chunks_mut(slab)
            .enumerate()
            .for_each(|(z, slab)| {
                let z = fine.coordinate(z);
                for ball in balls {
                    let dz = z - ball.center[2];
                    let squared = ball.radius * ball.radius - dz * dz;
                    if squared < 0.0 {
                        continue;
                    }
                    let (low, high) = fine.range(ball.center[1], squared.sqrt());
                    for y in low..high {
                        let dy = fine.coordinate(y) - ball.center[1];
                        let (from, to) =
                            fine.range(ball.center[0], (squared - dy * dy).max(0.0).sqrt());
                        fill(&mut slab[y * fine.words..(y + 1) * fine.words], from, to);
                    }
                }
            });
        covered
    }

    /// Points missed and outside in a row, and the farthest of either.
    fn measure_row(
        &self,
        row: usize,
        covered: &[u64],
        tree: &BallTree,
    ) -> (usize, usize, f64, f64) {
        let words = row * self.fine.words..(row + 1) * self.fine.words;
        let (mut missed, mut outside, mut inner, mut outer) = (0, 0, 0.0f64, 0.0f64);
        let own = self.inside[words.clone()].iter().zip(&covered[words]);
        for (word, (&inside, &covered)) in own.enumerate() {
            let mut differ = inside ^ covered;
            while differ != 0 {
                let bit = differ.trailing_zeros() as usize;
                differ &= differ - 1;
                let point = self.fine.point(row, 64 * word + bit);
                if inside >> bit & 1 == 1 {
                    missed += 1;
                    inner = inner.max(tree.distance(point, inner));
                } else {
                    outside += 1;
                    outer = outer.max(self.solid.distance(point));
                }
            }
        }
        (missed, outside, inner, outer)
    }

    fn surface_distance(&self, tree: &BallTree) -> f64 {
        let epsilon = self.field.grid.epsilon();
        let spacing = epsilon * SAMPLE_SPACING;
        let closed = self.solid.mesh().is_closed();
        // What all threads have found. A piece that cannot hold a farther sample is left out: the farthest of all
        // is found whatever the order.
        let farthest = Farthest(AtomicU64::new(0));
        let distance = |point, enough| tree.distance(point, enough);
        self.solid.search(|block| {
            block.samples(
                spacing,
                |point, piece| {
                    let farthest = farthest.get();
                    distance(point, farthest - piece) + piece <= farthest
                },
                |_, sample| {
                    let seen = farthest.get();
                    let away = distance(sample.point, seen);
                    // Only where a closed mesh breaks the bound may a sample be no point of the solid.
                    let in_doubt = closed && away > seen.max(epsilon);
                    if away > seen && (!in_doubt || is_beside(self.solid, &sample, epsilon)) {
                        farthest.raise(away);
                    }
                },
            );
        });
        farthest.get()
    }

    /// Upper bound of the distance of the solid's points from the balls, given the distance measured.
    fn inward_bound(&self, tree: &BallTree, measured: f64) -> Option<f64> {
        if !self.solid.mesh().is_closed() {
            return None;
        }
        // A set that covers the solid is shown to.
        let slack = INWARD_TOLERANCE * self.field.grid.epsilon();
        let goal = if measured > 0.0 {
            measured + slack
        } else {
            0.0
        };
        let fine = self.fine;
        let cells = fine.per_axis - 4;
        let row = |row: usize| {
            // The outermost two cells on either side are outside the cube.
            let place = |x: usize| [x, row % cells, row / cells];
            let near = (0..cells).map(place).filter(|place| {
                let node = self.field.grid.index(place.map(|number| number / 2));
                self.field.depth[node] >= -self.field.grid.epsilon() * (1.0 + 1e-9)
            });
            near.fold(goal, |goal, place| {
                let middle = place.map(|number| fine.coordinate(number + 2));
                self.beyond(tree, middle, 0.5 * fine.step, goal, HALVINGS)
            })
        };
        let rows = (0..cells * cells).into_par_iter().map(row);
        Some(rows.reduce(|| goal, f64::max))
    }

    /// `goal`, or if points of the solid in a cell may be farther from the balls, a bound for these. `half` is half of
    /// the cell's edge.
    fn beyond(
        &self,
        tree: &BallTree,
        middle: [f64; 3],
        half: f64,
        goal: f64,
        halvings: u32,
    ) -> f64 {
        let reach = 3.0f64.sqrt() * half * (1.0 + 1e-9);
        let away = tree.distance(middle, goal - reach);
        if away + reach <= goal {
            return goal;
        }
        if self.solid.distance(middle) > reach && !self.solid.is_inside(middle) {
            return goal;
        }
        if halvings == 0 {
            return away + reach;
        }
        let quarter = 0.5 * half;
        (0..8u32).fold(goal, |goal, corner| {
            let signs = [0, 1, 2].map(|axis| 2.0 * f64::from(corner >> axis & 1) - 1.0);
            let part = along(middle, quarter, signs);
            self.beyond(tree, part, quarter, goal, halvings - 1)
        })
    }

    /// Distance of a ball outside of the solid: measured, and its upper bound.
    fn outward(&self, ball: &Ball) -> (f64, f64) {
        let nearest = self.solid.nearest(ball.center);
        let away = distance(nearest, ball.center);
        let inside = self.solid.is_inside(ball.center);
        let sign = if inside { 1.0 } else { -1.0 };
        let bound = ball.radius - sign * away;
        if bound <= 0.0 || away == 0.0 {
            return (0.0, bound);
        }
        let outward = subtract(nearest, ball.center);
        let point = along(ball.center, sign * ball.radius / away, outward);
        ((-self.solid.depth(point)).max(0.0), bound)
    }
}

/// The largest of the lengths, zero or above, that threads have found.
struct Farthest(AtomicU64);

impl Farthest {
    fn get(&self) -> f64 {
        f64::from_bits(self.0.load(Ordering::Relaxed))
    }

    fn raise(&self, length: f64) {
        // The bits of numbers above zero are in the order of the numbers.
        self.0.fetch_max(length.to_bits(), Ordering::Relaxed);
    }
}

/// Sets bits `from` to before `to` of a row.
fn fill(row: &mut [u64], from: usize, to: usize) {
    if from >= to {
        return;
    }
    let (first, last) = (from / 64, (to - 1) / 64);
    let head = u64::MAX << (from % 64);
    let tail = u64::MAX >> (63 - (to - 1) % 64);
    if first == last {
        row[first] |= head & tail;
        return;
    }
    row[first] |= head;
    row[first + 1..last].fill(u64::MAX);
    row[last] |= tail;
}
