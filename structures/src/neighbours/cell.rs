//! Cubic cells of space, by three whole numbers.

/// Numbers of a cell along the three axes.
pub type Cell = [i64; 3];

/// Largest number of a cell along an axis, so that every cell has neighbours on both sides.
const LAST: f64 = (1i64 << 60) as f64;

/// The cell in which a point lies; `edge` > 0 is in the unit of the point, and cell 0 begins at 0.
pub fn cell_of(point: [f64; 3], edge: f64) -> Cell {
    point.map(|x| (x / edge).floor().clamp(-LAST, LAST) as i64)
}

/// A cell and the 26 cells that touch it, by rising x, then y, then z.
pub fn around([x, y, z]: Cell) -> impl Iterator<Item = Cell> {
    (0..27).map(move |at| [x + at / 9 - 1, y + at / 3 % 3 - 1, z + at % 3 - 1])
}

/// All cells from `first` to `last` inclusive on each axis, by rising x, then y, then z.
pub fn between(first: Cell, last: Cell) -> impl Iterator<Item = Cell> {
    (first[0]..=last[0]).flat_map(move |x| {
        (first[1]..=last[1]).flat_map(move |y| (first[2]..=last[2]).map(move |z| [x, y, z]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

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
