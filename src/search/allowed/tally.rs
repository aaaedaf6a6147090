//! Counts of restraints by voxel, a row of voxels to a word of bits.
//!
//! A ball covers an interval of each row that it meets. Bits of a row are added to counters whose binary digits are
//! words themselves, so that 64 voxels are counted by a few operations. A row that too few restraints have met is
//! given up.

use knotdock_scoring::peaks::{NEIGHBOURS, largest_of};
use knotdock_scoring::transform::Real;

/// Voxels in a word.
const WORD: usize = u64::BITS as usize;

/// Counts of restraints by voxel. Rows and places in them are in the order of coordinates, not of indices.
#[derive(Default)]
pub(crate) struct Tally {
    counts: [usize; 3],
    /// Words of a row.
    words: usize,
    /// Binary digits of a counter.
    digits: usize,
    /// Restraints in all, how many have to hold, and how many came.
    restraints: usize,
    needed: usize,
    came: usize,
    /// Restraints that meet each row.
    met: Vec<u32>,
    /// [row][digit][word].
    counters: Vec<u64>,
    /// [row][word]: voxels of the restraint at hand, and the rows that it meets.
    own: Vec<u64>,
    own_rows: Vec<usize>,
}

/// Voxels that are allowed.
#[derive(Default)]
pub(crate) struct RowMask {
    /// Indices (x, y) of the rows that hold any.
    rows: Vec<[usize; 2]>,
    /// [row][word], in the order of coordinates.
    bits: Vec<u64>,
    words: usize,
    /// Index of the voxel with the lowest coordinate.
    first: usize,
    /// Whether a row is near one that holds any.
    near: Vec<bool>,
}

impl Tally {
    /// Begins a grid of so many voxels, on which `needed` of so many restraints have to hold.
    pub fn begin(&mut self, counts: [usize; 3], (restraints, needed): (usize, usize)) {
        let rows = counts[0] * counts[1];
        self.words = counts[2].div_ceil(WORD);
        self.digits = (usize::BITS - restraints.leading_zeros()) as usize;
        self.counts = counts;
        (self.restraints, self.needed, self.came) = (restraints, needed.max(1), 0);
        self.met.clear();
        self.met.resize(rows, 0);
        // Counters of a row are cleared when it is first met.
        self.counters.resize(rows * self.digits * self.words, 0);
        self.own.clear();
        self.own.resize(rows * self.words, 0);
    }

    /// Adds a restraint: balls by their centres and radii in voxels from the lowest one.
    pub fn add(&mut self, balls: impl Iterator<Item = ([f64; 3], f64)>) {
        self.came += 1;
        for (center, radius) in balls {
            self.cover(center, radius);
        }
        let (words, digits) = (self.words, self.digits);
        for row in self.own_rows.drain(..) {
            let counters = &mut self.counters[row * digits * words..][..digits * words];
            if self.met[row] == 0 {
                counters.fill(0);
            }
            self.met[row] += 1;
            for (word, own) in self.own[row * words..][..words].iter_mut().enumerate() {
                let mut carry = std::mem::take(own);
                for digit in 0..digits {
                    let counter = &mut counters[digit * words + word];
                    (*counter, carry) = (*counter ^ carry, *counter & carry);
                }
            }
        }
    }

