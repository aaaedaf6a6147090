//! Edges of triangles, and the patches that hang together across them.

use std::collections::HashMap;

use crate::mesh::triangle_mesh::Mesh;

/// An edge as one triangle has it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::mesh) struct HalfEdge {
    pub low: u32,
    pub high: u32,
    pub triangle: u32,
    /// Whether the triangle runs from `low` to `high`.
    pub forward: bool,
}

/// The edges of all triangles, those between the same two vertices together.
pub(in crate::mesh) fn half_edges(triangles: &[[u32; 3]]) -> Vec<HalfEdge> {
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

/// The half edges between each two vertices, in the order of the triangles.
pub(in crate::mesh) fn by_place(edges: &[HalfEdge]) -> impl Iterator<Item = &[HalfEdge]> {
    edges.chunk_by(|a, b| (a.low, a.high) == (b.low, b.high))
}

/// Triangles connected across edges: those of two triangles, and the pairs at those of four, six and so on.
pub(in crate::mesh) struct Patches {
    /// Triangles of each patch, in rising order.
    pub members: Vec<Vec<u32>>,
    /// Patch of each triangle.
    pub of: Vec<u32>,
    /// Whether each triangle has to be turned to agree with the first of its patch.
    pub turned: Vec<bool>,
    /// Whether no turning makes all triangles of a patch agree, as on a Möbius strip or a Klein bottle.
    pub one_sided: Vec<bool>,
}

/// The pairs of triangles about an edge that hang together.
///
/// An even number of triangles is as many sheets of bodies that touch there. Files hold one body after the other, so
/// neighbours in the file are a pair; where all triangles agree with their neighbours, the nearest two that run
/// opposite ways. Of an odd number none is paired: which one is too many is not known.
fn pairs(about: &[HalfEdge], is_coherent: bool) -> Vec<[HalfEdge; 2]> {
    if about.len() % 2 == 1 {
        return Vec::new();
    }
    let mut pairs = Vec::with_capacity(about.len() / 2);
    let mut open: Vec<HalfEdge> = Vec::new();
    for &edge in about {
        match open.last() {
            Some(&last) if is_coherent && last.forward != edge.forward => {
                open.pop();
                pairs.push([last, edge]);
            }
            _ => open.push(edge),
        }
    }
    pairs.extend(open.chunks_exact(2).map(|pair| [pair[0], pair[1]]));
    pairs
}

/// The patches of `count` triangles with these edges.
pub(in crate::mesh) fn patches(count: usize, edges: &[HalfEdge]) -> Patches {
    // Neighbour across each side of each triangle, and whether both run the side the same way, which is amiss.
    let mut neighbours: Vec<[Option<(u32, bool)>; 3]> = vec![[None; 3]; count];
    let mut degree = vec![0u8; count];
    let mut join = |[a, b]: [HalfEdge; 2]| {
        for (own, other) in [(a, b), (b, a)] {
            let place = &mut degree[own.triangle as usize];
            neighbours[own.triangle as usize][usize::from(*place)] =
                Some((other.triangle, a.forward == b.forward));
            *place += 1;
        }
    };
    let is_coherent = by_place(edges).all(|about| match about {
        [a, b] => a.forward != b.forward,
        _ => true,
    });
    for about in by_place(edges) {
        match about {
            &[a, b] => join([a, b]),
            _ => pairs(about, is_coherent).into_iter().for_each(&mut join),
        }
    }
    let mut patches = Patches {
        members: Vec::new(),
        of: vec![0; count],
        turned: vec![false; count],
        one_sided: Vec::new(),
    };
    let mut seen = vec![false; count];
    for seed in 0..count {
        if seen[seed] {
            continue;
        }
        seen[seed] = true;
        let name = patches.members.len() as u32;
        let mut patch = vec![seed as u32];
        let mut one_sided = false;
        let mut next = 0;
        while let Some(&triangle) = patch.get(next) {
            next += 1;
            patches.of[triangle as usize] = name;
            let own = patches.turned[triangle as usize];
            for &(other, amiss) in neighbours[triangle as usize].iter().flatten() {
                let place = other as usize;
                if seen[place] {
                    one_sided |= patches.turned[place] != (own != amiss);
                } else {
                    seen[place] = true;
                    patches.turned[place] = own != amiss;
                    patch.push(other);
                }
            }
        }
        patch.sort_unstable();
        patches.members.push(patch);
        patches.one_sided.push(one_sided);
    }
    patches
}

/// Copies of triangles by which an edge has an odd number of them: faces that a file holds once more. Of all copies
/// the first stays.
pub(in crate::mesh) fn surplus(triangles: &[[u32; 3]], edges: &[HalfEdge]) -> Vec<bool> {
    let mut copies: HashMap<[u32; 3], Vec<u32>> = HashMap::with_capacity(triangles.len());
    for (index, &triangle) in (0u32..).zip(triangles) {
        copies.entry(sorted(triangle).0).or_default().push(index);
    }
    let about = |low: u32, high: u32| {
        let place = |edge: &HalfEdge| (edge.low, edge.high);
        let first = edges.partition_point(|edge| place(edge) < (low, high));
        edges[first..]
            .iter()
            .take_while(move |edge| place(edge) == (low, high))
    };
    let mut is_surplus = vec![false; triangles.len()];
    let repeated = copies.iter().filter(|(_, own)| own.len() > 1);
    let mut waiting: Vec<[u32; 3]> = repeated.map(|(corners, _)| *corners).collect();
    waiting.sort_unstable();
    while let Some(corners) = waiting.pop() {
        let sides = [(0, 1), (0, 2), (1, 2)].map(|(low, high)| (corners[low], corners[high]));
        let is_odd = sides.iter().any(|&(low, high)| {
            let left = about(low, high).filter(|edge| !is_surplus[edge.triangle as usize]);
            left.count() % 2 == 1
        });
        let Some(own) = copies
            .get_mut(&corners)
            .filter(|own| is_odd && own.len() > 1)
        else {
            continue;
        };
        if let Some(last) = own.pop() {
            is_surplus[last as usize] = true;
            let near = sides.iter().flat_map(|&(low, high)| about(low, high));
            waiting.extend(near.map(|edge| sorted(triangles[edge.triangle as usize]).0));
        }
    }
    is_surplus
}

/// Walls within a body: patches whose every border is an edge of three or more triangles, an odd number, of which the
/// others close the surface without them. The smallest go first.
pub(in crate::mesh) fn inner_walls(
    mesh: &Mesh,
    edges: &[HalfEdge],
    patches: &Patches,
) -> Vec<bool> {
    let is_odd = |about: &&[HalfEdge]| about.len() % 2 == 1;
    let groups: Vec<&[HalfEdge]> = by_place(edges).filter(is_odd).collect();
    let patch = |edge: &HalfEdge| patches.of[edge.triangle as usize] as usize;
    let mut borders: Vec<Vec<usize>> = vec![Vec::new(); patches.members.len()];
    for (group, about) in groups.iter().enumerate() {
        about
            .iter()
            .for_each(|edge| borders[patch(edge)].push(group));
    }
    let area = |patch: &usize| -> f64 {
        let members = patches.members[*patch].iter();
        members
            .map(|&triangle| mesh.area_of(mesh.triangles[triangle as usize]))
            .sum()
    };
    let mut left: Vec<usize> = groups.iter().map(|about| about.len()).collect();
    let is_wall = |patch: &usize, left: &[usize]| {
        let own = &borders[*patch];
        !own.is_empty()
            && own
                .iter()
                .all(|&group| left[group] > 1 && left[group] % 2 == 1)
    };
    let mut walls: Vec<(f64, usize)> = (0..patches.members.len())
        .filter(|patch| is_wall(patch, &left))
        .map(|patch| (area(&patch), patch))
        .collect();
    walls.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut dropped = vec![false; mesh.triangles.len()];
    for (_, patch) in walls {
        if is_wall(&patch, &left) {
            borders[patch].iter().for_each(|&group| left[group] -= 1);
            for &triangle in &patches.members[patch] {
                dropped[triangle as usize] = true;
            }
        }
    }
    dropped
}

/// Keeps the first of the triangles on the same three vertices, if there are as many on all such sets, all one way
/// round or half of them each way. Returns how often each was there; 1 where nothing is changed.
///
/// A surface and its reverse, as programs for pictures write it, bound nothing, and one that is there twice has twice
/// its volume. Where some triangles alone are repeated, bodies touch or surfaces overlap, and they stay.
pub(in crate::mesh) fn keep_first(triangles: &mut Vec<[u32; 3]>) -> usize {
    let mut sides: HashMap<[u32; 3], [usize; 2]> = HashMap::with_capacity(triangles.len());
    for &triangle in triangles.iter() {
        let (corners, side) = sorted(triangle);
        sides.entry(corners).or_default()[side] += 1;
    }
    let times = triangles.len() / sides.len().max(1);
    let whole = |&[one, other]: &[usize; 2]| {
        one + other == times && (one == other || one == 0 || other == 0)
    };
    let both = |&[one, other]: &[usize; 2]| one > 0 && other > 0;
    let alike = sides.values().all(both) || !sides.values().any(both);
    if times < 2 || !alike || !sides.values().all(whole) {
        return 1;
    }
    triangles.retain(|&triangle| {
        let (corners, _) = sorted(triangle);
        // Each set of corners goes with its first triangle.
        sides.remove(&corners).is_some()
    });
    times
}

/// A triangle's corners by number, and which way round it runs through them.
pub(in crate::mesh) fn sorted(triangle: [u32; 3]) -> ([u32; 3], usize) {
    let mut corners = triangle;
    corners.sort_unstable();
    let next = corners
        .iter()
        .position(|corner| *corner == triangle[0])
        .map_or(0, |first| (first + 1) % 3);
    (corners, usize::from(corners[next] == triangle[1]))
}

/// Sets that are joined step by step; each is known by its least member.
pub(in crate::mesh) struct Sets(Vec<usize>);

impl Sets {
    /// Sets of one member each.
    pub fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    /// The least member of a member's set.
    pub fn root(&mut self, mut member: usize) -> usize {
        while self.0[member] != member {
            self.0[member] = self.0[self.0[member]];
            member = self.0[member];
        }
        member
    }

    /// Makes one set of two.
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }
}
#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    fn kept(triangles: &[[u32; 3]]) -> (usize, Vec<[u32; 3]>) {
        let mut triangles = triangles.to_vec();
        let times = keep_first(&mut triangles);
        (times, triangles)
    }

    fn reversed([a, b, c]: [u32; 3]) -> [u32; 3] {
        [b, a, c]
    }

    #[test]
    fn a_surface_there_several_times_is_kept_once() {
        let again = TETRAHEDRON.map(|[a, b, c]| [c, a, b]);
        let back = TETRAHEDRON.map(reversed);
        for (times, copies) in [
            (2, vec![again]),
            (2, vec![back]),
            (3, vec![again, TETRAHEDRON]),
            (4, vec![back, again, back]),
        ] {
            let mut triangles = TETRAHEDRON.to_vec();
            triangles.extend(copies.concat());
            assert_eq!(kept(&triangles), (times, TETRAHEDRON.to_vec()));
        }
        // Side by side in the file.
        let pairs = TETRAHEDRON.map(|triangle| [triangle, reversed(triangle)]);
        assert_eq!(kept(&pairs.concat()), (2, TETRAHEDRON.to_vec()));
    }

    #[test]
    fn what_is_repeated_in_part_stays() {
        let back = TETRAHEDRON.map(reversed);
        let stays = |triangles: Vec<[u32; 3]>| assert_eq!(kept(&triangles), (1, triangles.clone()));
        stays(TETRAHEDRON.to_vec());
        stays([&TETRAHEDRON[..], &TETRAHEDRON[..1]].concat());
        stays([&TETRAHEDRON[..], &back[..3]].concat());
        // Three there twice, and one both ways: two bodies that share it, say.
        stays([&TETRAHEDRON[..], &TETRAHEDRON[..3], &back[3..]].concat());
        // Once and back twice.
        stays([TETRAHEDRON, back, back].concat());
        stays(Vec::new());
    }
}
