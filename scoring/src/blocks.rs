//! The points of a body in compact blocks of eight, side by side for vector registers, and those within reach of a place.
//!
//! Halving along the longest axis puts neighbours together. Every set of blocks is a full binary tree up to its last
//! branch, so sixteen blocks in a row share a branch: one box test passes or drops them all. Sixteen boxes are tested at
//! a time. Of the blocks that pass, the points within reach are collected, so that the later and dearer steps handle
//! these alone.

// Loops over lanes index several arrays at once: as iterators they read worse and vectorise no better.
#![allow(clippy::needless_range_loop)]

use crate::distance_floors::DistanceFloors;
use crate::vectorized::with_simd;
use nalgebra::Vector3;
use pulp::Simd;
use std::any::Any;

/// Blocks in a group.
const GROUP: usize = 16;

/// Eight neighbouring points; where fewer are left, places infinitely far away fill it.
#[derive(Clone, Debug)]
struct Block {
    /// [axis][point], in Å.
    positions: [[f64; LANES]; 3],
}

impl Block {
    fn bounds(&self) -> Bounds {
        let side = |start: f64, of: fn(f64, f64) -> f64| {
            let places = |own: &[f64; LANES]| {
                own.iter()
                    .copied()
                    .filter(|x| x.is_finite())
                    .fold(start, of)
            };
            self.positions.each_ref().map(places)
        };
        [
            side(f64::INFINITY, f64::min),
            side(f64::NEG_INFINITY, f64::max),
        ]
    }

    /// Squared distances in Å^2 to a place.
    #[inline(always)]
    fn squares<S: Simd>(&self, simd: S, x: &[S::f64s; 3]) -> [f64; LANES] {
        let mut squares = [0.0; LANES];
        let [xs, ys, zs] = by_axis::<S, LANES>(&self.positions);
        for (index, square) in vectors_mut::<S>(&mut squares).iter_mut().enumerate() {
            let [x, y, z] = [
                simd.sub_f64s(x[0], xs[index]),
                simd.sub_f64s(x[1], ys[index]),
                simd.sub_f64s(x[2], zs[index]),
            ];
            let sum = simd.mul_add_e_f64s(y, y, simd.mul_f64s(x, x));
            *square = simd.mul_add_e_f64s(z, z, sum);
        }
        squares
    }
}

/// Low and high corner of a bounding box, in Å.
type Bounds = [[f64; 3]; 2];

/// Bounding boxes of sixteen blocks or groups, [axis][member]. A member that is not there has an empty box, infinitely
/// far away.
struct Boxes {
    low: [[f64; GROUP]; 3],
    high: [[f64; GROUP]; 3],
}

impl Boxes {
    fn of(members: &[Bounds]) -> Self {
        let side = |end: usize, missing: f64| {
            [0, 1, 2].map(|axis| {
                std::array::from_fn(|index| {
                    members
                        .get(index)
                        .map_or(missing, |bounds| bounds[end][axis])
                })
            })
        };
        Self {
            low: side(0, f64::INFINITY),
            high: side(1, f64::NEG_INFINITY),
        }
    }

    /// The box around all.
    fn whole(&self) -> Bounds {
        let low = self
            .low
            .map(|lows| lows.into_iter().fold(f64::INFINITY, f64::min));
        let high = self
            .high
            .map(|highs| highs.into_iter().fold(f64::NEG_INFINITY, f64::max));
        [low, high]
    }

    /// Those whose squared distance to a place is below a limit in Å^2, as bits.
    #[inline(always)]
    fn near<S: Simd>(&self, simd: S, x: &[S::f64s; 3], limit: f64) -> u32 {
        let mut squares = [0.0; GROUP];
        let zero = simd.splat_f64s(0.0);
        let (lows, highs) = (
            by_axis::<S, GROUP>(&self.low),
            by_axis::<S, GROUP>(&self.high),
        );
        for (index, square) in vectors_mut::<S>(&mut squares).iter_mut().enumerate() {
            let mut gaps = [zero; 3];
            for axis in 0..3 {
                let below = simd.sub_f64s(lows[axis][index], x[axis]);
                let above = simd.sub_f64s(x[axis], highs[axis][index]);
                gaps[axis] = simd.max_f64s(simd.max_f64s(below, above), zero);
            }
            let [x, y, z] = gaps;
            let sum = simd.mul_add_e_f64s(y, y, simd.mul_f64s(x, x));
            *square = simd.mul_add_e_f64s(z, z, sum);
        }
        let (halves, _) = squares.as_chunks::<HALF>();
        halves.iter().enumerate().fold(0, |near, (index, half)| {
            near | (below(simd, *half, limit) as u32) << (HALF * index)
        })
    }
}