    /// Marks the voxels of a ball of the restraint at hand, in rows that enough restraints may still meet.
    fn cover(&mut self, [x, y, z]: [f64; 3], radius: f64) {
        let [nx, ny, nz] = self.counts;
        // By conversions: where the machine's rounding instructions are not compiled for, `ceil` and `floor` are calls.
        let range = |at: f64, reach: f64, count: usize| {
            let (low, high) = (at - reach, at + reach);
            if high < 0.0 || low > count as f64 - 1.0 {
                return None;
            }
            let from = low.max(0.0) as usize;
            let from = from + usize::from((from as f64) < low);
            let to = (high as usize).min(count - 1);
            (from <= to).then_some((from, to))
        };
        let Some((first, last)) = range(x, radius, nx) else {
            return;
        };
        let to_come = (self.restraints - self.came) as u32 + 1;
        for row_x in first..=last {
            let flat = radius * radius - (row_x as f64 - x).powi(2);
            let Some((first, last)) = range(y, flat.max(0.0).sqrt(), ny) else {
                continue;
            };
            for row_y in first..=last {
                let row = row_x * ny + row_y;
                if self.met[row] + to_come < self.needed as u32 {
                    continue;
                }
                let half = (flat - (row_y as f64 - y).powi(2)).max(0.0).sqrt();
                if let Some(interval) = range(z, half, nz) {
                    let bits = &mut self.own[row * self.words..][..self.words];
                    if bits.iter().all(|word| *word == 0) {
                        self.own_rows.push(row);
                    }
                    set(bits, interval);
                }
            }
        }
    }

    /// The voxels at which enough restraints hold. `firsts` are the indices of the lowest voxels on each axis.
    pub fn finish(&self, firsts: [usize; 3], mask: &mut RowMask) {
        mask.rows.clear();
        mask.bits.clear();
        (mask.words, mask.first) = (self.words, firsts[2]);
        let (words, digits) = (self.words, self.digits);
        for (row, _) in (0..)
            .zip(&self.met)
            .filter(|(_, met)| **met >= self.needed as u32)
        {
            let counters = &self.counters[row * digits * words..][..digits * words];
            let before = mask.bits.len();
            let mut any = 0;
            for word in 0..words {
                let (mut more, mut equal) = (0u64, !0u64);
                for digit in (0..digits).rev() {
                    let counter = counters[digit * words + word];
                    if self.needed >> digit & 1 == 1 {
                        equal &= counter;
                    } else {
                        more |= equal & counter;
                        equal &= !counter;
                    }
                }
                any |= more | equal;
                mask.bits.push(more | equal);
            }
            if any == 0 {
                mask.bits.truncate(before);
                continue;
            }
            let [nx, ny, _] = self.counts;
            let (x, y) = (row / ny, row % ny);
            mask.rows.push([(x + firsts[0]) % nx, (y + firsts[1]) % ny]);
        }
    }
}

/// Sets the bits from the first to the last, both included.
fn set(bits: &mut [u64], (first, last): (usize, usize)) {
    for (word, bits) in bits.iter_mut().enumerate() {
        let start = word * WORD;
        if last < start || first >= start + WORD {
            continue;
        }
        let from = first.saturating_sub(start);
        let to = (last - start).min(WORD - 1);
        *bits |= (!0u64 >> (WORD - 1 - to)) & (!0u64 << from);
    }
}

impl RowMask {
    /// Whether nothing is allowed.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Whether a voxel is allowed, by its indices.
    #[cfg(test)]
    pub fn allows(&self, size: [usize; 3], index: [usize; 3]) -> bool {
        let place = (index[2] + size[2] - self.first) % size[2];
        let row = self
            .rows
            .iter()
            .position(|row| *row == [index[0], index[1]]);
        row.is_some_and(|row| self.bits[row * self.words + place / WORD] >> (place % WORD) & 1 == 1)
    }

