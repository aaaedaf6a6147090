//! Vertices at one place made one vertex, so that triangles share edges.

use std::collections::HashMap;

use super::error::MeshErrorKind;

/// How far apart vertices may be to count as one, as a share of the longest edge of the bounding box. Files repeat a vertex
/// with the same digits, so this needs to take up no more than the rounding of one conversion of units.
pub const WELD_TOLERANCE: f64 = 1e-12;

/// A mesh whose vertices are distinct.
pub struct Welded {
    /// One vertex a place, in order of first appearance; vertices that no triangle uses are gone.
    pub positions: Vec<[f64; 3]>,
    /// Triangles with three different corners, in the order given.
    pub triangles: Vec<[u32; 3]>,
}

/// Lengths below which squared areas are lost.
const SMALLEST_EXTENT: f64 = 1e-60;

/// Merges vertices within [`WELD_TOLERANCE`] and drops triangles that lose a corner by it.
///
/// A vertex joins the earliest one within reach, so the outcome does not depend on anything but the order of the file.
pub fn weld(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Result<Welded, MeshErrorKind> {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for &corner in triangles.iter().flatten() {
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
        return Err(MeshErrorKind::Degenerate {
            triangles: triangles.len(),
        });
    }
    if extent < SMALLEST_EXTENT {
        return Err(MeshErrorKind::Tiny { extent });
    }
    let reach = extent * WELD_TOLERANCE;
    // Cells are twice the reach, so that what is within reach of a vertex lies in its cell or in one that it nearly
    // touches: mostly one look-up a vertex.
    let cell = 2.0 * reach;
    let mut places: HashMap<[i64; 3], Vec<u32>> = HashMap::with_capacity(positions.len() / 2);
    let mut names: Vec<Option<u32>> = vec![None; positions.len()];
    let mut kept: Vec<[f64; 3]> = Vec::new();
    let count = triangles.len();
    let mut welded = Vec::with_capacity(count);
    for triangle in triangles {
        let corners = triangle.map(|corner| {
            let slot = &mut names[corner as usize];
            *slot.get_or_insert_with(|| {
                place(
                    positions[corner as usize],
                    low,
                    cell,
                    reach,
                    &mut places,
                    &mut kept,
                )
            })
        });
        if corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0] {
            welded.push(corners);
        }
    }
    if welded.is_empty() {
        return Err(MeshErrorKind::Degenerate { triangles: count });
    }
    Ok(Welded {
        positions: kept,
        triangles: welded,
    })
}

/// The vertex that stands for a position: the earliest within reach, else a new one.
fn place(
    position: [f64; 3],
    low: [f64; 3],
    cell: f64,
    reach: f64,
    places: &mut HashMap<[i64; 3], Vec<u32>>,
    kept: &mut Vec<[f64; 3]>,
) -> u32 {
    let along =
        |axis: usize, shift: f64| ((position[axis] - low[axis] + shift) / cell).floor() as i64;
    let mut found: Option<u32> = None;
    for x in along(0, -reach)..=along(0, reach) {
        for y in along(1, -reach)..=along(1, reach) {
            for z in along(2, -reach)..=along(2, reach) {
                for &other in places.get(&[x, y, z]).into_iter().flatten() {
                    let near = super::vector::distance(kept[other as usize], position) <= reach;
                    if near && found.is_none_or(|found| other < found) {
                        found = Some(other);
                    }
                }
            }
        }
    }
    found.unwrap_or_else(|| {
        let name = kept.len() as u32;
        kept.push(position);
        places
            .entry([along(0, 0.0), along(1, 0.0), along(2, 0.0)])
            .or_default()
            .push(name);
        name
    })
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
        let apart = [1.0 + 1e-9, 0.0, 0.0];
        let welded = weld(
            vec![a, b, c, [5.0; 3], almost_b, apart, [-0.0; 3]],
            vec![[0, 1, 2], [6, 4, 2], [1, 4, 2], [0, 5, 2]],
        )
        .unwrap();
        assert_eq!(welded.positions, [a, b, c, apart]);
        assert_eq!(welded.triangles, [[0, 1, 2], [0, 1, 2], [0, 3, 2]]);
    }
}
