//! Cells: the regions into which triangles that meet at non-manifold edges cut the space about them.
//!
//! Each triangle has two sides. About an edge, the side of one triangle faces that of the next one round, and both
//! are walls of one cell. Source: Zhou, Grinspun, Zorin and Jacobson, ACM Transactions on Graphics 35:4, 2016,
//! article 39, section 3.2. Where the sheets do not cross elsewhere, a cell is a closed surface that faces outward,
//! and one cell, the one outside, has a volume below zero.

use std::collections::HashMap;

use crate::mesh::repair::edges::{HalfEdge, Patches, Sets, by_place};
use crate::mesh::triangle_mesh::{Mesh, doubled_normal};
use crate::mesh::vector::{cross, dot, norm, scale, subtract};

/// A region, known by its walls.
pub(in crate::mesh) struct Cell {
    /// Volume, in the file's unit cubed.
    pub volume: f64,
    /// Area of its walls.
    pub area: f64,
    /// Its walls: the triangle, and whether the cell lies on the side that the triangle faces.
    pub walls: Vec<(u32, bool)>,
}

/// A cell of less than this times its area to the power 3/2 is the gap between two walls that coincide.
const FLAT: f64 = 1e-12;

impl Cell {
    /// Whether the walls coincide, so that the cell has no volume to speak of.
    pub fn is_flat(&self) -> bool {
        self.volume.abs() <= FLAT * self.area.powf(1.5)
    }
}

/// Sheets closer than this about an edge, in radians, are taken in one order along all edges that their patches
/// share.
const NEAR: f64 = 0.05;

/// The cells of clusters of triangles.
pub(in crate::mesh) struct Cells {
    /// All of them.
    pub cells: Vec<Cell>,
    /// Cell in front of and behind each triangle; none for triangles that are in no cluster.
    pub beside: Vec<Option<[u32; 2]>>,
    /// Clusters with an edge about which the order of the sheets is not known.
    pub unordered: Vec<u32>,
}

/// The triangles about an edge and the angles at which they stand, anticlockwise seen against the edge's direction
/// from low to high.
struct Fan {
    edges: Vec<HalfEdge>,
    angles: Vec<f64>,
}

impl Fan {
    /// None where a triangle without area has no angle.
    fn new(mesh: &Mesh, triangles: &[[u32; 3]], edges: Vec<HalfEdge>) -> Option<Self> {
        let at = |corner: u32| mesh.positions[corner as usize];
        let (low, high) = (edges.first()?.low, edges.first()?.high);
        let along = subtract(at(high), at(low));
        let along = scale(along, 1.0 / norm(along));
        let mut axes: Option<([f64; 3], [f64; 3])> = None;
        let mut angles = Vec::with_capacity(edges.len());
        for edge in &edges {
            let corners = triangles[edge.triangle as usize];
            if mesh.is_sliver(corners) {
                return None;
            }
            let tip = corners.into_iter().find(|c| *c != low && *c != high)?;
            let arm = subtract(at(tip), at(low));
            let (first, second) = *axes.get_or_insert_with(|| {
                let across = subtract(arm, scale(along, dot(arm, along)));
                let across = scale(across, 1.0 / norm(across));
                (across, cross(along, across))
            });
            angles.push(dot(arm, second).atan2(dot(arm, first)));
        }
        Some(Self { edges, angles })
    }

    /// The triangles in turn, where `order` says how far the second of two near ones stands from the first.
    fn in_turn(&self, order: impl Fn(&HalfEdge, &HalfEdge) -> f64) -> Vec<HalfEdge> {
        let mut places: Vec<usize> = (0..self.edges.len()).collect();
        places.sort_by(|&a, &b| self.angles[a].total_cmp(&self.angles[b]));
        // The widest gap is where the turn begins, so that sheets which coincide are not parted.
        let count = places.len();
        let gap = |place: usize| {
            let (from, to) = (
                self.angles[places[place]],
                self.angles[places[(place + 1) % count]],
            );
            (to - from).rem_euclid(std::f64::consts::TAU)
        };
        let widest = (0..count).max_by(|&a, &b| gap(a).total_cmp(&gap(b)));
        places.rotate_left(widest.map_or(0, |widest| (widest + 1) % count));
        for _ in 0..count {
            let mut changed = false;
            for place in 1..count {
                let (a, b) = (places[place - 1], places[place]);
                let angle = (self.angles[b] - self.angles[a]).rem_euclid(std::f64::consts::TAU);
                let near = !(NEAR..=std::f64::consts::TAU - NEAR).contains(&angle);
                if near && order(&self.edges[a], &self.edges[b]) < 0.0 {
                    places.swap(place - 1, place);
                    changed = true;
                }
            }
            if !changed {
                break;
            }
        }
        places.into_iter().map(|place| self.edges[place]).collect()
    }
}

