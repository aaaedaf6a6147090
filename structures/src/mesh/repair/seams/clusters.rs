//! Sets of vertices that become one.

use crate::mesh::repair::faces::Faces;
use crate::mesh::repair::seams::border::{Border, NONE};
use crate::mesh::repair::seams::grid::axis_distance;

/// Sets of vertices that become one.
#[derive(Clone)]
pub struct Clusters {
    reach: f64,
    /// Leads from each vertex to the first of its set.
    parent: Vec<u32>,
    /// Leads round the set.
    next: Vec<u32>,
    /// Bounding box of the set, at its first.
    boxes: Vec<[[f64; 3]; 2]>,
}

impl Clusters {
    pub fn new(border: &Border, reach: f64) -> Self {
        let all = || (0..border.vertices.len() as u32).collect();
        Self {
            reach,
            parent: all(),
            next: all(),
            boxes: border.positions.iter().map(|&at| [at, at]).collect(),
        }
    }

    /// The first of a vertex's set.
    pub fn first(&mut self, mut vertex: u32) -> u32 {
        while self.parent[vertex as usize] != vertex {
            let above = self.parent[vertex as usize];
            self.parent[vertex as usize] = self.parent[above as usize];
            vertex = above;
        }
        vertex
    }

    /// The box about two, where it is no wider than the reach.
    fn common_box(&self, a: [[f64; 3]; 2], b: [[f64; 3]; 2]) -> Option<[[f64; 3]; 2]> {
        let low = [0, 1, 2].map(|axis| a[0][axis].min(b[0][axis]));
        let high = [0, 1, 2].map(|axis| a[1][axis].max(b[1][axis]));
        (axis_distance(low, high) <= self.reach).then_some([low, high])
    }

    /// Whether the sets of two vertices may be one.
    pub fn may_join(&mut self, border: &Border, a: u32, b: u32) -> bool {
        let (a, b) = (self.first(a), self.first(b));
        if a == b {
            return true;
        }
        let [one, other] = [a, b].map(|first| self.boxes[first as usize]);
        if self.common_box(one, other).is_none() {
            return false;
        }
        let mut member = a;
        loop {
            for &neighbour in border.beside.of_one(member) {
                if self.first(neighbour) == b {
                    return false;
                }
            }
            member = self.next[member as usize];
            if member == a {
                return true;
            }
        }
    }

    /// Makes the sets of two vertices one.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.first(a), self.first(b));
        if a == b {
            return;
        }
        let [one, other] = [a, b].map(|first| self.boxes[first as usize]);
        let (first, second) = (a.min(b), a.max(b));
        self.parent[second as usize] = first;
        self.next.swap(a as usize, b as usize);
        self.boxes[first as usize] = [
            [0, 1, 2].map(|axis| one[0][axis].min(other[0][axis])),
            [0, 1, 2].map(|axis| one[1][axis].max(other[1][axis])),
        ];
    }

    /// Joins the rims of holes that lie in a cube as wide as the reach, unless a whole face does.
    pub fn close_holes(&mut self, border: &Border, faces: &Faces) {
        let open = self.open_edges(border);
        // Rims as sets of their own, whose boxes may grow beyond the reach.
        let mut rims = self.clone();
        for &[a, b] in &open {
            rims.join(a, b);
        }
        let mut is_small = vec![false; self.parent.len()];
        for &[a, _] in &open {
            let rim = rims.first(a) as usize;
            let [low, high] = rims.boxes[rim];
            is_small[rim] = axis_distance(low, high) <= self.reach;
        }
        if !is_small.contains(&true) {
            return;
        }
        for face in faces.iter() {
            let mut rim_of = |corner: u32| match border.names[corner as usize] {
                NONE => NONE,
                name => rims.first(name),
            };
            let rim = rim_of(face[0]);
            if rim != NONE && face.iter().all(|&corner| rim_of(corner) == rim) {
                is_small[rim as usize] = false;
            }
        }
        for [a, b] in open {
            if is_small[rims.first(a) as usize] {
                self.join(a, b);
            }
        }
    }

    /// Edges that are of one face still, by the first vertices of their ends.
    fn open_edges(&mut self, border: &Border) -> Vec<[u32; 2]> {
        let mut edges: Vec<[u32; 2]> = Vec::with_capacity(border.edges.len());
        for &[a, b] in &border.edges {
            let (a, b) = (self.first(a), self.first(b));
            if a != b {
                edges.push([a.min(b), a.max(b)]);
            }
        }
        edges.sort_unstable();
        let groups = edges.chunk_by(|a, b| a == b);
        let of_one = groups.filter(|group| group.len() == 1);
        of_one.flatten().copied().collect()
    }
}
