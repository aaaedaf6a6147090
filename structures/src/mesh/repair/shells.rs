//! Shells: closed surfaces of one body each, where triangles meet at non-manifold edges or are there several times.
//!
//! Clusters of such triangles are cut into [`cells`](super::cells), the cells [labelled](super::labels), and each
//! body gets the triangles on its walls, all facing inward or all facing outward. Of a wall between two bodies each
//! has its own copy. Copies that no body needs are dropped: repeats, and what has nothing of the solid on either
//! side. A cluster that is not closed, or whose sheets cross, stays as it is.

use crate::mesh::repair::cells::Cells;
use crate::mesh::repair::clusters::clusters;
use crate::mesh::repair::distinct::Distinct;
use crate::mesh::repair::edges::{Sets, half_edges, patches};
use crate::mesh::repair::labels::{Cluster, Label, Labelled};
use crate::mesh::triangle_mesh::Mesh;

/// The shells of a mesh, and what was done to find them.
#[derive(Default)]
pub(in crate::mesh) struct Shells {
    /// Shell of each triangle; none for those of patches that need no cells, or have none.
    pub of: Vec<Option<u32>>,
    /// Whether each shell is the one before it, the other way round: a body that is there both ways.
    pub is_reverse: Vec<bool>,
    /// Triangles dropped because they were there before.
    pub repeated: usize,
    /// Triangles dropped because nothing of the solid is on either side of them.
    pub idle: usize,
    /// Triangles turned to agree with the others of their shell.
    pub turned: usize,
    /// Bodies within others, parted from them by walls that face outward.
    pub nested: usize,
    /// Their volume, in the file's unit cubed.
    pub overlap: f64,
}

/// What becomes of a triangle of a cluster.
#[derive(Clone, Copy, PartialEq)]
enum Fate {
    Stays,
    Repeated,
    Idle,
    Wall { shell: u32, turn: bool },
}

/// Finds the shells of a mesh, drops what belongs to none and turns what faces the other way than its shell.
pub(in crate::mesh) fn resolve(mesh: &mut Mesh) -> Shells {
    let distinct = Distinct::new(&mesh.triangles);
    let edges = half_edges(&distinct.corners);
    let patches = patches(distinct.len(), &edges);
    let (cluster, count) = clusters(mesh, &distinct, &edges, &patches);
    let cells = Cells::new(mesh, &distinct.corners, &edges, &patches, &cluster);
    let mut triangles_of = vec![Vec::new(); count];
    let mut names_of = vec![Vec::new(); count];
    for (triangle, name) in (0u32..).zip(&cluster) {
        if let Some(name) = name {
            triangles_of[*name as usize].push(triangle);
        }
    }
    for (name, cell) in (0u32..).zip(&cells.cells) {
        let wall = cell.walls.first().map(|&(triangle, _)| triangle as usize);
        if let Some(cluster) = wall.and_then(|triangle| cluster[triangle]) {
            names_of[cluster as usize].push(name);
        }
    }
    let mut shells = Shells::default();
    let mut fates = vec![Fate::Stays; mesh.triangles.len()];
    for (name, (triangles, names)) in triangles_of.iter().zip(&names_of).enumerate() {
        if cells.unordered.contains(&(name as u32)) {
            continue;
        }
        let cluster = Cluster {
            distinct: &distinct,
            patches: &patches,
            cells: &cells,
            names,
            triangles,
        };
        if let Some(labelled) = cluster.label() {
            shells.take(&cluster, &labelled, &mut fates);
        }
    }
    let dropped = |fate: &Fate| matches!(fate, Fate::Repeated | Fate::Idle);
    // What is left of a mesh that bounds nothing at all stays what it was.
    if fates.iter().all(dropped) {
        return Shells {
            of: vec![None; mesh.triangles.len()],
            ..Shells::default()
        };
    }
    let before = std::mem::take(&mut mesh.triangles);
    for (mut triangle, fate) in before.into_iter().zip(fates) {
        let shell = match fate {
            Fate::Repeated | Fate::Idle => continue,
            Fate::Stays => None,
            Fate::Wall { shell, turn } => {
                if turn {
                    triangle.swap(1, 2);
                }
                Some(shell)
            }
        };
        mesh.triangles.push(triangle);
        shells.of.push(shell);
    }
    shells
}

