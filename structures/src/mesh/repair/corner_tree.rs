//! The corners of a polygon in a tree of boxes, from which they are taken one by one.

/// Corners in a leaf.
const LEAF: usize = 8;

/// A binary tree over places, halved at the median of the longest side of their box.
pub struct CornerTree {
    /// Corners, leaf after leaf.
    corners: Vec<usize>,
    /// Of each corner, its place in `corners`.
    place_of: Vec<usize>,
    is_left: Vec<bool>,
    /// Nodes in depth-first order.
    nodes: Vec<Node>,
}

struct Node {
    low: [f64; 3],
    high: [f64; 3],
    /// Corners below that are left.
    left: usize,
    first: usize,
    count: usize,
    /// The second half; the first follows this node. Zero in a leaf.
    second: usize,
}

impl CornerTree {
    /// The tree of corners 0, 1, 2 ... at their places.
    pub fn new(places: &[[f64; 3]]) -> Self {
        let mut corners: Vec<usize> = (0..places.len()).collect();
        let mut nodes = Vec::new();
        if !corners.is_empty() {
            build(places, &mut corners, 0, &mut nodes);
        }
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
            if node.left == 0 || misses(node.low, node.high) {
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
            node.left -= 1;
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

/// Appends the node of corners that begin at `first` of the whole list, and the nodes below it.
fn build(places: &[[f64; 3]], corners: &mut [usize], first: usize, nodes: &mut Vec<Node>) {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for &corner in corners.iter() {
        for axis in 0..3 {
            low[axis] = low[axis].min(places[corner][axis]);
            high[axis] = high[axis].max(places[corner][axis]);
        }
    }
    let at = nodes.len();
    nodes.push(Node {
        low,
        high,
        left: corners.len(),
        first,
        count: corners.len(),
        second: 0,
    });
    if corners.len() <= LEAF {
        return;
    }
    let side = |axis: usize| high[axis] - low[axis];
    let axis = (1..3).fold(
        0,
        |best, axis| {
            if side(axis) > side(best) { axis } else { best }
        },
    );
    let middle = corners.len() / 2;
    corners.select_nth_unstable_by(middle, |&a, &b| {
        (places[a][axis].total_cmp(&places[b][axis])).then(a.cmp(&b))
    });
    let (before, after) = corners.split_at_mut(middle);
    build(places, before, first, nodes);
    nodes[at].second = nodes.len();
    build(places, after, first + middle, nodes);
}
