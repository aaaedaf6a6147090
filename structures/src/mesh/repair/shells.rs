//! Shells: closed surfaces of one body each, where triangles meet at non-manifold edges or are there several times.
//!
//! Clusters of such triangles are cut into [`cells`](super::cells), the cells [labelled](super::labels), and each
//! body gets the triangles on its walls, all facing inward or all facing outward. Of a wall between two bodies each
//! has its own copy. Copies that no body needs are dropped: repeats, and what has nothing of the solid on either
//! side. A cluster that is not closed, or whose sheets cross, stays as it is.

use std::collections::HashMap;

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

/// The bodies of a cluster, and the shells that they get.
struct Bodies<'a> {
    cluster: &'a Cluster<'a>,
    labelled: &'a Labelled,
    /// The first shell of each body, by its cells.
    shell_of: HashMap<u32, u32>,
    /// [`Shells::is_reverse`] of these shells.
    is_reverse: Vec<bool>,
}

impl<'a> Bodies<'a> {
    /// Numbers the shells of the bodies, from `first` on.
    fn new(cluster: &'a Cluster<'a>, labelled: &'a Labelled, first: usize) -> Self {
        let mut bodies = Self {
            cluster,
            labelled,
            shell_of: HashMap::new(),
            is_reverse: Vec::new(),
        };
        let mut merged = bodies.merged();
        for (place, &(cell, label)) in labelled.labels.iter().enumerate() {
            if let Label::Body { both_ways, .. } = label {
                let root = merged.root(place);
                let shell = if root < place {
                    let first = bodies.shell_of.get(&labelled.labels[root].0).copied();
                    debug_assert!(first.is_some(), "the first cell of a body comes first");
                    first.unwrap_or_default()
                } else {
                    let shell = (first + bodies.is_reverse.len()) as u32;
                    bodies.is_reverse.push(false);
                    if both_ways {
                        bodies.is_reverse.push(true);
                    }
                    shell
                };
                bodies.shell_of.insert(cell, shell);
            }
        }
        bodies
    }

    /// Bodies that are one, as the wall between them is there once.
    fn merged(&self) -> Sets {
        let mut merged = Sets::new(self.labelled.labels.len());
        for &triangle in self.cluster.triangles {
            if let (true, Some([front, behind])) = (self.is_single(triangle), self.beside(triangle))
                && let (Some(front), Some(behind)) = (self.place(front), self.place(behind))
            {
                merged.join(front, behind);
            }
        }
        merged
    }

    /// Place of a cell among the labels.
    fn place(&self, cell: u32) -> Option<usize> {
        let labels = &self.labelled.labels;
        labels.binary_search_by_key(&cell, |(cell, _)| *cell).ok()
    }

    fn label(&self, cell: u32) -> Label {
        self.place(cell)
            .map_or(Label::Empty, |place| self.labelled.labels[place].1)
    }

    /// The cells in front of a triangle and behind it.
    fn beside(&self, triangle: u32) -> Option<[u32; 2]> {
        self.cluster.cells.beside[triangle as usize]
    }

    fn copies(&self, triangle: u32) -> &'a [(u32, bool)] {
        &self.cluster.distinct.copies[triangle as usize]
    }

    /// Whether a triangle is the only copy of a wall between two bodies that merge.
    fn is_single(&self, triangle: u32) -> bool {
        let are_bodies = |cells: [u32; 2]| cells.iter().all(|&cell| self.label(cell).is_body());
        self.labelled.merges
            && self.beside(triangle).is_some_and(are_bodies)
            && self.copies(triangle).len() == 1
    }

    /// The shells at a triangle, and whether it faces as the first copy for them.
    fn needs(&self, triangle: u32) -> Vec<(u32, bool)> {
        let mut needs = Vec::new();
        if self.is_single(triangle) {
            return needs;
        }
        let Some([front, behind]) = self.beside(triangle) else {
            return needs;
        };
        for (cell, faces_outward) in [(front, false), (behind, true)] {
            if let Label::Body { inward, both_ways } = self.label(cell) {
                let shell = self.shell_of.get(&cell).copied();
                debug_assert!(shell.is_some(), "every cell of a body has a shell");
                let shell = shell.unwrap_or_default();
                needs.push((shell, faces_outward != inward));
                if both_ways {
                    needs.push((shell + 1, faces_outward == inward));
                }
            }
        }
        needs
    }
}

impl Shells {
    /// Gives each body of a cluster its walls.
    fn take(&mut self, cluster: &Cluster, labelled: &Labelled, fates: &mut [Fate]) {
        let bodies = Bodies::new(cluster, labelled, self.is_reverse.len());
        let mut triangles = cluster.triangles.iter();
        if triangles.any(|&triangle| bodies.needs(triangle).len() > bodies.copies(triangle).len()) {
            // A single wall parts one body from another within it: to drop it would be to trust that the two cross
            // nowhere else.
            self.nested += labelled.nested;
            self.overlap += labelled.overlap;
            return;
        }
        for &triangle in cluster.triangles {
            self.assign(bodies.copies(triangle), bodies.needs(triangle), fates);
        }
        self.is_reverse.extend(bodies.is_reverse);
    }

    /// Gives the copies of a triangle to the shells that need one.
    fn assign(&mut self, copies: &[(u32, bool)], mut needs: Vec<(u32, bool)>, fates: &mut [Fate]) {
        let left = match needs.is_empty() {
            true => Fate::Idle,
            false => Fate::Repeated,
        };
        // First the copies that face as they should, then others.
        for exact in [true, false] {
            for &(copy, same) in copies {
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
