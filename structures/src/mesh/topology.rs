//! How triangles hang together: open and non-manifold edges, parts, and which way they face.
//!
//! A **part** is a set of triangles connected across edges that exactly two of them share. A mesh is **closed** when every
//! edge is run through as often one way as the other; then its winding number is a whole number off the surface, whatever
//! else is wrong with it.

use super::Mesh;
use super::facing::turn_outward;
use super::vector::{norm, subtract};

/// What [`orient`] found and did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Topology {
    /// Edges of one triangle only.
    pub open_edges: usize,
    /// Their length, in the file's unit.
    pub open_length: f64,
    /// Edges of more than two triangles.
    pub nonmanifold_edges: usize,
    /// Edges run through more often one way than the other, after triangles have been turned.
    pub unbalanced_edges: usize,
    /// Number of parts.
    pub parts: usize,
    /// Triangles turned to agree with their neighbours.
    pub turned_triangles: usize,
    /// Parts turned whole because they faced inward.
    pub inverted_parts: usize,
}

/// An edge as one triangle has it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct HalfEdge {
    low: u32,
    high: u32,
    triangle: u32,
    /// Whether the triangle runs from `low` to `high`.
    forward: bool,
}

/// The edges of all triangles, those of one place together.
fn half_edges(triangles: &[[u32; 3]]) -> Vec<HalfEdge> {
    let mut edges = Vec::with_capacity(3 * triangles.len());
    for (triangle, corners) in (0u32..).zip(triangles) {
        for side in 0..3 {
            let (from, to) = (corners[side], corners[(side + 1) % 3]);
            edges.push(HalfEdge {
                low: from.min(to),
                high: from.max(to),
                triangle,
                forward: from < to,
            });
        }
    }
    edges.sort_unstable();
    edges
}

/// Turns triangles to agree with their neighbours and parts to face outward, and counts what is amiss.
///
/// In each part the majority decides. Then whole surfaces are turned that face inward: [`turn_outward`].
pub fn orient(mesh: &mut Mesh) -> Topology {
    let mut edges = half_edges(&mesh.triangles);
    let mut topology = Topology::default();
    // Neighbour across each side of each triangle, and whether both run the side the same way, which is amiss.
    let mut neighbours: Vec<[Option<(u32, bool)>; 3]> = vec![[None; 3]; mesh.triangles.len()];
    let mut degree = vec![0u8; mesh.triangles.len()];
    let mut at_border = vec![false; mesh.triangles.len()];
    for group in edges.chunk_by(|a, b| (a.low, a.high) == (b.low, b.high)) {
        match group {
            [one] => {
                topology.open_edges += 1;
                at_border[one.triangle as usize] = true;
                let along = subtract(
                    mesh.positions[one.high as usize],
                    mesh.positions[one.low as usize],
                );
                topology.open_length += norm(along);
            }
            [a, b] => {
                for (own, other) in [(a, b), (b, a)] {
                    let place = &mut degree[own.triangle as usize];
                    neighbours[own.triangle as usize][usize::from(*place)] =
                        Some((other.triangle, a.forward == b.forward));
                    *place += 1;
                }
            }
            several => {
                topology.nonmanifold_edges += 1;
                for edge in several {
                    at_border[edge.triangle as usize] = true;
                }
            }
        }
    }
    let parts = agree(mesh, &neighbours, &mut topology);
    topology.parts = parts.len();
    topology.inverted_parts = turn_outward(mesh, &parts, &at_border);
    if topology.turned_triangles + topology.inverted_parts > 0 {
        edges = half_edges(&mesh.triangles);
    }
    topology.unbalanced_edges = edges
        .chunk_by(|a, b| (a.low, a.high) == (b.low, b.high))
        .filter(|group| 2 * group.iter().filter(|edge| edge.forward).count() != group.len())
        .count();
    topology
}

/// Turns triangles until neighbours agree, the fewer of each part; returns the parts.
fn agree(
    mesh: &mut Mesh,
    neighbours: &[[Option<(u32, bool)>; 3]],
    topology: &mut Topology,
) -> Vec<Vec<u32>> {
    let mut turned: Vec<Option<bool>> = vec![None; mesh.triangles.len()];
    let mut parts = Vec::new();
    for seed in 0..mesh.triangles.len() {
        if turned[seed].is_some() {
            continue;
        }
        turned[seed] = Some(false);
        let mut part = vec![seed as u32];
        let mut next = 0;
        while let Some(&triangle) = part.get(next) {
            next += 1;
            let own = turned[triangle as usize] == Some(true);
            for &(other, amiss) in neighbours[triangle as usize].iter().flatten() {
                let slot = &mut turned[other as usize];
                if slot.is_none() {
                    *slot = Some(own != amiss);
                    part.push(other);
                }
            }
        }
        let count = part
            .iter()
            .filter(|&&t| turned[t as usize] == Some(true))
            .count();
        let most = 2 * count > part.len();
        for &triangle in &part {
            if (turned[triangle as usize] == Some(true)) != most {
                mesh.triangles[triangle as usize].swap(1, 2);
                topology.turned_triangles += 1;
            }
        }
        part.sort_unstable();
        parts.push(part);
    }
    parts
}
