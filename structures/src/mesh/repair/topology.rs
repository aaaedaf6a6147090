//! Topology of triangles: open and non-manifold edges, parts, and which way they face.
//!
//! A **part** is a set of triangles connected across edges that exactly two of them share or, where more do, the
//! walls of one body: [`shells`](super::shells). A mesh is **closed** when every edge is run through as often one
//! way as the other; then its winding number is a whole number off the surface, whatever else is wrong with it.

use crate::mesh::error::MeshErrorKind;
use crate::mesh::repair::bounded_surface::Part;
use crate::mesh::repair::edges::{HalfEdge, by_place, half_edges, patches};
use crate::mesh::repair::facing::turn_outward;
use crate::mesh::repair::shells;
use crate::mesh::repair::shells::Shells;
use crate::mesh::triangle_mesh::Mesh;
use crate::mesh::vector::{norm, subtract};

/// Report of [`orient`].
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
    /// Parts that lie within others and face outward.
    pub nested_parts: usize,
    /// Parts whose triangles cannot all agree, as those of a Möbius strip.
    pub one_sided_parts: usize,
    /// Triangles dropped because they were there before, one way round or the other.
    pub repeated_triangles: usize,
    /// Triangles dropped because nothing of the solid is on either side of them.
    pub idle_triangles: usize,
    /// Volume of nested parts, which the divergence theorem counts twice, in the file's unit cubed.
    pub overlap: f64,
}

/// Turns triangles to agree with their neighbours and parts to face outward, drops what bounds nothing, and counts
/// what is amiss.
///
/// In each part the majority decides. Then whole surfaces are turned that face inward: [`turn_outward`].
///
/// # Errors
/// [`MeshErrorKind::Nested`] for too many parts within one another.
pub fn orient(mesh: &mut Mesh) -> Result<Topology, MeshErrorKind> {
    let mut edges = half_edges(&mesh.triangles);
    let mut shells = Shells::default();
    let count = mesh.triangles.len();
    if is_tangled(mesh, &edges) {
        shells = shells::resolve(mesh);
        edges = half_edges(&mesh.triangles);
    } else {
        shells.of = vec![None; count];
    }
    let mut topology = Topology {
        turned_triangles: shells.turned,
        repeated_triangles: shells.repeated,
        idle_triangles: shells.idle,
        nested_parts: shells.nested,
        overlap: shells.overlap,
        ..Topology::default()
    };
    let turned_before = topology.turned_triangles;
    let (mut parts, part_of) = parts(mesh, &edges, &shells, &mut topology);
    if topology.turned_triangles > turned_before {
        edges = half_edges(&mesh.triangles);
    }
    let at_border = borders(&edges, &mut parts, &part_of);
    let facing = turn_outward(mesh, &parts, &at_border)?;
    topology.inverted_parts = facing.turned;
    topology.nested_parts += facing.nested;
    topology.overlap += facing.overlap;
    topology.repeated_triangles += facing.repeated.len();
    topology.idle_triangles += facing.idle.len();
    let mut dropped = vec![false; mesh.triangles.len()];
    for &triangle in facing.repeated.iter().chain(&facing.idle) {
        dropped[triangle as usize] = true;
    }
    let is_left = |part: &&Part| part.triangles.iter().any(|&t| !dropped[t as usize]);
    topology.parts = parts.iter().filter(is_left).count();
    if topology.repeated_triangles + topology.idle_triangles > 0 {
        drop_triangles(mesh, &dropped);
    }
    if topology.inverted_parts + topology.repeated_triangles + topology.idle_triangles > 0 {
        edges = half_edges(&mesh.triangles);
    }
    count_edges(mesh, &edges, &mut topology);
    Ok(topology)
}

/// Whether more than two triangles share an edge, or a triangle is there several times.
fn is_tangled(mesh: &Mesh, edges: &[HalfEdge]) -> bool {
    let tip = |edge: &HalfEdge| {
        let corners = mesh.triangles[edge.triangle as usize];
        corners
            .into_iter()
            .find(|c| *c != edge.low && *c != edge.high)
    };
    by_place(edges).any(|group| match group {
        [_] => false,
        [a, b] => tip(a) == tip(b),
        _ => true,
    })
}

