//! Lower bounds of the distance from any place to a set of points, by cells of space.
//!
//! Most atoms of a ligand are far from the receptor, and a look at one cell shows it.

use nalgebra::Vector3;

/// Edges of a cell in the reach that bounds are for.
const EDGES: usize = 6;
/// Square, in cell edges, of the distance from which no place is within the reach. Cells farther away have it, too.
const FAR: u8 = (EDGES * EDGES) as u8;
/// Most cells: where points are spread out they grow.
const MAX_CELLS: f64 = 4e6;
/// Share by which a bound must exceed a reach, for the rounding of cells.
const ROUNDING: f64 = 1e-9;

/// Lower bounds of the distance to some points, for places within a reach of them.
pub(crate) struct DistanceFloors {
    low: Vector3<f64>,
    /// Cells in a unit of length.
    per_unit: f64,
    square_edge: f64,
    counts: [usize; 3],
    /// Squares of the least distance between each cell and those that hold points, in edges: at most [`FAR`].
    squares: Vec<u8>,
}

impl DistanceFloors {
    /// Bounds for a reach above zero and the places of points, in one unit.
    pub fn new(points: &[Vector3<f64>], reach: f64) -> Self {
        let start = [f64::INFINITY, f64::NEG_INFINITY].map(Vector3::repeat);
        let [low, high] = (points.iter()).fold(start, |[low, high], point| {
            [low.inf(point), high.sup(point)]
        });
        let extent = (high - low).map(|length| length.max(0.0));
        let mut edge = reach * (1.0 + 2.0 * ROUNDING) / EDGES as f64;
        // A cell for what is left over, and a margin in which a place may be near.
        let margin = EDGES + 1;
        let along = |length: f64, edge: f64| length / edge + (2 * margin + 1) as f64;
        while extent
            .iter()
            .map(|&length| along(length, edge))
            .product::<f64>()
            > MAX_CELLS
        {
            edge *= 1.5;
        }
        let counts = [0, 1, 2].map(|axis| along(extent[axis], edge) as usize);
        let mut floors = Self {
            low: low.add_scalar(-(margin as f64) * edge),
            per_unit: 1.0 / edge,
            square_edge: edge * edge,
            counts,
            squares: vec![FAR; counts.iter().product()],
        };
        for point in points {
            if let Some(cell) = floors.cell(point) {
                floors.squares[cell] = 0;
            }
        }
        // Squares of a distance add up axis by axis. Cells that are next to each other touch.
        for stride in [1, counts[2], counts[1] * counts[2]] {
            let before = floors.squares.clone();
            for away in 1..=EDGES {
                let square = ((away - 1) * (away - 1)) as u8;
                let step = away * stride;
                // The margins hold nothing, so what goes around an edge of the grid brings nothing near.
                for (cell, &far) in floors.squares[step..].iter_mut().zip(&before) {
                    *cell = (*cell).min(far + square);
                }
                for (cell, &far) in floors.squares.iter_mut().zip(&before[step..]) {
                    *cell = (*cell).min(far + square);
                }
            }
        }
        floors
    }

    /// Number of the cell of a place; `None` beyond the grid.
    #[inline(always)]
    fn cell(&self, place: &Vector3<f64>) -> Option<usize> {
        let at = (place - self.low) * self.per_unit;
        let inside = (0..3).all(|axis| at[axis] >= 0.0 && at[axis] < self.counts[axis] as f64);
        let [x, y, z] = [at.x as usize, at.y as usize, at.z as usize];
        inside.then_some((x * self.counts[1] + y) * self.counts[2] + z)
    }

    /// Whether no point can be within `reach` of a place. `false` if the reach is larger than that of the bounds.
    #[inline(always)]
    pub fn excludes(&self, place: &Vector3<f64>, reach: f64) -> bool {
        let square = self
            .cell(place)
            .and_then(|cell| self.squares.get(cell))
            .map_or(FAR, |&square| square);
        f64::from(square) * self.square_edge >= reach * reach * (1.0 + ROUNDING)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::Numbers;

    /// Excluded places are farther than the reach, and most far places are excluded. Parts of a body may be far from each
    /// other.
    #[test]
    fn only_what_is_far_is_excluded() {
        for spread in [1.0, 1e5] {
            let mut numbers = Numbers(3);
            let mut point = |size: f64| Vector3::from_fn(|_, _| size * (numbers.next() - 0.5));
            let mut atoms: Vec<Vector3<f64>> = (0..200).map(|_| point(30.0)).collect();
            atoms.push(Vector3::new(spread, 0.0, 0.0));
            let near = DistanceFloors::new(&atoms, 8.0);
            assert!(near.squares.len() as f64 <= MAX_CELLS);
            let (mut far, mut excluded) = (0, 0);
            for _ in 0..2000 {
                let place = point(90.0);
                let distances = atoms.iter().map(|atom| (atom - place).norm());
                let distance = distances.fold(f64::INFINITY, f64::min);
                let is_excluded = near.excludes(&place, 8.0);
                assert!(!is_excluded || distance > 8.0);
                far += usize::from(distance > 14.0);
                excluded += usize::from(is_excluded);
            }
            assert!(far > 100 && (spread > 1.0 || excluded >= far));
        }
    }
}
