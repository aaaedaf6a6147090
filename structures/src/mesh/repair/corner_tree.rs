//! The corners of a polygon in a tree of boxes, from which they are taken one by one.

use crate::neighbours::box_tree::{BoxNode, box_tree};

/// Corners in a tree of boxes, each with the number of corners below that are left.
pub struct CornerTree {
    /// Corners, leaf after leaf.
    corners: Vec<usize>,
    /// Of each corner, its place in `corners`.
    place_of: Vec<usize>,
    is_left: Vec<bool>,
    nodes: Vec<BoxNode<usize>>,
}

impl CornerTree {
    /// The tree of corners 0, 1, 2 ... at their places.
    pub fn new(places: &[[f64; 3]]) -> Self {
        let mut corners: Vec<usize> = (0..places.len()).collect();
        let place = |&corner: &usize| (places[corner], corner);
        let nodes = box_tree(&mut corners, place, |corners| corners.len());
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
    pub fn find(
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

    /// Takes a corner out.
    pub fn remove(&mut self, corner: usize) {
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
