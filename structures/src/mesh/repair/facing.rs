//! Orientation of surfaces: what faces inward is turned, but for the walls of cavities.
//!
//! A **surface** is a closed part, or all parts whose open or unbalanced edges come near one another. A piece of a
//! surface, such as a face whose seams a file did not close, has no inside of its own. From the outside in, a surface
//! that lies
//!
//! - in no other faces outward; if it is turned, so is all that lies within it;
//! - where the surfaces about it leave the space empty faces outward, too: an island in a cavity;
//! - where they fill it is the wall of a cavity if it faces inward. If it faces outward, it bounds nothing: the
//!   solid is the union of both.

use std::collections::HashMap;

use crate::mesh::error::MeshErrorKind;
use crate::mesh::repair::bounded_surface::{Part, Surface};
use crate::mesh::repair::edges::Sets;
use crate::mesh::repair::nesting::containers;
use crate::mesh::triangle_mesh::Mesh;
use crate::neighbours::cell::{Cell, around, cell_of};

/// Largest distance, about, between the borders of two pieces of one surface, as a share of the mesh's longest side.
const SEAM: f64 = 1e-4;

/// What was found of the surfaces, and done to them.
#[derive(Default)]
pub(in crate::mesh) struct Facing {
    /// Parts that faced inward and were turned.
    pub turned: usize,
    /// Parts that lie within others and face outward, so that they bound nothing.
    pub nested: usize,
    /// Volume that the divergence theorem counts of these beyond once, in the file's unit cubed.
    pub overlap: f64,
    /// Triangles to drop: those of a surface that is there the other way round, too.
    pub repeated: Vec<u32>,
    /// Triangles to drop: those of surfaces without a thickness, outside the solid.
    pub idle: Vec<u32>,
}

/// Turns surfaces that face inward, unless they are walls of cavities. `at_border` says of each triangle whether an
/// edge of it is open or unbalanced.
///
/// # Errors
/// Those of [`containers`].
pub(in crate::mesh) fn turn_outward(
    mesh: &mut Mesh,
    parts: &[Part],
    at_border: &[bool],
) -> Result<Facing, MeshErrorKind> {
    let surfaces: Vec<Surface> = surfaces(mesh, parts, at_border)
        .into_iter()
        .map(|parts_of| Surface::new(mesh, parts, &parts_of))
        .collect();
    let containers = containers(mesh, &surfaces)?;
    let mut order: Vec<usize> = (0..surfaces.len()).collect();
    order.sort_by_key(|&index| containers[index].len());
    let mut facing = Facing::default();
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
                facing.idle.extend(&surface.triangles);
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
                facing
                    .repeated
                    .extend(if turn { &surface.triangles } else { reverse });
            }
            None if turn => {
                facing.turned += surface.parts;
                for &triangle in &surface.triangles {
                    mesh.triangles[triangle as usize].swap(1, 2);
                }
            }
            None => {}
        }
        sides[index] = if inward { -1 } else { 1 };
        let closed = surface.is_closed && about.iter().all(|&outer| surfaces[outer].is_closed);
        if closed && filled > i64::from(inward) {
            facing.nested += surface.parts;
            facing.overlap += surface.volume.abs() / 6.0 * sides[index] as f64;
        }
    }
    // What is left of a mesh that bounds nothing at all stays what it was.
    if facing.idle.len() + facing.repeated.len() == mesh.triangles.len() {
        facing.idle.clear();
    }
    Ok(facing)
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
        if part.is_reverse {
            continue;
        }
        let border: Vec<u32> = part
            .triangles
            .iter()
            .copied()
            .filter(|&triangle| at_border[triangle as usize])
            .collect();
        if border.is_empty() {
            let reverse = parts.get(index + 1).is_some_and(|next| next.is_reverse);
            surfaces.push((index..=index + usize::from(reverse)).collect());
            continue;
        }
        open.push(index);
        for triangle in border {
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