/// The points of a body.
#[derive(Default)]
pub(crate) struct Blocks {
    blocks: Vec<Block>,
    /// Indices of the points, block by block.
    order: Vec<usize>,
    /// Boxes of the blocks, group by group.
    groups: Vec<Boxes>,
    /// Boxes of the groups, sixteen by sixteen.
    above: Vec<Boxes>,
    floors: Option<DistanceFloors>,
}

impl Blocks {
    /// Blocks that quickly tell places farther from all points than `reach`, a length above zero.
    pub fn within(points: &[Vector3<f64>], reach: f64) -> Self {
        Self {
            floors: Some(DistanceFloors::new(points, reach)),
            ..Self::new(points)
        }
    }

    pub fn new(points: &[Vector3<f64>]) -> Self {
        let mut order: Vec<usize> = (0..points.len()).collect();
        halve(points, &mut order);
        let blocks: Vec<Block> = order
            .chunks(LANES)
            .map(|members| Block {
                positions: [0, 1, 2].map(|axis| {
                    std::array::from_fn(|lane| {
                        members
                            .get(lane)
                            .map_or(f64::INFINITY, |&index| points[index][axis])
                    })
                }),
            })
            .collect();
        let bounds: Vec<Bounds> = blocks.iter().map(Block::bounds).collect();
        let groups: Vec<Boxes> = bounds.chunks(GROUP).map(Boxes::of).collect();
        let bounds: Vec<Bounds> = groups.iter().map(Boxes::whole).collect();
        Self {
            blocks,
            order,
            above: bounds.chunks(GROUP).map(Boxes::of).collect(),
            groups,
            floors: None,
        }
    }

    /// Whether no point can be within `reach` of `x`. `false` says nothing.
    #[inline(always)]
    pub fn excludes(&self, x: &[f64; 3], reach: f64) -> bool {
        let floors = self.floors.as_ref();
        floors.is_some_and(|floors| floors.excludes(&Vector3::from(*x), reach))
    }

    /// Number of blocks.
    pub fn len(&self) -> usize {
        self.blocks.len()
    }

    /// Positions of the points of a block by [axis][point], in Å; infinite where it has no point.
    pub fn positions(&self, block: usize) -> &[[f64; LANES]; 3] {
        &self.blocks[block].positions
    }

    /// Position in Å of a point, by its place in the order of the blocks.
    #[inline(always)]
    pub fn position(&self, point: u32) -> [f64; 3] {
        let (index, lane) = (point as usize / LANES, point as usize % LANES);
        debug_assert!(index < self.blocks.len());
        self.blocks.get(index).map_or([f64::INFINITY; 3], |block| {
            let [x, y, z] = &block.positions;
            [x[lane], y[lane], z[lane]]
        })
    }

    /// Something of each point, in the order of the blocks.
    pub fn arranged<L>(&self, of: impl Fn(usize) -> L) -> Vec<L> {
        self.order.iter().map(|&index| of(index)).collect()
    }

    /// Visits the numbers of the blocks whose boxes lie within `reach` of `x`, by rising number.
    #[inline(always)]
    fn visit_blocks<S: Simd>(&self, simd: S, x: &[f64; 3], reach: f64, mut visit: impl FnMut(u32)) {
        let square_reach = reach * reach;
        let everywhere = splat(simd, x);
        for (boxes, first) in self.above.iter().zip((0..).step_by(GROUP)) {
            let mut groups = boxes.near(simd, &everywhere, square_reach);
            while groups != 0 {
                let group: usize = first + groups.trailing_zeros() as usize;
                groups &= groups - 1;
                let Some(boxes) = self.groups.get(group) else {
                    debug_assert!(false, "a group that is not there lies within reach");
                    continue;
                };
                let mut blocks = boxes.near(simd, &everywhere, square_reach);
                while blocks != 0 {
                    visit((group * GROUP) as u32 + blocks.trailing_zeros());
                    blocks &= blocks - 1;
                }
            }
        }
    }

