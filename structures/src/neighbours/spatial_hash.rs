//! Points by cubic cell in a hash map, added one at a time.

use std::collections::HashMap;

/// Numbers of a cell along the three axes.
pub(crate) type Cell = [i64; 3];

/// Largest number of a cell along an axis, so that every cell has neighbours on both sides.
const LAST: f64 = (1i64 << 60) as f64;

/// The cell in which a point lies; `edge` > 0 is in the unit of the point, and cell 0 begins at 0.
pub(crate) fn cell_of(point: [f64; 3], edge: f64) -> Cell {
    point.map(|x| (x / edge).floor().clamp(-LAST, LAST) as i64)
}

/// A cell and the 26 cells that touch it, by rising x, then y, then z.
pub(crate) fn around([x, y, z]: Cell) -> impl Iterator<Item = Cell> {
    (0..27).map(move |at| [x + at / 9 - 1, y + at / 3 % 3 - 1, z + at % 3 - 1])
}

/// All cells from `first` to `last` inclusive on each axis, by rising x, then y, then z.
fn between(first: Cell, last: Cell) -> impl Iterator<Item = Cell> {
    (first[0]..=last[0]).flat_map(move |x| {
        (first[1]..=last[1]).flat_map(move |y| (first[2]..=last[2]).map(move |z| [x, y, z]))
    })
}

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
    pub(crate) fn with_origin(origin: [f64; 3], edge: f64, capacity: usize) -> Self {
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

    fn members_at(&mut self, point: [f64; 3]) -> &mut Vec<T> {
        self.members.entry(self.cell(point, 0.0)).or_default()
    }

    /// Adds an item at a point.
    pub fn push(&mut self, point: [f64; 3], item: T) {
        self.members_at(point).push(item);
    }

    /// The items of a point's cell and of the 26 about it: all within one edge, among others up to 3.5 edges away.
    pub fn around(&self, point: [f64; 3]) -> impl Iterator<Item = &T> {
        self.of_cells(around(self.cell(point, 0.0)))
    }

    /// The items of all cells that a cube of half edge `reach` about a point touches: all that lie within reach, among
    /// others.
    pub fn touching(&self, point: [f64; 3], reach: f64) -> impl Iterator<Item = &T> {
        let [first, last] = [-reach, reach].map(|shift| self.cell(point, shift));
        self.of_cells(between(first, last))
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
    pub(crate) fn of_crowded_points(
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

    #[test]
    fn the_cells_around_one_are_those_between_its_neighbours() {
        let near: Vec<Cell> = around([4, -1, 0]).collect();
        assert_eq!(near, between([3, -2, -1], [5, 0, 1]).collect::<Vec<_>>());
        assert_eq!(near[13], [4, -1, 0]);
    }

    #[test]
    fn cells_are_half_open_and_never_overflow() {
        assert_eq!(cell_of([-0.1, 0.0, 2.0], 2.0), [-1, 0, 1]);
        let far = cell_of([1e300, -1e300, 0.0], 1e-9);
        assert_eq!(around(far).count(), 27);
    }
}
