//! Numbers at random that are the same in every run.

/// A generator of numbers: SplitMix64, Steele, Lea & Flood, OOPSLA 2014, 453-472.
pub(super) struct Numbers(pub u64);

impl Numbers {
    /// The next number, 0 to 1.
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    }

    /// The next whole number below `count`, which is at least 1.
    pub fn below(&mut self, count: usize) -> usize {
        (self.next() * count as f64) as usize % count
    }
}
