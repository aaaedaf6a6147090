//! The open edges of a mesh, and which of them lie within reach of one another.

use crate::mesh::repair::faces::Faces;
use crate::mesh::repair::seams::grid::{Grid, axis_distance};

/// Stands for no vertex.
pub const NONE: u32 = u32::MAX;

/// Two open edges that may be one, which are ordered by who goes first.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
pub struct Pair {
    /// How many edges are within reach of that one of the two that has fewer: what has no choice goes first.
    choices: u32,
    /// Whether the two run the same way.
    same_way: bool,
    /// Largest distance of their ends along an axis.
    distance: f64,
    /// The two edges.
    pub edges: [u32; 2],
}

impl Pair {
    /// The ends of the first edge, and which of the second each is joined with.
    pub fn ends(&self, border: &Border) -> [[u32; 2]; 2] {
        let [[a, b], [c, d]] = self.edges.map(|edge| border.edges[edge as usize]);
        if self.same_way {
            [[a, c], [b, d]]
        } else {
            [[a, d], [b, c]]
        }
    }
}

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

    /// Open edges whose ends lie within reach of one another, in the order in which they are joined. Edges no longer
    /// than the reach are left out: either end of one might be either end of another.
    pub fn pairs(&self, reach: f64) -> Vec<Pair> {
        let between =
            |p: u32, q: u32| axis_distance(self.positions[p as usize], self.positions[q as usize]);
        let grid = Grid::new(&self.positions, reach);
        let mut near = Vec::new();
        let mut pairs = Vec::new();
        for (index, &[a, b]) in (0u32..).zip(&self.edges) {
            if between(a, b) <= reach {
                continue;
            }
            // Many edges may meet at one end, as at the tip of a cone.
            let swapped = self.edges_of.of_one(b).len() < self.edges_of.of_one(a).len();
            let (start, end) = if swapped { (b, a) } else { (a, b) };
            grid.near(self.positions[start as usize], &mut near);
            for &beginning in &near {
                for &other in self.edges_of.of_one(beginning) {
                    let [c, d] = self.edges[other as usize];
                    if other <= index || between(c, d) <= reach {
                        continue;
                    }
                    let is_first = c == beginning;
                    let far_end = if is_first { d } else { c };
                    let far = between(end, far_end);
                    let may_join = |p, q| !self.beside.of_one(p).contains(&q);
                    if far <= reach && may_join(start, beginning) && may_join(end, far_end) {
                        pairs.push(Pair {
                            choices: 0,
                            same_way: is_first != swapped,
                            distance: far.max(between(start, beginning)),
                            edges: [index, other],
                        });
                    }
                }
            }
        }
        let mut choices = vec![0; self.edges.len()];
        for edge in pairs.iter().flat_map(|pair| pair.edges) {
            choices[edge as usize] += 1;
        }
        for pair in &mut pairs {
            let [one, other] = pair.edges.map(|edge| choices[edge as usize]);
            pair.choices = one.min(other);
        }
        // No distance is NaN.
        pairs.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
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
