//! The corners of a polygon as a ring from which ears are clipped, in about O(n log n) for n corners.
//!
//! Tips stand in a queue. When one is clipped its neighbours go to the end, so that a round along the ring clips every
//! second corner and triangles stay small. A tip that is no ear waits for the corner that is in its way, and queues
//! again when that corner or a neighbour has gone. A tree of corners finds what is in a triangle.

use std::collections::VecDeque;

use crate::mesh::repair::corner_tree::CornerTree;
use crate::mesh::vector::{cross, dot, subtract};

/// A tip of a polygon with its two neighbours: the triangle that it would leave.
pub struct Ear {
    corners: [[f64; 3]; 3],
    normal: [f64; 3],
}

impl Ear {
    /// The triangle of three corners in a row; `normal` is the polygon's, of any length.
    pub fn new(corners: [[f64; 3]; 3], normal: [f64; 3]) -> Self {
        Self { corners, normal }
    }

    /// Twice the area of a triangle in units of the normal: above zero where it turns as the polygon does.
    fn turn(&self, p: [f64; 3], q: [f64; 3], r: [f64; 3]) -> f64 {
        dot(cross(subtract(q, p), subtract(r, p)), self.normal)
    }

    /// Whether the tip stands out.
    pub fn is_tip(&self) -> bool {
        let [a, b, c] = self.corners;
        self.turn(a, b, c) > 0.0
    }

    /// Whether a point lies in the triangle or on its rim.
    pub fn holds(&self, point: [f64; 3]) -> bool {
        let [a, b, c] = self.corners;
        let is_outside = |p, q| self.turn(p, q, point) < 0.0;
        !(is_outside(a, b) || is_outside(b, c) || is_outside(c, a))
    }

    /// Whether no point of a box can be in the triangle, rounding included.
    fn misses(&self, low: [f64; 3], high: [f64; 3]) -> bool {
        let [a, b, c] = self.corners;
        // A long row of boxes may lie along the line of an edge.
        let is_beyond = |axis: usize| {
            let [a, b, c] = self.corners.map(|corner| corner[axis]);
            a.max(b).max(c) < low[axis] || a.min(b).min(c) > high[axis]
        };
        if (0..3).any(is_beyond) {
            return true;
        }
        [(a, b), (b, c), (c, a)].into_iter().any(|(p, q)| {
            let side = subtract(q, p);
            // turn(p, q, r) = (r - p) . inward
            let inward = cross(self.normal, side);
            let (mut most, mut reach) = (0.0, 0.0);
            for axis in 0..3 {
                let (to_low, to_high) = (low[axis] - p[axis], high[axis] - p[axis]);
                most += (inward[axis] * to_low).max(inward[axis] * to_high);
                reach += to_low.abs().max(to_high.abs());
            }
            let sum = |v: [f64; 3]| v[0].abs() + v[1].abs() + v[2].abs();
            most < -1e-12 * sum(self.normal) * sum(side) * reach
        })
    }
}

/// A corner of the ring: its vertex, and the corners before and after it.
struct Corner {
    vertex: u32,
    before: usize,
    after: usize,
    is_left: bool,
    /// How often it has queued; earlier places in the queue are void.
    turn: u32,
    /// Tips that this corner keeps from being ears.
    waiting: Vec<usize>,
}

/// The corners that are left of a polygon, and those that may be ears.
pub struct Ring {
    corners: Vec<Corner>,
    places: Vec<[f64; 3]>,
    normal: [f64; 3],
    tree: CornerTree,
    /// Tips to look at, each with its turn.
    queue: VecDeque<(usize, u32)>,
    /// A corner that is left.
    first: usize,
}

impl Ring {
    /// A ring of vertices, no two in a row alike; `normal` is the polygon's, of any length.
    pub fn new(vertices: &[u32], at: impl Fn(u32) -> [f64; 3], normal: [f64; 3]) -> Self {
        let count = vertices.len();
        let corner = |(place, &vertex): (usize, &u32)| Corner {
            vertex,
            before: (place + count - 1) % count,
            after: (place + 1) % count,
            is_left: true,
            turn: 0,
            waiting: Vec::new(),
        };
        let places: Vec<[f64; 3]> = vertices.iter().map(|&vertex| at(vertex)).collect();
        Self {
            corners: vertices.iter().enumerate().map(corner).collect(),
            tree: CornerTree::new(&places),
            places,
            normal,
            queue: (0..count).map(|tip| (tip, 0)).collect(),
            first: 0,
        }
    }

    /// Appends the triangles.
    pub fn clip(mut self, triangles: &mut Vec<[u32; 3]>) {
        let count = self.corners.len();
        for _ in 3..count {
            // Where nothing is an ear, a fan.
            let tip = self
                .next_ear()
                .unwrap_or_else(|| self.corners[self.first].after);
            triangles.push(self.vertices(self.row(tip)));
            self.remove(tip);
        }
        if count >= 3 {
            triangles.push(self.vertices(self.row(self.corners[self.first].after)));
        }
    }

    /// A tip between its neighbours.
    fn row(&self, tip: usize) -> [usize; 3] {
        let corner = &self.corners[tip];
        [corner.before, tip, corner.after]
    }

    fn vertices(&self, row: [usize; 3]) -> [u32; 3] {
        row.map(|place| self.corners[place].vertex)
    }

    /// The next tip of the queue that is an ear.
    fn next_ear(&mut self) -> Option<usize> {
        while let Some((tip, turn)) = self.queue.pop_front() {
            let corner = &self.corners[tip];
            if corner.is_left && corner.turn == turn && self.is_ear(tip) {
                return Some(tip);
            }
        }
        None
    }

    /// Whether a tip is an ear; if a corner is in its way, it waits for that one.
    fn is_ear(&mut self, tip: usize) -> bool {
        let row = self.row(tip);
        let ear = Ear::new(row.map(|place| self.places[place]), self.normal);
        if !ear.is_tip() {
            return false;
        }
        let vertices = self.vertices(row);
        let is_in_way = |place: usize| {
            !vertices.contains(&self.corners[place].vertex) && ear.holds(self.places[place])
        };
        match self.tree.find(|low, high| ear.misses(low, high), is_in_way) {
            Some(in_way) => {
                self.corners[in_way].waiting.push(tip);
                false
            }
            None => true,
        }
    }

    /// Puts a tip at the end of the queue.
    fn enqueue(&mut self, tip: usize) {
        let corner = &mut self.corners[tip];
        corner.turn += 1;
        self.queue.push_back((tip, corner.turn));
    }

    /// Takes a corner out of the ring; what depended on it queues again.
    fn remove(&mut self, tip: usize) {
        let [before, _, after] = self.row(tip);
        self.corners[before].after = after;
        self.corners[after].before = before;
        self.corners[tip].is_left = false;
        self.first = before;
        self.tree.remove(tip);
        self.enqueue(before);
        self.enqueue(after);
        for waiting in std::mem::take(&mut self.corners[tip].waiting) {
            self.enqueue(waiting);
        }
    }
}