    /// Lists the points within `reach` of `x`, a part at a time and always in the same order, and visits each part.
    #[inline(always)]
    pub fn near<S: Simd>(
        &self,
        simd: S,
        x: &[f64; 3],
        reach: f64,
        near: &mut NearPoints,
        mut visit: impl FnMut(&NearPoints),
    ) {
        if self.excludes(x, reach) {
            return;
        }
        let everywhere = splat(simd, x);
        near.clear();
        self.visit_blocks(
            simd,
            x,
            reach,
            #[inline(always)]
            |index| self.add_near(simd, index, (&everywhere, reach), near, &mut visit),
        );
        if !near.is_empty() {
            near.fill();
            visit(near);
        }
    }

    /// As [`Self::near`] among the points of some blocks.
    #[inline(always)]
    pub fn near_among<S: Simd>(
        &self,
        simd: S,
        blocks: &[u32],
        (x, reach): (&[f64; 3], f64),
        near: &mut NearPoints,
        mut visit: impl FnMut(&NearPoints),
    ) {
        let everywhere = splat(simd, x);
        near.clear();
        for &index in blocks {
            self.add_near(simd, index, (&everywhere, reach), near, &mut visit);
        }
        if !near.is_empty() {
            near.fill();
            visit(near);
        }
    }

    /// Adds the points of a block within reach of a place. If there is no room, those before are visited first.
    #[inline(always)]
    fn add_near<S: Simd>(
        &self,
        simd: S,
        index: u32,
        (x, reach): (&[S::f64s; 3], f64),
        near: &mut NearPoints,
        visit: &mut impl FnMut(&NearPoints),
    ) {
        let Some(block) = self.blocks.get(index as usize) else {
            debug_assert!(false, "a block that is not there lies within reach");
            return;
        };
        if near.is_full() {
            near.fill();
            visit(near);
            near.clear();
        }
        near.add(
            simd,
            index * LANES as u32,
            &block.squares(simd, x),
            reach * reach,
        );
    }
}

/// The same for callers that are not compiled for wide vector registers themselves: each call finds them.
impl Blocks {
    /// As [`Self::near`].
    pub fn list_near(
        &self,
        x: &[f64; 3],
        reach: f64,
        near: &mut NearPoints,
        visit: impl FnMut(&NearPoints),
    ) {
        if self.excludes(x, reach) {
            return;
        }
        let blocks = self;
        with_simd!(
            <'a, F: FnMut(&NearPoints)>(
                blocks: &'a Blocks, x: &'a [f64; 3], reach: f64, near: &'a mut NearPoints, visit: F
            ) -> (),
            |simd| blocks.near(simd, x, reach, near, visit)
        );
    }

    /// As [`Self::visit_blocks`].
    pub fn list_blocks(&self, x: &[f64; 3], reach: f64, visit: impl FnMut(u32)) {
        if self.excludes(x, reach) {
            return;
        }
        let blocks = self;
        with_simd!(
            <'a, F: FnMut(u32)>(blocks: &'a Blocks, x: &'a [f64; 3], reach: f64, visit: F) -> (),
            |simd| blocks.visit_blocks(simd, x, reach, visit)
        );
    }
}

/// Orders `members` so that blocks in a row are compact: halves along the longest axis of the box, the first half a
/// power of two of blocks; ties by index.
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

/// Points in a block: what vector registers take together.
pub(crate) const LANES: usize = 8;

/// Points that are collected before they are handed on.
const CAPACITY: usize = 1024;

/// Lanes that are sorted at once.
const HALF: usize = 4;

/// For each set of half of the lanes, as bits: its lanes first, in order; and the same as halves of numbers.
static FRONT: [([u32; HALF], [u32; 2 * HALF]); 1 << HALF] = front();

