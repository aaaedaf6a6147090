//! How triangles hang together: open and non-manifold edges, parts, and which way they face.
//!
//! A **part** is a set of triangles connected across edges that exactly two of them share. A mesh is **closed** when every
//! edge is run through as often one way as the other; then its winding number is a whole number off the surface, whatever
//! else is wrong with it.

use super::Mesh;
use super::vector::{add, cross, dot, norm, scale, subtract};
use super::winding::solid_angle;

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
/// In each part the majority decides. A part that faces inward is turned unless it lies inside another, where facing
/// inward makes it the wall of a cavity; if the part about it was turned, so is it.
pub fn orient(mesh: &mut Mesh) -> Topology {
    let mut edges = half_edges(&mesh.triangles);
    let mut topology = Topology::default();
    // Neighbour across each side of each triangle, and whether both run the side the same way, which is amiss.
    let mut neighbours: Vec<[Option<(u32, bool)>; 3]> = vec![[None; 3]; mesh.triangles.len()];
    let mut degree = vec![0u8; mesh.triangles.len()];
    let mut at_nonmanifold = vec![false; mesh.triangles.len()];
    for group in edges.chunk_by(|a, b| (a.low, a.high) == (b.low, b.high)) {
        match group {
            [one] => {
                topology.open_edges += 1;
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
                    at_nonmanifold[edge.triangle as usize] = true;
                }
            }
        }
    }
    let parts = agree(mesh, &neighbours, &mut topology);
    topology.parts = parts.len();
    let free: Vec<bool> = parts
        .iter()
        .map(|part| {
            part.iter()
                .all(|&triangle| !at_nonmanifold[triangle as usize])
        })
        .collect();
    turn_outward(mesh, &parts, &free, &mut topology);
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

/// Six times the volume of a part about the middle of its bounding box, and that box.
fn volume(mesh: &Mesh, part: &[u32]) -> (f64, [f64; 3], [f64; 3]) {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    let corners = || {
        part.iter()
            .map(|&triangle| mesh.corners(mesh.triangles[triangle as usize]))
    };
    for point in corners().flatten() {
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    let middle = scale(add(low, high), 0.5);
    let volume = corners()
        .map(|corners| {
            let [a, b, c] = corners.map(|corner| subtract(corner, middle));
            dot(a, cross(b, c))
        })
        .sum();
    (volume, low, high)
}

/// Turns parts that face inward; see [`orient`]. Parts at non-manifold edges (`free` is false) stay as they are: they are
/// pieces of a surface, not surfaces.
fn turn_outward(mesh: &mut Mesh, parts: &[Vec<u32>], free: &[bool], topology: &mut Topology) {
    let measured: Vec<_> = parts.iter().map(|part| volume(mesh, part)).collect();
    let inward: Vec<bool> = measured
        .iter()
        .zip(free)
        .map(|((v, ..), free)| *free && *v < 0.0)
        .collect();
    if !inward.contains(&true) {
        return;
    }
    // The parts about each inward one; the outermost decides.
    let mut turn = vec![false; parts.len()];
    let mut within: Vec<Vec<usize>> = vec![Vec::new(); parts.len()];
    for (index, part) in parts.iter().enumerate().filter(|(index, _)| inward[*index]) {
        let point = mesh.corners(mesh.triangles[part[0] as usize])[0];
        for (other, (_, low, high)) in measured.iter().enumerate() {
            let inside_box = (0..3).all(|axis| low[axis] < point[axis] && point[axis] < high[axis]);
            if other == index || !free[other] || !inside_box {
                continue;
            }
            let angle: f64 = parts[other]
                .iter()
                .map(|&t| solid_angle(mesh.corners(mesh.triangles[t as usize]), point))
                .sum();
            if angle.abs() > 2.0 * std::f64::consts::PI {
                within[index].push(other);
            }
        }
        turn[index] = within[index].is_empty();
    }
    for index in 0..parts.len() {
        if inward[index] && !turn[index] {
            // A cavity of a part that is turned is turned with it, or it would count as solid.
            turn[index] = within[index]
                .iter()
                .any(|&outer| inward[outer] && within[outer].is_empty());
        }
    }
    // A part that faces outward inside one that is turned was the wall of a cavity in an inverted file.
    let turned_whole: Vec<usize> = (0..parts.len())
        .filter(|&i| turn[i] && within[i].is_empty())
        .collect();
    for (index, part) in parts.iter().enumerate() {
        if inward[index] || !free[index] {
            continue;
        }
        let point = mesh.corners(mesh.triangles[part[0] as usize])[0];
        turn[index] = turned_whole.iter().any(|&outer| {
            let (_, low, high) = measured[outer];
            (0..3).all(|axis| low[axis] < point[axis] && point[axis] < high[axis])
                && parts[outer]
                    .iter()
                    .map(|&t| solid_angle(mesh.corners(mesh.triangles[t as usize]), point))
                    .sum::<f64>()
                    .abs()
                    > 2.0 * std::f64::consts::PI
        });
    }
    for (part, _) in parts.iter().zip(&turn).filter(|(_, turn)| **turn) {
        topology.inverted_parts += 1;
        for &triangle in part {
            mesh.triangles[triangle as usize].swap(1, 2);
        }
    }
}
