//! Triangles in a binary tree of clusters, with the moments that sums over far clusters need.

use std::cmp::Ordering;

use crate::mesh::triangle_mesh::{Mesh, centroid, doubled_normal};
use crate::vector::{add, bounds, distance, norm, scale};

const LEAF: usize = 8;
/// Step to which places are rounded before they are compared: the solid is about one long.
const ROUNDED: f64 = 1e-9;

/// A binary tree over triangles that have an area; halves at the median of the longest side.
#[derive(Clone, Debug)]
pub(crate) struct TriangleTree {
    /// Corners, in the order of the leaves.
    triangles: Vec<[[f64; 3]; 3]>,
    nodes: Vec<Cluster>,
}

#[derive(Clone, Debug)]
pub(crate) struct Cluster {
    /// Area-weighted middle.
    pub center: [f64; 3],
    /// No corner is farther from the middle.
    pub radius: f64,
    /// Sum of areas.
    pub area: f64,
    /// Sum of area times outward normal.
    pub area_vector: [f64; 3],
    /// Its triangles.
    pub first: u32,
    count: u32,
    /// Nodes below this one, which follow it.
    below: u32,
}

impl TriangleTree {
    /// The tree over a mesh's triangles. Those without area have no solid angle and no share of any integral, so
    /// they are left out.
    pub fn new(mesh: &Mesh) -> Self {
        Self::of(mesh.with_area(mesh.triangles.iter().copied()).collect())
    }

    /// The tree over triangles that have an area.
    pub fn of(triangles: Vec<[[f64; 3]; 3]>) -> Self {
        let place = |corners| (centroid(corners), corners);
        let mut placed: Vec<Placed> = triangles.into_iter().map(place).collect();
        let mut nodes = Vec::with_capacity(4 * placed.len() / LEAF + 1);
        build(&mut placed, 0, &mut nodes);
        let triangles = placed.into_iter().map(|(_, corners)| corners).collect();
        Self { triangles, nodes }
    }

    /// The triangles.
    pub fn triangles(&self) -> &[[[f64; 3]; 3]] {
        &self.triangles
    }

    /// The triangles of a cluster, if it has no clusters below.
    pub fn leaf(&self, cluster: &Cluster) -> Option<&[[[f64; 3]; 3]]> {
        let triangles = cluster.first as usize..(cluster.first + cluster.count) as usize;
        (cluster.below == 0).then(|| &self.triangles[triangles])
    }

    /// Walks the clusters at and below the node `top` from the largest down, the whole tree from node 0; `enter` returns
    /// whether to go on to those below.
    pub fn visit(&self, top: usize, mut enter: impl FnMut(&Cluster) -> bool) {
        let end = |node: &Cluster| top + node.below as usize + 1;
        let end = self.nodes.get(top).map_or(0, end);
        let mut at = top;
        while at < end {
            let node = &self.nodes[at];
            let down = enter(node);
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

type Placed = ([f64; 3], [[f64; 3]; 3]);

/// Puts the tree over `triangles`, which are numbers `first` and on, at the end of `nodes`.
fn build(triangles: &mut [Placed], first: usize, nodes: &mut Vec<Cluster>) {
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
    let radius = reach(corners, center);
    let place = nodes.len();
    nodes.push(Cluster {
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
    // Last digits neither choose between sides of one length nor order what is level.
    let side = |axis: usize| ((high[axis] - low[axis]) / ROUNDED).round();
    let axis = (0..3).max_by(|&a, &b| side(a).total_cmp(&side(b)));
    let axis = axis.unwrap_or(0);
    let middle = triangles.len() / 2;
    triangles.select_nth_unstable_by(middle, |a, b| {
        let part =
            |triangle: &Placed, step: usize| (triangle.0[(axis + step) % 3] / ROUNDED).round();
        let steps = (0..3).map(|step| part(a, step).total_cmp(&part(b, step)));
        steps.fold(Ordering::Equal, Ordering::then)
    });
    let (left, right) = triangles.split_at_mut(middle);
    build(left, first, nodes);
    build(right, first + middle, nodes);
    nodes[place].below = (nodes.len() - place - 1) as u32;
}

pub(crate) fn reach<'a>(points: impl IntoIterator<Item = &'a [f64; 3]>, center: [f64; 3]) -> f64 {
    let distances = points.into_iter().map(|&point| distance(point, center));
    distances.fold(0.0, f64::max)
}
