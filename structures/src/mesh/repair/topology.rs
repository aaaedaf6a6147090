//! Topology of triangles: open and non-manifold edges, parts, and which way they face.
//!
//! A **part** is a set of triangles connected across edges: see [`patches`]. A mesh is **closed** when every edge is
//! run through as often one way as the other; then its winding number is a whole number off the surface, whatever
//! else is wrong with it.

use std::collections::HashMap;

use crate::error::Error;
use crate::mesh::repair::edges::{
    HalfEdge, by_place, half_edges, inner_walls, patches, sorted, surplus,
};
use crate::mesh::repair::facing::{Part, turn_outward};
use crate::mesh::report::MeshReport;
use crate::mesh::triangle_mesh::Mesh;
use crate::vector::{norm, subtract};

/// Turns triangles to agree with their neighbours and parts to face outward, drops what bounds nothing, and counts
/// what is amiss.
///
/// In each part the majority decides. Then whole surfaces are turned that face inward: [`turn_outward`].
///
/// # Errors
/// Too many surfaces within one another.
pub fn orient(mesh: &mut Mesh, report: &mut MeshReport) -> Result<(), Error> {
    let mut edges = half_edges(&mesh.triangles);
    if by_place(&edges).any(|about| about.len() > 2) {
        report.repeated_triangles = drop_triangles(mesh, &surplus(&mesh.triangles, &edges));
        edges = half_edges(&mesh.triangles);
        let patches = patches(mesh.triangles.len(), &edges);
        report.idle_triangles = drop_triangles(mesh, &inner_walls(mesh, &edges, &patches));
        edges = half_edges(&mesh.triangles);
    }
    let (mut parts, part_of) = parts(mesh, &edges, report);
    if report.turned_triangles > 0 {
        edges = half_edges(&mesh.triangles);
    }
    let at_border = borders(&edges, &mut parts, &part_of);
    if by_place(&edges).any(|about| about.len() > 2) {
        find_repeats(mesh, &mut parts);
    }
    let dropped = turn_outward(mesh, &parts, &at_border, report)?;
    let is_left = |part: &&Part| part.triangles.iter().any(|&t| !dropped[t as usize]);
    report.parts = parts.iter().filter(is_left).count();
    if drop_triangles(mesh, &dropped) + report.inverted_parts > 0 {
        edges = half_edges(&mesh.triangles);
    }
    for about in by_place(&edges) {
        match about {
            [one] => {
                let [low, high] = [one.low, one.high].map(|end| mesh.positions[end as usize]);
                report.open_edges += 1;
                report.open_length += norm(subtract(high, low));
            }
            [_, _] => {}
            _ => report.nonmanifold_edges += 1,
        }
        let forward = about.iter().filter(|edge| edge.forward).count();
        report.unbalanced_edges += usize::from(2 * forward != about.len());
    }
    mesh.closed = report.is_closed();
    Ok(())
}

/// Turns triangles until neighbours agree, the fewer of each patch; returns the parts, and the part of each triangle.
fn parts(mesh: &mut Mesh, edges: &[HalfEdge], report: &mut MeshReport) -> (Vec<Part>, Vec<u32>) {
    let patches = patches(mesh.triangles.len(), edges);
    let mut parts: Vec<Part> = Vec::new();
    let mut part_of = vec![0; mesh.triangles.len()];
    for (patch, one_sided) in patches.members.into_iter().zip(patches.one_sided) {
        report.one_sided_parts += usize::from(one_sided);
        let turned = |&&triangle: &&u32| patches.turned[triangle as usize];
        let most = 2 * patch.iter().filter(turned).count() > patch.len();
        for triangle in &patch {
            part_of[*triangle as usize] = parts.len() as u32;
            if turned(&triangle) != most {
                mesh.triangles[*triangle as usize].swap(1, 2);
                report.turned_triangles += 1;
            }
        }
        parts.push(Part {
            triangles: patch,
            is_closed: !one_sided,
            again: None,
            reverse: None,
        });
    }
    (parts, part_of)
}

/// Finds closed parts that are there again, one way round or the other.
fn find_repeats(mesh: &Mesh, parts: &mut [Part]) {
    let mut known: HashMap<Vec<([u32; 3], usize)>, usize> = HashMap::new();
    for index in 0..parts.len() {
        if !parts[index].is_closed {
            continue;
        }
        let own = parts[index].triangles.iter();
        let mut own: Vec<_> = own.map(|&t| sorted(mesh.triangles[t as usize])).collect();
        own.sort_unstable();
        let turned: Vec<_> = own
            .iter()
            .map(|&(corners, side)| (corners, 1 - side))
            .collect();
        if let Some(&first) = known.get(&own) {
            parts[index].again = Some(first);
        } else if let Some(&first) = known.get(&turned) {
            parts[index].again = Some(first);
            parts[first].reverse.get_or_insert(index);
        } else {
            known.insert(own, index);
        }
    }
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

/// Drops triangles, and the vertices that none uses any longer; returns the number of triangles.
fn drop_triangles(mesh: &mut Mesh, dropped: &[bool]) -> usize {
    let count = dropped.iter().filter(|&&dropped| dropped).count();
    if count == 0 {
        return 0;
    }
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
    count
}
