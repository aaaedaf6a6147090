//! Peak picking: the best voxels of one rotation's correlation, at a distance from one another.

use crate::transform::Real;
use crate::vectorized::vectorized;

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

/// Appends the `count` best voxels of a periodic grid to `found`, best first, of those that score `floor` or more.
///
/// Each lies at least [`NEIGHBOURS`] + 1 voxels from the others along some axis. Ties go to the lower voxel. Fewer are
/// found where the neighbourhoods of those found leave nothing. `grid` is (nx, ny, nz) row-major, `row_best` holds the
/// largest value of each row (x, y); both are overwritten with minus infinity around peaks. Values must not be NaN.
pub fn find_peaks<T: Real>(
    size: [usize; 3],
    (grid, row_best): (&mut [T], &mut [T]),
    rotation: u32,
    (count, floor): (usize, f64),
    found: &mut Vec<Peak>,
) {
    find_peaks_among(
        size,
        (grid, row_best),
        rotation,
        (count, floor),
        found,
        |_, _| false,
    );
}

/// [`find_peaks`] among the voxels that `check` leaves.
///
/// It is called with a row that holds the largest value, and the row's values. It sets those that may be no peak to
/// minus infinity and returns true, or returns false where it has done so before.
pub fn find_peaks_among<T: Real>(
    size: [usize; 3],
    (grid, row_best): (&mut [T], &mut [T]),
    rotation: u32,
    (count, floor): (usize, f64),
    found: &mut Vec<Peak>,
    mut check: impl FnMut(usize, &mut [T]) -> bool,
) {
    vectorized(
        #[inline(always)]
        || {
            find(
                size,
                (grid, row_best),
                rotation,
                (count, floor),
                found,
                &mut check,
            )
        },
    );
}

#[inline(always)]
fn find<T: Real>(
    size: [usize; 3],
    (grid, row_best): (&mut [T], &mut [T]),
    rotation: u32,
    (count, floor): (usize, f64),
    found: &mut Vec<Peak>,
    check: &mut impl FnMut(usize, &mut [T]) -> bool,
) {
    let [nx, ny, nz] = size;
    let side = |n: usize| NEIGHBOURS.min((n - 1) / 2) as isize;
    let mut left = count;
    while left > 0 {
        let Some((row, score)) = best(row_best) else {
            return;
        };
        if score.wide() < floor {
            return;
        }
        let values = &mut grid[row * nz..(row + 1) * nz];
        if check(row, values) {
            row_best[row] = largest(values);
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
                let wrap =
                    |i: usize, d: isize, n: usize| (i as isize + d).rem_euclid(n as isize) as usize;
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

    #[test]
    fn peaks_are_the_best_and_spaced_across_the_periodic_edge() {
        let size = [8, 8, 8];
        let mut grid = vec![0.0f32; 512];
        let at = |x: usize, y: usize, z: usize| (x * 8 + y) * 8 + z;
        grid[at(0, 0, 0)] = 9.0;
        grid[at(7, 7, 7)] = 8.0; // a neighbour of the first through the edge
        grid[at(4, 4, 4)] = 7.0;
        grid[at(4, 4, 1)] = 7.0; // a tie: the lower voxel comes first
        let mut rows: Vec<f32> = grid
            .chunks(8)
            .map(|r| r.iter().copied().fold(f32::MIN, f32::max))
            .collect();
        let mut found = Vec::new();
        let values = (&mut grid[..], &mut rows[..]);
        find_peaks(size, values, 5, (3, 7.0), &mut found);
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
            let grid: Vec<f64> = (0..nx * ny * nz)
                .map(|_| (40.0 * numbers.next()).floor() - 20.0)
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
                expected.push((best, grid[best]));
            }
            let rows: Vec<f64> = grid.chunks(nz).map(largest).collect();
            for floor in [f64::NEG_INFINITY, 17.0, 100.0] {
                let (mut grid, mut rows) = (grid.clone(), rows.clone());
                let mut found = Vec::new();
                let values = (&mut grid[..], &mut rows[..]);
                find_peaks(size, values, 0, (30, floor), &mut found);
                let found = found.iter().map(|p| (p.voxel as usize, p.score));
                let expected = expected.iter().filter(|(_, score)| *score >= floor);
                assert!(found.eq(expected.copied()), "{size:?}");
            }
        }
    }

    #[test]
    fn a_tiny_grid_gives_all_its_voxels() {
        let mut grid = [1.0f32, 2.0];
        let mut rows = [2.0f32];
        let mut found = Vec::new();
        let values = (&mut grid[..], &mut rows[..]);
        find_peaks([1, 1, 2], values, 0, (5, f64::NEG_INFINITY), &mut found);
        assert_eq!(found.len(), 2);
    }
}
