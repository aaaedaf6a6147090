//! The translations that are allowed at one rotation.
//!
//! The voxels of a cell of 4 by 4 by 4 can hold no more restraints than have a ball that meets the cell. This leaves
//! out most of the grid, and shows most rotations at which nothing is allowed. What remains is decided voxel by voxel,
//! and only where a search looks: in rows that hold its best value, at values that it would keep.

use crate::search::allowed::lanes::{Balls, Span};
use crate::search::allowed::slab::Slab;
use knotdock_scoring::peaks::ScoreGrid;
use knotdock_scoring::vectorized::vectorized;
use std::ops::Range;

/// Voxels along an edge of a cell.
const CELL: usize = 4;

/// The translations that are allowed at one rotation. Places are voxels in the order of coordinates, not of indices.
#[derive(Default)]
pub(crate) struct Region {
    counts: [usize; 3],
    /// Index of the voxel with the lowest coordinate on each axis.
    firsts: [usize; 3],
    /// Number of restraints that have to hold.
    needed: usize,
    balls: Balls,
    /// Voxels that a membrane takes out.
    slab: Option<Slab>,
    /// Whether each cell may hold an allowed voxel, row-major.
    open: Vec<bool>,
    /// Whether each row, by its index, may still hold voxels that are not allowed.
    unchecked: Vec<bool>,
    /// Squares of the remaining radii of the balls along a row.
    left: Vec<f32>,
}

impl Region {
    /// Begins a grid of `counts` voxels.
    pub fn begin(&mut self, counts: [usize; 3], firsts: [usize; 3], needed: usize) {
        (self.counts, self.firsts, self.needed) = (counts, firsts, needed);
        self.balls.clear();
    }

    /// Adds a restraint: balls by their centres and radii in voxels from the lowest one. Restraints of one ball come
    /// first.
    pub fn add(&mut self, balls: impl Iterator<Item = ([f64; 3], f64)>) {
        self.balls.add(balls);
    }

    /// Ends the restraints, takes a slab of voxels out, and finds the cells that may hold allowed voxels.
    pub(super) fn close(&mut self, slab: Option<Slab>) {
        self.balls.end();
        self.slab = slab;
        self.open.clear();
        let [nx, ny, nz] = self.counts;
        let Self {
            balls, open, left, ..
        } = self;
        vectorized(
            #[inline(always)]
            || {
                for x in cells(nx) {
                    for y in cells(ny) {
                        balls.left_along(span(&x), span(&y), left);
                        open.extend(cells(nz).map(|z| {
                            let spans = [span(&x), span(&y), span(&z)];
                            slab.is_none_or(|slab| slab.leaves(spans))
                                && balls.hold(spans[2], left, self.needed)
                        }));
                    }
                }
            },
        );
    }

    /// Whether it is known that nothing is allowed.
    pub fn is_empty(&self) -> bool {
        !self.open.contains(&true)
    }

    /// Takes all voxels of cells without an allowed voxel out of a grid.
    pub fn restrict(&mut self, scores: &mut ScoreGrid) {
        let [nx, ny, nz] = self.counts;
        self.unchecked.clear();
        self.unchecked.resize(nx * ny, true);
        scores.restrict(&mut |row, open| {
            for (cell, is_open) in cells(nz).zip(self.open_along(row)) {
                if !is_open {
                    for z in cell {
                        open[wrapped(z + self.firsts[2], nz)] = false;
                    }
                }
            }
        });
    }

    /// Clears the marks of a row's voxels that are not allowed. False if this has been done before. The row is one of
    /// the grid of [`Region::restrict`].
    pub fn check(&mut self, row: usize, open: &mut [bool]) -> bool {
        if !std::mem::take(&mut self.unchecked[row]) {
            return false;
        }
        let (x, y) = self.places(row);
        let Self { balls, left, .. } = self;
        let (count, first, slab) = (self.counts[2], self.firsts[2], self.slab);
        vectorized(
            #[inline(always)]
            || {
                balls.left_along(Span::new(x, x), Span::new(y, y), left);
                for (index, open) in open.iter_mut().enumerate().filter(|(_, open)| **open) {
                    let z = wrapped(index + count - first, count);
                    let spans = [x, y, z].map(|place| Span::new(place, place));
                    let is_out = slab.is_some_and(|slab| !slab.leaves(spans));
                    *open = !is_out && balls.hold(spans[2], left, self.needed);
                }
            },
        );
        true
    }

    /// Places of a row on the first two axes.
    fn places(&self, row: usize) -> (usize, usize) {
        let [nx, ny, _] = self.counts;
        let place = |index: usize, axis: usize, count: usize| {
            wrapped(index + count - self.firsts[axis], count)
        };
        (place(row / ny, 0, nx), place(row % ny, 1, ny))
    }

