//! Points that are known beforehand, by cubic cell.

use crate::vector::bounds;

/// Most cells of a list: where points are more widely spaced, its cells grow.
const MAX_CELLS: f64 = 4e6;

/// A point of a list, with its item.
#[derive(Clone, Copy, Debug)]
pub struct Member<T> {
    /// Coordinates, in the unit of the list.
    pub position: [f64; 3],
    /// What a visitor sees of the point, such as its index or type.
    pub item: T,
}

/// Points by cubic cell, in one piece of memory. Lengths are in one unit throughout.
#[derive(Clone, Debug)]
pub struct CellList<T> {
    members: Bins<Member<T>>,
    low: [f64; 3],
    edge: f64,
    counts: [usize; 3],
}

impl<T> CellList<T> {
    /// Sorts points into cells of `edge` > 0, or of a larger edge where that would be more than four million cells.
    ///
    /// The grid of cells spans the points and the origin, so points are best given relative to their middle.
    pub fn new(members: Vec<Member<T>>, edge: f64) -> Self {
        let positions = members.iter().map(|member| member.position);
        let (low, high) = bounds(std::iter::once([0.0; 3]).chain(positions));
        let count =
            |edge: f64| [0, 1, 2].map(|axis| ((high[axis] - low[axis]) / edge).floor() + 1.0);
        let mut edge = edge;
        while count(edge).iter().product::<f64>() > MAX_CELLS {
            edge *= 1.5;
        }
        let counts = count(edge).map(|n| n as usize);
        let bin_of = |member: &Member<T>| {
            let along = |axis: usize| ((member.position[axis] - low[axis]) / edge) as usize;
            (along(0) * counts[1] + along(1)) * counts[2] + along(2)
        };
        Self {
            members: Bins::new(counts.iter().product(), members, bin_of),
            low,
            edge,
            counts,
        }
    }

    /// Visits every point nearer than `reach` to `center`, with its squared distance, in one fixed order.
    #[inline]
    pub fn visit_within(&self, center: [f64; 3], reach: f64, mut visit: impl FnMut(&T, f64)) {
        let cell =
            |axis: usize, shift: f64| ((center[axis] - self.low[axis] + shift) / self.edge).floor();
        let from = [0, 1, 2].map(|axis| cell(axis, -reach).max(0.0));
        let to = [0, 1, 2].map(|axis| cell(axis, reach));
        if (0..3).any(|axis| to[axis] < 0.0 || from[axis] >= self.counts[axis] as f64) {
            return;
        }
        let from = from.map(|x| x as usize);
        let last = |axis: usize| (to[axis] as usize).min(self.counts[axis] - 1);
        for x in from[0]..=last(0) {
            for y in from[1]..=last(1) {
                let row = (x * self.counts[1] + y) * self.counts[2];
                for member in self.members.run(row + from[2], row + last(2)) {
                    let [x, y, z] = [0, 1, 2].map(|axis| member.position[axis] - center[axis]);
                    let square = x * x + y * y + z * z;
                    if square < reach * reach {
                        visit(&member.item, square);
                    }
                }
            }
        }
    }
}

/// Items by the number of their bin, in one piece of memory.
#[derive(Clone, Debug)]
pub struct Bins<T> {
    /// Bin after bin; within a bin in the order given.
    items: Vec<T>,
    /// [bin]: place in `items` of the bin's first item; the last entry is their number.
    starts: Vec<u32>,
}

impl<T> Bins<T> {
    /// Sorts items into bins 0 to `count` - 1; the items of a bin keep their order.
    ///
    /// # Panics
    /// If `bin_of` gives a number that is not below `count`.
    pub fn new(count: usize, mut items: Vec<T>, bin_of: impl Fn(&T) -> usize) -> Self {
        items.sort_by_key(&bin_of);
        let mut starts = vec![0u32; count + 1];
        for item in &items {
            starts[bin_of(item) + 1] += 1;
        }
        for bin in 1..starts.len() {
            starts[bin] += starts[bin - 1];
        }
        Self { items, starts }
    }

    /// The items of the bins from `first` to `last` inclusive.
    #[inline]
    pub fn run(&self, first: usize, last: usize) -> &[T] {
        &self.items[self.starts[first] as usize..self.starts[last + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a spiral, whose spread grows with `scale`.
    fn spiral(count: usize, scale: f64) -> Vec<[f64; 3]> {
        let point = |i: usize| {
            let t = 0.7 * i as f64;
            [
                scale * t * t.cos(),
                -scale * t * t.sin(),
                scale * (t - 40.0),
            ]
        };
        (0..count).map(point).collect()
    }

    /// Every point within reach is visited once: also where cells have grown, outside the grid, and for a lone point.
    #[test]
    fn all_points_within_reach_are_visited_once() {
        for (count, scale) in [(1, 1.0), (200, 0.3), (200, 1e4)] {
            let points = spiral(count, scale);
            let members = points.iter().enumerate();
            let members = members.map(|(item, &position)| Member { position, item });
            let list = CellList::new(members.collect(), 4.0);
            for center in points.iter().copied().chain([[1e3; 3], [-1e9, 0.0, 0.0]]) {
                for reach in [0.5, 6.0, 3.0 * scale] {
                    let square = |index: usize| -> f64 {
                        (0..3)
                            .map(|axis| (points[index][axis] - center[axis]).powi(2))
                            .sum()
                    };
                    let mut found = Vec::new();
                    list.visit_within(center, reach, |&item, own| {
                        assert_eq!(own, square(item));
                        found.push(item);
                    });
                    found.sort_unstable();
                    let near = |&index: &usize| square(index) < reach * reach;
                    assert_eq!(found, (0..count).filter(near).collect::<Vec<_>>());
                }
            }
        }
    }

    #[test]
    fn a_list_of_no_points_has_no_neighbours() {
        let list = CellList::<usize>::new(Vec::new(), 4.0);
        list.visit_within([0.0; 3], 1e9, |_, _| panic!("nothing to visit"));
    }

    #[test]
    fn items_of_a_bin_keep_their_order() {
        let bins = Bins::new(4, vec![31, 10, 30, 11], |item| item / 10);
        assert!(bins.run(0, 0).is_empty() && bins.run(2, 2).is_empty());
        assert_eq!(bins.run(3, 3), [31, 30]);
        assert_eq!(bins.run(0, 3), [10, 11, 31, 30]);
    }
}
