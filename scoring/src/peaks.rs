//! Peak picking: the best voxels of one rotation's correlation, at a distance from one another.

use crate::precision::{InPrecision, of_precision};
use crate::transform::Real;
use crate::vectorized::vectorize;

/// A grid pose: rotation and voxel, with the fast path's score.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Score on the grid.
    pub score: f64,
    /// Index in the rotation set.
    pub rotation: u32,
    /// Voxel, row-major: plans refuse grids of more points than 32 bits number.
    pub voxel: u32,
}

impl Peak {
    /// Best first; ties by rotation, then voxel, so that the order never depends on threads.
    pub fn order(&self, other: &Self) -> std::cmp::Ordering {
        other
            .score
            .total_cmp(&self.score)
            .then(self.rotation.cmp(&other.rotation))
            .then(self.voxel.cmp(&other.voxel))
    }
}

/// Voxels next to a peak, on each axis and side, that hold no further peak.
pub const NEIGHBOURS: usize = 2;

/// Limits of a search for peaks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeakLimits {
    /// Number of peaks.
    pub count: usize,
    /// Least score.
    pub floor: f64,
}

/// Scores of all translations at one rotation, (nx, ny, nz) row-major, in single or double precision.
#[derive(Clone, Debug, PartialEq)]
pub struct ScoreGrid(pub(crate) InPrecision<Rows<f32>, Rows<f64>>);

/// Scores in one floating-point type.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rows<T> {
    size: [usize; 3],
    pub values: Vec<T>,
    /// Largest score of each row (x, y).
    pub best: Vec<T>,
    /// Whether each voxel of a row may hold a peak.
    open: Vec<bool>,
}

impl ScoreGrid {
    /// A grid of given scores, in single precision.
    ///
    /// # Panics
    /// If there is not one score per voxel.
    pub fn of_scores(size: [usize; 3], scores: Vec<f32>) -> Self {
        let mut rows = Rows::new(size);
        assert_eq!(scores.len(), rows.values.len(), "one score per voxel");
        rows.values = scores;
        for (row, best) in rows.values.chunks_exact(size[2]).zip(&mut rows.best) {
            *best = largest(row);
        }
        Self(InPrecision::Single(rows))
    }

    /// Number of voxels.
    pub fn count(&self) -> usize {
        of_precision!(&self.0, rows => rows.values.len())
    }

    /// Score of a voxel.
    pub fn score(&self, voxel: usize) -> f64 {
        of_precision!(&self.0, rows => rows.values[voxel].wide())
    }

    /// Scores of all voxels.
    pub fn iter(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.count()).map(|voxel| self.score(voxel))
    }

    /// Scores of all voxels as an array.
    pub fn to_vec(&self) -> Vec<f64> {
        self.iter().collect()
    }

    /// Takes voxels out: `open` gets each row with a mark for each of its voxels, and clears those that may be no peak.
    /// Their scores become minus infinity.
    pub fn restrict(&mut self, open: &mut dyn FnMut(usize, &mut [bool])) {
        of_precision!(&mut self.0, rows => rows.restrict(open));
    }

    /// Appends the best voxels to `found`, best first.
    ///
    /// Each is at least [`NEIGHBOURS`] + 1 voxels from the others along some axis of the periodic grid; ties go to the
    /// lower voxel. Scores around peaks are overwritten with minus infinity. Scores must not be NaN.
    pub fn find_peaks(&mut self, rotation: u32, limits: PeakLimits, found: &mut Vec<Peak>) {
        self.find_peaks_among(rotation, limits, found, &mut |_, _| false);
    }

    /// [`Self::find_peaks`] among the voxels that `check` leaves.
    ///
    /// It gets a row that holds the largest score, with a mark for each voxel that may be a peak, clears those that may
    /// be none and returns true. It returns false for a row that it has checked before.
    pub fn find_peaks_among(
        &mut self,
        rotation: u32,
        limits: PeakLimits,
        found: &mut Vec<Peak>,
        check: &mut dyn FnMut(usize, &mut [bool]) -> bool,
    ) {
        of_precision!(&mut self.0, rows => rows.find(rotation, limits, found, check));
    }
}

