//! Vertices at one place made one vertex, so that triangles share edges.
//!
//! 1. Vertices within [`WELD_TOLERANCE`] become one: copies with the same digits.
//! 2. Seams that are left open are joined within the rounding of the file's numbers ([`rounding`]). Programs that mesh
//!    each face of a body by itself, or that move a part after meshing it, round the two copies of a vertex
//!    differently. Only ends of open edges (of one face alone) are joined, so a closed mesh stays as it is, however
//!    thin.
//! 3. Only then are polygons cut into triangles, so that a vertex on both sides of a bridge between a rim and a hole is
//!    one.

use crate::error::Error;
use crate::mesh::read::soup::Faces;
use crate::mesh::repair::rounding::Digits;
use crate::mesh::repair::{polygon, rounding};
use crate::mesh::report::MeshReport;
use crate::mesh::triangle_mesh::Mesh;
use crate::neighbours::SpatialHash;
use crate::vector::{bounds, distance, extent};

/// Largest distance of vertices that count as one, as a share of the longest edge of the bounding box. Files repeat a
/// vertex with the same digits, so this needs to take up no more than the rounding of one conversion of units.
const WELD_TOLERANCE: f64 = 1e-12;

/// Lengths below which squared areas are lost.
const SMALLEST_EXTENT: f64 = 1e-60;

/// Stands for a vertex that has no name yet.
const NONE: u32 = u32::MAX;

