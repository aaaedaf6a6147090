//! Triangles in a binary tree of clusters, with what sums over far clusters need of each.

use crate::mesh::triangle_mesh::{Mesh, doubled_normal};
use crate::vector::{add, bounds, distance, norm, scale};

/// Triangles in a leaf.
const LEAF: usize = 8;

/// A binary tree over triangles that have an area; halves at the median of the longest side.
#[derive(Debug)]
pub(crate) struct TriangleTree {
    /// Corners, in the order of the leaves.
    triangles: Vec<[[f64; 3]; 3]>,
    /// Nodes in depth-first order.
    nodes: Vec<Node>,
}

#[derive(Debug)]
struct Node {
    /// Area-weighted middle.
    center: [f64; 3],
    /// No corner is farther from the middle.
    radius: f64,
    /// Sum of areas.
    area: f64,
    /// Sum of area times outward normal.
    area_vector: [f64; 3],
    /// Its triangles.
    first: u32,
    count: u32,
    /// Nodes below this one, which follow it.
    below: u32,
}

/// A cluster of triangles as a visitor sees it.
pub(crate) struct Cluster<'a> {
    /// Area-weighted middle.
    pub center: [f64; 3],
    /// No corner is farther from the middle.
    pub radius: f64,
    /// Sum of areas.
    pub area: f64,
    /// Sum of area times outward normal.
    pub area_vector: [f64; 3],
    /// Its triangles, if it has no clusters below.
    pub leaf: Option<&'a [[[f64; 3]; 3]]>,
}

impl TriangleTree {
    /// The tree over a mesh's triangles. Those without area have no solid angle and no share of any integral, so
    /// they are left out.
    pub fn new(mesh: &Mesh) -> Self {
        let triangles = mesh.triangles.iter().copied();
        Self::of(
            triangles
                .filter(|&triangle| !mesh.is_sliver(triangle))
                .map(|triangle| mesh.corners(triangle))
                .collect(),
        )
    }

    /// The tree over triangles that have an area.
    pub fn of(triangles: Vec<[[f64; 3]; 3]>) -> Self {
        let mut placed: Vec<Placed> = triangles
            .into_iter()
            .map(|corners| (centroid(corners), corners))
            .collect();
        let mut nodes = Vec::with_capacity(4 * placed.len() / LEAF + 1);
        build(&mut placed, 0, &mut nodes);
        let triangles = placed.into_iter().map(|(_, corners)| corners).collect();
        Self { triangles, nodes }
    }

    /// The triangles.
    pub fn triangles(&self) -> &[[[f64; 3]; 3]] {
        &self.triangles
    }

    /// Walks the clusters from the largest down; `enter` says whether to go on to those below.
    pub fn visit(&self, mut enter: impl FnMut(Cluster<'_>) -> bool) {
        self.visit_below(0, |cluster, _| enter(cluster));
    }

    /// As [`visit`](Self::visit), of the node `top` and those below it; `enter` gets the number of the cluster's
    /// first triangle, too.
    pub fn visit_below(&self, top: usize, mut enter: impl FnMut(Cluster<'_>, usize) -> bool) {
        let end = self
            .nodes
            .get(top)
            .map_or(0, |node| top + node.below as usize + 1);
        let mut at = top;
        while at < end {
            let node = &self.nodes[at];
            let triangles =
                &self.triangles[node.first as usize..(node.first + node.count) as usize];
            let cluster = Cluster {
                center: node.center,
                radius: node.radius,
                area: node.area,
                area_vector: node.area_vector,
                leaf: (node.below == 0).then_some(triangles),
            };
            let down = enter(cluster, node.first as usize);
            at += 1 + if down { 0 } else { node.below as usize };
        }
    }

    /// Nodes of no more than `size` triangles that have all triangles below them, in the order of these.
    pub fn blocks(&self, size: usize) -> Vec<usize> {
        let mut blocks = Vec::new();
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            let whole = node.count as usize <= size || node.below == 0;
            if whole {
                blocks.push(at);
            }
            at += 1 + if whole { node.below as usize } else { 0 };
        }
        blocks
    }
}

/// A triangle after its middle.
type Placed = ([f64; 3], [[f64; 3]; 3]);

/// Puts the tree over `triangles`, which are numbers `first` and on, at the end of `nodes`.
fn build(triangles: &mut [Placed], first: usize, nodes: &mut Vec<Node>) {
    let mut area = 0.0;
    let mut area_vector = [0.0; 3];
    let mut moment = [0.0; 3];
    let (low, high) = bounds(triangles.iter().map(|(middle, _)| *middle));
    for &(middle, corners) in &*triangles {
        let normal = scale(doubled_normal(corners), 0.5);
        let own = norm(normal);
        area += own;
        area_vector = add(area_vector, normal);
        moment = add(moment, scale(middle, own));
    }
    let center = if area > 0.0 {
        scale(moment, 1.0 / area)
    } else {
        scale(add(low, high), 0.5)
    };
    let corners = triangles.iter().flat_map(|(_, corners)| corners);
    let radius = corners
        .map(|&corner| distance(corner, center))
        .fold(0.0, f64::max);
    let place = nodes.len();
    nodes.push(Node {
        center,
        radius,
        area,
        area_vector,
        first: first as u32,
        count: triangles.len() as u32,
        below: 0,
    });
    if triangles.len() <= LEAF {
        return;
    }
    let axis = (0..3)
        .max_by(|&a, &b| (high[a] - low[a]).total_cmp(&(high[b] - low[b])))
        .unwrap_or(0);
    let middle = triangles.len() / 2;
    triangles.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]));
    let (left, right) = triangles.split_at_mut(middle);
    build(left, first, nodes);
    build(right, first + middle, nodes);
    nodes[place].below = (nodes.len() - place - 1) as u32;
}

/// The middle of a triangle.
pub(crate) fn centroid([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    scale(add(a, add(b, c)), 1.0 / 3.0)
}
