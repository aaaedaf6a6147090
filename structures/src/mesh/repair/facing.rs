//! Orientation of surfaces: those that face inward are turned, but for the walls of cavities.
//!
//! A **surface** is a closed part, or all parts whose open or unbalanced edges come near one another. A piece of a
//! surface, such as a face whose seams a file did not close, has no inside. From the outside in, a surface
//! that lies
//!
//! - in no other faces outward; if it is turned, so is all that lies within it;
//! - where the surfaces about it leave the space empty faces outward, too: an island in a cavity;
//! - where they fill it is the wall of a cavity if it faces inward. If it faces outward, it bounds nothing: the
//!   solid is the union of both.
//!
//! A surface is within another if its bounding box is and all points that are looked at are: its outermost vertices
//! and the middles of some of its triangles. A point on the other surface itself says nothing, so that bodies and
//! cavities may touch the walls about them.

use std::collections::HashMap;
use std::sync::OnceLock;

use rayon::prelude::*;

use crate::error::Error;
use crate::mesh::repair::edges::Sets;
use crate::mesh::report::MeshReport;
use crate::mesh::triangle_mesh::{Mesh, centroid, doubled_normal};
use crate::mesh::triangle_tree::TriangleTree;
use crate::mesh::winding::encloses;
use crate::neighbours::box_tree::{LEAF, box_tree};
use crate::neighbours::{Cell, around, cell_of};
use crate::vector::{add, bounds, cross, dot, norm, scale, subtract};

/// Largest distance, about, between the borders of two pieces of one surface, as a share of the mesh's longest side.
const SEAM: f64 = 1e-4;

/// A closed surface of less volume than this times its area to the power 3/2 has no inside.
const FLAT: f64 = 1e-14;

/// A set of triangles that hang together.
pub(in crate::mesh) struct Part {
    /// Its triangles, in rising order.
    pub triangles: Vec<u32>,
    /// Whether each edge is run through as often one way as the other.
    pub is_closed: bool,
    /// The part that this one repeats, one way round or the other.
    pub again: Option<usize>,
    /// The first part that is this one the other way round.
    pub reverse: Option<usize>,
}

struct Surface {
    parts: usize,
    triangles: Vec<u32>,
    /// The same surface the other way round, if it is there both ways.
    reverse: Option<Vec<u32>>,
    is_closed: bool,
    /// Six times its volume about the middle of its bounding box.
    volume: f64,
    area: f64,
    /// Whether a triangle of it has an area.
    has_area: bool,
    low: [f64; 3],
    high: [f64; 3],
    /// Its outermost vertices either way along each axis.
    outermost: Vec<[f64; 3]>,
}

impl Surface {
    fn new(mesh: &Mesh, parts: &[Part], parts_of: &[usize]) -> Self {
        let own = || parts_of.iter().map(|&part| &parts[part]);
        let triangles: Vec<u32> = own().flat_map(|part| &part.triangles).copied().collect();
        let reverse = own().find_map(|part| part.reverse);
        let corners = || {
            triangles
                .iter()
                .map(|&triangle| mesh.corners(mesh.triangles[triangle as usize]))
        };
        let sides = [1.0, -1.0]
            .into_iter()
            .flat_map(|sign| [0, 1, 2].map(|axis| (axis, sign)));
        let farthest = |(axis, sign): (usize, f64)| {
            let along = |point: &[f64; 3]| sign * point[axis];
            let corners = corners().flatten();
            corners.max_by(|a, b| along(a).total_cmp(&along(b)))
        };
        let outermost: Vec<[f64; 3]> = sides.filter_map(farthest).collect();
        let (low, high) = bounds(outermost.iter().copied());
        let middle = scale(add(low, high), 0.5);
        let volume = corners()
            .map(|corners| {
                let [a, b, c] = corners.map(|corner| subtract(corner, middle));
                dot(a, cross(b, c))
            })
            .sum();
        let has_area = triangles
            .iter()
            .any(|&triangle| !mesh.is_sliver(mesh.triangles[triangle as usize]));
        let area = corners()
            .map(|corners| 0.5 * norm(doubled_normal(corners)))
            .sum();
        Self {
            parts: parts_of.len(),
            is_closed: own().all(|part| part.is_closed),
            reverse: reverse.map(|part| parts[part].triangles.clone()),
            triangles,
            volume,
            area,
            has_area,
            low,
            high,
            outermost,
        }
    }

    /// Whether it faces inward as the file has it.
    fn is_inward(&self) -> bool {
        self.volume < 0.0
    }

    /// Whether it is closed and all in one plane, or doubled onto itself.
    fn is_flat(&self) -> bool {
        self.is_closed && self.volume.abs() <= FLAT * self.area.powf(1.5)
    }

