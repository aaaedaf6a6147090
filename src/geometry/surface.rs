//! The surface of a union of balls as a mesh, by surface nets on a grid.

use fast_surface_nets::ndshape::RuntimeShape;
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};

use super::ball_field::BallField;

/// The surface at depth zero: triangles anticlockwise from outside, positions in the frame of the files, where the
/// balls' origin is at `origin`. A vertex lies within a cell of the surface, and features narrower than a cell may be
/// missing.
///
/// Method: naive surface nets (Gibson, MICCAI 1998), by the crate fast-surface-nets.
pub fn surface(field: &BallField, origin: [f64; 3]) -> Surface {
    let grid = field.grid;
    let size = grid.shape.map(|count| count as u32);
    let shape = RuntimeShape::<u32, 3>::new(size);
    // It is below zero inside, in units of the spacing.
    let distances: Vec<f32> = (field.depth.iter())
        .map(|depth| -depth / grid.spacing as f32)
        .collect();
    let mut nets = SurfaceNetsBuffer::default();
    surface_nets(
        &distances,
        &shape,
        [0; 3],
        size.map(|count| count - 1),
        &mut nets,
    );
    let place = |position: &[f32; 3]| {
        [0, 1, 2].map(|axis| {
            let number = f64::from(position[axis]);
            origin[axis] + (grid.first[axis] + grid.spacing * number)
        })
    };
    Surface {
        positions: nets.positions.iter().map(place).collect(),
        triangles: (nets.indices.chunks_exact(3))
            .map(|corners| [corners[0], corners[1], corners[2]])
            .collect(),
    }
}

/// A mesh that was computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Places of the vertices.
    pub positions: Vec<[f64; 3]>,
    /// Triangles by the numbers of their vertices, from zero, anticlockwise from outside.
    pub triangles: Vec<[u32; 3]>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::ball_field::FieldGrid;
    use knotdock_structures::sampling::Ball;
    use knotdock_structures::sampling::ball_tree::BallTree;

    #[test]
    fn the_surface_of_two_balls_is_closed_and_faces_outward() {
        let ball = |x: f64| Ball {
            center: [x, 0.0, 0.0],
            radius: 1.0,
        };
        let balls = [ball(0.0), ball(4.0)];
        let grid = FieldGrid::about(&balls, 60).unwrap();
        let field = BallField::new(&BallTree::new(&balls), grid);
        let found = surface(&field, [1e6, 0.0, -1e6]);
        let corners = |triangle: &[u32; 3]| triangle.map(|corner| found.positions[corner as usize]);
        let mut edges = std::collections::HashMap::new();
        let mut volume = 0.0;
        for triangle in &found.triangles {
            for side in 0..3 {
                let [a, b] = [triangle[side], triangle[(side + 1) % 3]];
                *edges.entry((a.min(b), a.max(b))).or_insert(0) += if a < b { 1 } else { -1 };
            }
            let [a, b, c] = corners(triangle).map(|[x, y, z]| [x - 1e6, y, z + 1e6]);
            volume += (a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]))
                / 6.0;
        }
        assert!(edges.values().all(|&sum| sum == 0), "an open edge");
        let exact = 8.0 / 3.0 * std::f64::consts::PI;
        assert!((volume / exact - 1.0).abs() < 0.03, "{volume} {exact}");
    }
}
