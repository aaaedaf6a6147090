//! Surfaces of parts that belong together, measured.

use crate::mesh::triangle_mesh::Mesh;
use crate::mesh::vector::{add, cross, dot, norm, scale, subtract};

/// A closed surface of less volume than this times its area to the power 3/2 has no inside.
const FLAT: f64 = 1e-14;

/// A set of triangles that hang together.
pub(in crate::mesh) struct Part {
    /// Its triangles, in rising order.
    pub triangles: Vec<u32>,
    /// Whether it is the part before it, the other way round.
    pub is_reverse: bool,
    /// Whether each edge is run through as often one way as the other.
    pub is_closed: bool,
}

/// A surface, measured.
pub(in crate::mesh) struct Surface {
    pub parts: usize,
    pub triangles: Vec<u32>,
    /// The same surface the other way round, if it is there both ways.
    pub reverse: Option<Vec<u32>>,
    pub is_closed: bool,
    /// Six times its volume about the middle of its bounding box.
    pub volume: f64,
    pub area: f64,
    /// Whether a triangle of it has an area.
    pub has_area: bool,
    pub low: [f64; 3],
    pub high: [f64; 3],
    /// Its outermost vertices either way along each axis.
    pub outermost: Vec<[f64; 3]>,
}

impl Surface {
    pub fn new(mesh: &Mesh, parts: &[Part], parts_of: &[usize]) -> Self {
        let own = || parts_of.iter().map(|&part| &parts[part]);
        let triangles: Vec<u32> = own()
            .filter(|part| !part.is_reverse)
            .flat_map(|part| part.triangles.iter().copied())
            .collect();
        let reverse = own().find(|part| part.is_reverse);
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
        let has_area = triangles
            .iter()
            .any(|&triangle| !mesh.is_sliver(mesh.triangles[triangle as usize]));
        let area = corners()
            .map(|corners| 0.5 * norm(crate::mesh::triangle_mesh::doubled_normal(corners)))
            .sum();
        Self {
            parts: own().filter(|part| !part.is_reverse).count(),
            is_closed: own().all(|part| part.is_closed),
            reverse: reverse.map(|part| part.triangles.clone()),
            triangles,
            volume,
            area,
            has_area,
            low,
            high,
            outermost,
        }
    }

    /// Whether it faces inward as the file has it.
    pub fn is_inward(&self) -> bool {
        self.volume < 0.0
    }

    /// Whether it is closed and all in one plane, or doubled onto itself.
    pub fn is_flat(&self) -> bool {
        self.is_closed && self.volume.abs() <= FLAT * self.area.powf(1.5)
    }

    /// Whether another's bounding box lies within this one's.
    pub fn can_hold(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.low[axis] <= other.low[axis] && other.high[axis] <= self.high[axis])
    }
}
