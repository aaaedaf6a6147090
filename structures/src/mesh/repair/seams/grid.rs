//! Points by the cell that they lie in, to find those near a place.

use crate::neighbours::SpatialHash;

/// Open vertices within reach of one, at most. Numbers rounded to a unit allow 125 different ones within two units.
pub const MAX_NEAR: usize = 128;

/// The largest difference along an axis.
pub fn axis_distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3)
        .map(|axis| (a[axis] - b[axis]).abs())
        .fold(0.0, f64::max)
}

/// Points by the cell that they lie in.
pub struct Grid<'a> {
    positions: &'a [[f64; 3]],
    reach: f64,
    /// Cells are twice the reach, so that mostly one is looked at.
    cells: SpatialHash<u32>,
}

impl<'a> Grid<'a> {
    pub fn new(positions: &'a [[f64; 3]], reach: f64) -> Self {
        let low = positions.iter().fold([f64::INFINITY; 3], |low, position| {
            std::array::from_fn(|axis| low[axis].min(position[axis]))
        });
        let mut cells = SpatialHash::with_origin(low, 2.0 * reach, positions.len());
        for (&position, index) in positions.iter().zip(0..) {
            cells.push(position, index);
        }
        Self {
            positions,
            reach,
            cells,
        }
    }

    /// The points within reach along each axis; none where they are too many.
    pub fn near(&self, position: [f64; 3], near: &mut Vec<u32>) {
        near.clear();
        for &point in self.cells.touching(position, self.reach) {
            if axis_distance(self.positions[point as usize], position) <= self.reach {
                near.push(point);
            }
            if near.len() > MAX_NEAR {
                return near.clear();
            }
        }
    }
}