impl<T: Real> Rows<T> {
    /// All zero.
    pub fn new(size: [usize; 3]) -> Self {
        let [nx, ny, nz] = size;
        Self {
            size,
            values: vec![T::zero(); nx * ny * nz],
            best: vec![T::zero(); nx * ny],
            open: vec![true; nz],
        }
    }

    fn restrict(&mut self, open: &mut dyn FnMut(usize, &mut [bool])) {
        let rows = self.values.chunks_exact_mut(self.size[2]);
        for (row, (values, best)) in rows.zip(&mut self.best).enumerate() {
            self.open.fill(true);
            open(row, &mut self.open);
            vectorize!(*best = keep(&self.open, values));
        }
    }

    fn find(
        &mut self,
        rotation: u32,
        limits: PeakLimits,
        found: &mut Vec<Peak>,
        check: &mut dyn FnMut(usize, &mut [bool]) -> bool,
    ) {
        vectorize!(self.find_inline(rotation, limits, found, check));
    }

    #[inline(always)]
    fn find_inline(
        &mut self,
        rotation: u32,
        limits: PeakLimits,
        found: &mut Vec<Peak>,
        check: &mut dyn FnMut(usize, &mut [bool]) -> bool,
    ) {
        let Self {
            size: [nx, ny, nz],
            values: grid,
            best: row_best,
            open,
        } = self;
        let (nx, ny, nz) = (*nx, *ny, *nz);
        let side = |n: usize| NEIGHBOURS.min((n - 1) / 2) as isize;
        let mut left = limits.count;
        while left > 0 {
            let Some((row, score)) = best(row_best) else {
                return;
            };
            if score.wide() < limits.floor {
                return;
            }
            let values = &mut grid[row * nz..(row + 1) * nz];
            for (open, value) in open.iter_mut().zip(&*values) {
                *open = *value > T::neg_infinity() && value.wide() >= limits.floor;
            }
            if check(row, open) {
                row_best[row] = keep(open, values);
                continue;
            }
            let Some((z, _)) = best(values) else {
                return;
            };
            left -= 1;
            found.push(Peak {
                score: score.wide(),
                rotation,
                voxel: (row * nz + z) as u32,
            });
            let (x, y) = (row / ny, row % ny);
            for dx in -side(nx)..=side(nx) {
                for dy in -side(ny)..=side(ny) {
                    let wrap = |i: usize, d: isize, n: usize| {
                        (i as isize + d).rem_euclid(n as isize) as usize
                    };
                    let row = wrap(x, dx, nx) * ny + wrap(y, dy, ny);
                    let values = &mut grid[row * nz..(row + 1) * nz];
                    for dz in -side(nz)..=side(nz) {
                        values[wrap(z, dz, nz)] = T::neg_infinity();
                    }
                    row_best[row] = largest(values);
                }
            }
        }
    }
}

/// Sets the values of a row that are not open to minus infinity; returns the largest of the others.
#[inline(always)]
fn keep<T: Real>(open: &[bool], values: &mut [T]) -> T {
    for (value, open) in values.iter_mut().zip(open) {
        *value = if *open { *value } else { T::neg_infinity() };
    }
    largest(values)
}

/// Largest of some values, in lanes so that it vectorises.
#[inline(always)]
pub(crate) fn largest<T: Real>(values: &[T]) -> T {
    let larger = |a: T, b: T| if b > a { b } else { a };
    let (chunks, rest) = values.as_chunks::<16>();
    let mut lanes = [T::neg_infinity(); 16];
    for chunk in chunks {
        for lane in 0..16 {
            lanes[lane] = larger(lanes[lane], chunk[lane]);
        }
    }
    lanes
        .iter()
        .chain(rest)
        .fold(T::neg_infinity(), |a, &b| larger(a, b))
}

