//! Triangles on the same three vertices: one distinct triangle, and its copies either way round.

use std::collections::HashMap;

use crate::mesh::repair::repeats::sorted;

/// The distinct triangles of a mesh, in order of first appearance.
pub(in crate::mesh) struct Distinct {
    /// Corners, as the first copy has them.
    pub corners: Vec<[u32; 3]>,
    /// The copies of each: the triangle, and whether it runs the way that the first does.
    pub copies: Vec<Vec<(u32, bool)>>,
}

impl Distinct {
    pub fn new(triangles: &[[u32; 3]]) -> Self {
        let mut places: HashMap<[u32; 3], (usize, usize)> = HashMap::with_capacity(triangles.len());
        let mut distinct = Self {
            corners: Vec::with_capacity(triangles.len()),
            copies: Vec::with_capacity(triangles.len()),
        };
        for (index, &triangle) in (0u32..).zip(triangles) {
            let (corners, side) = sorted(triangle);
            let count = distinct.corners.len();
            let &mut (place, first) = places.entry(corners).or_insert((count, side));
            if place == count {
                distinct.corners.push(triangle);
                distinct.copies.push(Vec::with_capacity(1));
            }
            distinct.copies[place].push((index, side == first));
        }
        distinct
    }

    /// Number of distinct triangles.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// Whether a triangle is there more than once.
    pub fn is_repeated(&self, triangle: u32) -> bool {
        self.copies[triangle as usize].len() > 1
    }

    /// Whether a triangle is there both ways round.
    pub fn is_both_ways(&self, triangle: u32) -> bool {
        self.copies[triangle as usize].iter().any(|(_, same)| !same)
    }

    /// Copies that run as the first does, less those that run the other way.
    pub fn net(&self, triangle: u32) -> i64 {
        let copies = self.copies[triangle as usize].iter();
        copies.map(|&(_, same)| if same { 1 } else { -1 }).sum()
    }
}