    /// Whether another's bounding box lies within this one's.
    fn can_hold(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.low[axis] <= other.low[axis] && other.high[axis] <= self.high[axis])
    }
}

/// Turns surfaces that face inward, unless they are walls of cavities, and counts them in the report.
///
/// `at_border` holds for each triangle whether an edge of it is open or unbalanced. The report's volume falls by the
/// volume that nested surfaces count beyond once. Returns whether each triangle is to be dropped: those of surfaces
/// that are there again, and those of surfaces without thickness outside the solid.
///
/// # Errors
/// Too many surfaces within one another.
pub(in crate::mesh) fn turn_outward(
    mesh: &mut Mesh,
    parts: &[Part],
    at_border: &[bool],
    report: &mut MeshReport,
) -> Result<Vec<bool>, Error> {
    let surfaces: Vec<Surface> = surfaces(mesh, parts, at_border)
        .into_iter()
        .map(|parts_of| Surface::new(mesh, parts, &parts_of))
        .collect();
    let containers = containers(mesh, &surfaces)?;
    let mut order: Vec<usize> = (0..surfaces.len()).collect();
    order.sort_by_key(|&index| containers[index].len());
    let mut repeated: Vec<u32> = Vec::new();
    let mut idle: Vec<u32> = Vec::new();
    // Of a part that is there again the first stays, and the first the other way round.
    for (index, part) in parts.iter().enumerate() {
        if let Some(first) = part.again
            && parts[first].reverse != Some(index)
        {
            repeated.extend(&part.triangles);
        }
    }
    // +1 for surfaces that face outward in the end, -1 inward, 0 for those that bound nothing.
    let mut sides = vec![0i64; surfaces.len()];
    let mut turned = vec![false; surfaces.len()];
    for index in order {
        let surface = &surfaces[index];
        let about = &containers[index];
        let innermost = about
            .iter()
            .copied()
            .max_by_key(|&outer| (containers[outer].len(), std::cmp::Reverse(outer)));
        let within_both_ways = innermost.is_some_and(|outer| surfaces[outer].reverse.is_some());
        let mut turn = innermost.is_some_and(|outer| turned[outer]);
        let filled = about.iter().map(|&outer| sides[outer]).sum::<i64>();
        if surface.is_flat() {
            if filled <= 0 && surface.has_area {
                idle.extend(&surface.triangles);
            }
            continue;
        }
        let mut inward = surface.is_inward() != turn;
        if inward && filled <= 0 {
            inward = false;
            turn = !turn;
        }
        turned[index] = turn;
        match &surface.reverse {
            // Within a body that is there once, both sides are the walls of bodies that touch.
            Some(_) if filled > 0 && !within_both_ways => continue,
            Some(reverse) => {
                repeated.extend(if turn { &surface.triangles } else { reverse });
            }
            None if turn => {
                report.inverted_parts += surface.parts;
                for &triangle in &surface.triangles {
                    mesh.triangles[triangle as usize].swap(1, 2);
                }
            }
            None => {}
        }
        sides[index] = if inward { -1 } else { 1 };
        let closed = surface.is_closed && about.iter().all(|&outer| surfaces[outer].is_closed);
        if closed && filled > i64::from(inward) {
            report.nested_parts += surface.parts;
            report.volume -= surface.volume.abs() / 6.0 * sides[index] as f64;
        }
    }
    // What is left of a mesh that bounds nothing at all stays what it was.
    if idle.len() + repeated.len() == mesh.triangles.len() {
        idle.clear();
    }
    report.repeated_triangles += repeated.len();
    report.idle_triangles += idle.len();
    let mut dropped = vec![false; mesh.triangles.len()];
    for &triangle in repeated.iter().chain(&idle) {
        dropped[triangle as usize] = true;
    }
    Ok(dropped)
}

/// The parts of each surface.
fn surfaces(mesh: &Mesh, parts: &[Part], at_border: &[bool]) -> Vec<Vec<usize>> {
    let edge = SEAM * mesh.extent();
    let mut surfaces = Vec::new();
    // The parts with a border in each cell, and those that hang together.
    let mut borders: HashMap<Cell, usize> = HashMap::new();
    let mut joined = Sets::new(parts.len());
    let mut open = Vec::new();
    for (index, part) in parts.iter().enumerate() {
        if part.again.is_some() {
            continue;
        }
        let is_border = |triangle: &&u32| at_border[**triangle as usize];
        let border: Vec<&u32> = part.triangles.iter().filter(is_border).collect();
        if border.is_empty() {
            surfaces.push(vec![index]);
            continue;
        }
        open.push(index);
        for &triangle in border {
            for corner in mesh.corners(mesh.triangles[triangle as usize]) {
                let place = cell_of(corner, edge);
                let first = *borders.entry(place).or_insert(index);
                joined.join(first, index);
            }
        }
    }
    let mut places: Vec<(Cell, usize)> = borders.iter().map(|(at, part)| (*at, *part)).collect();
    places.sort_unstable();
    for (at, part) in places {
        for near in around(at) {
            if let Some(&other) = borders.get(&near) {
                joined.join(part, other);
            }
        }
    }
    let mut places: HashMap<usize, usize> = HashMap::new();
    for index in open {
        let place = *places.entry(joined.root(index)).or_insert(surfaces.len());
        if place == surfaces.len() {
            surfaces.push(Vec::new());
        }
        surfaces[place].push(index);
    }
    surfaces
}