    /// The cells along a row.
    fn open_along(&self, row: usize) -> &[bool] {
        let [_, ny, nz] = self.counts.map(|count| count.div_ceil(CELL));
        let (x, y) = self.places(row);
        &self.open[(x / CELL * ny + y / CELL) * nz..][..nz]
    }

    /// Whether each voxel is allowed, by its index.
    #[cfg(test)]
    pub fn allowed(&mut self) -> Vec<bool> {
        let [nx, ny, nz] = self.counts;
        let mut scores = ScoreGrid::of_scores(self.counts, vec![0.0; nx * ny * nz]);
        self.restrict(&mut scores);
        let mut allowed: Vec<bool> = scores.iter().map(|score| score == 0.0).collect();
        for (row, open) in allowed.chunks_mut(nz).enumerate() {
            self.check(row, open);
        }
        allowed
    }
}

/// The cells along an axis.
fn cells(count: usize) -> impl Iterator<Item = Range<usize>> {
    let lows = (0..count).step_by(CELL);
    lows.map(move |low| low..(low + CELL).min(count))
}

/// An index below twice the count, brought below it. A division would take longer than all else that is done here.
#[inline(always)]
fn wrapped(index: usize, count: usize) -> usize {
    if index < count { index } else { index - count }
}

fn span(places: &Range<usize>) -> Span {
    Span::new(places.start, places.end - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock_scoring::peaks::PeakLimits;

    /// Adds balls by restraint.
    fn fill(region: &mut Region, balls: &[&[([f64; 3], f64)]]) {
        for restraint in balls {
            region.add(restraint.iter().copied());
        }
        region.close(None);
    }

    /// Counts of balls on a grid that wraps, against the definition at each voxel.
    #[test]
    fn voxels_that_enough_restraints_hold_are_allowed() {
        let counts = [9, 12, 70];
        let firsts = [4, 7, 33];
        let balls: [&[([f64; 3], f64)]; 4] = [
            &[([4.0, 5.0, 66.0], 40.0)],
            &[([3.0, 4.2, 30.0], 5.01)],
            &[([-3.0, 20.0, 5.0], 4.0)],
            &[
                ([5.0, 6.0, 33.0], 4.51),
                ([4.0, 6.0, 34.5], 3.0),
                ([0.0, 0.0, 0.0], 2.01),
            ],
        ];
        let mut region = Region::default();
        // One region serves several grids.
        for needed in [1, 2, 3, 4, 1] {
            region.begin(counts, firsts, needed);
            fill(&mut region, &balls);
            let holds = |ball: &([f64; 3], f64), at: [usize; 3]| {
                let square: f64 = (0..3).map(|k| (ball.0[k] - at[k] as f64).powi(2)).sum();
                square <= ball.1 * ball.1
            };
            let (mut allowed, mask) = (0, region.allowed());
            for voxel in 0..counts.iter().product() {
                let at = [voxel / (12 * 70), voxel / 70 % 12, voxel % 70];
                let held = balls
                    .iter()
                    .filter(|balls| balls.iter().any(|ball| holds(ball, at)));
                let expected = held.count() >= needed;
                let index = [0, 1, 2].map(|axis| (at[axis] + firsts[axis]) % counts[axis]);
                let [x, y, z] = index;
                let voxel = (x * counts[1] + y) * counts[2] + z;
                assert_eq!(mask[voxel], expected, "{needed} {at:?}");
                allowed += usize::from(expected);
            }
            assert_eq!(allowed > 0, needed < 4);
            assert_eq!(region.is_empty(), needed == 4);
        }
    }

    /// The peaks of a grid of which all voxels that are not allowed are taken out first, with and without a floor.
    #[test]
    fn peaks_are_those_of_the_allowed_voxels() {
        let size = [11, 9, 14];
        let mut region = Region::default();
        let value = |voxel: usize| (voxel * 7919 % 1386) as f32;
        let grid: Vec<f32> = (0..1386).map(value).collect();
        for radius in [1.0, 3.3, 5.2] {
            for floor in [f64::NEG_INFINITY, 1300.0] {
                region.begin(size, [2, 0, 7], 1);
                fill(&mut region, &[&[([3.0, 3.0, 3.0], radius)]]);
                let mut masked = grid.clone();
                for (value, allowed) in masked.iter_mut().zip(region.allowed()) {
                    if !allowed {
                        *value = f32::NEG_INFINITY;
                    }
                }
                let (mut expected, mut found) = (Vec::new(), Vec::new());
                let limits = PeakLimits { count: 9, floor };
                ScoreGrid::of_scores(size, masked).find_peaks(0, limits, &mut expected);
                let mut all = ScoreGrid::of_scores(size, grid.clone());
                region.restrict(&mut all);
                let check = &mut |row, open: &mut [bool]| region.check(row, open);
                all.find_peaks_among(0, limits, &mut found, check);
                assert_eq!(found, expected);
                assert_eq!(found.is_empty(), radius < 2.0 && floor > 0.0, "{found:?}");
            }
        }
    }
}