/// First of the largest finite values, with its index.
#[inline(always)]
fn best<T: Real>(values: &[T]) -> Option<(usize, T)> {
    let largest = largest(values);
    if largest == T::neg_infinity() {
        return None;
    }
    let (chunks, rest) = values.as_chunks::<16>();
    // Whole chunks first, so that the search vectorises.
    let holds = |chunk: &[T; 16]| chunk.iter().fold(false, |any, &v| any | (v == largest));
    let (start, part) = match chunks.iter().position(holds) {
        Some(chunk) => (16 * chunk, &chunks[chunk][..]),
        None => (16 * chunks.len(), rest),
    };
    let index = part.iter().position(|&value| value == largest)?;
    Some((start + index, largest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::Numbers;

    fn limits(count: usize, floor: f64) -> PeakLimits {
        PeakLimits { count, floor }
    }

    #[test]
    fn peaks_are_the_best_and_spaced_across_the_periodic_edge() {
        let size = [8, 8, 8];
        let mut grid = vec![0.0f32; 512];
        let at = |x: usize, y: usize, z: usize| (x * 8 + y) * 8 + z;
        grid[at(0, 0, 0)] = 9.0;
        grid[at(7, 7, 7)] = 8.0; // a neighbour of the first through the edge
        grid[at(4, 4, 4)] = 7.0;
        grid[at(4, 4, 1)] = 7.0; // a tie: the lower voxel comes first
        let mut found = Vec::new();
        let mut grid = ScoreGrid::of_scores(size, grid);
        grid.find_peaks(5, limits(3, 7.0), &mut found);
        let voxels: Vec<u32> = found.iter().map(|p| p.voxel).collect();
        assert_eq!(
            voxels,
            [at(0, 0, 0), at(4, 4, 1), at(4, 4, 4)].map(|v| v as u32)
        );
        assert!(found.iter().all(|p| p.rotation == 5));
    }

    /// Against the definition: of all voxels that no earlier peak excludes, the best, the lowest of equals.
    #[test]
    fn agrees_with_brute_force() {
        let mut numbers = Numbers(7);
        for size in [[5, 6, 7], [4, 9, 3], [1, 2, 8], [12, 5, 10]] {
            let [nx, ny, nz] = size;
            // Few distinct values, so that ties are common.
            let grid: Vec<f32> = (0..nx * ny * nz)
                .map(|_| (40.0 * numbers.next()).floor() as f32 - 20.0)
                .collect();
            let mut expected: Vec<(usize, f64)> = Vec::new();
            let near = |a: usize, b: usize| {
                let index = |v: usize| [v / (ny * nz), v / nz % ny, v % nz];
                let (a, b) = (index(a), index(b));
                (0..3).all(|axis| {
                    let direct = a[axis].abs_diff(b[axis]);
                    // On an axis of fewer than five voxels as many as fit around one without overlap.
                    let side = NEIGHBOURS.min((size[axis] - 1) / 2);
                    direct.min(size[axis] - direct) <= side
                })
            };
            while expected.len() < 30 {
                let free = (0..grid.len()).filter(|&v| expected.iter().all(|&(p, _)| !near(v, p)));
                let Some(best) = free.reduce(|a, b| if grid[b] > grid[a] { b } else { a }) else {
                    break;
                };
                expected.push((best, f64::from(grid[best])));
            }
            let grid = ScoreGrid::of_scores(size, grid);
            for floor in [f64::NEG_INFINITY, 17.0, 100.0] {
                let mut found = Vec::new();
                grid.clone().find_peaks(0, limits(30, floor), &mut found);
                let found = found.iter().map(|p| (p.voxel as usize, p.score));
                let expected = expected.iter().filter(|(_, score)| *score >= floor);
                assert!(found.eq(expected.copied()), "{size:?}");
            }
        }
    }

    #[test]
    fn a_tiny_grid_gives_all_its_voxels() {
        let mut found = Vec::new();
        let mut grid = ScoreGrid::of_scores([1, 1, 2], vec![1.0, 2.0]);
        grid.find_peaks(0, limits(5, f64::NEG_INFINITY), &mut found);
        assert_eq!(found.len(), 2);
    }
}
