//! Receptor knots in compact blocks of eight, side by side for vector registers, and the blocks within reach of a point.
//!
//! Halving along the longest axis puts neighbours together. Every set of blocks is a full binary tree up to its last branch, so
//! sixteen blocks in a row share a branch: one box test passes or drops them all.

use nalgebra::Vector3;

/// Knots in a block.
pub(super) const LANES: usize = 8;
/// Blocks in a group.
const GROUP: usize = 16;
/// Blocks that are listed before they are handed on.
const LISTED: usize = 256;

/// Eight neighbouring knots; where fewer are left, copies of the last with weight 0 fill it.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// [axis][knot], relative to the receptor's centre, in Å.
    pub positions: [[f64; LANES]; 3],
    pub weights: [f64; LANES],
    /// Radius classes.
    pub classes: [u32; LANES],
}

impl Block {
    /// Squared distances in Å^2 to a point.
    #[inline(always)]
    pub fn squares(&self, x: &[f64; 3]) -> [f64; LANES] {
        let mut squares = [0.0; LANES];
        for (positions, x) in self.positions.iter().zip(x) {
            for (square, position) in squares.iter_mut().zip(positions) {
                let d = x - position;
                *square += d * d;
            }
        }
        squares
    }
}

/// Bounding boxes: of a group and, [axis][block], of its blocks. A block that is not there has an empty box, infinitely far away.
struct Group {
    low: [f64; 3],
    high: [f64; 3],
    block_low: [[f64; GROUP]; 3],
    block_high: [[f64; GROUP]; 3],
}

/// All knots of a receptor.
pub(super) struct Blocks {
    blocks: Vec<Block>,
    /// Indices of the knots, block by block.
    order: Vec<usize>,
    groups: Vec<Group>,
}

impl Blocks {
    pub fn new(points: &[Vector3<f64>], weights: &[f64], classes: &[usize]) -> Self {
        let mut order: Vec<usize> = (0..points.len()).collect();
        halve(points, &mut order);
        let blocks: Vec<Block> = order
            .chunks(LANES)
            .map(|members| {
                let member = |lane: usize| members[lane.min(members.len() - 1)];
                Block {
                    positions: [0, 1, 2]
                        .map(|axis| std::array::from_fn(|lane| points[member(lane)][axis])),
                    weights: std::array::from_fn(|lane| {
                        members.get(lane).map_or(0.0, |&index| weights[index])
                    }),
                    classes: std::array::from_fn(|lane| classes[member(lane)] as u32),
                }
            })
            .collect();
        let groups = blocks
            .chunks(GROUP)
            .map(|members| {
                let bound = |start: f64, of: fn(f64, f64) -> f64| {
                    [0, 1, 2].map(|axis| {
                        std::array::from_fn::<f64, GROUP, _>(|index| {
                            members.get(index).map_or(start, |block| {
                                block.positions[axis].iter().copied().fold(start, of)
                            })
                        })
                    })
                };
                let block_low = bound(f64::INFINITY, f64::min);
                let block_high = bound(f64::NEG_INFINITY, f64::max);
                Group {
                    low: block_low.map(|lows| lows.into_iter().fold(f64::INFINITY, f64::min)),
                    high: block_high
                        .map(|highs| highs.into_iter().fold(f64::NEG_INFINITY, f64::max)),
                    block_low,
                    block_high,
                }
            })
            .collect();
        Self {
            blocks,
            order,
            groups,
        }
    }

    /// Something of each knot, laid out as the blocks are, `filler` where a block is not full.
    pub fn arranged<L: Copy>(&self, filler: L, of: impl Fn(usize) -> L) -> Vec<[L; LANES]> {
        self.order
            .chunks(LANES)
            .map(|members| {
                std::array::from_fn(|lane| members.get(lane).map_or(filler, |&index| of(index)))
            })
            .collect()
    }

