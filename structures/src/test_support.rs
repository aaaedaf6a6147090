//! What unit tests of several modules are made of.

/// A box of these half sides about the origin.
pub fn cuboid(half: [f64; 3]) -> crate::mesh::Solid {
    let positions: Vec<[f64; 3]> = (0..8)
        .map(|i| [0, 1, 2].map(|axis| half[axis] * (2.0 * f64::from(i >> axis & 1) - 1.0)))
        .collect();
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles: Vec<[u32; 3]> = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    let (mesh, _) = crate::mesh::from_triangles(&positions, &triangles).unwrap();
    crate::mesh::Solid::new(&mesh).unwrap()
}