/// Turns triangles until neighbours agree, the fewer of each patch; returns the parts, and the part of each triangle.
fn parts(
    mesh: &mut Mesh,
    edges: &[HalfEdge],
    shells: &Shells,
    topology: &mut Topology,
) -> (Vec<Part>, Vec<u32>) {
    let patches = patches(mesh.triangles.len(), edges);
    let mut parts = Vec::new();
    let mut part_of = vec![0; mesh.triangles.len()];
    for (patch, one_sided) in patches.members.into_iter().zip(patches.one_sided) {
        if patch
            .iter()
            .any(|&triangle| shells.of[triangle as usize].is_some())
        {
            continue;
        }
        topology.one_sided_parts += usize::from(one_sided);
        let turned = |&&triangle: &&u32| patches.turned[triangle as usize];
        let most = 2 * patch.iter().filter(turned).count() > patch.len();
        for triangle in &patch {
            part_of[*triangle as usize] = parts.len() as u32;
            if turned(&triangle) != most {
                mesh.triangles[*triangle as usize].swap(1, 2);
                topology.turned_triangles += 1;
            }
        }
        parts.push(Part {
            triangles: patch,
            is_reverse: false,
            is_closed: !one_sided,
        });
    }
    let first = parts.len();
    for &is_reverse in &shells.is_reverse {
        parts.push(Part {
            triangles: Vec::new(),
            is_reverse,
            is_closed: true,
        });
    }
    for (triangle, shell) in shells.of.iter().enumerate() {
        if let Some(shell) = shell {
            let part = first + *shell as usize;
            parts[part].triangles.push(triangle as u32);
            part_of[triangle] = part as u32;
        }
    }
    (parts, part_of)
}

/// Whether each triangle has an edge that its own part runs through more often one way than the other.
fn borders(edges: &[HalfEdge], parts: &mut [Part], part_of: &[u32]) -> Vec<bool> {
    let mut at_border = vec![false; part_of.len()];
    let part = |edge: &HalfEdge| part_of[edge.triangle as usize];
    for group in by_place(edges) {
        // Of the two triangles at most edges both are of one part, which agrees unless it is one-sided.
        if group.len() == 2 {
            continue;
        }
        for edge in group {
            let own = group.iter().filter(|other| part(other) == part(edge));
            let balance: i64 = own.map(|other| if other.forward { 1 } else { -1 }).sum();
            if balance != 0 {
                at_border[edge.triangle as usize] = true;
                parts[part(edge) as usize].is_closed = false;
            }
        }
    }
    at_border
}

/// Drops triangles, and the vertices that none uses any longer.
fn drop_triangles(mesh: &mut Mesh, dropped: &[bool]) {
    let mut places = dropped.iter();
    mesh.triangles.retain(|_| places.next() != Some(&true));
    let mut names: Vec<Option<u32>> = vec![None; mesh.positions.len()];
    for &corner in mesh.triangles.iter().flatten() {
        names[corner as usize] = Some(0);
    }
    let mut kept = Vec::with_capacity(mesh.positions.len());
    for (name, position) in names.iter_mut().zip(&mesh.positions) {
        if let Some(name) = name {
            *name = kept.len() as u32;
            kept.push(*position);
        }
    }
    mesh.positions = kept;
    for corner in mesh.triangles.iter_mut().flatten() {
        let name = names[*corner as usize];
        debug_assert!(
            name.is_some(),
            "every corner of a triangle is a vertex that is kept"
        );
        *corner = name.unwrap_or_default();
    }
}

fn count_edges(mesh: &Mesh, edges: &[HalfEdge], topology: &mut Topology) {
    for group in by_place(edges) {
        match group {
            [one] => {
                topology.open_edges += 1;
                let along = subtract(
                    mesh.positions[one.high as usize],
                    mesh.positions[one.low as usize],
                );
                topology.open_length += norm(along);
            }
            [_, _] => {}
            _ => topology.nonmanifold_edges += 1,
        }
        let forward = group.iter().filter(|edge| edge.forward).count();
        topology.unbalanced_edges += usize::from(2 * forward != group.len());
    }
}