/// Distance of the second of two patches that run close beside each other from the first, seen along the first's own
/// direction.
struct Beside<'a> {
    patches: &'a Patches,
    sums: HashMap<(u32, u32), f64>,
}

impl Beside<'_> {
    /// +1 where the edge runs in the direction of its patch, else -1.
    fn direction(&self, edge: &HalfEdge) -> f64 {
        if edge.forward != self.patches.turned[edge.triangle as usize] {
            1.0
        } else {
            -1.0
        }
    }

    fn patch(&self, edge: &HalfEdge) -> u32 {
        self.patches.of[edge.triangle as usize]
    }

    fn add(&mut self, fan: &Fan) {
        for (i, a) in fan.edges.iter().enumerate() {
            for (j, b) in fan.edges.iter().enumerate() {
                let (p, q) = (self.patch(a), self.patch(b));
                let angle = fan.angles[j] - fan.angles[i];
                let angle = angle - (angle / std::f64::consts::TAU).round() * std::f64::consts::TAU;
                if p < q && angle.abs() < NEAR {
                    *self.sums.entry((p, q)).or_default() += angle * self.direction(a);
                }
            }
        }
    }

    /// Below zero if `b` comes before `a` about an edge that both share.
    fn order(&self, a: &HalfEdge, b: &HalfEdge) -> f64 {
        let (p, q) = (self.patch(a), self.patch(b));
        let sum = |p, q| match self.sums.get(&(p, q)) {
            Some(sum) if *sum != 0.0 => sum.signum(),
            // Sheets that coincide all along have any order, but one.
            _ => 1.0,
        };
        match p.cmp(&q) {
            std::cmp::Ordering::Less => sum(p, q) * self.direction(a),
            std::cmp::Ordering::Greater => -sum(q, p) * self.direction(b),
            std::cmp::Ordering::Equal => 0.0,
        }
    }
}

impl Cells {
    /// The cells of the triangles that have a cluster.
    pub fn new(
        mesh: &Mesh,
        triangles: &[[u32; 3]],
        edges: &[HalfEdge],
        patches: &Patches,
        cluster: &[Option<u32>],
    ) -> Self {
        let in_cluster = |edge: &HalfEdge| cluster[edge.triangle as usize].is_some();
        let mut beside = Beside {
            patches,
            sums: HashMap::new(),
        };
        let mut unordered = Vec::new();
        let mut sides = Sets::new(2 * triangles.len());
        let mut join_round = |edges: &[HalfEdge]| {
            for (place, edge) in edges.iter().enumerate() {
                let next = &edges[(place + 1) % edges.len()];
                // The front of a triangle that runs along the edge's direction faces on, anticlockwise.
                let on = 2 * edge.triangle as usize + usize::from(!edge.forward);
                let back = 2 * next.triangle as usize + usize::from(next.forward);
                sides.join(on, back);
            }
        };
        let mut fans = Vec::new();
        for group in by_place(edges) {
            let own: Vec<HalfEdge> = group.iter().copied().filter(in_cluster).collect();
            if own.len() < 3 {
                join_round(&own);
                continue;
            }
            let name = cluster[own[0].triangle as usize];
            match Fan::new(mesh, triangles, own) {
                Some(fan) => {
                    beside.add(&fan);
                    fans.push(fan);
                }
                None => unordered.extend(name),
            }
        }
        for fan in &fans {
            join_round(&fan.in_turn(|a, b| beside.order(a, b)));
        }
        let (low, high) = mesh.bounds();
        let middle: [f64; 3] = std::array::from_fn(|axis| 0.5 * low[axis] + 0.5 * high[axis]);
        let mut found = Self {
            cells: Vec::new(),
            beside: vec![None; triangles.len()],
            unordered,
        };
        let mut names: HashMap<usize, u32> = HashMap::new();
        for (triangle, &corners) in triangles.iter().enumerate() {
            if cluster[triangle].is_none() {
                continue;
            }
            let places = mesh.corners(corners);
            let [a, b, c] = places.map(|corner| subtract(corner, middle));
            let volume = dot(a, cross(b, c)) / 6.0;
            let area = 0.5 * norm(doubled_normal(places));
            let pair = [true, false].map(|in_front| {
                let root = sides.root(2 * triangle + usize::from(!in_front));
                let name = *names.entry(root).or_insert_with(|| {
                    found.cells.push(Cell {
                        volume: 0.0,
                        area: 0.0,
                        walls: Vec::new(),
                    });
                    found.cells.len() as u32 - 1
                });
                let cell = &mut found.cells[name as usize];
                cell.volume += if in_front { -volume } else { volume };
                cell.area += area;
                cell.walls.push((triangle as u32, in_front));
                name
            });
            found.beside[triangle] = Some(pair);
        }
        found
    }
}
