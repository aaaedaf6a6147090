//! Polygons cut into triangles by ear clipping (Meisters, American Mathematical Monthly 82, 1975).
//!
//! A fan from the first corner, which most readers use, lays triangles outside a face that is not convex: the distance
//! to them is not the distance to the solid.
//!
//! The corners of a large polygon are a ring whose tips are in a queue. When one is clipped its neighbours go to the
//! end, so that a round along the ring clips every second corner and triangles stay small. A tip that is no ear waits
//! for the corner that is in its way, and queues again when that corner or a neighbour has gone. A tree of corners
//! finds the corners in a triangle.

use std::collections::VecDeque;

use crate::neighbours::box_tree::{BoxNode, LEAF, box_tree};
use crate::vector::{cross, dot, subtract};

/// Corners up to which every other corner is gone through for each; of more, a tree finds those that are in the way.
const FEW: usize = 64;

/// Appends the triangles of a polygon with three or more corners, in its own orientation.
///
/// A corner may occur several times, as if a bridge leads from the rim to a hole and back. Vertices are
/// distinguished by their numbers, so those in one place must be one.
///
/// A polygon that crosses itself, is far from plane or has no area gives a fan for what cannot be clipped. O(n log n)
/// for n corners as a rule.
pub fn triangulate(positions: &[[f64; 3]], corners: &[u32], triangles: &mut Vec<[u32; 3]>) {
    if let &[a, b, c] = corners {
        triangles.push([a, b, c]);
        return;
    }
    let at = |corner: u32| positions.get(corner as usize).copied().unwrap_or_default();
    let mut left = corners.to_vec();
    // A corner twice in succession is one; as two it would be a tip without a turn.
    left.dedup();
    while left.len() > 1 && left.first() == left.last() {
        left.pop();
    }
    let normal = newell(corners.iter().map(|&corner| at(corner)));
    if left.len() > FEW {
        Ring::new(&left, at, normal).clip(triangles);
    } else {
        clip_few(left, at, normal, triangles);
    }
}

/// Clips the first of all ears, time after time, in O(n^2) for n corners as a rule.
fn clip_few(
    mut left: Vec<u32>,
    at: impl Fn(u32) -> [f64; 3],
    normal: [f64; 3],
    triangles: &mut Vec<[u32; 3]>,
) {
    while left.len() > 3 {
        let count = left.len();
        let ear = (0..count).find(|&tip| {
            let corners = [
                left[(tip + count - 1) % count],
                left[tip],
                left[(tip + 1) % count],
            ];
            let ear = Ear {
                corners: corners.map(&at),
                normal,
            };
            ear.is_tip()
                && left
                    .iter()
                    .filter(|other| !corners.contains(other))
                    .all(|&other| !ear.holds(at(other)))
        });
        let tip = ear.unwrap_or(1);
        triangles.push([
            left[(tip + count - 1) % count],
            left[tip],
            left[(tip + 1) % count],
        ]);
        left.remove(tip);
    }
    if let &[a, b, c] = left.as_slice() {
        triangles.push([a, b, c]);
    }
}

/// Normal of a polygon, as long as twice its area (Newell's method), about its first corner for the sake of digits.
fn newell(mut points: impl Iterator<Item = [f64; 3]>) -> [f64; 3] {
    let mut normal = [0.0; 3];
    let Some(first) = points.next() else {
        return normal;
    };
    let mut last = [0.0; 3];
    for point in points {
        let point = subtract(point, first);
        let part = cross(last, point);
        for axis in 0..3 {
            normal[axis] += part[axis];
        }
        last = point;
    }
    normal
}

/// A tip of a polygon with its two neighbours: the triangle that it would leave.
struct Ear {
    corners: [[f64; 3]; 3],
    /// The polygon's, of any length.
    normal: [f64; 3],
}

impl Ear {
    /// Twice the area of a triangle in units of the normal: above zero where it turns as the polygon does.
    fn turn(&self, p: [f64; 3], q: [f64; 3], r: [f64; 3]) -> f64 {
        dot(cross(subtract(q, p), subtract(r, p)), self.normal)
    }

    fn is_tip(&self) -> bool {
        let [a, b, c] = self.corners;
        self.turn(a, b, c) > 0.0
    }

