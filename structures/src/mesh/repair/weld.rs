//! Vertices at one place made one vertex, so that triangles share edges.
//!
//! 1. Vertices within [`WELD_TOLERANCE`] become one: copies with the same digits.
//! 2. Seams that are left open are joined within the rounding of the file's numbers: [`seams`] and [`rounding`] have
//!    the rules.
//! 3. Only then are polygons cut into triangles, so that a vertex on both sides of a bridge between a rim and a hole is
//!    one.

use crate::mesh::error::MeshErrorKind;
use crate::mesh::repair::faces::Faces;
use crate::mesh::repair::rounding::Digits;
use crate::mesh::repair::{polygon, rounding, seams};
use crate::neighbours::SpatialHash;

/// Largest distance of vertices that count as one, as a share of the longest edge of the bounding box. Files repeat a
/// vertex with the same digits, so this needs to take up no more than the rounding of one conversion of units.
pub const WELD_TOLERANCE: f64 = 1e-12;

/// A mesh whose vertices are distinct.
pub struct Welded {
    /// One vertex a place, in order of first appearance; vertices that no triangle uses are gone.
    pub positions: Vec<[f64; 3]>,
    /// Triangles with three different corners, in the order given.
    pub triangles: Vec<[u32; 3]>,
    /// Vertices joined with others across seams, within the rounding.
    pub seam_vertices: usize,
    /// Largest distance of these along an axis, in the file's unit.
    pub reach: f64,
}

/// Lengths below which squared areas are lost.
const SMALLEST_EXTENT: f64 = 1e-60;

/// Stands for a vertex that has no name yet.
const NONE: u32 = u32::MAX;

/// Merges vertices, cuts faces into triangles and drops those that have lost a corner.
///
/// A vertex joins the earliest one within reach, so the outcome does not depend on anything but the order of the file.
pub fn weld(
    positions: Vec<[f64; 3]>,
    mut faces: Faces,
    digits: &Digits,
) -> Result<Welded, MeshErrorKind> {
    let count = faces.triangle_count();
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for &corner in faces.corners() {
        let position = positions[corner as usize];
        for axis in 0..3 {
            low[axis] = low[axis].min(position[axis]);
            high[axis] = high[axis].max(position[axis]);
        }
    }
    let extent = (0..3)
        .map(|axis| high[axis] - low[axis])
        .fold(0.0, f64::max);
    if extent == 0.0 {
        return Err(MeshErrorKind::Degenerate { triangles: count });
    }
    if extent < SMALLEST_EXTENT {
        return Err(MeshErrorKind::Tiny { extent });
    }
    let mut places = Places::new(low, extent * WELD_TOLERANCE, positions.len());
    let mut names = vec![NONE; positions.len()];
    for corner in faces.corners_mut() {
        let name = &mut names[*corner as usize];
        if *name == NONE {
            *name = places.name(positions[*corner as usize]);
        }
        *corner = *name;
    }
    drop((positions, names));
    let kept = places.into_kept();

    let reach = rounding::reach(&kept, digits, extent);
    let mut seam_vertices = 0;
    if reach > extent * WELD_TOLERANCE
        && let Some(names) = seams::join(&kept, &faces, reach)
    {
        seam_vertices = (0..)
            .zip(&names)
            .filter(|&(own, &name)| own != name)
            .count();
        for corner in faces.corners_mut() {
            *corner = names[*corner as usize];
        }
    }

    let mut triangles = Vec::with_capacity(count);
    for face in faces.iter() {
        polygon::triangulate(&kept, face, &mut triangles);
    }
    drop(faces);
    let positions = number_by_appearance(kept, &mut triangles);
    triangles.retain(|&[a, b, c]| a != b && b != c && c != a);
    if triangles.is_empty() {
        return Err(MeshErrorKind::Degenerate { triangles: count });
    }
    Ok(Welded {
        positions,
        triangles,
        seam_vertices,
        reach: if seam_vertices > 0 { reach } else { 0.0 },
    })
}

/// Numbers vertices in the order in which triangles name them, and leaves out the others.
fn number_by_appearance(kept: Vec<[f64; 3]>, triangles: &mut [[u32; 3]]) -> Vec<[f64; 3]> {
    let mut names = vec![NONE; kept.len()];
    let mut positions = Vec::with_capacity(kept.len());
    for corner in triangles.iter_mut().flatten() {
        let name = &mut names[*corner as usize];
        if *name == NONE {
            *name = positions.len() as u32;
            positions.push(kept[*corner as usize]);
        }
        *corner = *name;
    }
    positions
}

/// Vertices by their place.
struct Places {
    reach: f64,
    /// Cells are twice the reach, so that what is within reach of a vertex lies in its cell or in one that it nearly
    /// touches: mostly one look-up a vertex.
    cells: SpatialHash<u32>,
    kept: Vec<[f64; 3]>,
}

impl Places {
    fn new(low: [f64; 3], reach: f64, vertices: usize) -> Self {
        Self {
            reach,
            cells: SpatialHash::with_origin(low, 2.0 * reach, vertices / 2),
            kept: Vec::new(),
        }
    }

    /// The vertex that stands for a position: the earliest within reach, else a new one.
    fn name(&mut self, position: [f64; 3]) -> u32 {
        let within = |other: &&u32| {
            crate::mesh::vector::distance(self.kept[**other as usize], position) <= self.reach
        };
        let earliest = self
            .cells
            .touching(position, self.reach)
            .filter(within)
            .min();
        if let Some(&earliest) = earliest {
            return earliest;
        }
        let name = self.kept.len() as u32;
        self.kept.push(position);
        self.cells.push(position, name);
        name
    }

    /// One position for each name.
    fn into_kept(self) -> Vec<[f64; 3]> {
        self.kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_at_one_place_become_one_and_triangles_without_three_corners_go() {
        let a = [0.0, 0.0, 0.0];
        let b = [1.0, 0.0, 0.0];
        let c = [0.0, 1.0, 0.0];
        let almost_b = [1.0 + 0.5e-12, -0.0, 0.2e-12];
        let beyond = [1.0 + 1e-9, 0.0, 0.0];
        let mut faces = Faces::default();
        for triangle in [[0, 1, 2], [6, 4, 2], [1, 4, 2], [0, 5, 2]] {
            faces.push(&triangle);
        }
        let positions = vec![a, b, c, [5.0; 3], almost_b, beyond, [-0.0; 3]];
        let welded = weld(positions, faces, &Digits::default()).unwrap();
        assert_eq!(welded.positions, [a, b, c, beyond]);
        assert_eq!(welded.triangles, [[0, 1, 2], [0, 1, 2], [0, 3, 2]]);
        assert_eq!(welded.seam_vertices, 0);
    }
}