/// Middles of triangles that are looked at, about, beside the outermost vertices.
const MIDDLES: usize = 8;

/// Most pairs of surfaces of which one may lie within the other, by their boxes: 2,000 shells like an onion's, or any
/// number of parts side by side in one.
const MAX_PAIRS: usize = 2_000_000;

/// The surfaces about each one, in rising order.
///
/// # Errors
/// More than [`MAX_PAIRS`]: each takes a look at two surfaces.
fn containers(mesh: &Mesh, surfaces: &[Surface]) -> Result<Vec<Vec<usize>>, Error> {
    if surfaces.len() < 2 {
        return Ok(vec![Vec::new(); surfaces.len()]);
    }
    // Lowest corners in a tree, each box with the highest corner of all boxes below.
    let mut order: Vec<usize> = (0..surfaces.len()).collect();
    let corner = |&index: &usize| (surfaces[index].low, index);
    let highest = |own: &[usize]| bounds(own.iter().map(|&index| surfaces[index].high)).1;
    let nodes = box_tree(&mut order, LEAF, corner, highest);
    let (mut pairs, mut looked) = (0, 0);
    let mut by_box = Vec::with_capacity(surfaces.len());
    for (index, own) in surfaces.iter().enumerate() {
        let mut about = Vec::new();
        let mut waiting = vec![0];
        while let Some(node) = waiting.pop() {
            let here = &nodes[node];
            looked += 1;
            let is_beyond =
                |axis: usize| here.low[axis] > own.low[axis] || here.known[axis] < own.high[axis];
            if (0..3).any(is_beyond) {
                continue;
            }
            if here.second > 0 {
                waiting.extend([node + 1, here.second]);
                continue;
            }
            let others = order[here.first..here.first + here.count].iter().copied();
            about.extend(others.filter(|&other| other != index && surfaces[other].can_hold(own)));
        }
        about.sort_unstable();
        pairs += about.len();
        if pairs > MAX_PAIRS || looked > 100 * MAX_PAIRS {
            return Err(Error::input(format!(
                "too many of its {} closed surfaces lie within one another to find which of them bound the solid",
                surfaces.len()
            ))
            .help("leave out the inner surfaces, or sample the parts one by one"));
        }
        by_box.push(about);
    }
    let trees: Vec<OnceLock<TriangleTree>> = surfaces.iter().map(|_| OnceLock::new()).collect();
    let containers = by_box
        .into_par_iter()
        .enumerate()
        .map(|(index, mut about)| {
            let own = &surfaces[index];
            about.retain(|&other| {
                let outer = trees[other].get_or_init(|| {
                    let triangles = surfaces[other].triangles.iter();
                    let triangles = triangles.map(|&t| mesh.triangles[t as usize]);
                    TriangleTree::of(mesh.with_area(triangles).collect())
                });
                let earlier = match (own.is_inward(), surfaces[other].is_inward()) {
                    // Of two that coincide, the wall of a cavity is about what fills it.
                    (false, true) => true,
                    (true, false) => false,
                    _ => other < index,
                };
                is_within(mesh, own, outer).unwrap_or(earlier)
            });
            about
        })
        .collect();
    Ok(containers)
}

/// Whether a surface is within another; `None` if it is on it all over.
fn is_within(mesh: &Mesh, inner: &Surface, outer: &TriangleTree) -> Option<bool> {
    let middle = |&triangle: &u32| centroid(mesh.corners(mesh.triangles[triangle as usize]));
    let count = inner.triangles.len();
    let step = count.div_ceil(MIDDLES).max(1);
    let some = inner.triangles.iter().step_by(step).map(middle);
    let mut found = None;
    for point in inner.outermost.iter().copied().chain(some) {
        match encloses(outer, point) {
            Some(false) => return Some(false),
            within => found = found.or(within),
        }
    }
    found.or_else(|| {
        let mut all = inner.triangles.iter().map(middle);
        all.find_map(|point| encloses(outer, point))
    })
}
