//! Points by cubic cell in a hash map, added one at a time.

use std::collections::HashMap;

use super::cell::{self, Cell, cell_of};

/// Points in each cubic cell of space. Lengths are in one unit throughout.
#[derive(Clone, Debug)]
pub struct SpatialHash<T> {
    /// Where cell 0 begins on each axis.
    origin: [f64; 3],
    edge: f64,
    members: HashMap<Cell, Vec<T>>,
}

impl<T> SpatialHash<T> {
    /// An empty hash with cells of `edge` > 0.
    pub fn new(edge: f64) -> Self {
        Self::with_origin([0.0; 3], edge, 0)
    }

    /// An empty hash whose cells are counted from `origin`, with room for items in `capacity` cells.
    ///
    /// An origin near the points keeps their digits where they all lie far from 0.
    pub fn with_origin(origin: [f64; 3], edge: f64, capacity: usize) -> Self {
        Self {
            origin,
            edge,
            members: HashMap::with_capacity(capacity),
        }
    }

    fn cell(&self, point: [f64; 3], shift: f64) -> Cell {
        let from_origin = [0, 1, 2].map(|axis| point[axis] - self.origin[axis] + shift);
        cell_of(from_origin, self.edge)
    }

    /// The items of the cell of a point, to add to.
    pub fn members_at(&mut self, point: [f64; 3]) -> &mut Vec<T> {
        self.members.entry(self.cell(point, 0.0)).or_default()
    }

    /// Adds an item at a point.
    pub fn push(&mut self, point: [f64; 3], item: T) {
        self.members_at(point).push(item);
    }

    /// The items of a point's cell and of the 26 about it: all within one edge, among others up to 3.5 edges away.
    pub fn around(&self, point: [f64; 3]) -> impl Iterator<Item = &T> {
        self.of_cells(cell::around(self.cell(point, 0.0)))
    }

    /// The items of all cells that a cube of half edge `reach` about a point touches: all that lie within reach, among
    /// others.
    pub fn touching(&self, point: [f64; 3], reach: f64) -> impl Iterator<Item = &T> {
        self.of_cells(cell::between(
            self.cell(point, -reach),
            self.cell(point, reach),
        ))
    }

    fn of_cells(&self, cells: impl Iterator<Item = Cell>) -> impl Iterator<Item = &T> {
        cells.filter_map(|cell| self.members.get(&cell)).flatten()
    }
}

impl SpatialHash<usize> {
    /// The indices of points, in cells of `edge` > 0.
    pub fn of_points(points: impl IntoIterator<Item = [f64; 3]>, edge: f64) -> Self {
        Self::of_crowded_points(points, edge, usize::MAX)
    }

    /// The indices of points, in cells of `edge` > 0: of the first `max` points of each cell.
    pub fn of_crowded_points(
        points: impl IntoIterator<Item = [f64; 3]>,
        edge: f64,
        max: usize,
    ) -> Self {
        let mut hash = Self::new(edge);
        for (index, point) in points.into_iter().enumerate() {
            let members = hash.members_at(point);
            if members.len() < max {
                members.push(index);
            }
        }
        hash
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_near_position_is_missed() {
        let place = |i: usize| {
            [
                0.37 * (i % 7) as f64,
                -0.91 * (i % 5) as f64,
                1.3 * (i / 9) as f64,
            ]
        };
        let positions: Vec<[f64; 3]> = (0..200).map(place).collect();
        for edge in [0.5, 1.7, 40.0] {
            let hash = SpatialHash::of_points(positions.iter().copied(), edge);
            for &point in positions.iter().chain(&[[1.0, -1.0, 3.3], [1e300; 3]]) {
                for reach in [edge, 0.4 * edge] {
                    let near = |index: &usize| {
                        let square: f64 = (0..3)
                            .map(|axis| (positions[*index][axis] - point[axis]).powi(2))
                            .sum();
                        square <= reach * reach
                    };
                    let expected: Vec<usize> = (0..positions.len()).filter(near).collect();
                    let sorted = |mut found: Vec<usize>| {
                        found.sort_unstable();
                        found
                    };
                    let around = hash.around(point).copied().filter(near);
                    assert_eq!(sorted(around.collect()), expected);
                    let touching = hash.touching(point, reach).copied().filter(near);
                    assert_eq!(sorted(touching.collect()), expected);
                }
            }
        }
    }

    #[test]
    fn a_crowded_cell_keeps_its_first_points() {
        let hash = SpatialHash::of_crowded_points([[0.5; 3]; 5], 1.0, 2);
        assert!(hash.around([0.5; 3]).eq(&[0, 1]));
    }
}