    /// Sets what is not allowed to minus infinity wherever peaks may be looked for, and updates each row's largest
    /// value. A search for peaks reads rows by their largest value, and the neighbours of the rows with peaks.
    pub fn apply<T: Real>(&mut self, [nx, ny, nz]: [usize; 3], grid: &mut [T], row_best: &mut [T]) {
        row_best.fill(T::neg_infinity());
        self.near.clear();
        self.near.resize(nx * ny, false);
        let beside = |at: usize, count: usize| {
            let side = NEIGHBOURS.min((count - 1) / 2);
            (0..=2 * side).map(move |step| (at + count + step - side) % count)
        };
        for &[x, y] in &self.rows {
            for x in beside(x, nx) {
                for y in beside(y, ny) {
                    self.near[x * ny + y] = true;
                }
            }
        }
        for (&[x, y], bits) in self.rows.iter().zip(self.bits.chunks(self.words)) {
            let row = x * ny + y;
            self.near[row] = false;
            let values = &mut grid[row * nz..][..nz];
            for (index, value) in values.iter_mut().enumerate() {
                let place = (index + nz - self.first) % nz;
                if bits[place / WORD] >> (place % WORD) & 1 == 0 {
                    *value = T::neg_infinity();
                }
            }
            row_best[row] = largest_of(values);
        }
        for (row, _) in (0..).zip(&self.near).filter(|(_, near)| **near) {
            grid[row * nz..][..nz].fill(T::neg_infinity());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts of balls on a grid that wraps, against the definition at each voxel.
    #[test]
    fn voxels_that_enough_restraints_hold_are_allowed() {
        let counts = [9, 12, 70];
        let firsts = [4, 7, 33];
        let balls: [&[([f64; 3], f64)]; 4] = [
            &[([3.0, 4.2, 30.0], 5.0)],
            &[
                ([5.0, 6.0, 33.0], 4.5),
                ([4.0, 6.0, 34.5], 3.0),
                ([0.0, 0.0, 0.0], 2.0),
            ],
            &[([4.0, 5.0, 66.0], 40.0)],
            &[([-3.0, 20.0, 5.0], 4.0)],
        ];
        let mut tally = Tally::default();
        let mut mask = RowMask::default();
        // One tally counts several grids.
        for needed in [1, 2, 3, 4, 1] {
            tally.begin(counts, (balls.len(), needed));
            for restraint in balls {
                tally.add(restraint.iter().copied());
            }
            tally.finish(firsts, &mut mask);
            let holds = |ball: &([f64; 3], f64), at: [usize; 3]| {
                let square: f64 = (0..3).map(|k| (ball.0[k] - at[k] as f64).powi(2)).sum();
                square <= ball.1 * ball.1
            };
            let mut allowed = 0;
            for voxel in 0..counts.iter().product() {
                let at = [voxel / (12 * 70), voxel / 70 % 12, voxel % 70];
                let held = balls
                    .iter()
                    .filter(|balls| balls.iter().any(|ball| holds(ball, at)));
                let expected = held.count() >= needed;
                let index = [0, 1, 2].map(|axis| (at[axis] + firsts[axis]) % counts[axis]);
                assert_eq!(mask.allows(counts, index), expected, "{needed} {at:?}");
                allowed += usize::from(expected);
            }
            assert_eq!(allowed > 0, needed < 4);
            assert_eq!(mask.is_empty(), needed == 4);
        }
    }

    /// Rows with allowed voxels keep these, and peaks are found among them alone.
    #[test]
    fn peaks_are_looked_for_where_it_is_allowed() {
        let size = [8, 8, 8];
        let mut tally = Tally::default();
        let mut mask = RowMask::default();
        tally.begin(size, (1, 1));
        tally.add(std::iter::once(([3.0, 3.0, 3.0], 1.0)));
        tally.finish([2, 0, 7], &mut mask);
        let mut grid: Vec<f32> = (0..512).map(|index| (index * 7919 % 512) as f32).collect();
        let before = grid.clone();
        let mut rows = vec![0.0f32; 64];
        mask.apply(size, &mut grid, &mut rows);
        let mut found = Vec::new();
        let values = (&mut grid[..], &mut rows[..]);
        knotdock_scoring::peaks::find_peaks(size, values, 0, (9, f64::NEG_INFINITY), &mut found);
        // The middle of the ball is (5, 3, 2).
        let allowed = |voxel: usize| mask.allows(size, [voxel / 64, voxel / 8 % 8, voxel % 8]);
        assert_eq!((0..512).filter(|&voxel| allowed(voxel)).count(), 7);
        assert!(allowed((5 * 8 + 3) * 8 + 2));
        let best = (0..512).filter(|&voxel| allowed(voxel));
        let best = best
            .max_by(|&a, &b| before[a].total_cmp(&before[b]))
            .unwrap();
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].voxel as usize, best);
    }
}
