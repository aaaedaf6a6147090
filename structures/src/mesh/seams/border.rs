//! The open edges of a mesh, and which of them lie within reach of one another.

use super::super::faces::Faces;
use super::apart;
use super::grid::Grid;

/// Stands for no vertex.
pub const NONE: u32 = u32::MAX;

/// Two open edges that may be one: whether they run the same way, how far their ends are apart, the two, and whether the
/// first end of one is the second of the other.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
pub struct Pair(pub bool, pub f64, pub u32, pub u32, pub bool);

/// The open edges and their vertices, which are numbered by themselves, in the order of the mesh's.
pub struct Border {
    /// The number here of each of the mesh's vertices, or [`NONE`].
    pub names: Vec<u32>,
    /// The mesh's number of each vertex.
    pub vertices: Vec<u32>,
    pub positions: Vec<[f64; 3]>,
    /// Ends of each open edge, as its face runs through it.
    pub edges: Vec<[u32; 2]>,
    /// Open edges of each vertex.
    edges_of: Lists,
    /// Vertices next to each on a face.
    pub beside: Lists,
}

impl Border {
    /// None where the faces leave no edge open.
    pub fn of(positions: &[[f64; 3]], faces: &Faces) -> Option<Self> {
        let mut sides: Vec<(u32, u32, bool)> = Vec::with_capacity(faces.corners().len());
        for face in faces.iter() {
            let next = face.iter().cycle().skip(1);
            for (&from, &to) in face.iter().zip(next) {
                if from != to {
                    sides.push((from.min(to), from.max(to), from < to));
                }
            }
        }
        sides.sort_unstable();
        let groups = || sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1));
        let mut names = vec![NONE; positions.len()];
        let mut edges = Vec::new();
        for group in groups() {
            if let &[(low, high, forward)] = group {
                edges.push(if forward { [low, high] } else { [high, low] });
                names[low as usize] = 0;
                names[high as usize] = 0;
            }
        }
        if edges.is_empty() {
            return None;
        }
        let mut vertices = Vec::new();
        for (vertex, name) in (0..).zip(&mut names) {
            if *name != NONE {
                *name = vertices.len() as u32;
                vertices.push(vertex);
            }
        }
        let name = |vertex: u32| names[vertex as usize];
        for edge in &mut edges {
            *edge = edge.map(name);
        }
        let beside = groups()
            .filter_map(|group| group.first())
            .map(|&(low, high, _)| (name(low), name(high)))
            .filter(|&(low, high)| low != NONE && high != NONE)
            .flat_map(|(low, high)| [(low, high), (high, low)]);
        let beside = Lists::of(vertices.len(), beside.collect());
        let ends = (0..)
            .zip(&edges)
            .flat_map(|(edge, &[a, b])| [(a, edge), (b, edge)]);
        Some(Self {
            edges_of: Lists::of(vertices.len(), ends.collect()),
            positions: vertices
                .iter()
                .map(|&vertex| positions[vertex as usize])
                .collect(),
            vertices,
            names,
            edges,
            beside,
        })
    }

    /// Open edges whose ends lie within reach of one another.
    pub fn pairs(&self, reach: f64) -> Vec<Pair> {
        let grid = Grid::new(&self.positions, reach);
        let mut near = Vec::new();
        let mut pairs = Vec::new();
        for (index, &[a, b]) in (0u32..).zip(&self.edges) {
            // Many edges may meet at one end, as at the tip of a cone.
            let swapped = self.edges_of.of_one(b).len() < self.edges_of.of_one(a).len();
            let (start, end) = if swapped { (b, a) } else { (a, b) };
            grid.near(self.positions[start as usize], &mut near);
            for &beginning in &near {
                for &other in self.edges_of.of_one(beginning) {
                    if other <= index {
                        continue;
                    }
                    let [c, d] = self.edges[other as usize];
                    let (far_end, is_first) = if c == beginning {
                        (d, true)
                    } else {
                        (c, false)
                    };
                    let apart = |p: u32, q: u32| {
                        apart(self.positions[p as usize], self.positions[q as usize])
                    };
                    let far = apart(end, far_end);
                    if far <= reach {
                        // Both run away from the ends that are near, or both towards them.
                        let same_way = is_first != swapped;
                        let distance = far.max(apart(start, beginning));
                        pairs.push(Pair(same_way, distance, index, other, !same_way));
                    }
                }
            }
        }
        pairs
    }
}

/// Lists of numbers by number, in one piece of memory.
pub struct Lists {
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Lists {
    fn of(count: usize, mut pairs: Vec<(u32, u32)>) -> Self {
        pairs.sort_unstable();
        let mut starts = vec![0; count + 1];
        for &(of, _) in &pairs {
            starts[of as usize + 1] += 1;
        }
        for index in 0..count {
            starts[index + 1] += starts[index];
        }
        Self {
            starts,
            items: pairs.into_iter().map(|(_, item)| item).collect(),
        }
    }

    pub fn of_one(&self, index: u32) -> &[u32] {
        let index = index as usize;
        &self.items[self.starts[index] as usize..self.starts[index + 1] as usize]
    }
}