const fn front() -> [([u32; HALF], [u32; 2 * HALF]); 1 << HALF] {
    let mut front = [([0; HALF], [0; 2 * HALF]); 1 << HALF];
    let mut mask = 0;
    while mask < 1 << HALF {
        let (mut lane, mut count) = (0, 0);
        while lane < HALF as u32 {
            if mask >> lane & 1 == 1 {
                front[mask].0[count] = lane;
                front[mask].1[2 * count] = 2 * lane;
                front[mask].1[2 * count + 1] = 2 * lane + 1;
                count += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    front
}

/// Which of four numbers are below a limit, as bits.
#[inline(always)]
fn below<S: Simd>(simd: S, values: [f64; HALF], limit: f64) -> usize {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = (&simd as &dyn Any).downcast_ref::<pulp::x86::V3>() {
        use core::arch::x86_64::{__m256d, _CMP_LT_OQ};
        let [values, limits]: [__m256d; 2] = [pulp::cast(values), pulp::cast([limit; HALF])];
        let below = simd.avx._mm256_cmp_pd::<_CMP_LT_OQ>(values, limits);
        return simd.avx._mm256_movemask_pd(below) as usize % (1 << HALF);
    }
    let _ = simd;
    let bits = values.iter().enumerate();
    bits.fold(0, |mask, (lane, &value)| {
        mask | usize::from(value < limit) << lane
    })
}

/// Four numbers, those of a set first.
#[inline(always)]
fn sorted<S: Simd>(simd: S, values: [f64; HALF], mask: usize) -> [f64; HALF] {
    let (lanes, halves) = &FRONT[mask];
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = (&simd as &dyn Any).downcast_ref::<pulp::x86::V3>() {
        let order = pulp::cast(*halves);
        let sorted = simd
            .avx2
            ._mm256_permutevar8x32_ps(pulp::cast(values), order);
        return pulp::cast(sorted);
    }
    let _ = (simd, halves);
    let mut sorted = [0.0; HALF];
    for (to, &lane) in sorted.iter_mut().zip(lanes) {
        *to = values[lane as usize % HALF];
    }
    sorted
}

/// Points within reach of another.
pub(crate) struct NearPoints {
    /// Squared distances in Å^2.
    squares: [f64; CAPACITY],
    /// Places in the order of the blocks.
    points: [u32; CAPACITY],
    count: usize,
}

impl Default for NearPoints {
    fn default() -> Self {
        Self {
            squares: [0.0; CAPACITY],
            points: [0; CAPACITY],
            count: 0,
        }
    }
}

impl NearPoints {
    /// Whether another eight might find no room.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        self.count > CAPACITY - LANES
    }

    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    #[inline(always)]
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds those of eight points, the first of which is `first`, that are nearer than the root of `square_reach`.
    /// Whether one is near is a coin toss that no branch predictor wins, so all are written, the near ones first, and only
    /// these are counted.
    #[inline(always)]
    pub fn add<S: Simd>(&mut self, simd: S, first: u32, squares: &[f64; LANES], square_reach: f64) {
        debug_assert!(!self.is_full());
        let (halves, _) = squares.as_chunks::<HALF>();
        for (half, first) in halves.iter().zip((first..).step_by(HALF)) {
            let mask = below(simd, *half, square_reach);
            let from = self.count.min(CAPACITY - HALF);
            self.squares[from..from + HALF].copy_from_slice(&sorted(simd, *half, mask));
            for (to, lane) in self.points[from..from + HALF].iter_mut().zip(FRONT[mask].0) {
                *to = first + lane;
            }
            self.count = from + mask.count_ones() as usize;
        }
    }

    /// Fills up the last eight with places infinitely far away.
    #[inline(always)]
    pub fn fill(&mut self) {
        for place in self.count..self.count.next_multiple_of(LANES) {
            if let (Some(square), Some(point)) =
                (self.squares.get_mut(place), self.points.get_mut(place))
            {
                (*square, *point) = (f64::INFINITY, 0);
            }
        }
    }

    /// Squared distances and places, eight by eight.
    #[inline(always)]
    pub fn eights(&self) -> impl Iterator<Item = (&[f64; LANES], &[u32; LANES])> {
        let filled = self.count.div_ceil(LANES);
        let (squares, _) = self.squares.as_chunks();
        let (points, _) = self.points.as_chunks();
        squares.iter().zip(points).take(filled)
    }

    /// Squared distances and places one by one, without what fills up the last eight.
    #[inline(always)]
    pub fn pairs(&self) -> impl Iterator<Item = (f64, u32)> {
        let pairs = self.squares.iter().zip(&self.points).take(self.count);
        pairs.map(|(&square, &point)| (square, point))
    }
}

/// Four, eight or sixteen numbers as vectors.
#[inline(always)]
pub(crate) fn vectors<S: Simd>(values: &[f64]) -> &[S::f64s] {
    const { assert!(S::F64_LANES <= 4, "longer vectors would leave numbers out") };
    S::as_simd_f64s(values).0
}

// Written out, unlike `map` of arrays: its closures are not inlined, and have no wide registers.

/// [`vectors`] of each axis.
#[inline(always)]
fn by_axis<S: Simd, const N: usize>([x, y, z]: &[[f64; N]; 3]) -> [&[S::f64s]; 3] {
    [vectors::<S>(x), vectors::<S>(y), vectors::<S>(z)]
}

/// A place in every lane.
#[inline(always)]
fn splat<S: Simd>(simd: S, [x, y, z]: &[f64; 3]) -> [S::f64s; 3] {
    [
        simd.splat_f64s(*x),
        simd.splat_f64s(*y),
        simd.splat_f64s(*z),
    ]
}

/// Four, eight or sixteen numbers as vectors to write to.
#[inline(always)]
pub(crate) fn vectors_mut<S: Simd>(values: &mut [f64]) -> &mut [S::f64s] {
    const { assert!(S::F64_LANES <= 4, "longer vectors would leave numbers out") };
    S::as_mut_simd_f64s(values).0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::Numbers;
    use pulp::Scalar;

    /// Every point within reach is visited exactly once. Cases: a spread cloud, coincident points (no axis to halve
    /// along), points at distances of 1e6 Å (boxes that a cell list could not hold), counts around the sizes of blocks
    /// and groups.
    #[test]
    fn every_point_within_reach_is_visited_once() {
        let mut numbers = Numbers(7);
        let mut next = || numbers.next();
        for count in [1, 7, 8, 9, 127, 128, 129, 2500] {
            for spread in [0.0, 30.0, 1e6] {
                let points: Vec<Vector3<f64>> = (0..count)
                    .map(|_| Vector3::new(spread * next(), spread * next(), spread * next()))
                    .collect();
                for blocks in [Blocks::new(&points), Blocks::within(&points, 9.0)] {
                    let numbers = blocks.arranged(|index| index);
                    for from in [points[0], points[0] + Vector3::new(3.0, -4.0, 5.0)] {
                        let reach = 9.0;
                        let x = from.into();
                        let mut found = Vec::new();
                        blocks.near(Scalar, &x, reach, &mut NearPoints::default(), |near| {
                            for (square, point) in near.pairs() {
                                let number = numbers[point as usize];
                                let distance = (from - points[number]).norm_squared();
                                assert!((square - distance).abs() <= 1e-12 * distance);
                                found.push(number);
                            }
                        });
                        found.sort_unstable();
                        let expected: Vec<usize> = (0..points.len())
                            .filter(|&index| (from - points[index]).norm() < reach)
                            .collect();
                        assert_eq!(found, expected, "{count} points over {spread} Å");
                        let mut listed = Vec::new();
                        blocks.list_near(&x, reach, &mut NearPoints::default(), |near| {
                            listed.extend(near.pairs().map(|(_, point)| numbers[point as usize]));
                        });
                        listed.sort_unstable();
                        assert_eq!(listed, expected, "{count} points over {spread} Å");
                        let mut among = Vec::new();
                        blocks.list_blocks(&x, 2.0 * reach, |block| among.push(block));
                        let mut of_blocks = Vec::new();
                        let near = &mut NearPoints::default();
                        blocks.near_among(Scalar, &among, (&x, reach), near, |near| {
                            of_blocks
                                .extend(near.pairs().map(|(_, point)| numbers[point as usize]));
                        });
                        of_blocks.sort_unstable();
                        assert_eq!(of_blocks, expected);
                    }
                }
            }
        }
    }
}
