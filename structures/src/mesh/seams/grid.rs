//! Points by the cell that they lie in, to find those near a place.

use super::{MAX_NEAR, apart};

/// Points by the cell that they lie in.
pub struct Grid<'a> {
    positions: &'a [[f64; 3]],
    low: [f64; 3],
    reach: f64,
    /// Cells are twice the reach, so that mostly one is looked at.
    cells: Vec<([i64; 3], u32)>,
}

impl<'a> Grid<'a> {
    pub fn new(positions: &'a [[f64; 3]], reach: f64) -> Self {
        let low = positions.iter().fold([f64::INFINITY; 3], |low, position| {
            std::array::from_fn(|axis| low[axis].min(position[axis]))
        });
        let mut grid = Self {
            positions,
            low,
            reach,
            cells: Vec::new(),
        };
        let at = |position: &[f64; 3]| [0, 1, 2].map(|axis| grid.along(*position, axis, 0.0));
        grid.cells = positions.iter().map(at).zip(0..).collect();
        grid.cells.sort_unstable();
        grid
    }

    fn along(&self, position: [f64; 3], axis: usize, shift: f64) -> i64 {
        ((position[axis] - self.low[axis] + shift) / (2.0 * self.reach)).floor() as i64
    }

    /// The points within reach along each axis; none where they are too many.
    pub fn near(&self, position: [f64; 3], near: &mut Vec<u32>) {
        near.clear();
        let span =
            |axis| self.along(position, axis, -self.reach)..=self.along(position, axis, self.reach);
        for x in span(0) {
            for y in span(1) {
                for z in span(2) {
                    let start = self.cells.partition_point(|(cell, _)| *cell < [x, y, z]);
                    let cells = self.cells.get(start..).unwrap_or_default();
                    for &(_, point) in cells.iter().take_while(|(cell, _)| *cell == [x, y, z]) {
                        if apart(self.positions[point as usize], position) <= self.reach {
                            near.push(point);
                        }
                        if near.len() > MAX_NEAR {
                            return near.clear();
                        }
                    }
                }
            }
        }
    }
}