impl Shells {
    /// Gives each body of a cluster its walls.
    fn take(&mut self, cluster: &Cluster, labelled: &Labelled, fates: &mut [Fate]) {
        let distinct = cluster.distinct;
        let label = |cell: u32| {
            let place = labelled
                .labels
                .binary_search_by_key(&cell, |(cell, _)| *cell);
            place.map_or(Label::Empty, |place| labelled.labels[place].1)
        };
        let copies = |triangle: u32| &distinct.copies[triangle as usize];
        // Bodies that are one, as the wall between them is there once.
        let mut merged = Sets::new(labelled.labels.len());
        let place = |cell: u32| {
            labelled
                .labels
                .binary_search_by_key(&cell, |(cell, _)| *cell)
        };
        let is_single = |triangle: u32| {
            let beside = cluster.cells.beside[triangle as usize];
            let bodies = beside.is_some_and(|cells| cells.map(label).iter().all(Label::is_body));
            labelled.merges && bodies && copies(triangle).len() == 1
        };
        for &triangle in cluster.triangles {
            if let (true, Some([front, behind])) =
                (is_single(triangle), cluster.cells.beside[triangle as usize])
                && let (Ok(front), Ok(behind)) = (place(front), place(behind))
            {
                merged.join(front, behind);
            }
        }
        // The first shell of each body.
        let mut shell_of = std::collections::HashMap::new();
        let mut is_reverse = Vec::new();
        for (place, &(cell, label)) in labelled.labels.iter().enumerate() {
            if let Label::Body { both_ways, .. } = label {
                let root = merged.root(place);
                if root < place {
                    let first = shell_of.get(&labelled.labels[root].0).copied();
                    debug_assert!(first.is_some(), "the first cell of a body comes first");
                    shell_of.insert(cell, first.unwrap_or_default());
                    continue;
                }
                shell_of.insert(cell, (self.is_reverse.len() + is_reverse.len()) as u32);
                is_reverse.push(false);
                if both_ways {
                    is_reverse.push(true);
                }
            }
        }
        // The shells at each triangle, and whether it faces as the first copy for them.
        let needs = |triangle: u32| {
            let mut needs = Vec::new();
            if is_single(triangle) {
                return needs;
            }
            let Some([front, behind]) = cluster.cells.beside[triangle as usize] else {
                return needs;
            };
            for (cell, faces_outward) in [(front, false), (behind, true)] {
                if let Label::Body { inward, both_ways } = label(cell) {
                    let shell = shell_of.get(&cell).copied();
                    debug_assert!(shell.is_some(), "every cell of a body has a shell");
                    let shell = shell.unwrap_or_default();
                    needs.push((shell, faces_outward != inward));
                    if both_ways {
                        needs.push((shell + 1, faces_outward == inward));
                    }
                }
            }
            needs
        };
        let mut triangles = cluster.triangles.iter();
        if triangles.any(|&triangle| needs(triangle).len() > copies(triangle).len()) {
            // A single wall parts one body from another within it: to drop it would be to trust that the two cross
            // nowhere else.
            self.nested += labelled.nested;
            self.overlap += labelled.overlap;
            return;
        }
        self.is_reverse.extend(is_reverse);
        for &triangle in cluster.triangles {
            let mut needs = needs(triangle);
            let left = match needs.is_empty() {
                true => Fate::Idle,
                false => Fate::Repeated,
            };
            // First the copies that face as they should, then others.
            for exact in [true, false] {
                for &(copy, same) in copies(triangle) {
                    let fate = &mut fates[copy as usize];
                    if *fate != Fate::Stays {
                        continue;
                    }
                    let wanted = needs
                        .iter()
                        .position(|&(_, as_first)| !exact || as_first == same);
                    if let Some(wanted) = wanted {
                        let (shell, as_first) = needs.remove(wanted);
                        let turn = as_first != same;
                        self.turned += usize::from(turn);
                        *fate = Fate::Wall { shell, turn };
                    } else if !exact {
                        *fate = left;
                        match left {
                            Fate::Idle => self.idle += 1,
                            _ => self.repeated += 1,
                        }
                    }
                }
            }
        }
    }
}
