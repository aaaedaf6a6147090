//! Report on a mesh file: its content, and the faults of its surface.

use std::fmt;

use serde::Serialize;

use crate::mesh::read::MeshFormat;
use crate::mesh::triangle_mesh::{Mesh, doubled_normal};
use crate::vector::{add, norm};

/// Counts of the mesh that was read, and its faults.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MeshReport {
    /// Format of the file; none for a mesh made in memory.
    pub format: Option<MeshFormat>,
    /// Vertices in the file.
    pub file_vertices: usize,
    /// Triangles in the file, larger faces cut up.
    pub file_triangles: usize,
    /// Distinct vertices.
    pub vertices: usize,
    /// Triangles kept.
    pub triangles: usize,
    /// Triangles dropped because two of their corners are one vertex, and kept ones without area.
    pub degenerate_triangles: usize,
    /// Vertices joined with another across a seam, both being one but for the rounding of the file's numbers.
    pub seam_vertices: usize,
    /// Largest distance of these along an axis, in the file's unit; 0 where none were joined.
    pub weld_reach: f64,
    /// What was left out of the file, or read otherwise than it says: a sentence each.
    pub reading_notes: Vec<String>,
    /// How often the file holds each triangle, one way round or both; they are kept once. 1 but for surfaces that are
    /// there several times.
    pub times: usize,
    /// Edges of one triangle only.
    pub open_edges: usize,
    /// Length of the open edges, in the file's unit.
    pub open_length: f64,
    /// Edges of more than two triangles.
    pub nonmanifold_edges: usize,
    /// Edges run through more often one way than the other: none in a closed mesh.
    pub unbalanced_edges: usize,
    /// Area that is missing at least, as a share of the area that is there: the length of the sum of area vectors,
    /// which is zero for a closed surface.
    pub missing_share: f64,
    /// Sets of triangles connected across edges of two or, where more than two meet, walls of one body.
    pub parts: usize,
    /// Triangles that were turned to agree with their neighbours.
    pub turned_triangles: usize,
    /// Parts that faced inward and were turned.
    pub inverted_parts: usize,
    /// Parts that lie within others and face outward: the solid is the union, so they add nothing to it.
    pub nested_parts: usize,
    /// Parts whose triangles cannot all face one way, as those of a Möbius strip or a Klein bottle.
    pub one_sided_parts: usize,
    /// Triangles dropped because they were there before, one way round or the other, beside those that `times`
    /// counts.
    pub repeated_triangles: usize,
    /// Triangles dropped because they bound nothing, as those of a sheet without thickness.
    pub idle_triangles: usize,
    /// Volume, in the file's unit cubed: that of [`Mesh::volume`], nested parts left out. Parts that cross count
    /// twice where they do.
    pub volume: f64,
    /// Area, in the file's unit squared.
    pub area: f64,
    /// Smallest coordinate on each axis, in the file's unit.
    pub low: [f64; 3],
    /// Largest coordinate on each axis, in the file's unit.
    pub high: [f64; 3],
}

impl MeshReport {
    /// Measures what has become of the mesh. The volume holds what nested parts take from it.
    pub(super) fn measure(&mut self, mesh: &Mesh) {
        self.vertices = mesh.positions.len();
        self.triangles = mesh.triangles.len();
        let slivers = mesh.triangles.iter().filter(|&&t| mesh.is_sliver(t));
        self.degenerate_triangles += slivers.count();
        self.area = mesh.area();
        self.volume += mesh.volume();
        (self.low, self.high) = mesh.bounds();
        // The sum of a closed surface is zero but for rounding.
        if !self.is_closed() {
            let normals = mesh
                .triangles
                .iter()
                .map(|&t| doubled_normal(mesh.corners(t)));
            self.missing_share = norm(normals.fold([0.0; 3], add)) / 2.0 / self.area;
        }
    }

    /// Whether the surface bounds a solid: every edge is run through as often one way as the other.
    pub fn is_closed(&self) -> bool {
        self.unbalanced_edges == 0
    }

