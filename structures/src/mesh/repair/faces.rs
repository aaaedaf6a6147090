//! The faces of a file: polygons as lists of vertices, one after the other in one list.

/// Polygons of three or more corners.
#[derive(Clone, Debug, Default)]
pub struct Faces {
    /// Corners of all faces.
    corners: Vec<u32>,
    /// Number of corners of each face.
    sizes: Vec<u32>,
}

impl Faces {
    /// Adds a face of three or more corners; fewer bound nothing.
    pub fn push(&mut self, corners: &[u32]) {
        if let (3.., Ok(size)) = (corners.len(), u32::try_from(corners.len())) {
            self.corners.extend_from_slice(corners);
            self.sizes.push(size);
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.sizes.is_empty()
    }

    /// The corners of all faces, in their order.
    pub fn corners(&self) -> &[u32] {
        &self.corners
    }

    /// The same, to rename vertices.
    pub fn corners_mut(&mut self) -> &mut [u32] {
        &mut self.corners
    }

    /// The corners of each face.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let mut left = self.corners.as_slice();
        self.sizes.iter().map(move |&size| {
            let (face, rest) = left.split_at(size as usize);
            left = rest;
            face
        })
    }

    /// Number of triangles that the faces are cut into.
    pub fn triangle_count(&self) -> usize {
        self.corners.len() - 2 * self.sizes.len()
    }
}
