//! Clusters: patches that only together make closed surfaces, because they meet at non-manifold edges or are there
//! several times.

use crate::mesh::repair::distinct::Distinct;
use crate::mesh::repair::edges::{HalfEdge, Patches, Sets, by_place};
use crate::mesh::triangle_mesh::Mesh;

/// Rounds in which patches with a free edge are left out.
const ROUNDS: usize = 8;

/// The cluster of each distinct triangle, and the number of clusters.
///
/// A patch that is closed by itself is in none, though it may touch others along an edge: it has a volume of its
/// own. Nor is one with a free edge, unless it is there both ways round.
pub(in crate::mesh) fn clusters(
    mesh: &Mesh,
    distinct: &Distinct,
    edges: &[HalfEdge],
    patches: &Patches,
) -> (Vec<Option<u32>>, usize) {
    let count = patches.members.len();
    let patch = |edge: &HalfEdge| patches.of[edge.triangle as usize] as usize;
    // What is there several times, or meets others at an edge; and what is not closed by itself.
    let mut member = vec![false; count];
    let mut needy = patches.one_sided.clone();
    for triangle in 0..distinct.len() {
        let has_area = !mesh.is_sliver(distinct.corners[triangle]);
        if distinct.is_repeated(triangle as u32) && has_area {
            member[patches.of[triangle] as usize] = true;
            needy[patches.of[triangle] as usize] = true;
        }
    }
    for group in by_place(edges) {
        if group.len() == 2 {
            continue;
        }
        for edge in group {
            member[patch(edge)] |= group.len() > 2;
            let own = group.iter().filter(|other| patch(other) == patch(edge));
            let balance: i64 = own
                .map(|other| {
                    let forward = other.forward != patches.turned[other.triangle as usize];
                    if forward { 1 } else { -1 }
                })
                .sum();
            needy[patch(edge)] |= balance != 0;
        }
    }
    for (member, needy) in member.iter_mut().zip(needy) {
        *member &= needy;
    }
    for _ in 0..ROUNDS {
        let mut changed = false;
        for group in by_place(edges) {
            let mut own = group.iter().filter(|edge| member[patch(edge)]);
            if let (Some(edge), None) = (own.next(), own.next())
                && !distinct.is_both_ways(edge.triangle)
            {
                member[patch(edge)] = false;
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    let mut sets = Sets::new(count);
    for group in by_place(edges) {
        let mut own = group.iter().map(patch).filter(|&patch| member[patch]);
        if let Some(first) = own.next() {
            own.for_each(|other| sets.join(first, other));
        }
    }
    let mut names: Vec<Option<u32>> = vec![None; count];
    let mut clusters = 0;
    let mut of = vec![None; distinct.len()];
    for (triangle, cluster) in of.iter_mut().enumerate() {
        let patch = patches.of[triangle] as usize;
        if member[patch] {
            let name = &mut names[sets.root(patch)];
            *cluster = Some(*name.get_or_insert_with(|| {
                clusters += 1;
                clusters as u32 - 1
            }));
        }
    }
    (of, clusters)
}