    /// Whether the file's surface was closed, faced outward, was there once as it came and was read whole, which is
    /// what `--strict` requires.
    pub fn is_sound(&self) -> bool {
        self.warnings().is_empty()
    }

    /// What a user has to know before trusting what is made of the mesh, a sentence each.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = self.reading_notes.clone();
        if self.times > 1 {
            warnings.push(format!(
                "the file holds each triangle {} times, one way round or both; it is taken once",
                self.times
            ));
        }
        if !self.is_closed() {
            warnings.push(format!(
                "the mesh is not closed: {} of its edges do not balance ({} open, {} long in all; {} of more than two triangles) and \
                 holes take at least {:.3}% of its area; inside is where the generalised winding number is above one half",
                self.unbalanced_edges,
                self.open_edges,
                Figure(self.open_length),
                self.nonmanifold_edges,
                100.0 * self.missing_share
            ));
        }
        if self.turned_triangles > 0 {
            warnings.push(format!(
                "{} of {} triangles faced the other way than their neighbours and were turned",
                self.turned_triangles, self.triangles
            ));
        }
        if self.inverted_parts > 0 {
            warnings.push(format!(
                "{} of {} parts faced inward and were turned",
                self.inverted_parts, self.parts
            ));
        }
        if self.repeated_triangles > 0 {
            warnings.push(format!(
                "{} triangles repeat others of the file, one way round or the other; each body has its walls once",
                self.repeated_triangles
            ));
        }
        if self.idle_triangles > 0 {
            warnings.push(format!(
                "{} triangles bound nothing: the same lies on both sides of them, as of a sheet without thickness; \
                 they are left out",
                self.idle_triangles
            ));
        }
        match self.nested_parts {
            0 => {}
            1 => warnings.push(
                "a part lies within another and faces outward; is it a cavity? It is taken as solid: \
                 if it is a cavity, turn it to face inward"
                    .to_owned(),
            ),
            count => warnings.push(format!(
                "{count} of {} parts lie within others and face outward; are they cavities? They are taken as solid: \
                 turn those that are cavities to face inward",
                self.parts
            )),
        }
        if self.one_sided_parts > 0 {
            warnings.push(format!(
                "{} of {} parts have one side only, as a Möbius strip or a Klein bottle: they bound no solid",
                self.one_sided_parts, self.parts
            ));
        }
        warnings
    }
}

impl fmt::Display for MeshReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} triangles on {} vertices in {} {}, {}",
            self.triangles,
            self.vertices,
            self.parts,
            if self.parts == 1 { "part" } else { "parts" },
            if self.is_closed() { "closed" } else { "open" }
        )?;
        if self.nonmanifold_edges > 0 {
            write!(f, ", {} non-manifold edges", self.nonmanifold_edges)?;
        }
        if self.degenerate_triangles > 0 {
            write!(f, ", {} degenerate triangles", self.degenerate_triangles)?;
        }
        let size: Vec<String> = self
            .low
            .iter()
            .zip(self.high)
            .map(|(low, high)| Figure(high - low).to_string())
            .collect();
        write!(
            f,
            "; {} across, volume {}, area {}",
            size.join(" x "),
            Figure(self.volume),
            Figure(self.area)
        )
    }
}

/// A length, area or volume as a person reads it: with six decimals, or in powers of ten where these would hide it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure(
    /// The value, in whatever unit.
    pub f64,
);

/// Sizes that six decimals show at least four digits of, and that a person still counts.
const PLAIN: std::ops::Range<f64> = 1e-3..1e9;

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = self;
        if *value == 0.0 || PLAIN.contains(&value.abs()) {
            write!(f, "{value:.6}")
        } else {
            write!(f, "{value:.6e}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Figure;

    #[test]
    fn small_and_large_figures_keep_their_digits() {
        let printed =
            [0.0, 0.25, -1234.5, 2.5e-7, -9.999e-4, 3.0e12].map(|v| Figure(v).to_string());
        let expected = [
            "0.000000",
            "0.250000",
            "-1234.500000",
            "2.500000e-7",
            "-9.999000e-4",
            "3.000000e12",
        ];
        assert_eq!(printed, expected);
    }
}
