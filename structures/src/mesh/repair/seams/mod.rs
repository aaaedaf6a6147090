//! Seams: open edges in one place but for rounding, made one.
//!
//! Programs that mesh each face of a body by itself, or that move a part after meshing it, round the two copies of a
//! vertex differently. The rule:
//!
//! - Only ends of **open edges** (of one face alone) are joined, so a closed mesh stays as it is, however thin.
//! - Two open edges longer than the reach are joined when both their ends lie within reach of one another. What has the
//!   fewest edges within reach goes first, then edges that run opposite ways, then the closest, then by their place in
//!   the file.
//! - All the vertices that become one lie in a cube as wide as the reach: no chain leads farther.
//! - Two vertices that follow each other on a face are not joined, so no sliver is lost.
//! - Where more than [`MAX_NEAR`] open vertices lie within reach of one, the surface is finer than its numbers, and
//!   nothing is joined.
//! - Last, a hole that lies in a cube as wide as the reach is closed: its rim becomes one vertex, unless a whole face
//!   lies in it.
//!
//! The earliest vertex stands for those joined with it. Time and memory are about proportional to the number of edges.

mod border;
mod clusters;
mod grid;

use crate::mesh::repair::faces::Faces;
use crate::mesh::repair::seams::border::Border;
use crate::mesh::repair::seams::clusters::Clusters;

/// Which vertex each becomes, the earliest of those that are one; none where nothing is joined.
///
/// `reach` is the most by which copies of a vertex differ along an axis.
pub fn join(positions: &[[f64; 3]], faces: &Faces, reach: f64) -> Option<Vec<u32>> {
    let border = Border::of(positions, faces)?;
    let mut clusters = Clusters::new(&border, reach);
    let mut is_joined = vec![false; border.edges.len()];
    for pair in border.pairs(reach) {
        let edges = pair.edges.map(|edge| edge as usize);
        let ends = pair.ends(&border);
        if edges.iter().any(|&edge| is_joined[edge])
            || !ends.iter().all(|&[a, b]| clusters.may_join(&border, a, b))
        {
            continue;
        }
        for edge in edges {
            is_joined[edge] = true;
        }
        for [a, b] in ends {
            // The first may have come in the way of the second.
            if clusters.may_join(&border, a, b) {
                clusters.join(a, b);
            }
        }
    }
    clusters.close_holes(&border, faces);
    let mut names: Vec<u32> = (0..positions.len() as u32).collect();
    let mut any = false;
    for vertex in 0..border.vertices.len() as u32 {
        let first = clusters.first(vertex);
        any |= first != vertex;
        names[border.vertices[vertex as usize] as usize] = border.vertices[first as usize];
    }
    any.then_some(names)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::repair::seams::grid::axis_distance;

    fn joined(positions: &[[f64; 3]], faces: &[&[u32]], reach: f64) -> Option<Vec<u32>> {
        let mut all = Faces::default();
        for face in faces {
            all.push(face);
        }
        join(positions, &all, reach)
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
            assert!(axis_distance(positions[vertex], positions[name as usize]) <= 1.0);
        }
        // Within reach of too many, nothing is done.
        assert_eq!(joined(&positions[..], &faces, 1e-3), None);
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