/// Merges vertices, cuts faces into triangles and drops those that have lost a corner.
///
/// Vertices come in order of first appearance and triangles in the order given. A vertex joins the earliest one within
/// reach, so the outcome depends on nothing but the order of the file.
pub fn weld(
    positions: Vec<[f64; 3]>,
    mut faces: Faces,
    digits: &Digits,
    report: &mut MeshReport,
) -> Result<Mesh, Error> {
    let count = faces.triangle_count();
    let corners = faces.corners.iter();
    let (low, high) = bounds(corners.map(|&corner| positions[corner as usize]));
    let extent = extent((low, high));
    if extent == 0.0 {
        return Err(degenerate(count));
    }
    if extent < SMALLEST_EXTENT {
        return Err(Error::input(format!(
            "the mesh is {extent:e} across; lengths below 1e-60 are not distinguished from zero"
        ))
        .help("export the mesh in a smaller unit of length"));
    }
    let reach = extent * WELD_TOLERANCE;
    let mut places = Places {
        reach,
        cells: SpatialHash::with_origin(low, 2.0 * reach, positions.len() / 2),
        kept: Vec::new(),
    };
    let mut names = vec![NONE; positions.len()];
    for corner in &mut faces.corners {
        let name = &mut names[*corner as usize];
        if *name == NONE {
            *name = places.name(positions[*corner as usize]);
        }
        *corner = *name;
    }
    drop((positions, names));
    let kept = places.kept;

    let reach = rounding::reach(&kept, digits, extent);
    if reach > extent * WELD_TOLERANCE
        && let Some(names) = join_seams(&kept, &faces, reach)
    {
        let joined = (0..).zip(&names).filter(|&(own, &name)| own != name);
        (report.seam_vertices, report.weld_reach) = (joined.count(), reach);
        for corner in &mut faces.corners {
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
        return Err(degenerate(count));
    }
    report.degenerate_triangles = count - triangles.len();
    Ok(Mesh {
        positions,
        triangles,
        closed: false,
    })
}

/// The refusal of a mesh of `triangles` of which none has an area.
pub fn degenerate(triangles: usize) -> Error {
    Error::input(format!(
        "all {triangles} triangles are degenerate: none has an area"
    ))
    .help("check the unit of the export: too few digits may have merged the vertices")
}

/// Which vertex each becomes: an end of an open edge the earliest one within `reach` along each axis. None if nothing
/// is joined.
///
/// A face no wider than the reach would vanish, so its corners stay: the surface there is finer than its numbers.
fn join_seams(positions: &[[f64; 3]], faces: &Faces, reach: f64) -> Option<Vec<u32>> {
    let mut sides: Vec<[u32; 2]> = Vec::with_capacity(faces.corners.len());
    for face in faces.iter() {
        let next = face.iter().cycle().skip(1);
        let ends = face.iter().zip(next).filter(|(from, to)| from != to);
        sides.extend(ends.map(|(&from, &to)| [from.min(to), from.max(to)]));
    }
    sides.sort_unstable();
    let mut is_open = vec![false; positions.len()];
    for group in sides.chunk_by(|a, b| a == b) {
        if let [ends] = group {
            ends.iter().for_each(|&end| is_open[end as usize] = true);
        }
    }
    let are_near = |a: u32, b: u32| {
        let (a, b) = (positions[a as usize], positions[b as usize]);
        (0..3).all(|axis| (a[axis] - b[axis]).abs() <= reach)
    };
    for face in faces.iter() {
        let mut others = face.iter().enumerate();
        if others.all(|(place, &a)| face[..place].iter().all(|&b| are_near(a, b))) {
            face.iter().for_each(|&end| is_open[end as usize] = false);
        }
    }
    let open = || {
        (0u32..)
            .zip(&is_open)
            .filter_map(|(vertex, &is_open)| is_open.then_some(vertex))
    };
    let (low, _) = bounds(open().map(|vertex| positions[vertex as usize]));
    // Cells are twice the reach, so that mostly one is looked at.
    let mut cells = SpatialHash::with_origin(low, 2.0 * reach, 0);
    let mut names: Vec<u32> = (0..positions.len() as u32).collect();
    let mut any = false;
    for vertex in open() {
        let position = positions[vertex as usize];
        let near = cells.touching(position, reach).copied();
        match near.filter(|&earlier| are_near(earlier, vertex)).min() {
            Some(earliest) => {
                names[vertex as usize] = earliest;
                any = true;
            }
            None => cells.push(position, vertex),
        }
    }
    any.then_some(names)
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

struct Places {
    reach: f64,
    /// Cells are twice the reach, so that mostly one is looked at for each vertex.
    cells: SpatialHash<u32>,
    kept: Vec<[f64; 3]>,
}

impl Places {
    /// The vertex that stands for a position: the earliest within reach, else a new one.
    fn name(&mut self, position: [f64; 3]) -> u32 {
        let near = self.cells.touching(position, self.reach);
        let within = |&&other: &&u32| distance(self.kept[other as usize], position) <= self.reach;
        if let Some(&earliest) = near.filter(within).min() {
            return earliest;
        }
        let name = self.kept.len() as u32;
        self.kept.push(position);
        self.cells.push(position, name);
        name
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
        let mut report = MeshReport::default();
        let welded = weld(positions, faces, &Digits::default(), &mut report).unwrap();
        assert_eq!(welded.positions, [a, b, c, beyond]);
        assert_eq!(welded.triangles, [[0, 1, 2], [0, 1, 2], [0, 3, 2]]);
        assert_eq!((report.seam_vertices, report.degenerate_triangles), (0, 1));
    }

    fn joined(positions: &[[f64; 3]], faces: &[&[u32]], reach: f64) -> Option<Vec<u32>> {
        let mut all = Faces::default();
        for face in faces {
            all.push(face);
        }
        join_seams(positions, &all, reach)
    }

    /// Two triangles with an edge in common but for a unit; the second is the same turned over.
    #[test]
    fn edges_within_reach_become_one_whichever_way_they_run() {
        let positions = [
            [0., 0., 0.],
            [10., 0., 0.],
            [0., 10., 0.],
            [10., 1., 0.],
            [0., 10., 1.],
            [9., 9., 0.],
        ];
        for second in [[3, 5, 4], [4, 5, 3]] {
            let names = joined(&positions, &[&[0, 1, 2], &second], 1.0);
            assert_eq!(names, Some(vec![0, 1, 2, 1, 2, 5]));
        }
        assert_eq!(joined(&positions, &[&[0, 1, 2], &[3, 5, 4]], 0.9), None);
    }

    /// Strips whose edges are one unit from each other: pairs become one, the whole row does not.
    #[test]
    fn no_chain_leads_beyond_the_reach() {
        let mut positions = Vec::new();
        let mut faces = Vec::new();
        for row in 0..40u32 {
            let x = f64::from(row);
            positions.extend([[x, 0., 0.], [x, 99., 0.], [x, 50., 90.]]);
            faces.push([3 * row, 3 * row + 1, 3 * row + 2]);
        }
        let faces: Vec<&[u32]> = faces.iter().map(|face| face.as_slice()).collect();
        let names = joined(&positions, &faces, 1.0).unwrap();
        for (vertex, &name) in names.iter().enumerate() {
            assert!((positions[vertex][0] - positions[name as usize][0]).abs() <= 1.0);
        }
        assert_eq!(joined(&positions[..], &faces, 1e-3), None);
        // Faces within the reach stay.
        let crowd: Vec<[f64; 3]> = (0..900).map(|i| [f64::from(i), 0.0, 0.0]).collect();
        let faces: Vec<[u32; 3]> = (0..300).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let faces: Vec<&[u32]> = faces.iter().map(|face| face.as_slice()).collect();
        assert_eq!(joined(&crowd, &faces, 850.0), None);
    }

    /// The tip of a cone whose copies differ: a hole of three edges within the reach.
    #[test]
    fn a_hole_no_wider_than_the_reach_is_closed() {
        let positions = [
            [0., 0., 9.],
            [1., 0., 9.],
            [0., 1., 9.],
            [-50., -50., 0.],
            [50., -50., 0.],
            [0., 50., 0.],
        ];
        let faces: [&[u32]; 7] = [
            &[3, 5, 4],
            &[3, 4, 0],
            &[4, 1, 0],
            &[4, 5, 1],
            &[5, 2, 1],
            &[5, 3, 2],
            &[3, 0, 2],
        ];
        assert_eq!(
            joined(&positions, &faces, 1.0),
            Some(vec![0, 0, 0, 3, 4, 5])
        );
        assert_eq!(joined(&positions, &faces, 0.5), None);
    }
}
