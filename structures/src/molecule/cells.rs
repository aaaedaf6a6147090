//! Positions sorted into cubic cells, so that what is near a point is found without asking all.

use std::collections::HashMap;

/// Positions by the cell that they lie in.
pub(super) struct Cells {
    /// Edge of a cell, in Å.
    width: f64,
    members: HashMap<[i64; 3], Vec<usize>>,
}

/// Within what has neighbours on both sides.
const LAST: f64 = (1i64 << 60) as f64;

impl Cells {
    /// Sorts positions into cells of `width` > 0, in Å: the largest distance that will be asked for.
    pub(super) fn new(positions: impl IntoIterator<Item = [f64; 3]>, width: f64) -> Self {
        Self::with_at_most(positions, width, usize::MAX)
    }

    /// As [`Cells::new`], with the first `most` positions of each cell and none beyond.
    pub(super) fn with_at_most(
        positions: impl IntoIterator<Item = [f64; 3]>,
        width: f64,
        most: usize,
    ) -> Self {
        let mut cells = Self {
            width,
            members: HashMap::new(),
        };
        for (index, position) in positions.into_iter().enumerate() {
            let cell = cells.cell(position);
            let members = cells.members.entry(cell).or_default();
            if members.len() < most {
                members.push(index);
            }
        }
        cells
    }

    fn cell(&self, position: [f64; 3]) -> [i64; 3] {
        position.map(|x| (x / self.width).floor().clamp(-LAST, LAST) as i64)
    }

    /// Indices of all positions within `width` of a point, among others up to 3.5 times as far.
    pub(super) fn around(&self, point: [f64; 3]) -> impl Iterator<Item = usize> + '_ {
        let [x, y, z] = self.cell(point);
        (0..27)
            .filter_map(move |at| {
                let cell = [x + at / 9 - 1, y + at / 3 % 3 - 1, z + at % 3 - 1];
                self.members.get(&cell)
            })
            .flatten()
            .copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::squared_distance;

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
        for width in [0.5, 1.7, 40.0] {
            let cells = Cells::new(positions.iter().copied(), width);
            for &point in positions.iter().chain(&[[1.0, -1.0, 3.3], [1e300; 3]]) {
                let near =
                    |&index: &usize| squared_distance(positions[index], point) <= width * width;
                let mut found: Vec<usize> = cells.around(point).filter(near).collect();
                found.sort_unstable();
                let expected: Vec<usize> = (0..positions.len()).filter(near).collect();
                assert_eq!(found, expected);
            }
        }
    }
}
