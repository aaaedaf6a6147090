//! Which way surfaces face: what faces inward is turned, but for the walls of cavities.
//!
//! A **surface** is a closed part, or all parts whose open or non-manifold edges come near one another: a piece of a surface, such as a face
//! whose seams a file did not close, has no inside of its own.

use std::collections::HashMap;

use super::Mesh;
use super::vector::{add, cross, dot, scale, subtract};
use super::winding::solid_angle;

/// How far apart the borders of two pieces of one surface are at most, about, as a share of the mesh's longest side.
const SEAM: f64 = 1e-4;

/// A surface, measured.
struct Surface {
    parts: usize,
    triangles: Vec<u32>,
    /// Six times its volume about the middle of its bounding box.
    volume: f64,
    low: [f64; 3],
    high: [f64; 3],
    /// Its outermost vertices either way along each axis.
    outermost: Vec<[f64; 3]>,
}

/// Turns surfaces that face inward, unless they lie inside another: that makes them walls of a cavity. If the surface about one is turned, so is
/// it. `at_border` says of each triangle whether an edge of it is open or non-manifold. Returns how many parts were turned.
pub fn turn_outward(mesh: &mut Mesh, parts: &[Vec<u32>], at_border: &[bool]) -> usize {
    let surfaces: Vec<Surface> = surfaces(mesh, parts, at_border)
        .into_iter()
        .map(|parts_of| Surface::new(mesh, parts, &parts_of))
        .collect();
    let inward: Vec<bool> = surfaces.iter().map(|one| one.volume < 0.0).collect();
    if !inward.contains(&true) {
        return 0;
    }
    let about = |index: usize| -> Vec<usize> {
        let others = (0..surfaces.len()).filter(|&other| other != index);
        others
            .filter(|&other| surfaces[other].holds(mesh, &surfaces[index]))
            .collect()
    };
    // The surfaces about each inward one; the outermost decides.
    let within: Vec<Vec<usize>> = (0..surfaces.len())
        .map(|index| {
            if inward[index] {
                about(index)
            } else {
                Vec::new()
            }
        })
        .collect();
    let turned_whole: Vec<usize> = (0..surfaces.len())
        .filter(|&index| inward[index] && within[index].is_empty())
        .collect();
    let turn = |index: usize| match inward[index] {
        // A cavity of a surface that is turned is turned with it, or it would count as solid.
        true => {
            within[index].is_empty()
                || within[index]
                    .iter()
                    .any(|outer| turned_whole.contains(outer))
        }
        // What faces outward inside one that is turned was the wall of a cavity in an inverted file.
        false => turned_whole
            .iter()
            .any(|&outer| surfaces[outer].holds(mesh, &surfaces[index])),
    };
    let turned: Vec<usize> = (0..surfaces.len()).filter(|&index| turn(index)).collect();
    for &index in &turned {
        for &triangle in &surfaces[index].triangles {
            mesh.triangles[triangle as usize].swap(1, 2);
        }
    }
    turned.iter().map(|&index| surfaces[index].parts).sum()
}

/// The parts of each surface.
fn surfaces(mesh: &Mesh, parts: &[Vec<u32>], at_border: &[bool]) -> Vec<Vec<usize>> {
    let cell = SEAM * mesh.extent();
    let mut surfaces = Vec::new();
    // The parts with a border in each cell; `joined` leads from each part to the first of its surface.
    let mut borders: HashMap<[i64; 3], usize> = HashMap::new();
    let mut joined: Vec<usize> = (0..parts.len()).collect();
    let mut open = Vec::new();
    for (index, part) in parts.iter().enumerate() {
        let border: Vec<u32> = part
            .iter()
            .copied()
            .filter(|&triangle| at_border[triangle as usize])
            .collect();
        if border.is_empty() {
            surfaces.push(vec![index]);
            continue;
        }
        open.push(index);
        for triangle in border {
            for corner in mesh.corners(mesh.triangles[triangle as usize]) {
                let place = corner.map(|x| (x / cell).floor() as i64);
                let first = *borders.entry(place).or_insert(index);
                join(&mut joined, first, index);
            }
        }
    }
    let mut places: Vec<([i64; 3], usize)> =
        borders.iter().map(|(at, part)| (*at, *part)).collect();
    places.sort_unstable();
    for (at, part) in places {
        for step in 0..27 {
            let near = std::array::from_fn(|axis| at[axis] + step / 3_i64.pow(axis as u32) % 3 - 1);
            if let Some(&other) = borders.get(&near) {
                join(&mut joined, part, other);
            }
        }
    }
    let mut places: HashMap<usize, usize> = HashMap::new();
    for index in open {
        let place = *places
            .entry(root(&mut joined, index))
            .or_insert(surfaces.len());
        if place == surfaces.len() {
            surfaces.push(Vec::new());
        }
        surfaces[place].push(index);
    }
    surfaces
}

/// The first of the parts that one hangs together with.
fn root(joined: &mut [usize], mut part: usize) -> usize {
    while joined[part] != part {
        joined[part] = joined[joined[part]];
        part = joined[part];
    }
    part
}

fn join(joined: &mut [usize], a: usize, b: usize) {
    let (a, b) = (root(joined, a), root(joined, b));
    joined[a.max(b)] = a.min(b);
}

impl Surface {
    fn new(mesh: &Mesh, parts: &[Vec<u32>], parts_of: &[usize]) -> Self {
        let triangles: Vec<u32> = parts_of
            .iter()
            .flat_map(|&part| parts[part].iter().copied())
            .collect();
        let corners = || {
            triangles
                .iter()
                .map(|&triangle| mesh.corners(mesh.triangles[triangle as usize]))
        };
        let outermost: Vec<[f64; 3]> = (0..6)
            .filter_map(|side: usize| {
                let along = |point: &[f64; 3]| {
                    if side < 3 {
                        point[side]
                    } else {
                        -point[side - 3]
                    }
                };
                corners()
                    .flatten()
                    .max_by(|a, b| along(a).total_cmp(&along(b)))
            })
            .collect();
        let end = |pick: fn(f64, f64) -> f64, start: f64| {
            outermost.iter().fold([start; 3], |end, point| {
                std::array::from_fn(|axis| pick(end[axis], point[axis]))
            })
        };
        let (low, high) = (
            end(f64::min, f64::INFINITY),
            end(f64::max, f64::NEG_INFINITY),
        );
        let middle = scale(add(low, high), 0.5);
        let volume = corners()
            .map(|corners| {
                let [a, b, c] = corners.map(|corner| subtract(corner, middle));
                dot(a, cross(b, c))
            })
            .sum();
        Self {
            parts: parts_of.len(),
            triangles,
            volume,
            low,
            high,
            outermost,
        }
    }

    /// Whether another lies inside, as far as its outermost vertices tell.
    fn holds(&self, mesh: &Mesh, other: &Self) -> bool {
        let in_box = |point: &[f64; 3]| {
            (0..3).all(|axis| self.low[axis] < point[axis] && point[axis] < self.high[axis])
        };
        let encloses = |point: &[f64; 3]| {
            let angles = self
                .triangles
                .iter()
                .map(|&t| solid_angle(mesh.corners(mesh.triangles[t as usize]), *point));
            angles.sum::<f64>().abs() > std::f64::consts::TAU
        };
        other.outermost.iter().all(in_box) && other.outermost.iter().all(encloses)
    }
}
