//! Edges of triangles, and the patches that hang together across edges of two.

/// An edge as one triangle has it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::mesh) struct HalfEdge {
    pub low: u32,
    pub high: u32,
    pub triangle: u32,
    /// Whether the triangle runs from `low` to `high`.
    pub forward: bool,
}

impl HalfEdge {
    /// Whether both lie between the same two vertices.
    pub fn is_along(&self, other: &Self) -> bool {
        (self.low, self.high) == (other.low, other.high)
    }
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

/// The half edges between each two vertices.
pub(in crate::mesh) fn by_place(edges: &[HalfEdge]) -> impl Iterator<Item = &[HalfEdge]> {
    edges.chunk_by(HalfEdge::is_along)
}

/// Triangles connected across edges that exactly two of them share.
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

/// The patches of `count` triangles with these edges.
pub(in crate::mesh) fn patches(count: usize, edges: &[HalfEdge]) -> Patches {
    // Neighbour across each side of each triangle, and whether both run the side the same way, which is amiss.
    let mut neighbours: Vec<[Option<(u32, bool)>; 3]> = vec![[None; 3]; count];
    let mut degree = vec![0u8; count];
    for group in by_place(edges) {
        let [a, b] = group else { continue };
        for (own, other) in [(a, b), (b, a)] {
            let place = &mut degree[own.triangle as usize];
            neighbours[own.triangle as usize][usize::from(*place)] =
                Some((other.triangle, a.forward == b.forward));
            *place += 1;
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
