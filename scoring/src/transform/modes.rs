//! The modes of a periodic box that a correlation keeps: those inside the kernel's cut-off ball, half of them.

/// All modes with kz >= 0, |k_i| < n_i / 2 and |w| < cut, as columns along x.
///
/// Columns come by rising kz, then ky in transform order (0, 1, ..., -2, -1); within a column kx runs from -kx_max to
/// kx_max.
#[derive(Clone, Debug)]
pub struct ModeSet {
    /// Grid points per axis (nx, ny, nz), each even.
    pub size: [usize; 3],
    /// Box lengths in Å.
    pub lengths: [f64; 3],
    /// Frequency from which on no mode is kept, cycles per Å.
    pub cut: f64,
    /// The columns.
    pub columns: Vec<Column>,
    /// For each kz = 0..=kz_max the range of its columns.
    pub planes: Vec<std::ops::Range<usize>>,
    /// Number of modes in all columns.
    pub count: usize,
}

/// Modes that differ in kx alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Index along y, negative for negative frequencies.
    pub ky: i32,
    /// Index along z, not negative.
    pub kz: i32,
    /// Modes kx = -kx_max..=kx_max belong to the column.
    pub kx_max: i32,
    /// Place of the first mode (kx = -kx_max) in arrays over all modes.
    pub start: usize,
}

impl Column {
    /// Number of modes in the column.
    pub fn count(&self) -> usize {
        2 * self.kx_max as usize + 1
    }
}

impl ModeSet {
    /// The modes of a box in the ball |w| < `cut`.
    pub fn new(size: [usize; 3], lengths: [f64; 3], cut: f64) -> Self {
        let limit = |axis: usize| (size[axis] as i32 - 1) / 2;
        let mut columns = Vec::new();
        let mut planes = Vec::new();
        let mut count = 0;
        for kz in 0..=limit(2) {
            let first = columns.len();
            let wz = f64::from(kz) / lengths[2];
            for ky in (0..=limit(1)).chain(-limit(1)..=-1) {
                let wy = f64::from(ky) / lengths[1];
                // Alike for (y, z) and (z, y), so that quarter turns about x map the set onto itself.
                let rest = cut * cut - (wy * wy + wz * wz);
                if rest <= 0.0 {
                    continue;
                }
                // Strictly inside the ball: |w| < cut.
                let kx_max = ((rest.sqrt() * lengths[0]).ceil() as i32 - 1).min(limit(0));
                let column = Column {
                    ky,
                    kz,
                    kx_max,
                    start: count,
                };
                count += column.count();
                columns.push(column);
            }
            if columns.len() == first {
                break;
            }
            planes.push(first..columns.len());
        }
        Self {
            size,
            lengths,
            cut,
            columns,
            planes,
            count,
        }
    }

    /// Visits every mode in order with its frequency (wx, wy, wz), cycles per Å, and its multiplicity: 1 at kz = 0,
    /// where the set holds both signs, else 2.
    pub fn for_each(&self, mut visit: impl FnMut(usize, [f64; 3], f64)) {
        for column in &self.columns {
            let wy = f64::from(column.ky) / self.lengths[1];
            let wz = f64::from(column.kz) / self.lengths[2];
            let multiplicity = if column.kz == 0 { 1.0 } else { 2.0 };
            for (place, kx) in (-column.kx_max..=column.kx_max).enumerate() {
                let wx = f64::from(kx) / self.lengths[0];
                visit(column.start + place, [wx, wy, wz], multiplicity);
            }
        }
    }

    /// For each column the one that has -ky instead of ky.
    pub fn mirrors(&self) -> Vec<u32> {
        let mut mirrors = vec![0; self.columns.len()];
        for range in &self.planes {
            // ky comes as 0, 1, ..., n, -n, ..., -1.
            mirrors[range.start] = range.start as u32;
            for (up, down) in (range.start + 1..range.end).zip((range.start + 1..range.end).rev()) {
                mirrors[up] = down as u32;
            }
        }
        mirrors
    }

    /// Whether quarter turns about x map the modes onto themselves: the box is as long in y as in z.
    pub fn has_quarter_turns(&self) -> bool {
        self.size[1] == self.size[2] && self.lengths[1] == self.lengths[2]
    }

    /// Volume of the box in Å^3.
    pub fn volume(&self) -> f64 {
        self.lengths.iter().product()
    }
}

/// Place of index k in a transform of length n.
#[inline(always)]
pub fn place(k: i32, n: usize) -> usize {
    if k >= 0 {
        k as usize
    } else {
        (n as i32 + k) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holds_each_mode_of_the_ball_once_up_to_conjugation() {
        let modes = ModeSet::new([12, 10, 14], [24.0, 21.0, 26.0], 0.2);
        let mut seen = 0.0;
        modes.for_each(|_, w, multiplicity| {
            assert!(w.iter().map(|x| x * x).sum::<f64>() < 0.04);
            seen += multiplicity;
        });
        let mut expected = 0.0;
        for kx in -5..=5 {
            for ky in -4..=4 {
                for kz in -6..=6 {
                    let w = [
                        f64::from(kx) / 24.0,
                        f64::from(ky) / 21.0,
                        f64::from(kz) / 26.0,
                    ];
                    if w.iter().map(|x| x * x).sum::<f64>() < 0.04 {
                        expected += 1.0;
                    }
                }
            }
        }
        assert_eq!(seen, expected);
        assert_eq!(
            modes.columns.last().map(|c| c.start + c.count()),
            Some(modes.count)
        );
    }
}
