//! Frequencies of a cube, k / L with integer k, by shells of rising |k|^2.
//!
//! Functions are real, so half of the frequencies are kept: one of each pair of conjugates. They come as columns along
//! x, whose entries are harmonics k >= 0 that stand for both +k and -k.

use std::ops::Range;

/// Modes of the first block; each block after it doubles what was there.
const FIRST: usize = 32;

/// One harmonic of a column.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// |kx|.
    pub k: usize,
    /// |k|^2.
    pub shell: usize,
    /// Counts of +kx and -kx: 2 for a mode and its conjugate, 0 for one that is not there.
    pub counts: [f64; 2],
}

/// Entries that share ky and kz.
#[derive(Clone, Debug)]
pub(super) struct Column {
    pub ky: i32,
    pub kz: usize,
    pub entries: Range<usize>,
}

/// Some shells.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    pub columns: Vec<Column>,
    pub entries: Vec<Entry>,
    /// Modes, conjugates counted.
    pub modes: usize,
    /// The shell after the last.
    pub end: usize,
}

/// All shells up to a number of modes.
#[derive(Clone, Debug)]
pub(super) struct Lattice {
    /// Edge of the cube.
    pub length: f64,
    /// Blocks of shells, lowest frequencies first.
    pub blocks: Vec<Block>,
    /// Largest |k| along an axis.
    pub limit: usize,
}

impl Lattice {
    /// The largest whole number of shells with at most `most` modes, conjugates counted; at least the mean.
    pub fn new(length: f64, most: usize) -> Self {
        // The ball of this radius has more.
        let limit = (0.63 * (most.max(1) as f64).cbrt()).ceil() as usize + 2;
        let counts = counts(limit);
        let mut ends = Vec::new();
        let (mut total, mut stop) = (0, FIRST);
        for (shell, &count) in counts.iter().enumerate() {
            if total + count > most.max(1) {
                break;
            }
            if total > 0 && total + count > stop {
                ends.push(shell);
                stop = 2 * total.max(FIRST);
            }
            total += count;
            if shell + 1 == counts.len() || total + counts[shell + 1] > most.max(1) {
                ends.push(shell + 1);
                break;
            }
        }
        let mut start = 0;
        let blocks: Vec<Block> = ends
            .iter()
            .map(|&end| {
                let block = Block::new(start..end);
                start = end;
                block
            })
            .collect();
        let ks = blocks.iter().map(|block| (block.end - 1).isqrt());
        Self {
            length,
            limit: ks.max().unwrap_or(0),
            blocks,
        }
    }

    /// Modes in all blocks, conjugates counted.
    pub fn modes(&self) -> usize {
        self.blocks.iter().map(|block| block.modes).sum()
    }

    /// Number of shells.
    pub fn shells(&self) -> usize {
        self.blocks.last().map_or(0, |block| block.end)
    }

    /// Most entries in a block.
    pub fn widest(&self) -> usize {
        let entries = self.blocks.iter().map(|block| block.entries.len());
        entries.max().unwrap_or(0)
    }
}

impl Block {
    /// The shells of a range.
    fn new(shells: Range<usize>) -> Self {
        let limit = (shells.end - 1).isqrt() as i32;
        let mut block = Self {
            end: shells.end,
            ..Self::default()
        };
        for kz in 0..=limit {
            for ky in if kz == 0 { 0 } else { -limit }..=limit {
                let start = block.entries.len();
                let axis = ky == 0 && kz == 0;
                for k in 0..=limit {
                    let shell = (k * k + ky * ky + kz * kz) as usize;
                    if !shells.contains(&shell) {
                        continue;
                    }
                    let counts = match (axis, k) {
                        (true, 0) => [1.0, 0.0],
                        (true, _) | (false, 0) => [2.0, 0.0],
                        (false, _) => [2.0, 2.0],
                    };
                    block.modes += (counts[0] + counts[1]) as usize;
                    let k = k as usize;
                    block.entries.push(Entry { k, shell, counts });
                }
                let entries = start..block.entries.len();
                if !entries.is_empty() {
                    let kz = kz as usize;
                    block.columns.push(Column { ky, kz, entries });
                }
            }
        }
        block
    }
}

/// Number of lattice points on each shell |k|^2 < `limit`^2.
fn counts(limit: usize) -> Vec<usize> {
    let mut counts = vec![0; limit * limit];
    let times = |k: usize| if k == 0 { 1 } else { 2 };
    for x in 0..limit {
        for y in 0..limit {
            for z in 0..limit {
                if let Some(count) = counts.get_mut(x * x + y * y + z * z) {
                    *count += times(x) * times(y) * times(z);
                }
            }
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mode_of_the_ball_is_there_once() {
        for most in [1, 6, 7, 33, 100, 4096, 20_000] {
            let lattice = Lattice::new(1.0, most);
            let shells = lattice.shells();
            let limit = (shells - 1).isqrt() as i32;
            let mut points = 0;
            for x in -limit..=limit {
                for y in -limit..=limit {
                    for z in -limit..=limit {
                        points += usize::from(((x * x + y * y + z * z) as usize) < shells);
                    }
                }
            }
            assert_eq!(points, lattice.modes());
            assert!(points <= most && lattice.limit == limit as usize);
            // The next shell that is not empty would not have fitted.
            let next = Lattice::new(1.0, most + most / 8 + 64);
            assert!(next.modes() > most || next.shells() == shells);
        }
        assert_eq!(Lattice::new(1.0, 0).modes(), 1);
    }
}