    /// Whether a point is in the triangle or on its rim.
    fn holds(&self, point: [f64; 3]) -> bool {
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
struct Ring {
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
    /// A ring of vertices, no two in succession alike; `normal` is the polygon's, of any length.
    fn new(vertices: &[u32], at: impl Fn(u32) -> [f64; 3], normal: [f64; 3]) -> Self {
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

    fn clip(mut self, triangles: &mut Vec<[u32; 3]>) {
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

    fn row(&self, tip: usize) -> [usize; 3] {
        let corner = &self.corners[tip];
        [corner.before, tip, corner.after]
    }

    fn vertices(&self, row: [usize; 3]) -> [u32; 3] {
        row.map(|place| self.corners[place].vertex)
    }

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
        let ear = Ear {
            corners: row.map(|place| self.places[place]),
            normal: self.normal,
        };
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

/// Corners in a tree of boxes, each with the number of corners below that are left.
struct CornerTree {
    /// Corners, leaf after leaf.
    corners: Vec<usize>,
    /// Of each corner, its place in `corners`.
    place_of: Vec<usize>,
    is_left: Vec<bool>,
    nodes: Vec<BoxNode<usize>>,
}

impl CornerTree {
    /// The tree of corners 0, 1, 2 ... at their places.
    fn new(places: &[[f64; 3]]) -> Self {
        let mut corners: Vec<usize> = (0..places.len()).collect();
        let place = |&corner: &usize| (places[corner], corner);
        let nodes = box_tree(&mut corners, LEAF, place, |corners| corners.len());
        let mut place_of = vec![0; corners.len()];
        for (place, &corner) in corners.iter().enumerate() {
            place_of[corner] = place;
        }
        Self {
            is_left: vec![true; corners.len()],
            corners,
            place_of,
            nodes,
        }
    }

    /// A corner that `is_wanted`, if there is one: boxes that `misses` rules out are passed over.
    fn find(
        &self,
        misses: impl Fn([f64; 3], [f64; 3]) -> bool,
        is_wanted: impl Fn(usize) -> bool,
    ) -> Option<usize> {
        let mut waiting = vec![0];
        while let Some(at) = waiting.pop() {
            let node = self.nodes.get(at)?;
            if node.known == 0 || misses(node.low, node.high) {
                continue;
            }
            if node.second > 0 {
                waiting.extend([node.second, at + 1]);
                continue;
            }
            let corners = &self.corners[node.first..node.first + node.count];
            let mut corners = corners.iter().copied();
            let found = corners.find(|&corner| self.is_left[corner] && is_wanted(corner));
            if found.is_some() {
                return found;
            }
        }
        None
    }

    fn remove(&mut self, corner: usize) {
        if !std::mem::replace(&mut self.is_left[corner], false) {
            return;
        }
        let place = self.place_of[corner];
        let mut at = 0;
        loop {
            let node = &mut self.nodes[at];
            node.known -= 1;
            if node.second == 0 {
                return;
            }
            let second = node.second;
            at = if place < self.nodes[second].first {
                at + 1
            } else {
                second
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::norm;
    use std::f64::consts::TAU;

    /// A polygon about the origin in a tilted plane: corner i at `radius(i)`.
    fn about_origin(count: usize, radius: impl Fn(usize) -> f64) -> Vec<[f64; 3]> {
        let place = |i: usize| {
            let angle = TAU * i as f64 / count as f64;
            let [x, y] = [angle.cos(), angle.sin()].map(|side| radius(i) * side);
            [x, y, 0.3 * x - 0.2 * y]
        };
        (0..count).map(place).collect()
    }

    /// A cap of a million corners took hours, for each ear went through all corners. Convex, a star, and a comb.
    #[test]
    fn polygons_of_many_corners_are_covered_once() {
        let count = 100_000;
        let radii: [fn(usize) -> f64; 3] = [
            |_| 1.0,
            |i| 1.0 + 0.5 * (i % 2) as f64,
            |i| 1.0 + 0.3 * (i as f64 * 1e-3).sin() + 0.1 * (i as f64).sin(),
        ];
        for radius in radii {
            let positions = about_origin(count, radius);
            let corners: Vec<u32> = (0..count as u32).collect();
            let mut triangles = Vec::new();
            triangulate(&positions, &corners, &mut triangles);
            assert_eq!(triangles.len(), count - 2);
            let exact = norm(newell(positions.iter().copied())) / 2.0;
            let found = area(&positions, &triangles);
            assert!((found - exact).abs() < 1e-9 * exact, "{found} {exact}");
        }
        // Without area.
        let line: Vec<[f64; 3]> = (0..count).map(|i| [i as f64, 0.0, 0.0]).collect();
        let corners: Vec<u32> = (0..count as u32).collect();
        let mut triangles = Vec::new();
        triangulate(&line, &corners, &mut triangles);
        assert_eq!(triangles.len(), count - 2);
    }

    /// With a tree and without, a polygon is covered once: jagged, with a bridge to a hole, and crossing itself,
    /// whose triangles sum up to its area with their signs.
    #[test]
    fn few_corners_and_many_are_clipped_to_one_area() {
        let jagged = about_origin(61, |i| 1.0 + 0.9 * (7.3 * i as f64).sin());
        // A rim, a bridge, a hole, and back over the bridge.
        let ring = [
            [0., 0.],
            [9., 0.],
            [9., 9.],
            [0., 9.],
            [3., 3.],
            [3., 6.],
            [6., 6.],
            [6., 3.],
        ];
        let ring = ring.map(|[x, y]| [x, y, 1.0]).to_vec();
        let crossing = (0..40)
            .map(|i| [(i * i % 37) as f64, (i * 5 % 11) as f64, 0.0])
            .collect();
        let in_order = |count: u32| (0..count).collect::<Vec<u32>>();
        for (positions, corners, is_simple) in [
            (jagged, in_order(61), true),
            (ring, vec![0, 1, 2, 3, 0, 4, 5, 6, 7, 4], true),
            (crossing, in_order(40), false),
        ] {
            for turn in [0, 1, corners.len() / 2] {
                let mut corners = corners.clone();
                corners.rotate_left(turn);
                let at = |corner: u32| positions[corner as usize];
                let normal = newell(corners.iter().map(|&corner| at(corner)));
                let exact = norm(normal) / 2.0;
                let (mut few, mut many) = (Vec::new(), Vec::new());
                clip_few(corners.clone(), at, normal, &mut few);
                Ring::new(&corners, at, normal).clip(&mut many);
                for triangles in [few, many] {
                    assert_eq!(triangles.len(), corners.len() - 2);
                    let signed: f64 = triangles
                        .iter()
                        .map(|t| newell(t.iter().map(|&i| at(i))))
                        .map(|part| dot(part, normal) / norm(normal) / 2.0)
                        .sum();
                    assert!((signed - exact).abs() < 1e-12 * exact.max(1.0) * 100.0);
                    if is_simple {
                        let found = area(&positions, &triangles);
                        assert!((found - exact).abs() < 1e-12 * exact, "{found} {exact}");
                    }
                }
            }
        }
    }

    fn area(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> f64 {
        triangles
            .iter()
            .map(|t| newell(t.iter().map(|&i| positions[i as usize])))
            .map(|normal| norm(normal) / 2.0)
            .sum()
    }

    /// An L of area 3, from each of its corners: a fan from most of them would cover more than the face.
    #[test]
    fn a_face_that_is_not_convex_is_covered_once() {
        let ring = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];
        for turn in 0..6 {
            for tilt in [0.0, 0.5] {
                let positions: Vec<[f64; 3]> = (0..6)
                    .map(|i| ring[(i + turn) % 6])
                    .map(|[x, y]| [x, y, 5.0 + tilt * x])
                    .collect();
                let mut triangles = Vec::new();
                triangulate(&positions, &[0, 1, 2, 3, 4, 5], &mut triangles);
                assert_eq!(triangles.len(), 4);
                let expected = 3.0 * (1.0f64 + tilt * tilt).sqrt();
                assert!((area(&positions, &triangles) - expected).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_face_without_area_or_with_repeated_corners_ends() {
        let positions = [[1.0; 3]; 5];
        let mut triangles = Vec::new();
        triangulate(&positions, &[0, 1, 2, 3, 4], &mut triangles);
        assert_eq!(triangles.len(), 3);
        triangulate(&positions, &[0, 0, 0, 0], &mut triangles);
        assert_eq!(triangles.len(), 3, "nothing is left of it");
    }
}