    /// Visits the blocks whose boxes lie within `reach` of `x`, with their indices, always in the same order.
    ///
    /// Whether a box is within reach is a coin toss that no branch predictor wins, so blocks are listed always and counted only
    /// when near.
    #[inline(always)]
    pub fn near(&self, x: &[f64; 3], reach: f64, mut visit: impl FnMut(usize, &Block)) {
        let square_reach = reach * reach;
        let mut listed = [0u32; LISTED + GROUP];
        let mut groups = self.groups.iter().zip((0u32..).step_by(GROUP));
        loop {
            let mut count = 0;
            for (group, first) in groups.by_ref() {
                let square: f64 = (0..3)
                    .map(|axis| gap(x[axis], group.low[axis], group.high[axis]).powi(2))
                    .sum();
                if square >= square_reach {
                    continue;
                }
                let mut squares = [0.0; GROUP];
                for axis in 0..3 {
                    let (lows, highs) = (&group.block_low[axis], &group.block_high[axis]);
                    for (square, (low, high)) in squares.iter_mut().zip(lows.iter().zip(highs)) {
                        let gap = gap(x[axis], *low, *high);
                        *square += gap * gap;
                    }
                }
                for (square, block) in squares.into_iter().zip(first..) {
                    listed[count] = block;
                    count += usize::from(square < square_reach);
                }
                if count >= LISTED {
                    break;
                }
            }
            for &index in &listed[..count] {
                if let Some(block) = self.blocks.get(index as usize) {
                    visit(index as usize, block);
                }
            }
            if count < LISTED {
                return;
            }
        }
    }
}

/// Distance along one axis from a coordinate to an interval; 0 inside it. Comparisons rather than `f64::max`, whose care for NaN
/// costs a blend each.
#[inline(always)]
fn gap(x: f64, low: f64, high: f64) -> f64 {
    let (below, above) = (low - x, x - high);
    let outside = if below > above { below } else { above };
    if outside > 0.0 { outside } else { 0.0 }
}

/// Orders `members` so that blocks in a row are compact: halves along the longest axis of the box, the first half a power of two
/// of blocks; ties by index.
fn halve(points: &[Vector3<f64>], members: &mut [usize]) {
    if members.len() <= LANES {
        members.sort_unstable();
        return;
    }
    let mut low = Vector3::repeat(f64::INFINITY);
    let mut high = Vector3::repeat(f64::NEG_INFINITY);
    for &member in members.iter() {
        low = low.inf(&points[member]);
        high = high.sup(&points[member]);
    }
    let axis = (high - low).imax();
    let blocks = members.len().div_ceil(LANES);
    let left = LANES * (blocks.next_power_of_two() / 2);
    members.select_nth_unstable_by(left, |&a, &b| {
        points[a][axis].total_cmp(&points[b][axis]).then(a.cmp(&b))
    });
    let (first, second) = members.split_at_mut(left);
    halve(points, first);
    halve(points, second);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::Numbers;

    /// Every knot within reach must be visited, once, whatever the crowd: a spread cloud, coincident knots (no axis to halve
    /// along), knots 1e6 Å apart (boxes that a cell list could not hold), and counts around the sizes of blocks and groups.
    #[test]
    fn every_knot_within_reach_is_visited_once() {
        let mut numbers = Numbers(7);
        let mut next = || numbers.next();
        for count in [1, 7, 8, 9, 127, 128, 129, 2500] {
            for spread in [0.0, 30.0, 1e6] {
                let points: Vec<Vector3<f64>> = (0..count)
                    .map(|_| Vector3::new(spread * next(), spread * next(), spread * next()))
                    .collect();
                let weights: Vec<f64> = (0..count).map(|i| f64::from(i) + 1.0).collect();
                let blocks = Blocks::new(&points, &weights, &vec![0; points.len()]);
                for from in [points[0], points[0] + Vector3::new(3.0, -4.0, 5.0)] {
                    let reach = 9.0;
                    let x = from.into();
                    let mut found = Vec::new();
                    blocks.near(&x, reach, |_, block| {
                        for (square, weight) in block.squares(&x).iter().zip(block.weights) {
                            if *square < reach * reach && weight > 0.0 {
                                found.push(weight);
                            }
                        }
                    });
                    found.sort_by(f64::total_cmp);
                    let expected: Vec<f64> = points
                        .iter()
                        .zip(&weights)
                        .filter(|(point, _)| (from - *point).norm() < reach)
                        .map(|(_, &weight)| weight)
                        .collect();
                    assert_eq!(found, expected, "{count} knots over {spread} Å");
                }
            }
        }
    }
}
